"""Images from outside: opened by their content as one of a few formats, and refused by their header, not by the memory."""

from __future__ import annotations

import os
import resource
import struct
import time
import zlib
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from render.stage.materials.image_files import TextureError
from render.stage.materials.textures import read_pixels

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


def png(width: int, height: int, data: bytes, depth: int = 8, colour: int = 6) -> bytes:
    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    head = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(data, 9)) + chunk(b"IEND", b"")


def tiff(width: int, height: int, tile: int = 0, samples: int = 3) -> bytes:
    tags = [(256, 4, width), (257, 4, height), (258, 3, 8), (259, 3, 1), (262, 3, 2), (277, 3, samples)]
    tags += (
        [(322, 4, tile), (323, 4, tile), (324, 4, 8), (325, 4, 8)]
        if tile
        else [(273, 4, 8), (278, 4, height), (279, 4, 8)]
    )
    entries = b"".join(struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in sorted(tags))
    return b"II*\0" + struct.pack("<IHxxxxxx", 16, 0)[:12] + struct.pack("<H", len(tags)) + entries + bytes(4)


def exr(width: int, height: int, tile: int = 0) -> bytes:
    def entry(name: bytes, kind: bytes, value: bytes) -> bytes:
        return name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value

    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channels = b"".join(c + b"\0" + struct.pack("<iB3xii", 1, 0, 1, 1) for c in (b"B", b"G", b"R")) + b"\0"
    head = entry(b"channels", b"chlist", channels) + entry(b"compression", b"compression", b"\0")
    head += entry(b"dataWindow", b"box2i", window) + entry(b"displayWindow", b"box2i", window)
    head += entry(b"lineOrder", b"lineOrder", b"\0") + entry(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    head += entry(b"screenWindowCenter", b"v2f", bytes(8)) + entry(b"screenWindowWidth", b"float", struct.pack("<f", 1))
    if tile:
        head += entry(b"tiles", b"tiledesc", struct.pack("<IIB", tile, tile, 0))
    return b"\x76\x2f\x31\x01" + struct.pack("<I", 2 | (0x200 if tile else 0)) + head + b"\0" + bytes(64)


BOMBS = {
    "png_of_a_million_a_side": png(1_000_000, 1_000_000, b""),
    "png_beyond_the_limit": png(30_000, 30_000, b""),
    "png_of_16_bits": png(16_384, 16_384, bytes(100), 16),
    "png_that_is_too_short": png(16_000, 16_000, bytes(100)),
    "tiff_of_two_billion_a_side": tiff(2**31 - 1, 2**31 - 1),
    "tiff_that_is_too_short": tiff(16_000, 16_000),
    "tiff_of_60000_samples": tiff(4_000, 4_000, samples=60_000),
    "tiff_of_a_tile_that_is_huge": tiff(64, 64, 2**20),
    "exr_of_two_billion_a_side": exr(2**30, 2**30),
    "exr_that_is_too_short": exr(16_000, 16_000),
    "exr_of_many_tiles": exr(10_000, 10_000, 1),
    "exr_of_a_tile_that_is_huge": exr(64, 64, 2**30),
    "hdr_that_is_too_short": b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16000 +X 16000\n",
    "dds_that_is_too_short": b"DDS " + struct.pack("<7I44x", 124, 0x1007, 16_000, 16_000, 0, 0, 0)
    + struct.pack("<8I20x", 32, 0x41, 0, 32, 255, 65280, 0xFF0000, 0),
    "psd_that_is_too_short": b"8BPS" + struct.pack(">H6xHIIHH", 1, 3, 16_000, 16_000, 8, 3) + bytes(14),
    "gif_that_is_too_short": b"GIF89a" + struct.pack("<HHBBB", 65_535, 65_535, 0, 0, 0)
    + b"\x2c" + struct.pack("<4HB", 0, 0, 65_535, 65_535, 0) + b"\2\1\0\0;",
    "bmp_that_is_too_short": b"BM" + struct.pack("<I4xIIiiHHI24x", 54, 54, 40, 16_000, 16_000, 1, 24, 0),
    "targa_that_is_too_short": struct.pack("<BBB9xHHBB", 0, 0, 2, 60_000, 4_000, 24, 0) + bytes(9),
    "pnm_that_is_too_short": b"P6 16000 16000 255\n",
}  # fmt: skip


@pytest.mark.parametrize("name", BOMBS)
def test_a_bomb_is_refused_by_its_header(name: str, tmp_path: Path) -> None:
    kind = name.partition("_")[0]
    file = tmp_path / f"a.{ {'targa': 'tga', 'tiff': 'tif', 'pnm': 'ppm'}.get(kind, kind) }"
    file.write_bytes(BOMBS[name])

    assert grown_kb(file) < 100_000
