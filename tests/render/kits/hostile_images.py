"""Images of a few bytes that say that they are huge."""

from __future__ import annotations

import struct
import zlib


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


IMAGE_BOMBS = {
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


def file_name(bomb: str) -> str:
    """Name of a file with a bomb in it."""
    kind = bomb.partition("_")[0]
    return f"a.{ {'targa': 'tga', 'tiff': 'tif', 'pnm': 'ppm'}.get(kind, kind) }"
