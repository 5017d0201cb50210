"""Archives and packages that leave their folder, unpack to more than there is room for, or contradict themselves."""

from __future__ import annotations

import stat
import struct
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from tests.hostile.raw_archives import (
    DEFLATED,
    ENCRYPTED,
    LATER,
    MEGABYTE,
    UTF_8,
    Entry,
    archive,
    closed,
    deflated,
    package,
    quoted_overlap,
    shot,
    zeros,
)
from tests.service.conftest import ROOM

GIGABYTE = 2**30
END_64, LOCATOR = struct.Struct("<4sQ2H2L4Q"), struct.Struct("<4sLQL")
STAGE = Entry(b"room.usda", ROOM.encode())
NAMES = (
    b"../a.txt",
    b"a/../../a.txt",
    b"..\\..\\a.txt",
    b"/etc/cron.d/a",
    b"//server/share/a",
    b"C:\\a.txt",
    b"c:a.txt",
    b"\\\\?\\C:\\a",
    b"a.txt\0.usda",
    b"a\nb.txt",
    b"a\x7f\x1b[2J.txt",
    b"\xff\xfe.txt",
    b"....//a.txt",
    b". ./a",
    b"a/./././b",
    b"\xe2\x80\xaeadsu.txt",
    b"CON",
    b"a" * 300,
    b"a/" * 3_000 + b"a",
    b"",
    b"/",
    b"~/.bashrc",
    b"$HOME/a",
    b"-rf",
    b"a.usda:stream",
    b"\xed\xa0\x80.txt",
)
MODES = {
    "fifo": stat.S_IFIFO,
    "device": stat.S_IFCHR,
    "block": stat.S_IFBLK,
    "socket": stat.S_IFSOCK,
    "link": stat.S_IFLNK,
}
INNER = ("../../secret", "../secret.usda", "/etc/passwd", "room.usda[a]", "", "a" * 5_000, "secret.txt")
TARGETS = ("../a.usda", "/etc/passwd", "a.usdz[b.usda]", "../../../../../../etc/passwd", "./room.usdz[room.usda]")


Upload = tuple[str, str, bytes]


def archive_attacks(canary: Path) -> Iterator[Upload]:
    """Name, file name and content of each upload.

    Args:
        canary: file that nothing may be read from.
    """
    for number, name in enumerate(NAMES):
        yield f"name/{number}", "a.zip", shot(Entry(name, b"a"))
        yield f"name/old-{number}", "a.zip", shot(Entry(name, b"a", flags=0))
        yield f"name/package-{number}", "a.usdz", package(STAGE, Entry(name, b"a"))
    yield from _links(canary)
    yield from _bombs()
    yield from _lies()
    yield from _many()
    yield from _packages(canary)


def _links(canary: Path) -> Iterator[Upload]:
    dome = 'def DomeLight "dome" {\n asset inputs:texture:file = @a.png@\n}\n'
    layered = ROOM.replace("(\n", "(\n    subLayers = [@b.usda@]\n", 1)
    for number, target in enumerate(
        (str(canary), "/etc/passwd", "../../../../../../etc/passwd", "/proc/self/environ", "/")
    ):
        for kind, stage, name in (
            ("texture", ROOM + dome, b"a.png"),
            ("sublayer", layered, b"b.usda"),
            ("folder", ROOM, b"c/"),
        ):
            link = Entry(name, target.encode(), mode=stat.S_IFLNK | 0o777)
            yield f"link/{kind}-{number}", "a.zip", archive((Entry(b"room.usda", stage.encode()), link))
    over = (Entry(b"a", str(canary.parent).encode(), mode=stat.S_IFLNK | 0o777), Entry(b"a/b.txt", b"b"))
    yield "link/written-through", "a.zip", shot(*over)
    for name, mode in MODES.items():
        yield f"mode/{name}", "a.zip", shot(Entry(b"a.png", b"", mode=mode | 0o666))
        yield f"mode/{name}-package", "a.usdz", package(Entry(b"room.usda", ROOM.encode(), mode=mode | 0o666))
    for mode in (0, 0o4755, 0o1777, 0o200):
        yield f"mode/{mode:o}", "a.zip", archive((Entry(b"room.usda", ROOM.encode(), mode=stat.S_IFREG | mode),))


def _bombs() -> Iterator[Upload]:
    packed, crc = zeros(GIGABYTE // MEGABYTE)
    bomb = Entry(b"a.png", packed, DEFLATED, size=GIGABYTE, crc=crc)
    yield "bomb/zeros", "a.zip", shot(bomb)
    yield "bomb/zeros-that-claim-little", "a.zip", shot(Entry(b"a.png", packed, DEFLATED, size=10, crc=crc))
    yield "bomb/zeros-package", "a.usdz", archive((Entry(b"room.usda", packed, DEFLATED, size=GIGABYTE, crc=crc),))
    yield "bomb/zeros-stage", "a.zip", archive((Entry(b"room.usda", packed, DEFLATED, size=GIGABYTE, crc=crc),))
    text = b"#usda 1.0\n" + b" " * (60 * MEGABYTE)
    yield "bomb/spaces", "a.zip", archive((deflated(b"room.usda", text),))
    yield "bomb/quoted-overlap", "a.zip", quoted_overlap(200, 4)
    kernel, crc = zeros(16)
    same = [
        Entry(b"%d" % number, size=16 * MEGABYTE, packed=len(kernel), crc=crc, method=DEFLATED, at=0)
        for number in range(99)
    ]
    first = Entry(b"0", kernel, DEFLATED, size=16 * MEGABYTE, crc=crc)
    yield "bomb/full-overlap", "a.zip", archive((first, *same[1:]))
    inner = shot(deflated(b"a.zip", archive((bomb,))))
    yield "bomb/nested", "a.zip", shot(deflated(b"b.zip", inner))
    nested = shot()
    for _ in range(3):
        nested = archive((deflated(b"a.zip", nested),))
    yield "bomb/zip-in-zip", "a.zip", nested
    yield "bomb/flushes", "a.zip", shot(Entry(b"a", b"\0\0\0\xff\xff" * MEGABYTE + b"\3\0", DEFLATED, size=0, crc=0))


def _lies() -> Iterator[Upload]:
    """Archives whose parts contradict each other, or ask for what nobody gives."""
    a = Entry(b"a.png", b"abc")
    for size in (0, 1, 2**31, 2**32 - 1):
        yield f"lie/size-{size}", "a.zip", shot(replace(a, size=size))
        yield f"lie/local-size-{size}", "a.zip", shot(replace(a, local_size=size))
        yield f"lie/packed-{size}", "a.zip", shot(replace(a, packed=size))
        yield f"lie/deflated-{size}", "a.zip", shot(deflated(b"a.png", b"abc", size=size))
        yield f"lie/at-{size}", "a.zip", shot(replace(a, at=size))
        yield f"lie/package-size-{size}", "a.usdz", package(replace(STAGE, size=size))
        yield f"lie/package-packed-{size}", "a.usdz", package(replace(STAGE, packed=size))
        yield f"lie/package-at-{size}", "a.usdz", package(replace(STAGE, at=size))
    yield "lie/name", "a.zip", shot(replace(a, local_name=b"../a.png"))
    yield "lie/crc", "a.zip", shot(replace(a, crc=1))
    yield "lie/encrypted", "a.zip", shot(replace(a, flags=UTF_8 | ENCRYPTED))
    yield "lie/encrypted-strongly", "a.zip", shot(replace(a, flags=UTF_8 | ENCRYPTED | 0x2040))
    yield "lie/sizes-behind", "a.zip", shot(replace(a, flags=UTF_8 | LATER, local_size=0))
    for method in (1, 6, 9, 12, 14, 93, 95, 98, 99, 0xFFFF):
        yield f"lie/method-{method}", "a.zip", shot(replace(a, method=method))
    for number, extra in enumerate(
        (b"\1\0\x18\0" + b"\xff" * 24, b"\1\0\xff\xff", b"\1\0\0\0", b"up\5\0\1\0\0\0\0../b")
    ):
        yield f"lie/extra-{number}", "a.zip", shot(replace(a, extra=extra, size=2**32 - 1 if number < 3 else None))
    good = shot(a)
    for number, rest in enumerate((b"\0" * 70_000, b"PK\5\6" + bytes(18), good, b"PK\5\6", b"#usda 1.0\n")):
        yield f"garbage/behind-{number}", "a.zip", good + rest
        yield f"garbage/before-{number}", "a.zip", rest + good
        yield f"garbage/before-unknown-{number}", "a.zip", archive((STAGE, a), before=rest)
        yield f"garbage/package-{number}", "a.usdz", package(STAGE) + rest
    for count in (0, 1, 0xFFFF):
        yield f"lie/count-{count}", "a.zip", archive((STAGE, a), count=count)
    for count in (2, 2**31, 2**63, 2**64 - 1):
        end = END_64.pack(b"PK\6\6", 44, 45, 45, 0, 0, count, count, count, count) + LOCATOR.pack(
            b"PK\6\7", 0, len(good), 1
        )
        yield f"zip64/{count}", "a.zip", good[:-22] + end + good[-22:]
        yield f"zip64/package-{count}", "a.usdz", package(STAGE)[:-22] + end + package(STAGE)[-22:]
    for cut in (1, 22, 40, len(good) - 30):
        yield f"cut/{cut}", "a.zip", good[:-cut]


def _many() -> Iterator[Upload]:
    """Entries that are too many, too deep, or the same under two names."""
    yield "many/entries", "a.zip", shot(*(Entry(b"%d" % number) for number in range(60_000)))
    yield "many/entries-below-the-limit", "a.zip", shot(*(Entry(b"%d" % number) for number in range(9_990)))
    yield "many/entries-of-a-package", "a.usdz", package(STAGE, *(Entry(b"%d" % number) for number in range(20_000)))
    for depth in (300, 800, 950, 990, 3_000):
        yield f"many/folders-{depth}", "a.zip", shot(Entry(b"a/" * depth + b"a"))
        yield f"many/stage-{depth}", "a.zip", archive((replace(STAGE, name=b"a/" * depth + b"room.usda"),))
    inner = b"a/" * 400
    yield "many/folders-beside-each-other", "a.zip", shot(*(Entry(b"%d/" % number + inner) for number in range(400)))
    yield "many/long-names", "a.zip", shot(*(Entry((b"a" * 250 + b"/") * 7 + b"%d" % number) for number in range(900)))
    yield "many/stages", "a.zip", archive(replace(STAGE, name=b"%d.usda" % number) for number in range(2_000))
    pairs = {
        "same": (b"a.txt", b"a.txt"),
        "stage": (b"room.usda", b"./room.usda"),
        "case": (b"a.txt", b"A.TXT"),
        "case-of-the-stage": (b"a.txt", b"Room.USDA"),
        "composed": ("\u00e9.txt".encode(), "e\u0301.txt".encode()),
        "wide": (b"a.txt", "\uff41.txt".encode()),
        "file-and-folder": (b"a", b"a/b.txt"),
        "folder-and-file": (b"a/b.txt", b"a"),
        "backslash": (b"a/b.txt", b"a\\b.txt"),
        "blank": (b"a.txt", b"a.txt "),
    }
    for name, (one, other) in pairs.items():
        yield f"twice/{name}", "a.zip", shot(Entry(one, b"1"), Entry(other, b"2"))
        yield f"twice/package-{name}", "a.usdz", package(STAGE, Entry(one, b"1"), Entry(other, b"2"))


def _packages(canary: Path) -> Iterator[Upload]:
    """USDZ packages that USD opens by itself."""
    picture, text = Entry(b"a.png", b"\x89PNG\r\n\x1a\n"), Entry(b"a.txt", b"abc")
    yield "package/no-layer-first", "a.usdz", package(picture, STAGE)
    yield "package/no-layer", "a.usdz", package(text)
    yield "package/empty", "a.usdz", closed([], 0)
    yield "package/text", "a.usdz", ROOM.encode()
    yield "package/unaligned", "a.usdz", archive((replace(STAGE, padding=5), picture))
    yield "package/compressed", "a.usdz", archive((deflated(b"room.usda", ROOM.encode()), picture))
    yield "package/encrypted", "a.usdz", package(replace(STAGE, flags=UTF_8 | ENCRYPTED))
    yield "package/other-suffix", "a.usdz", package(replace(STAGE, name=b"room.txt"))
    yield "package/binary", "a.usdz", package(replace(STAGE, name=b"room.usdc"))
    yield "package/named-zip", "a.zip", package(STAGE)
    yield "package/zip-named-usdz", "a.zip", archive((Entry(b"room.usdz", shot(text)),))
    nested = package(STAGE)
    for depth in range(6):
        nested = package(Entry(b"room.usdz", nested))
        yield f"package/nested-{depth}", "a.usdz", nested
    for number, target in enumerate((*TARGETS, str(canary))):
        asset = f'def "A" (references = @{target}@) {{}}\ndef DomeLight "d" {{\n asset inputs:texture:file = @{target}@\n}}\n'
        yield f"package/target-{number}", "a.usdz", package(replace(STAGE, content=(ROOM + asset).encode()), text)
        layered = ROOM.replace("(\n", f"(\n    subLayers = [@{target}@]\n", 1)
        yield f"package/sublayer-{number}", "a.usdz", package(replace(STAGE, content=layered.encode()), text)
    for number, inner in enumerate(
        ("../../secret", "../secret.usda", "/etc/passwd", "room.usda[a]", "", "a" * 5_000, "secret.txt")
    ):
        stage = f'{ROOM}def "A" (references = @a.usdz[{inner}]@) {{}}\n'
        holder = Entry(b"a.usdz", package(STAGE, Entry(inner.encode() or b"b", b"#usda 1.0\n")))
        yield f"package/inner-{number}", "a.zip", archive((replace(STAGE, content=stage.encode()), holder))
        dome = f'{ROOM}def DomeLight "d" {{\n asset inputs:texture:file = @a.usdz[{inner}]@\n}}\n'
        yield f"package/inner-texture-{number}", "a.zip", archive((replace(STAGE, content=dome.encode()), holder))
