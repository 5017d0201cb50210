"""Images of kinds that few people send: damaged, of sizes that they cannot have, and of another kind than they say."""

from __future__ import annotations

import random
import struct
from collections.abc import Iterator
from pathlib import Path

from tests.hostile.corpus import mutated
from tests.hostile.image_bases import HEIGHT, WIDTH, good_images, tif_of_directories, webp_of_nothing
from tests.render.kits.hostile_images import exr, png, tiff

SEED = 4711
DAMAGED = 12
SIZES = (2**31 - 1, 2**31, 2**16, 2**14, 0)
PLACES = {
    "tga": (12, "<HH"),
    "gif": (6, "<HH"),
    "bmp": (18, "<ii"),
    "psd": (14, ">II"),
    "dds": (12, "<II"),
    "dpx": (772, ">II"),
    "sgi": (6, ">HH"),
    "cin": (200, ">II"),
    "pic": (88, ">HH"),
    "zfile": (4, "<HH"),
}
"""Where the two sides of an image stand in a file, and how."""
MARKS = {"jp2": (b"ihdr", 4, ">II"), "j2k": (b"\xff\x51", 6, ">II"), "iff": (b"TBHD", 8, ">II")}
"""The same behind a mark in the file."""
SUFFIXES = (
    "png",
    "jpg",
    "tif",
    "hdr",
    "gif",
    "webp",
    "tga",
    "tx",
    "exr",
    "usda",
    "usdz",
    "mp4",
    "svg",
    "term",
    "null",
    "pic",
)
NAMES = (
    "a.bmp?RES=9x9",
    "a.%04d.bmp",
    "a.<UDIM>.bmp",
    "a.#.bmp",
    "a.bmp[b]",
    "$HOME.bmp",
    "a b.bmp",
    "a.bmp.",
    "-a.bmp",
)

Image = tuple[str, str, bytes]


def image_attacks(canary: Path) -> Iterator[Image]:
    """Name, image file name and bytes of each texture.

    Args:
        canary: file that nothing may be read from.
    """
    for kind, good in good_images().items():
        mutate = random.Random(f"{SEED}/{kind}")
        for number in range(DAMAGED):
            how, content = mutated(good, mutate)
            yield f"damaged/{kind}-{number}-{how}", f"a.{kind}", content
        for size in SIZES:
            content = _of_size(kind, good, size)
            if content is not None:
                yield f"size/{kind}-{size}", f"a.{kind}", content
    yield from _promises()
    yield from _liars(canary)
    yield from _names()


def _of_size(kind: str, good: bytes, size: int) -> bytes | None:
    """A good image that says that it is of another size; None where a kind has no such place."""
    if kind == "hdr":
        return good.replace(b"-Y %d +X %d" % (HEIGHT, WIDTH), b"-Y %d +X %d" % (size, size))
    if kind in ("ppm", "pfm"):
        return good.replace(b"%d %d" % (WIDTH, HEIGHT), b"%d %d" % (size, size), 1)
    at, how = PLACES.get(kind, (0, ""))
    if kind in MARKS:
        mark, behind, how = MARKS[kind]
        at = good.index(mark) + behind
    if kind == "jp2":
        good = good.replace(
            struct.pack(">II", WIDTH, HEIGHT), struct.pack(">II", min(size, 2**32 - 1), min(size, 2**32 - 1))
        )
    if not how:
        return None
    most = 2 ** (8 * struct.calcsize(how) // 2 - how.islower() * ("i" in how)) - 1
    changed = bytearray(good)
    struct.pack_into(how, changed, at, min(size, most), min(size, most))
    return bytes(changed)


def _promises() -> Iterator[Image]:
    """Small files of many pixels, of many parts, or of parts that lead back."""
    for side in (4_000, 12_000, 16_384):
        yield f"promise/webp-{side}", "a.webp", webp_of_nothing(side, side)
    for width, height in ((2**30, 2**30), (2**18, 2**18), (16_384, 16_384)):
        sizes = "1" + "11" + f"{height - 1:030b}"[::-1]
        bits = sizes.replace("1", "0", 1) + "000" + "11" + f"{width - 1:030b}"[::-1]
        yield (
            f"promise/jxl-{width}",
            "a.jxl",
            b"\xff\x0a" + int(bits[::-1], 2).to_bytes(10, "little") + good_images()["jxl"][4:],
        )
    stripes = bytearray(good_images()["j2k"])
    at = stripes.index(b"\xff\x51") + 6
    for name, numbers in {"tiles": (4096, 4096, 0, 0, 1, 1), "tile": (16_384, 16_384, 0, 0, 2**31, 2**31)}.items():
        struct.pack_into(">6I", stripes, at, *numbers)
        yield f"promise/j2k-{name}", "a.j2k", bytes(stripes)
    yield "promise/png", "a.png", png(2**31 - 1, 2**31 - 1, bytes(100))
    yield "promise/png-palette", "a.png", png(16_384, 16_384, bytes(2_000_000), 1, 3)
    yield "promise/tif", "a.tif", tiff(2**31 - 1, 1)
    yield "promise/tif-narrow", "a.tif", tiff(1, 65_536, samples=64)
    yield "promise/exr", "a.exr", exr(2**31 - 1, 1)
    yield "tif/directories", "a.tif", tif_of_directories(65_000)
    loop = bytearray(tiff(4, 4))
    loop[-4:] = struct.pack("<I", 24)
    yield "tif/loop", "a.tif", bytes(loop)
    yield "tif/itself", "a.tif", b"II*\0" + struct.pack("<I", 8) + struct.pack("<H", 0) + struct.pack("<I", 8)
    yield "tif/big", "a.tif", b"II+\0" + struct.pack("<HHQQ", 8, 0, 16, 2**63 - 1)
    frames = good_images()["gif"][:-1]
    start = frames.index(b"\x2c")
    yield "gif/frames", "a.gif", frames[:start] + frames[start:] * 3_000 + b";"
    yield (
        "gif/comments",
        "a.gif",
        frames[:start] + (b"\x21\xfe\xff" + b"a" * 255 + b"\0") * 20_000 + frames[start:] + b";",
    )
    head = b"#?RADIANCE\n" + b"A=b\n" * 500_000 + b"FORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 8\n"
    yield "hdr/lines", "a.hdr", head + bytes(256)
    yield "hdr/line", "a.hdr", b"#?RADIANCE\n" + b"a" * 5_000_000
    yield "ppm/comments", "a.ppm", b"P3\n" + b"# a\n" * 1_000_000 + b"4 4 255\n" + b"1 " * 48
    yield "ppm/digits", "a.ppm", b"P3 4 4 255\n" + b"9" * 5_000_000


def _liars(canary: Path) -> Iterator[Image]:
    """Files whose suffix says another kind than they are, and lists that name other files."""
    good = good_images()
    picture = exr(16, 8)
    for suffix in SUFFIXES:
        yield f"liar/exr-as-{suffix}", f"a.{suffix}", picture
        yield f"liar/text-as-{suffix}", f"a.{suffix}", f"{canary}\n/etc/passwd\n".encode()
        yield f"liar/tga-as-{suffix}", f"a.{suffix}", good["tga"]
        yield f"liar/zip-as-{suffix}", f"a.{suffix}", b"PK\3\4" + bytes(100)
    playlist = f"#EXTM3U\n#EXTINF:1,\nfile://{canary}\n#EXT-X-ENDLIST\n".encode()
    svg = f'<svg xmlns:x="http://www.w3.org/1999/xlink"><image x:href="file://{canary}"/></svg>'.encode()
    concat = f"ffconcat version 1.0\nfile '{canary}'\n".encode()
    script = f"%!PS\n({canary}) (r) file 100 string readstring pop print\n".encode()
    lists = {"playlist": playlist, "svg": svg, "concat": concat, "script": script, "link": str(canary).encode()}
    for name, content in lists.items():
        for suffix in ("png", "hdr", "mp4", "svg", "m3u8"):
            yield f"list/{name}-{suffix}", f"a.{suffix}", content
    for kind in sorted(good):
        yield f"liar/empty-{kind}", f"a.{kind}", b""
        yield f"liar/good-{kind}-as-png", "a.png", good[kind]
        yield f"liar/{kind}-head-alone", f"a.{kind}", good[kind][:18]


def _names() -> Iterator[Image]:
    """Good images under names in which readers see more than a name."""
    good = good_images()["bmp"]
    for number, name in enumerate(NAMES):
        yield f"name/{number}", name, good
