"""The cache on disk gives back what was kept, and never stops a render: damaged, unwritable or full, it is passed over."""

from __future__ import annotations

import os
import subprocess
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from render import disk_cache
from render.disk_cache import ArrayCache, cache_folder, code_key, content_key, load_arrays, store_arrays
from render.errors import OutputError
from render.model.lens import Glass, HeightField, Surface

KEY = content_key("a key")
KEPT = {"rows": np.arange(12, dtype=np.float32).reshape(3, 4) / 7, "reach": np.asarray(0.1)}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of an empty cache; it does not exist yet."""
    monkeypatch.setenv(disk_cache.ENVIRONMENT, str(tmp_path / "home" / "cache"))
    return tmp_path / "home" / "cache"


def test_arrays_come_back_to_the_bit(folder: Path) -> None:
    assert load_arrays("table", KEY) is None
    store_arrays("table", KEY, KEPT)
    found = load_arrays("table", KEY)
    assert found is not None
    assert list(found) == list(KEPT)
    for name, array in KEPT.items():
        assert found[name].dtype == array.dtype
        np.testing.assert_array_equal(found[name], array)
    assert load_arrays("table", content_key("another key")) is None
    assert load_arrays("other", KEY) is None


@pytest.mark.parametrize("damage", ["cut", "empty", "flipped", "not ours"])
def test_a_damaged_entry_is_ignored_and_written_anew(folder: Path, damage: str) -> None:
    store_arrays("table", KEY, KEPT)
    (entry,) = folder.iterdir()
    whole = entry.read_bytes()
    flipped = bytes([*whole[:90], whole[90] ^ 1, *whole[91:]])
    entry.write_bytes({"cut": whole[:-5], "empty": b"", "flipped": flipped, "not ours": b"hello, world"}[damage])
    assert load_arrays("table", KEY) is None
    store_arrays("table", KEY, KEPT)
    assert entry.read_bytes() == whole


def test_a_folder_that_cannot_be_made_is_passed_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv(disk_cache.ENVIRONMENT, str(tmp_path / "file" / "cache"))
    store_arrays("table", KEY, KEPT)
    assert load_arrays("table", KEY) is None


@pytest.mark.parametrize("error", [OutputError("the disk is full"), PermissionError("read-only")])
def test_a_disk_that_takes_nothing_is_passed_over(
    folder: Path, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    def refuse(path: Path, content: bytes) -> None:
        raise error

    monkeypatch.setattr(disk_cache, "write_atomic", refuse)
    store_arrays("table", KEY, KEPT)
    assert load_arrays("table", KEY) is None


def test_the_entries_used_last_stay_within_the_limit(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    keys = [content_key(i) for i in range(4)]
    store_arrays("table", keys[0], KEPT)
    size = sum(path.stat().st_size for path in folder.iterdir())
    monkeypatch.setattr(disk_cache, "MAX_BYTES", 2 * size)
    for age, key in enumerate(keys[1:]):
        for path in folder.iterdir():
            os.utime(path, (0, age))
        load_arrays("table", keys[0])
        store_arrays("table", key, KEPT)
    assert [load_arrays("table", key) is not None for key in keys] == [True, False, False, True]


def test_large_arrays_are_not_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(disk_cache, "MAX_ENTRY_BYTES", 47)
    store_arrays("table", KEY, KEPT)
    assert not folder.exists()


def test_two_processes_write_the_same_entry_at_once(folder: Path) -> None:
    code = (
        "import numpy as np\n"
        "from render.disk_cache import content_key, load_arrays, store_arrays\n"
        "for i in range(50):\n"
        "    store_arrays('table', content_key(i % 3), {'rows': np.full(1000, i % 3)})\n"
        "    found = load_arrays('table', content_key(i % 3))\n"
        "    assert found is not None and (found['rows'] == i % 3).all()\n"
    )
    both = [subprocess.Popen([sys.executable, "-c", code], stderr=subprocess.PIPE, text=True) for _ in range(2)]
    for process in both:
        _, error = process.communicate()
        assert process.returncode == 0, error
    assert len(list(folder.iterdir())) == 3


@pytest.mark.parametrize(
    ("variables", "ending"),
    [
        ({"PULLFOCUS_CACHE": "/a/b", "XDG_CACHE_HOME": "/x"}, "/a/b"),
        ({"PULLFOCUS_CACHE": "", "XDG_CACHE_HOME": "/x"}, "/x/pullfocus"),
        ({"PULLFOCUS_CACHE": "", "XDG_CACHE_HOME": "", "HOME": "/h"}, "/h/.cache/pullfocus"),
        ({"PULLFOCUS_CACHE": "off"}, None),
    ],
)
def test_the_environment_names_the_folder(
    variables: dict[str, str], ending: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "platform", "linux")
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert cache_folder() == (None if ending is None else Path(ending))


def test_different_values_have_different_keys() -> None:
    values = [
        (1, 2), ((1,), 2), (12,), ("1", 2), (1.0, 2), (True, 2), (None, 2), (b"1", 2), ("ab", "c"), ("a", "bc"),
        Glass(), Glass(index=1.5), Surface(10.0, 1.0), np.zeros(2), np.zeros(2, np.float32), np.zeros((2, 1)),
        HeightField(front=np.zeros((2, 2))), HeightField(back=np.zeros((2, 2))),
    ]  # fmt: skip
    assert len({content_key(value) for value in values}) == len(values)
    assert content_key(HeightField(np.ones((2, 2)))) == content_key(HeightField(np.ones((2, 2))))
    assert content_key(np.float64(0.1)) == content_key(0.1)
    with pytest.raises(TypeError, match="object has no content key"):
        content_key(object())


def test_a_change_of_the_code_changes_its_key(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(disk_cache, "_PACKAGE", tmp_path)
    source = tmp_path / "optics" / "lenses" / "trace.py"
    source.parent.mkdir(parents=True)
    keys = []
    for text in ("a = 1\n", "a = 12\n"):
        source.write_text(text)
        disk_cache._source_files.cache_clear()
        keys.append(code_key(["optics"]))
    assert keys[0] != keys[1]


def number(value: int) -> dict[str, np.ndarray]:
    """Arrays that hold one number."""
    return {"number": np.asarray(value)}


def test_an_array_cache_computes_once_in_all_processes(folder: Path) -> None:
    computed = []

    def compute() -> dict[str, np.ndarray]:
        computed.append(1)
        return {"numbers": np.arange(3.0) / 7}

    caches = [ArrayCache("numbers", ("optics",)) for _ in range(2)]
    first, second = (cache.get(compute, 2.5, "a") for cache in caches)
    assert len(computed) == 1
    assert first["numbers"].tobytes() == second["numbers"].tobytes()
    caches[1].get(compute, 2.5, "b")
    ArrayCache("others", ("optics",)).get(compute, 2.5, "a")
    assert len(computed) == 3


def test_an_array_cache_keeps_its_first_entries_alone(folder: Path) -> None:
    cache = ArrayCache("numbers", ("optics",), most=2)
    for i in range(5):
        assert cache.get(partial(number, i), i)["number"] == i
    assert len(list(folder.iterdir())) == 2
    assert cache.get(partial(number, 7), 4)["number"] == 4  # held in memory
    assert cache.get(partial(number, 7), 2)["number"] == 7


def test_an_array_cache_computes_anew_what_is_damaged(folder: Path) -> None:
    for content in (b"", b"\0\0\0\0", b"hello, world"):
        assert ArrayCache("numbers", ("optics",)).get(partial(number, 1), 1)["number"] == 1
        (entry,) = folder.iterdir()
        entry.write_bytes(content)
    assert ArrayCache("numbers", ("optics",)).get(partial(number, 2), 1)["number"] == 2
