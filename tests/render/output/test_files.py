"""PNG and JPEG, names of files, and writing that is never half done."""

from __future__ import annotations

import errno
import os
import struct
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import OpenImageIO
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import OutputError, SettingsError
from render.files import check_writable, read_regular_file, write_atomic
from render.film import Grade
from render.model.camera import Camera
from render.output import FrameMetadata, encode, format_of, write_frame
from render.output.encode import to_8_bit

METADATA = FrameMetadata(
    Camera(np.eye(4), focal_length_mm=35, f_stop=2.8, focus_distance_m=3.2, path="/cam"), time=12, stage="shot.usda"
)


def blank_frame(height: int, width: int) -> Any:
    return SimpleNamespace(color=np.zeros((height, width, 4), np.float32), aovs={})


def smooth_picture(height: int = 48, width: int = 64) -> np.ndarray:
    y, x = np.mgrid[0 : 1 : height * 1j, 0 : 1 : width * 1j]
    return np.stack([x, y, (1 - x) * y], axis=-1).astype(np.float32)


def encoded(file_format: str, picture: np.ndarray, metadata: FrameMetadata = METADATA) -> bytes:
    return encode(file_format, blank_frame(*picture.shape[:2]), picture, metadata)


def read_back(content: bytes, path: Path) -> OpenImageIO.ImageBuf:
    path.write_bytes(content)
    picture = OpenImageIO.ImageBuf(str(path))
    assert not picture.has_error
    return picture


def png_chunks(content: bytes) -> dict[bytes, bytes]:
    chunks, at = {}, 8
    while at < len(content):
        (length,) = struct.unpack(">I", content[at : at + 4])
        chunks[content[at + 4 : at + 8]] = content[at + 8 : at + 8 + length]
        at += 12 + length
    return chunks


def test_a_png_holds_the_nearest_of_256_levels_exactly(tmp_path: Path) -> None:
    picture = np.random.default_rng(0).uniform(0, 1, (9, 13, 3)).astype(np.float32)

    pixels = read_back(encoded("png", picture), tmp_path / "a.png").get_pixels(OpenImageIO.UINT8)

    assert pixels.shape == (9, 13, 3)
    assert np.abs(pixels / 255 - picture).max() <= 0.5 / 255 + 1e-6


@given(st.integers(0, 255))
def test_every_level_survives_its_own_rounding(level: int) -> None:
    assert to_8_bit(np.array([level / 255], np.float32))[0] == level


def test_levels_outside_the_display_are_clipped() -> None:
    np.testing.assert_array_equal(to_8_bit(np.array([-0.2, 0, 1, 1.7], np.float32)), [0, 0, 255, 255])


@pytest.mark.parametrize("file_format", ["png", "jpeg", "exr"])
def test_the_same_frame_gives_the_same_bytes_whenever_it_is_written(file_format: str, tmp_path: Path) -> None:
    first, second = encoded(file_format, smooth_picture()), encoded(file_format, smooth_picture())

    assert first == second
    names = [a.name.lower() for a in read_back(first, tmp_path / f"a.{file_format}").spec().extra_attribs]
    assert names, "metadata is there to be looked at"
    assert not [name for name in names if "date" in name]


def test_a_jpeg_is_close_and_keeps_colour_at_full_resolution(tmp_path: Path) -> None:
    picture = smooth_picture()

    read = read_back(encoded("jpeg", picture), tmp_path / "a.jpg")

    # Quality 92 quantises the lowest frequencies in steps of 2 to 3 levels.
    assert np.abs(read.get_pixels(OpenImageIO.FLOAT) - picture).mean() < 1.5 / 255
    assert read.spec()["jpeg:subsampling"] == "4:4:4"


@pytest.mark.parametrize("file_format", ["png", "jpeg"])
def test_a_picture_says_what_it_is_and_through_which_lens(file_format: str, tmp_path: Path) -> None:
    spec = read_back(encoded(file_format, smooth_picture()), tmp_path / f"a.{file_format}").spec()

    assert spec["Software"] == "Pullfocus"
    assert spec["ImageDescription"] == "shot.usda /cam frame 12"
    assert spec["Exif:FocalLength"] == pytest.approx(35)
    assert spec["FNumber"] == pytest.approx(2.8)
    assert spec["Exif:SubjectDistance"] == pytest.approx(3.2)


def test_a_png_is_marked_with_the_displays_colour_space() -> None:
    wide = FrameMetadata(METADATA.camera, grade=Grade(display="Display P3 - Display"))

    # ITU-T H.273: primaries 1 BT.709, 12 P3 D65; transfer 13 sRGB; matrix 0 RGB; full range.
    assert png_chunks(encoded("png", smooth_picture()))[b"cICP"] == bytes([1, 13, 0, 1])
    assert png_chunks(encoded("png", smooth_picture(), wide))[b"cICP"] == bytes([12, 13, 0, 1])


def test_a_picture_of_one_pixel_is_a_picture(tmp_path: Path) -> None:
    for file_format in ("png", "jpeg", "exr"):
        picture = read_back(encoded(file_format, np.ones((1, 1, 3), np.float32)), tmp_path / f"one.{file_format}")
        assert (picture.spec().width, picture.spec().height) == (1, 1)


@pytest.mark.parametrize(
    ("name", "expected"), [("a.exr", "exr"), ("b/c.PNG", "png"), ("d.e.jpg", "jpeg"), ("f.####.JPEG", "jpeg")]
)
def test_the_ending_of_a_name_chooses_the_format(name: str, expected: str) -> None:
    assert format_of(name) == expected


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("shot.mp4", "'shot.mp4' is a movie: expected a picture, one of .exr, .png, .jpg, .jpeg"),
        ("shot.AVI", "unknown movie format of 'shot.AVI': expected one of .mp4, .mov, .webm, got '.avi'"),
        ("shot.tif", r"unknown picture format of 'shot.tif': expected one of .exr, .png, .jpg, .jpeg, got '.tif'"),
        ("shot", "expected one of .exr, .png, .jpg, .jpeg, got no ending"),
    ],
)
def test_a_name_that_cannot_be_written_is_refused(name: str, message: str) -> None:
    with pytest.raises(SettingsError, match=message):
        format_of(name)


def test_an_unknown_format_is_refused() -> None:
    with pytest.raises(SettingsError, match="unknown picture format 'tiff': expected one of exr, jpeg, png"):
        encoded("tiff", smooth_picture())


def test_a_frame_is_written_in_the_format_of_its_name(tmp_path: Path) -> None:
    picture = smooth_picture()
    for name, file_format in (("a.png", "png"), ("a.jpg", "jpeg"), ("a.exr", "exr")):
        write_frame(tmp_path / name, blank_frame(48, 64), picture, METADATA)
        assert (tmp_path / name).read_bytes() == encoded(file_format, picture)
    assert sorted(os.listdir(tmp_path)) == ["a.exr", "a.jpg", "a.png"]


def test_an_existing_file_is_replaced_with_the_usual_permissions(tmp_path: Path) -> None:
    target = tmp_path / "a.png"
    target.write_bytes(b"old")
    (tmp_path / "usual").touch()

    write_atomic(target, b"new")

    assert target.read_bytes() == b"new"
    assert target.stat().st_mode == (tmp_path / "usual").stat().st_mode


@pytest.mark.parametrize(
    ("number", "code", "message"),
    [
        (errno.ENOSPC, "disk_full", "the disk is full"),
        (errno.EDQUOT, "disk_full", "the disk is full"),
        (errno.EROFS, "not_allowed", "writing in the folder .* is not allowed"),
        (errno.EIO, "output", "Input/output error"),
    ],
)
def test_a_disk_that_refuses_leaves_what_was_there(
    number: int, code: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "a.png"
    target.write_bytes(b"old")

    def refuse(descriptor: int) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, "fsync", refuse)
    with pytest.raises(OutputError, match=rf"cannot write .*a\.png: {message}") as caught:
        write_atomic(target, b"new")

    assert caught.value.code == code
    assert caught.value.path == str(target)
    assert target.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["a.png"]


def test_an_interruption_leaves_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*paths: Path) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_atomic(tmp_path / "a.png", b"new")

    assert os.listdir(tmp_path) == []


def test_a_missing_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"cannot write .*: the folder .*/no/such does not exist") as caught:
        write_atomic(tmp_path / "no" / "such" / "a.png", b"new")

    assert caught.value.code == "missing_folder"


def test_a_folder_in_the_files_place_is_kept(tmp_path: Path) -> None:
    (tmp_path / "a.png").mkdir()

    with pytest.raises(OutputError, match="it is a folder, expected a file"):
        write_atomic(tmp_path / "a.png", b"new")

    assert os.listdir(tmp_path) == ["a.png"]


def test_a_pipe_in_the_files_place_is_kept(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.png")

    for refusing in (lambda: write_atomic(tmp_path / "a.png", b"new"), lambda: check_writable(tmp_path / "a.png")):
        with pytest.raises(OutputError, match="it is a device or a pipe, expected a file"):
            refusing()

    assert (tmp_path / "a.png").is_fifo()


def test_what_cannot_be_written_is_known_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    check_writable(tmp_path / "a.png")
    assert os.listdir(tmp_path) == []
    with pytest.raises(OutputError, match=r"cannot write .*: the folder .*/no/such does not exist"):
        check_writable(tmp_path / "no" / "such" / "a.png")
    with pytest.raises(
        OutputError, match=r"cannot write /proc/a.png: (no file can be made|writing) in the folder /proc"
    ):
        check_writable("/proc/a.png")
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(OutputError, match=r"writing in the folder .* is not allowed"):
        check_writable(tmp_path / "a.png")


def test_an_encoder_without_room_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "gone"))

    with pytest.raises(OutputError, match=r"cannot encode a \.png file in the temporary folder .*gone"):
        encoded("png", smooth_picture())


def test_only_plain_files_of_the_right_size_are_read(tmp_path):
    file, folder, pipe, link = (tmp_path / name for name in ("file", "folder", "pipe", "link"))
    file.write_bytes(b"1234")
    folder.mkdir()
    os.mkfifo(pipe)
    link.symlink_to(file)
    assert read_regular_file(file, 4) == b"1234"
    assert read_regular_file(file, 3) is None
    before = len(os.listdir("/proc/self/fd"))
    for other in (folder, pipe, link, tmp_path / "missing", tmp_path / "nul\0"):
        assert read_regular_file(other, 4) is None
    assert len(os.listdir("/proc/self/fd")) == before
