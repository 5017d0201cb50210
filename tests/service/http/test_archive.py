"""Archives from strangers: nothing leaves the folder, nothing goes off in it."""

from __future__ import annotations

import io
import stat
import struct
import zipfile
import zlib
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from service.http.archive import unpack
from service.http.errors import ServiceError
from service.http.settings import MEBIBYTE, Settings
from service.http.upload import MAX_CANDIDATES, choose_root, upload_name

LIMITS = Settings(data=Path("unused"), max_unpacked_mb=100, max_archive_entries=20, max_archive_ratio=50)


def zipped(*entries: tuple[str | zipfile.ZipInfo, bytes]) -> io.BytesIO:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in entries:
            archive.writestr(name, content)
    return file


def refused(file: io.BytesIO, folder: Path, limits: Settings = LIMITS) -> ServiceError:
    folder.mkdir(exist_ok=True)
    with pytest.raises(ServiceError) as error:
        unpack(file, "shot.zip", folder, limits)
    assert 400 <= error.value.status < 500
    return error.value


def files_in(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_files_come_out_as_they_went_in(tmp_path):
    sent = {"shot.usda": b"#usda 1.0\n", "textures/wood grain.png": bytes(range(256)), "a/b/c.txt": b""}
    unpack(zipped(*sent.items(), ("a/empty/", b"")), "shot.zip", tmp_path, LIMITS)
    assert files_in(tmp_path) == sent


def test_clutter_of_desktops_stays_out_and_backslashes_are_folders(tmp_path):
    entries = [("__MACOSX/._shot.usda", b"x"), ("set/.DS_Store", b"x"), ("set\\shot.usda", b"#usda 1.0\n")]
    unpack(zipped(*entries), "shot.zip", tmp_path, LIMITS)
    assert files_in(tmp_path) == {"set/shot.usda": b"#usda 1.0\n"}


@pytest.mark.parametrize(
    "name", ["../out.usda", "a/../../out.usda", "/etc/out.usda", "\\\\host\\out.usda", "C:\\out.usda", "..\\out.usda"]
)
def test_a_name_that_leaves_the_folder_is_refused(tmp_path, name):
    error = refused(zipped(("shot.usda", b""), (name, b"out")), tmp_path / "files")
    assert (error.status, error.code) == (422, "unsafe_archive")
    assert "out.usda" in (error.path or "")
    assert set(files_in(tmp_path)) <= {"files/shot.usda"}


@pytest.mark.parametrize("kind", [stat.S_IFLNK, stat.S_IFCHR, stat.S_IFIFO])
def test_links_and_devices_are_refused(tmp_path, kind):
    entry = zipfile.ZipInfo("shot.usda")
    entry.external_attr = (kind | 0o777) << 16
    assert refused(zipped((entry, b"/etc/passwd")), tmp_path).code == "unsafe_archive"
    assert files_in(tmp_path) == {}


@pytest.mark.parametrize("second", ["shot.usda", "./shot.usda", "shot.usda/inside.usda"])
def test_one_name_for_two_things_is_refused(tmp_path, second):
    with pytest.warns(UserWarning, match="Duplicate name") if second == "shot.usda" else io.BytesIO():
        file = zipped(("shot.usda", b"one"), (second, b"two"))
    assert refused(file, tmp_path).code == "unsafe_archive"


def test_a_bomb_is_stopped_by_its_ratio_while_it_goes_off(tmp_path):
    file = zipped(("shot.usda", b"\0" * (90 * MEBIBYTE)))
    error = refused(file, tmp_path)
    assert (error.status, error.code, error.path) == (413, "archive_too_large", "shot.usda")
    assert sum(map(len, files_in(tmp_path).values())) <= 64 * MEBIBYTE


def test_a_bomb_is_stopped_by_its_size(tmp_path):
    chunk = b"\0" * MEBIBYTE
    error = refused(zipped(*((f"{n}.bin", chunk) for n in range(12))), tmp_path, replace(LIMITS, max_unpacked_mb=10))
    assert (error.status, error.path) == (413, "10.bin")
    assert len(files_in(tmp_path)) == 11


def test_a_bomb_that_lies_about_its_size_is_stopped(tmp_path):
    """The headers say 10 bytes; zipfile stops reading there, and the checksum gives the lie away."""
    content = b"\0" * (8 * MEBIBYTE)
    file = zipped(("shot.usda", content))
    honest = struct.pack("<L", len(content))
    file = io.BytesIO(file.getvalue().replace(honest, struct.pack("<L", 10)))
    assert refused(file, tmp_path).code == "bad_archive"
    assert sum(map(len, files_in(tmp_path).values())) <= MEBIBYTE


def test_too_many_entries_are_refused(tmp_path):
    error = refused(zipped(*((f"{n}.txt", b"") for n in range(21))), tmp_path)
    assert (error.status, error.code) == (413, "archive_too_large")
    assert files_in(tmp_path) == {}


def test_too_many_folders_are_refused(tmp_path):
    limits = replace(LIMITS, max_archive_entries=20)
    deep = [(f"{letter}/" + "/".join(f"{letter}{depth}" for depth in range(9)) + "/f.txt", b"") for letter in "abc"]
    error = refused(zipped(*deep), tmp_path, limits)
    assert (error.status, error.code, error.path) == (413, "archive_too_large", deep[2][0])
    assert len([path for path in tmp_path.rglob("*") if path.is_dir()]) <= 20


def test_a_list_of_entries_that_would_fill_the_memory_is_not_read(tmp_path, monkeypatch):
    monkeypatch.setattr(zipfile.ZipFile, "__init__", lambda *_: pytest.fail("the list of entries was read"))
    end = struct.pack("<4s4H2LH", b"PK\x05\x06", 0, 0, 1, 1, 400_000_000, 0, 0)
    assert refused(io.BytesIO(b"\0" * 100 + end), tmp_path).status == 413


def test_zip64_is_refused_where_its_list_could_be_any_length(tmp_path):
    plain = zipped(("shot.usda", b"")).getvalue()
    locator = struct.pack("<4sLQL", b"PK\x06\x07", 0, 0, 1)
    assert refused(io.BytesIO(plain[:-22] + locator + plain[-22:]), tmp_path).code == "bad_archive"


@pytest.mark.parametrize("damage", ["empty", "text", "truncated", "content", "encrypted"])
def test_damage_is_named(tmp_path, damage):
    whole = zipped(("shot.usda", zlib.compress(bytes(range(256)) * 50))).getvalue()
    flags = whole.index(b"PK\x01\x02") + 8
    sent = {
        "empty": b"",
        "text": b"#usda 1.0\n" * 20,
        "truncated": whole[: len(whole) // 2],
        "content": whole[:60] + b"\xff\xff\xff\xff" + whole[64:],
        "encrypted": whole[:flags] + b"\x01" + whole[flags + 1 :],
    }[damage]
    error = refused(io.BytesIO(sent), tmp_path)
    assert error.code in ("bad_archive", "unsafe_archive")


@given(at=st.integers(0, 400), value=st.binary(min_size=1, max_size=4))
@settings(max_examples=200)
def test_no_damage_leads_to_anything_but_a_refusal(tmp_path_factory, at, value):
    whole = zipped(("set/shot.usda", b"#usda 1.0\n" * 9), ("a.png", bytes(64))).getvalue()
    broken = whole[:at] + value + whole[at + len(value) :]
    top = tmp_path_factory.mktemp("fuzz")
    folder = top / "files"
    folder.mkdir()
    with suppress(ServiceError):  # any other exception fails the test
        unpack(io.BytesIO(broken), "shot.zip", folder, LIMITS)
    assert [p.name for p in top.iterdir()] == ["files"]


@pytest.mark.parametrize(
    ("paths", "requested", "root"),
    [
        (["shot.usda", "a.png"], None, "shot.usda"),
        (["set/shot.usdc", "set/sub/prop.usda"], None, "set/shot.usdc"),
        (["one.usda", "two.usda"], "two.usda", "two.usda"),
        (["one.usda", "sub/two.usda"], "./sub/two.usda", "sub/two.usda"),
        (["Shot.USDZ"], "", "Shot.USDZ"),
    ],
)
def test_the_root_layer_is_found(paths, requested, root):
    assert choose_root(paths, requested, "shot.zip") == root


@pytest.mark.parametrize(
    ("paths", "requested", "code"),
    [
        (["a.png"], None, "no_stage"),
        ([], None, "no_stage"),
        (["one.usda", "two.usda"], None, "ambiguous_root"),
        (["one.usda"], "two.usda", "bad_root"),
        (["one.usda"], "../one.usda", "bad_root"),
        (["one.usda", "a.png"], "a.png", "bad_root"),
    ],
)
def test_a_root_layer_that_cannot_be_found_is_named(paths, requested, code):
    with pytest.raises(ServiceError) as error:
        choose_root(paths, requested, "shot.zip")
    assert (error.value.status, error.value.code) == (422, code)


def test_a_choice_of_roots_is_listed_and_not_too_long():
    stages = [f"{number:04}.usda" for number in range(MAX_CANDIDATES + 50)]
    with pytest.raises(ServiceError) as error:
        choose_root([*stages, "sets/deeper.usda", "notes.txt"], None, "shot.zip")
    assert [finding["path"] for finding in error.value.errors] == stages[:MAX_CANDIDATES]
    assert len(error.value.detail) < 300


@pytest.mark.parametrize(
    ("sent", "name"),
    [("shot.usda", "shot.usda"), ("C:\\work\\My Shot.USD", "My Shot.USD"), ("../../x/ä?.zip", "ä_.zip")],
)
def test_a_file_name_is_made_safe(sent, name):
    assert upload_name(sent, b"") == name


@pytest.mark.parametrize("sent", [None, "", "shot", "shot.fbx", ".usda", "shot.usda.exe", "..", "usda/"])
def test_what_is_no_stage_by_its_name_is_refused(sent):
    with pytest.raises(ServiceError) as error:
        upload_name(sent, b"")
    assert (error.value.status, error.value.code) == (415, "unsupported_type")


@pytest.mark.parametrize(
    ("begin", "name"), [(b"#usda 1.", "piped.usda"), (b"PXR-USDC", "piped.usdc"), (b"PK\x03\x04\0\0\0\0", "piped.zip")]
)
def test_a_name_without_a_suffix_gets_that_of_the_content(begin, name):
    assert upload_name("piped", begin) == name
    assert upload_name("-", b"#usda 1.").endswith(".usda")
    with pytest.raises(ServiceError):
        upload_name("piped.txt", begin)
