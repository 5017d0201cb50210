"""Cache folders of workers: each process has its own, begins with what all share, and leaves nothing behind."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest

from service.workers import caches, folders, own_cache
from service.workers.caches import KEPT_BASE_S, KEPT_BASES, Caches
from service.workers.calls import call
from service.workers.errors import UnfitError
from service.workers.folders import is_fuller, remove_tree
from service.workers.own_cache import begin_cache
from service.workers.places import Place
from service.workers.roles import role
from tests.service.conftest import until
from tests.service.workers.fake_work import Tally, read, temporary_folder, try_to_change, write
from tests.service.workers.kit import LIMITS, WAIT_S, tally_lane, tally_pool, wait_until_idle

ROOM, HALL = Place("room"), Place("hall")
MOST_BYTES = 1 << 20


def caches_in(folder: Path, **environment: str) -> Caches:
    return Caches(folder, environment, MOST_BYTES)


@pytest.fixture
def shared(tmp_path) -> Iterator[Caches]:
    with closing(caches_in(tmp_path / "cache")) as made:
        yield made


@pytest.fixture
def base(shared) -> Path:
    """A base with one file."""
    shared.fill_base(lambda folder: (folder / "kept").write_text("compiled"))
    return shared.base


def test_a_worker_sees_no_other_cache_and_cannot_change_the_base(shared, base):
    with tally_pool(caches=shared) as pool, tally_lane(pool, options={"draws": True}) as lane:
        other = lane.submit(call(temporary_folder), HALL).result(WAIT_S)
        own = lane.submit(call(temporary_folder), ROOM).result(WAIT_S)
        assert own != other
        (base.parent / "kept").write_text("of the service")

        assert lane.submit(call(try_to_change, other), ROOM).result(WAIT_S) == []
        assert lane.submit(call(try_to_change, str(base)), ROOM).result(WAIT_S) == ["list", "read"]
        assert lane.submit(call(try_to_change, str(base.parent)), ROOM).result(WAIT_S) == []
        assert lane.submit(call(read, f"{own}/kept"), ROOM).result(WAIT_S) == b"compiled"
        assert lane.submit(call(write, f"{own}/kept"), ROOM).result(WAIT_S)

        assert lane.submit(call(read, f"{other}/kept"), HALL).result(WAIT_S) == b"compiled"
        assert [(file.name, file.read_text()) for file in base.iterdir()] == [("kept", "compiled")]


def test_a_worker_that_draws_nothing_begins_empty(shared, base):
    with tally_pool(caches=shared) as pool, tally_lane(pool) as lane:
        own = lane.submit(call(temporary_folder), ROOM).result(WAIT_S)
        assert os.listdir(own) == []


def test_the_cache_of_a_closed_worker_is_removed(shared):
    with tally_pool(caches=shared) as pool:
        process = pool.take(role("tally", Tally, LIMITS), ROOM)
        process.call(call(write, f"{process.cache}/made"), WAIT_S)
        pool.give_back(process)
        assert (process.cache / "made").exists()
        pool.close_place("room")
        until(lambda: not process.cache.exists())


def test_a_worker_that_fills_the_disk_is_ended(shared):
    blamed: list[tuple[str, str]] = []
    with (
        tally_pool(caches=shared, on_blame=lambda key, end: blamed.append((key, end))) as pool,
        tally_lane(pool) as lane,
    ):
        own = Path(lane.submit(call(temporary_folder), ROOM).result(WAIT_S))
        little = lane.submit(call(write, f"{own}/one", bytes(MOST_BYTES // 2)), ROOM)
        assert little.result(WAIT_S)
        pool.end_full()
        much = lane.submit(call(write, f"{own}/two", bytes(MOST_BYTES), pause_s=WAIT_S), ROOM)
        until(lambda: (own / "two").exists() and (own / "two").stat().st_size == MOST_BYTES)
        pool.end_full()
        error = much.exception(WAIT_S)
        assert isinstance(error, UnfitError)
        assert "disk" in str(error)
        until(lambda: bool(blamed) and not own.exists())
        assert lane.submit(call(temporary_folder), ROOM).result(WAIT_S) != str(own)
    assert blamed == [("room", "disk")]


def test_an_idle_worker_that_has_filled_the_disk_is_ended(shared):
    blamed: list[tuple[str, str]] = []
    with (
        tally_pool(caches=shared, on_blame=lambda key, end: blamed.append((key, end))) as pool,
        tally_lane(pool) as lane,
    ):
        own = Path(lane.submit(call(temporary_folder), ROOM).result(WAIT_S))
        for part in range(2):
            lane.submit(call(write, f"{own}/{part}", bytes(MOST_BYTES)), ROOM).result(WAIT_S)
        wait_until_idle(lane)
        pool.end_full()
        until(lambda: not own.exists())
        assert pool.processes() == []
    assert blamed == [("room", "disk")]


def test_a_worker_that_is_ended_as_its_call_returns_is_blamed_too(shared):
    blamed: list[tuple[str, str]] = []
    with tally_pool(caches=shared, on_blame=lambda key, end: blamed.append((key, end))) as pool:
        tally = role("tally", Tally, LIMITS)
        process = pool.take(tally, ROOM)
        process.kill("disk")
        pool.give_back(process)
        until(lambda: not process.is_alive())
        pool.give_back(pool.take(tally, ROOM))
    assert blamed == [("room", "disk")]


def test_a_base_survives_its_service(tmp_path):
    for content in ("first", "second"):
        with closing(caches_in(tmp_path)) as made:
            made.fill_base(lambda folder, text=content: (folder / "kept").write_text(text))
            assert (made.base / "kept").read_text() == "first"
    assert os.listdir(tmp_path) == [made.base.name]


def test_another_environment_has_another_base(tmp_path):
    with closing(caches_in(tmp_path)) as one, closing(caches_in(tmp_path, GALLIUM_DRIVER="softpipe")) as other:
        one.fill_base(lambda folder: None)
        assert other.base is None


def test_a_base_that_cannot_be_filled_does_not_exist(shared, tmp_path):
    def fail(folder: Path) -> None:
        (folder / "half").write_text("half")
        raise OSError(28, "no space")

    with pytest.raises(OSError, match="no space"):
        shared.fill_base(fail)
    assert shared.base is None
    shared.fill_base(lambda folder: (folder / "kept").write_text("whole"))
    assert [file.name for file in shared.base.iterdir()] == ["kept"]


def test_the_base_of_a_quicker_service_is_used(tmp_path, shared):
    def fill_slowly(folder: Path) -> None:
        (folder / "kept").write_text("slow")
        with closing(caches_in(tmp_path / "cache")) as other:
            other.fill_base(lambda quick: (quick / "kept").write_text("quick"))

    shared.fill_base(fill_slowly)
    assert (shared.base / "kept").read_text() == "quick"


def test_a_start_removes_what_ended_services_left(tmp_path, shared):
    folder = shared.create().parents[1]
    dead = folder / "run-0123456789abcdef"
    (tmp_path / "left" / "base").mkdir(parents=True)
    (tmp_path / "left" / "base" / "half").write_text("half")
    (tmp_path / "left").rename(dead)  # at once: the upkeep of `shared` may be at work
    ages_s = {"old": 2 * KEPT_BASE_S} | {f"recent{age_s}": age_s for age_s in range(60, 60 + KEPT_BASES)}
    for name, age_s in ages_s.items():
        (folder / f"base-{name}").mkdir()
        os.utime(folder / f"base-{name}", (time.time() - age_s,) * 2)
    (folder / "of somebody else").mkdir()
    living = shared.create()

    with closing(caches_in(folder)):
        unused = folder / f"base-recent{59 + KEPT_BASES}"
        until(lambda: not dead.exists() and not (folder / "base-old").exists() and not unused.exists())
        assert living.exists()
        assert len(list(folder.glob("base-recent*"))) == KEPT_BASES - 1
        assert (folder / "of somebody else").exists()


def test_workers_do_without_caches_that_cannot_be_written(tmp_path, caplog):
    (tmp_path / "file").write_text("")
    with closing(caches_in(tmp_path / "file" / "cache")) as made, tally_pool(caches=made) as pool:
        with tally_lane(pool) as lane:
            assert lane.submit(call(read, "/dev/null"), ROOM).result(WAIT_S) == b""
        with pytest.raises(OSError, match="Not a directory"):
            made.fill_base(lambda folder: None)
    assert "cannot be written" in caplog.text


def test_a_copy_that_fails_leaves_no_part_of_a_file(tmp_path, monkeypatch):
    for name in ("base", "own"):
        (tmp_path / name).mkdir()
    (tmp_path / "base" / "kept").write_text("compiled")

    def write_half(path: Path, content: bytes) -> None:
        with path.open("wb") as file:
            file.write(content[:3])
        raise OSError(28, "no space")

    monkeypatch.setattr(Path, "write_bytes", write_half)
    monkeypatch.setattr(own_cache, "cache_environment", lambda folder: {})
    monkeypatch.setattr(own_cache.tempfile, "tempdir", None)
    begin_cache(tmp_path / "own", tmp_path / "base")
    assert os.listdir(tmp_path / "own") == []


def test_a_very_deep_folder_is_measured_and_removed(tmp_path):
    deep = tmp_path / "deep"
    deep.mkdir()
    at = os.open(deep, os.O_RDONLY)
    for _ in range(60):  # a path of 12,000 characters, three times what the kernel takes
        os.mkdir("d" * 200, dir_fd=at)
        below = os.open("d" * 200, os.O_RDONLY, dir_fd=at)
        os.close(at)
        at = below
    os.close(os.open("file", os.O_CREAT | os.O_WRONLY, dir_fd=at))
    os.close(at)
    (deep / "linked").symlink_to(tmp_path)
    (tmp_path / "stays").write_text("")

    assert is_fuller(deep, 1 << 40)  # nobody sees how much is down there
    remove_tree(deep)
    assert os.listdir(tmp_path) == ["stays"]


def test_a_folder_is_full_by_bytes_or_by_files(tmp_path, monkeypatch):
    (tmp_path / "below").mkdir()
    (tmp_path / "below" / "file").write_bytes(bytes(100_000))
    assert [is_fuller(tmp_path, most) for most in (99_000, 120_000)] == [True, False]
    monkeypatch.setattr(folders, "FILES", 1)
    assert is_fuller(tmp_path, 120_000)


def test_a_file_that_vanishes_hides_no_other_file(tmp_path, monkeypatch):
    for name in "abc":
        (tmp_path / name).write_bytes(bytes(100_000))
    scandir = folders.os.scandir

    @contextmanager
    def scandir_while_one_vanishes(path):
        with scandir(path) as entries:
            listed = list(entries)
            os.unlink(listed[0].path)
            yield iter(listed)

    monkeypatch.setattr(folders.os, "scandir", scandir_while_one_vanishes)
    assert is_fuller(tmp_path, 150_000)  # two of three are left


def test_a_lock_that_a_sweep_took_first_is_made_again(tmp_path, monkeypatch):
    folder = tmp_path / "cache"
    sweep_between = [True]
    lock = caches.fcntl.flock

    def locked(file: object, how: int) -> None:
        if sweep_between:
            sweep_between.clear()
            remove_tree(next(folder.glob("run-*")))
        lock(file, how)

    monkeypatch.setattr(caches.fcntl, "flock", locked)
    with closing(caches_in(folder)) as made:
        assert made.create().exists()
