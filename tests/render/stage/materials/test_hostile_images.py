"""Images from outside: opened by their content as one of a few formats, and refused by their header, not by the memory."""

from __future__ import annotations

import os
import resource
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from render.stage.materials import image_files
from render.stage.materials.image_files import TextureError
from render.stage.materials.textures import read_pixels
from tests.render.kits.hostile_images import IMAGE_BOMBS, file_name

KINDS = (
    "png",
    "jpg",
    "exr",
    "tif",
    "hdr",
    "webp",
    "gif",
    "bmp",
    "psd",
    "tga",
    "dpx",
    "sgi",
    "ppm",
    "iff",
    "dds",
    "cin",
)


def write(file: Path, pixels: np.ndarray | None = None) -> Path | None:
    """An image of a format by its suffix; None where OpenImageIO writes no such files."""
    pixels = np.full((8, 8, 3), 128, np.uint8) if pixels is None else pixels
    output = oiio.ImageOutput.create(str(file))
    if output is None:
        oiio.geterror()
        return None
    height, width, channels = pixels.shape
    assert output.open(str(file), oiio.ImageSpec(width, height, channels, str(pixels.dtype)))
    assert output.write_image(pixels)
    output.close()
    return file


def read(file: Path) -> np.ndarray:
    return read_pixels(str(file), "raw")[0]


def grown_kb(file: Path, match: str = ".") -> int:
    """Memory in kB by which the refusal of a file raises the peak."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    begun_s = time.monotonic()
    with pytest.raises(TextureError, match=match) as caught:
        read(file)
    assert time.monotonic() - begun_s < 5
    assert str(file.parent) not in str(caught.value)
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before


@pytest.mark.parametrize("kind", KINDS)
def test_formats_of_pictures_are_read_by_their_content(kind: str, tmp_path: Path) -> None:
    file = write(tmp_path / f"a.{kind}")
    if file is None:
        pytest.skip("OpenImageIO writes none")
    expected = read(file)
    assert expected.shape[:2] == (8, 8)

    for name in ("b?RES=100000x100000", "c.null", "d.term", f"e.{kind}?f.png"):
        if kind != "tga":  # which has no mark of its own
            np.testing.assert_array_equal(read(file.rename(tmp_path / name)), expected)
            file = tmp_path / name


def test_where_no_links_are_allowed_the_file_is_copied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = write(tmp_path / "a.png")
    assert file is not None
    expected = read(file)

    def refuse(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(Path, "symlink_to", refuse)
    np.testing.assert_array_equal(read(file.rename(tmp_path / "b.null")), expected)
    monkeypatch.setattr(image_files.shutil, "copyfile", refuse)
    with pytest.raises(TextureError, match="another suffix: Operation not permitted"):
        read(tmp_path / "b.null")


@pytest.mark.parametrize("name", ["x.null", "x.null?RES=100000x100000", "x.term", "x.png", "x.mp4", "x.tga"])
def test_what_is_no_picture_is_refused(name: str, tmp_path: Path) -> None:
    for content in (b"", b"x", b"#usda 1.0\n" * 9, bytes(4000)):
        (tmp_path / name).write_bytes(content)
        grown_kb(tmp_path / name, "unknown format")


def test_a_pipe_or_a_folder_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.png")
    (tmp_path / "b.png").mkdir()

    for name, match in (("a.png", "is no file"), ("b.png", "is "), ("c.png", "is missing"), ("a\0.png", "is missing")):
        with pytest.raises(TextureError, match=match):
            read(tmp_path / name)


@pytest.mark.parametrize("name", IMAGE_BOMBS)
def test_a_bomb_is_refused_by_its_header(name: str, tmp_path: Path) -> None:
    file = tmp_path / file_name(name)
    file.write_bytes(IMAGE_BOMBS[name])

    assert grown_kb(file) < 100_000
