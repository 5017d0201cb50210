"""Zip archives written byte by byte, so that they can contradict themselves."""

from __future__ import annotations

import stat
import struct
import zlib
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache

from tests.service.conftest import ROOM

MEGABYTE = 2**20
LOCAL, CENTRAL, END = struct.Struct("<4s5H3L2H"), struct.Struct("<4s6H3L5H2L"), struct.Struct("<4s4H2LH")
STORED, DEFLATED = 0, 8
ENCRYPTED, UTF_8, LATER = 1, 0x800, 8
"""Flags of an entry: encrypted, named in UTF-8, and with sizes that stand behind it."""
PACKAGE_ALIGNMENT = 64


@dataclass(frozen=True)
class Entry:
    """Entry of an archive, which may contradict itself.

    Attributes:
        name: bytes of its name.
        content: as it stands in the archive.
        method: of compression.
        flags: general purpose bits.
        size: size of the unpacked content that both headers claim; None for that of the content.
        packed: size of the content that both headers claim; None for the true one.
        crc: checksum that both headers claim; None for that of the content.
        local_name: name in the local header; None for the same.
        local_size: size of the unpacked content in the local header; None for the same.
        mode: of the file, as Unix has it.
        padding: bytes of the extra field of the local header.
        extra: extra field of the central directory.
        at: offset in the central directory; None for the true one.
    """

    name: bytes
    content: bytes = b""
    method: int = STORED
    flags: int = UTF_8
    size: int | None = None
    packed: int | None = None
    crc: int | None = None
    local_name: bytes | None = None
    local_size: int | None = None
    mode: int = stat.S_IFREG | 0o644
    padding: int = 0
    extra: bytes = b""
    at: int | None = None

    @property
    def _numbers(self) -> tuple[int, int, int]:
        crc = zlib.crc32(self.content) if self.crc is None else self.crc
        packed = len(self.content) if self.packed is None else self.packed
        return crc, packed, len(self.content) if self.size is None else self.size

    def local(self) -> bytes:
        """Header that stands before the content."""
        name, (crc, packed, size) = self.name if self.local_name is None else self.local_name, self._numbers
        size = size if self.local_size is None else self.local_size
        head = (b"PK\3\4", 20, self.flags, self.method, 0, 33, crc, packed, size, len(name), self.padding)
        return LOCAL.pack(*head) + name + bytes(self.padding)

    def central(self, at: int) -> bytes:
        """Header in the central directory.

        Args:
            at: offset of the local header.
        """
        at = at if self.at is None else self.at
        head = (
            b"PK\1\2",
            0x314,
            20,
            self.flags,
            self.method,
            0,
            33,
            *self._numbers,
            len(self.name),
            len(self.extra),
            0,
        )
        return CENTRAL.pack(*head, 0, 0, self.mode << 16, at) + self.name + self.extra


def archive(entries: Iterable[Entry], before: bytes = b"", behind: bytes = b"", count: int | None = None) -> bytes:
    """Zip archive of entries.

    Args:
        entries: what it holds.
        before: bytes before the first entry, of which the offsets know nothing.
        behind: bytes behind the end.
        count: number of entries that it claims.
    """
    files, directory, at = list[bytes](), list[bytes](), 0
    for entry in entries:
        files.append(entry.local() + entry.content)
        directory.append(entry.central(at))
        at += len(files[-1])
    return before + b"".join(files) + closed(directory, at, count) + behind


def closed(directory: list[bytes], at: int, count: int | None = None) -> bytes:
    """Central directory and the end of an archive.

    Args:
        directory: its entries.
        at: where it begins.
        count: number of entries that the end claims.
    """
    number, listed = min(len(directory), 0xFFFF) if count is None else count, b"".join(directory)
    return listed + END.pack(b"PK\5\6", 0, 0, number, number, len(listed), at, 0)


def shot(*entries: Entry) -> bytes:
    """Zip archive of a good stage and of entries."""
    return archive((Entry(b"room.usda", ROOM.encode()), *entries))


def deflated(name: bytes, content: bytes, **values: int) -> Entry:
    """Compressed entry, as any archive has it."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    packed = packer.compress(content) + packer.flush()
    claims = {"size": len(content), "crc": zlib.crc32(content), "method": DEFLATED} | values
    return Entry(name, packed, **claims)


@lru_cache
def zeros(count: int) -> tuple[bytes, int]:
    """Compressed zeros and their checksum; count is of megabytes."""
    packer, crc, block = zlib.compressobj(9, zlib.DEFLATED, -15), 0, bytes(MEGABYTE)
    packed = packer.compress(block) + packer.flush(zlib.Z_FULL_FLUSH)
    for _ in range(count):
        crc = zlib.crc32(block, crc)
    return packed * count + b"\3\0", crc


def quoted_overlap(count: int, megabytes: int) -> bytes:
    """Bomb whose files quote the headers of those behind them, down to zeros that all share (Fifield, WOOT 2019).

    Args:
        count: number of files.
        megabytes: of the zeros.
    """
    packed, crc = zeros(megabytes)
    entry = Entry(b"%04d" % count, packed, DEFLATED, size=megabytes * MEGABYTE, crc=crc)
    plain, body, entries = bytes(entry.size or 0), entry.local() + packed, [entry]
    for number in reversed(range(count)):
        header = entries[-1].local()
        quote = struct.pack("<BHH", 0, len(header), len(header) ^ 0xFFFF)
        plain = header + plain
        claims = {"size": len(plain), "crc": zlib.crc32(plain), "packed": len(quote) + len(body)}
        entries.append(Entry(b"%04d" % number, quote, DEFLATED, **claims))
        body = entries[-1].local() + quote + body
    at, directory = 0, list[bytes]()
    for entry in reversed(entries):
        directory.append(entry.central(at))
        at += len(entry.local()) + (len(entry.content) if entry is not entries[0] else 0)
    stage = Entry(b"room.usda", ROOM.encode())
    end = len(body) + len(stage.local()) + len(stage.content)
    return body + stage.local() + stage.content + closed([*directory, stage.central(len(body))], end)


def package(*entries: Entry) -> bytes:
    """USDZ package of entries, whose contents are aligned as they must be.

    Args:
        *entries: the first is the root layer.
    """
    at, aligned = 0, list[Entry]()
    for entry in entries:
        gap = -(at + len(entry.local())) % PACKAGE_ALIGNMENT
        aligned.append(replace(entry, padding=gap))
        at += len(aligned[-1].local()) + len(entry.content)
    return archive(aligned)
