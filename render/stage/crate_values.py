"""Lengths of the arrays and lists that a crate file (.usdc) stores, judged before USD takes memory for them.

Layout: OpenUSD, pxr/usd/sdf/crateFile.cpp. The fields of a crate are 64-bit words: flags, a type, and where the value stands in
the file. There, arrays and lists begin with their length.
"""

from __future__ import annotations

import mmap
import struct
from collections.abc import Iterator

import numpy as np

from render.model.arrays import WordArray

_ARRAY, _INLINED, _COMPRESSED, _ARRAY_EDIT = (np.uint64(1 << bit) for bit in (63, 62, 61, 60))
_PLACE = np.uint64((1 << 48) - 1)
_LISTS = (40, 41, 48, 49, 50)  # of paths, tokens, doubles, layer offsets and strings
_TIME_SAMPLES = 46
_LIST_ITEM_BYTES = 4
# LZ4 packs at most 255 to 1, and a number of a list into no less than two bits.
MOST_PER_BYTE = 4 * 255
Content = bytes | mmap.mmap | memoryview


def value_fault(content: Content, fields: tuple[int, int]) -> str:
    """Say why the lengths of a crate's values cannot be true; empty where they can.

    Args:
        content: all bytes of the crate.
        fields: offset and length of its section of fields, which lies within the content and begins with a count that was judged.
    """
    version = content[8], content[9], content[10]
    try:
        words = _field_words(content, fields, is_packed=version >= (0, 4, 0))
        samples = [word for place in _places(words, _TIME_SAMPLES) for word in _sample_words(content, place)]
    except (IndexError, ValueError, struct.error):
        return "its fields are damaged"
    values = np.concatenate([words, *samples]) if samples else words
    length_at, is_long = (0, True) if version >= (0, 7, 0) else (0 if version >= (0, 5, 0) else 4, False)
    is_array = (values & (_ARRAY | _INLINED | _ARRAY_EDIT) == _ARRAY) & (values & _PLACE != 0)
    for is_packed, most in ((False, 1), (True, MOST_PER_BYTE)):
        chosen = is_array & ((values & _COMPRESSED != 0) == is_packed)
        if not _are_true(
            content, (values[chosen] & _PLACE) + np.uint64(length_at), is_long=is_long, most_per_byte=most
        ):
            return "an array has more elements than fit into it"
    lists = np.concatenate([_places(values, kind) for kind in _LISTS])
    if not _are_true(content, lists, is_long=True, most_per_byte=1 / _LIST_ITEM_BYTES):
        return "a list has more elements than fit into it"
    return ""


def _places(words: WordArray, kind: int) -> WordArray:
    """Where the values of a type that are no arrays stand in the file."""
    is_meant = (words & (_ARRAY | _INLINED) == 0) & (words >> np.uint64(48) & np.uint64(0xFF) == kind)
    places: WordArray = words[is_meant] & _PLACE
    return places


def _are_true(content: Content, places: WordArray, *, is_long: bool, most_per_byte: float) -> bool:
    """Whether the lengths at some places are no more than what follows there can hold."""
    size = len(content)
    width = 8 if is_long else 4
    if not len(places):
        return True
    if size < width or int(places.max()) > size - width:
        return False
    data = np.frombuffer(content, np.uint8)
    offsets = places.astype(np.int64)
    counts = data[offsets[:, None] + np.arange(width)].view("<u8" if is_long else "<u4")[:, 0]
    return bool((counts <= most_per_byte * (size - width - offsets)).all())


def _field_words(content: Content, fields: tuple[int, int], *, is_packed: bool) -> WordArray:
    """Words of the fields. Raises `ValueError`, `IndexError`, `struct.error`: they are damaged."""
    at, length = fields
    (count,) = struct.unpack_from("<Q", content, at)
    if not is_packed:
        return np.frombuffer(content, "<u8", 2 * count, at + 8)[1::2]
    (names,) = struct.unpack_from("<Q", content, at + 8)
    if names > length:
        raise ValueError("the names of the fields are cut off")
    (packed,) = struct.unpack_from("<Q", content, at + 16 + names)
    begin = at + 24 + names
    if not 0 < packed <= at + length - begin:
        raise ValueError("the fields are cut off")
    if content[begin]:  # several pieces, which only more than 2 GB have
        return np.zeros(0, np.uint64)
    return np.frombuffer(_unpacked(bytes(content[begin + 1 : begin + packed]), 8 * count), "<u8")


def _sample_words(content: Content, place: np.uint64) -> Iterator[WordArray]:
    """Words of the times and values of time samples. Raises `ValueError`, `struct.error`: they are damaged."""
    times = int(place) + _jump(content, int(place))
    yield np.frombuffer(content, "<u8", 1, times)
    values = times + 8 + _jump(content, times + 8)
    (count,) = struct.unpack_from("<Q", content, values)
    yield np.frombuffer(content, "<u8", min(count, len(content)), values + 8)


def _jump(content: Content, at: int) -> int:
    jump: int = struct.unpack_from("<q", content, at)[0]
    if not 0 <= at + jump <= len(content):
        raise ValueError("a place lies outside of the file")
    return jump


def _unpacked(packed: bytes, size: int) -> bytes:
    """Unpack an LZ4 block of a known size. Raises `ValueError`, `IndexError`: it is damaged."""
    out, at, end = bytearray(), 0, len(packed)
    while at < end:
        token = packed[at]
        literals, at = _length(packed, at + 1, token >> 4)
        if at + literals > end:
            raise ValueError("an LZ4 block is cut off")
        out += packed[at : at + literals]
        at += literals
        if at == end:
            break
        offset = packed[at] | packed[at + 1] << 8
        matched, at = _length(packed, at + 2, token & 15)
        matched += 4
        if not 0 < offset <= len(out) or len(out) + matched > size:
            raise ValueError("an LZ4 block is damaged")
        start = len(out) - offset
        piece = out[start : start + matched]
        out += (piece * (matched // offset + 1))[:matched] if offset < matched else piece
    if len(out) != size:
        raise ValueError("an LZ4 block has another size")
    return bytes(out)


def _length(packed: bytes, at: int, begin: int) -> tuple[int, int]:
    """Length that a token begins, and where what follows it stands."""
    if begin == 15:
        while packed[at] == 255:
            begin += 255
            at += 1
        begin += packed[at]
        at += 1
    return begin, at
