"""Layer files are judged by their bytes before USD parses them: files of kilobytes can ask its parsers for gigabytes."""

from __future__ import annotations

import mmap
import os
import re
import struct
from pathlib import Path

import numpy as np

from render.errors import StageError
from render.stage.crate_values import MOST_PER_BYTE, value_fault

MAX_TUPLE_DEPTH = 64  # parentheses and square brackets; metadata of lists of matrices are 4 deep
MAX_BLOCK_DEPTH = 500  # braces: prims within prims, dictionaries within dictionaries
_TEXT_MAGIC = (b"#usda", b"#sdf")
_CRATE_MAGIC = b"PXR-USDC"
_CRATE_SECTIONS = 64
_CRATE_SECTION = struct.Struct("<16sqq")
_LZ4_RATIO = 255
_COUNTED = (b"STRINGS", b"FIELDS", b"FIELDSETS", b"PATHS", b"SPECS")
# Strings, asset paths and comments, in which brackets mean nothing.
_QUOTED = re.compile(
    rb'"""(?:[^\\]|\\.)*?"""|"(?:[^"\\\n]|\\.)*"'
    rb"|'''(?:[^\\]|\\.)*?'''|'(?:[^'\\\n]|\\.)*'"
    rb"|@@@.*?@@@|@[^@\n]*@|\#[^\n]*|//[^\n]*|/\*.*?\*/",
    re.DOTALL,
)
_NOT_TUPLES = bytes(set(range(256)) - set(b"()[]"))
_NOT_BLOCKS = bytes(set(range(256)) - set(b"{}"))


def check_layer_file(file: str) -> None:
    """Judge a text or crate file; others, packages among them, are left to USD.

    Args:
        file: path of a plain file; nothing is said of one that is missing.

    Raises:
        StageError: code ``stage_unreadable``; its values are nested too deeply, or its table of contents cannot be true.
    """
    try:
        with open(file, "rb") as opened:
            size = os.fstat(opened.fileno()).st_size
            if not size:
                return
            with mmap.mmap(opened.fileno(), 0, access=mmap.ACCESS_READ) as content:
                check_layer_content(content, Path(file).name)
    except (OSError, ValueError):  # missing, or no plain file: opening it will say so
        return


def check_layer_content(content: bytes | mmap.mmap | memoryview, name: str) -> None:
    """Judge the bytes of a layer; errors as for `check_layer_file`.

    Args:
        content: all bytes.
        name: of the layer, for messages.
    """
    if bytes(content[:8]) == _CRATE_MAGIC:
        why = _crate_fault(content)
    elif bytes(content[:5]).startswith(_TEXT_MAGIC):
        why = _nesting_fault(content)
    else:
        return
    if why:
        raise StageError(f"{name} is not a readable USD file: {why}", code="stage_unreadable", path=name)


def _nesting_fault(content: bytes | mmap.mmap | memoryview) -> str:
    bare = bytes(_QUOTED.sub(b"", content))
    for kept, most, what in ((_NOT_TUPLES, MAX_TUPLE_DEPTH, "parentheses"), (_NOT_BLOCKS, MAX_BLOCK_DEPTH, "braces")):
        brackets = np.frombuffer(bare.translate(None, kept), np.uint8)
        opens = (brackets == ord("(")) | (brackets == ord("[")) | (brackets == ord("{"))
        depth = np.cumsum(np.where(opens, np.int8(1), np.int8(-1)), dtype=np.int32)
        if len(depth) and (depth - np.minimum.accumulate(np.minimum(depth, 0))).max() > most:
            return f"its {what} are nested more than {most:,} deep"
    return ""


def _crate_fault(content: bytes | mmap.mmap | memoryview) -> str:
    """Why a crate's table of contents cannot be true (OpenUSD, pxr/usd/sdf/crateFile.h); empty where it can."""
    size = len(content)
    if size < 88:
        return "its head is cut off"
    (start,) = struct.unpack_from("<q", content, 16)
    if not 0 <= start <= size - 8:
        return "its table of contents lies outside of the file"
    (count,) = struct.unpack_from("<Q", content, start)
    if count > _CRATE_SECTIONS or start + 8 + count * _CRATE_SECTION.size > size:
        return "its table of contents is cut off"
    is_packed = tuple(content[8:10]) >= (0, 4)
    fields: tuple[int, int] | None = None
    for name, at, length in _CRATE_SECTION.iter_unpack(content[start + 8 : start + 8 + count * _CRATE_SECTION.size]):
        section = name.rstrip(b"\0")
        if at < 0 or length < 0 or at + length > size:
            return "a section lies outside of the file"
        if section in _COUNTED and (length < 8 or struct.unpack_from("<Q", content, at)[0] > MOST_PER_BYTE * length):
            return "a section has more entries than fit into it"
        if section == b"TOKENS" and is_packed:
            if length < 24:
                return "its tokens are cut off"
            tokens, unpacked, packed = struct.unpack_from("<3Q", content, at)
            if packed > length - 24 or unpacked > _LZ4_RATIO * packed or tokens > unpacked:
                return "it has more tokens than fit into it"
        if section == b"FIELDS":
            fields = at, length
    return value_fault(content, fields) if fields is not None else ""
