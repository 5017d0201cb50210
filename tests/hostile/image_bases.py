"""Good images of the kinds that the corpus damages, and images that hold next to nothing."""

from __future__ import annotations

import struct
import tempfile
from functools import lru_cache
from pathlib import Path

WIDTH, HEIGHT = 72, 48
WRITTEN = {
    "hdr": "float",
    "tga": "uint8",
    "gif": "uint8",
    "bmp": "uint8",
    "webp": "uint8",
    "jp2": "uint8",
    "jxl": "uint8",
    "ico": "uint8",
    "fits": "float",
    "dpx": "uint16",
    "iff": "uint8",
    "ppm": "uint8",
    "pfm": "float",
    "rla": "uint8",
    "sgi": "uint8",
    "zfile": "float",
}
"""Kinds that OpenImageIO writes, by their suffixes, and the type of their pixels. It has no writer for psd, dds, cin and pic,
and in the wheels no heic.
"""


@lru_cache
def good_images() -> dict[str, bytes]:
    """Small image of each kind."""
    made = {kind: _written(kind, type_) for kind, type_ in WRITTEN.items()}
    return made | {
        "j2k": made["jp2"][made["jp2"].index(b"\xff\x4f\xff\x51") :],
        "psd": _psd(),
        "dds": _dds(),
        "cin": _cin(),
        "pic": _pic(),
    }


def _written(kind: str, type_: str) -> bytes:
    import numpy as np
    import OpenImageIO as oiio

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"a.{kind}"
        output = oiio.ImageOutput.create(str(file))
        spec = oiio.ImageSpec(WIDTH, HEIGHT, 1 if kind == "zfile" else 3, type_)
        spec.attribute("DateTime", "2024:01:01 00:00:00")
        spec.attribute("ImageDescription", "a picture")
        output.open(str(file), spec)
        output.write_image(
            np.linspace(0, 1, WIDTH * HEIGHT * spec.nchannels, dtype=np.float32).reshape(HEIGHT, WIDTH, -1)
        )
        output.close()
        return file.read_bytes()


def _pixels(channels: int) -> bytes:
    return bytes(number % 251 for number in range(WIDTH * HEIGHT * channels))


def _psd() -> bytes:
    head = b"8BPS" + struct.pack(">H6xHIIHH", 1, 3, HEIGHT, WIDTH, 8, 3)
    return head + bytes(12) + bytes(2) + _pixels(3)


def _dds() -> bytes:
    head = struct.pack("<7I44x", 124, 0x1007, HEIGHT, WIDTH, 0, 0, 0)
    return (
        b"DDS "
        + head
        + struct.pack("<9I16x", 32, 4, 0x31545844, 0, 0, 0, 0, 0, 0x1000)
        + _pixels(1)[: WIDTH * HEIGHT // 2]
    )


def _cin() -> bytes:
    head = bytearray(2048)
    struct.pack_into(">4sIIIII", head, 0, b"\x80\x2a\x5f\xd7", 2048, 1024, 1024, 0, 2048 + WIDTH * HEIGHT * 4)
    head[193] = 3
    for channel in range(3):
        struct.pack_into(">BBBxII", head, 196 + 28 * channel, 0, channel + 1, 10, WIDTH, HEIGHT)
    return bytes(head) + _pixels(4)


def _pic() -> bytes:
    head = b"\x53\x80\xf6\x34" + struct.pack(">f80s4sHHfHH", 1.0, b"a", b"PICT", WIDTH, HEIGHT, 1.0, 3, 0)
    return head + bytes((0, 8, 0, 0xE0)) + _pixels(3)


def webp_of_nothing(width: int, height: int) -> bytes:
    """Lossless WebP of one colour, whose pixels take no bits at all."""
    bits = f"{0:01b}" + "0" + "0"  # no transform, no colour cache, no codes of other parts
    bits += "1000" * 5  # each of five codes has the one symbol 0
    head = (width - 1) | (height - 1) << 14 | 1 << 28
    body = b"\x2f" + struct.pack("<I", head) + int(bits[::-1], 2).to_bytes(4, "little")
    body += bytes(len(body) % 2)
    chunk = b"VP8L" + struct.pack("<I", len(body)) + body
    return b"RIFF" + struct.pack("<I", 4 + len(chunk)) + b"WEBP" + chunk


def tif_of_directories(count: int) -> bytes:
    """TIFF of many directories, each with an image of four pixels."""
    tags = (
        (256, 4, 2),
        (257, 4, 2),
        (258, 3, 8),
        (259, 3, 1),
        (262, 3, 1),
        (273, 4, 8),
        (277, 3, 1),
        (278, 4, 2),
        (279, 4, 4),
    )
    size, out = 2 + 12 * len(tags) + 4, bytearray(b"II*\0" + struct.pack("<I", 12) + b"abcd")
    body = b"".join(struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in tags)
    for number in range(count):
        out += struct.pack("<H", len(tags)) + body
        out += struct.pack("<I", 12 + (number + 1) * size if number + 1 < count else 0)
    return bytes(out)
