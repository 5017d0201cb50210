"""Arrays kept on disk between runs: a few that take long to compute and depend on little.

An entry is named by a hash of everything that its arrays depend on. It is written whole or not at all, and a checksum finds a
damaged one. Whatever goes wrong with the cache (a full disk, a folder that cannot be written, a damaged entry), the arrays are
computed as without it.
"""

from __future__ import annotations

import hashlib
import os
import sys
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, is_dataclass
from functools import cache, cached_property
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from render.errors import OutputError
from render.files import write_atomic

ENVIRONMENT = "PULLFOCUS_CACHE"
"""Environment variable: the folder of the cache, or ``off`` for none."""
MAX_BYTES = 64 << 20
"""Limit on the size of the cache; the entries that were not used for longest are removed."""
MAX_ENTRY_BYTES = 8 << 20
"""Arrays larger than this are not kept."""
_SUFFIX = ".arrays"
_CHECKSUM_BYTES = 4
_PACKAGE = Path(__file__).parent

Arrays = Mapping[str, NDArray[Any]]


class ArrayCache:
    """Arrays of one kind: loaded where an earlier process kept them, else computed and kept.

    A process keeps only its first few results on disk, those that the next process starts with: a drag of the focus makes many
    more. The last few are also held in memory.
    """

    def __init__(self, kind: str, folders: Sequence[str], most: int = 4) -> None:
        """Make the cache.

        Args:
            kind: name of what is kept, a word.
            folders: of this package, with the code that computes the arrays; see `code_key`.
            most: number of results that a process keeps on disk, and that are held in memory.
        """
        self._kind, self._folders, self._most = kind, folders, most
        self._stored = 0
        self._held: dict[str, Arrays] = {}

    def get(self, compute: Callable[[], Arrays], *values: object) -> Arrays:
        """Return arrays by name, read-only.

        Args:
            compute: computes them.
            values: all that they depend on; see `content_key`.
        """
        key = content_key(self._code_key, values)
        arrays = self._held.pop(key, None)
        if arrays is None:
            arrays = self._load(key, compute)
            for array in arrays.values():
                array.setflags(write=False)
        self._held[key] = arrays  # last: held longest
        while len(self._held) > self._most:
            del self._held[next(iter(self._held))]
        return arrays

    def _load(self, key: str, compute: Callable[[], Arrays]) -> Arrays:
        arrays = load_arrays(self._kind, key)
        if arrays is None:
            arrays = compute()
            if self._stored < self._most:
                self._stored += 1
                store_arrays(self._kind, key, arrays)
        return arrays

    @cached_property
    def _code_key(self) -> str:
        return code_key(self._folders)


def cache_folder() -> Path | None:
    """Return the folder of the cache, which need not exist; None where the cache is off or the user has no home."""
    typed = os.environ.get(ENVIRONMENT, "")
    if typed:
        return None if typed == "off" else Path(typed).absolute()
    with suppress(RuntimeError):
        return _user_caches() / "pullfocus"
    return None


def content_key(*values: object) -> str:
    """Hash values by their content.

    Args:
        values: None, bool, int, float, str, bytes, numbers of numpy, arrays, and sequences and dataclasses of these.

    Returns:
        Hexadecimal digits; those of different values differ.

    Raises:
        TypeError: a value is of another type.
    """
    digest = hashlib.sha256()
    for part in _parts(values):
        digest.update(part)
    return digest.hexdigest()


def code_key(folders: Sequence[str]) -> str:
    """Hash the names, sizes and times of the source files in folders of this package: a change of the code changes it.

    Args:
        folders: names such as ``optics``; folders in them are included.
    """
    return content_key(np.__version__, [list(_source_files(_PACKAGE / folder)) for folder in folders])


def load_arrays(kind: str, key: str) -> Arrays | None:
    """Load an entry.

    Args:
        kind: name of what is kept, a word.
        key: from `content_key`.

    Returns:
        The arrays by name; None where there is no such entry, or it cannot be used.
    """
    folder = cache_folder()
    if folder is None:
        return None
    path = _path(folder, kind, key)
    try:
        with path.open("rb") as file:
            found = _unpack(file.read())
            with suppress(OSError):
                os.utime(file.fileno())  # used now: removed last
    except (OSError, ValueError, KeyError, EOFError):
        return None
    return found


def store_arrays(kind: str, key: str, arrays: Arrays) -> None:
    """Keep arrays, where the cache can be written.

    Args:
        kind: name of what is kept, a word.
        key: from `content_key`.
        arrays: by name.
    """
    folder = cache_folder()
    if folder is None or sum(array.nbytes for array in arrays.values()) > MAX_ENTRY_BYTES:
        return
    content = _pack(arrays)
    with suppress(OSError, OutputError):
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        write_atomic(_path(folder, kind, key), content)
        _remove_oldest(folder)


def _user_caches() -> Path:
    """Return the platform's folder for caches. Raises `RuntimeError` where the user has no home."""
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    named = os.environ.get("LOCALAPPDATA" if sys.platform == "win32" else "XDG_CACHE_HOME", "")
    return Path(named) if os.path.isabs(named) else Path.home() / ".cache"


def _path(folder: Path, kind: str, key: str) -> Path:
    return folder / f"{kind}-{key}{_SUFFIX}"


def _parts(value: object) -> Iterator[bytes]:
    if value is None or isinstance(value, (bool, int, str)):
        yield f"{type(value).__name__}:{value!r};".encode()
    elif isinstance(value, float):
        yield f"float:{float(value).hex()};".encode()
    elif isinstance(value, np.generic):
        yield from _parts(value.item())
    elif isinstance(value, bytes):
        yield f"bytes:{len(value)}:".encode()
        yield value
    elif isinstance(value, np.ndarray):
        yield f"array:{value.dtype.str}:{value.shape}:".encode()
        yield np.ascontiguousarray(value).tobytes()
    elif isinstance(value, Sequence):
        yield f"sequence:{len(value)}:".encode()
        for item in value:
            yield from _parts(item)
    elif is_dataclass(value) and not isinstance(value, type):
        yield f"{type(value).__qualname__}(".encode()
        for item in fields(value):
            yield f"{item.name}=".encode()
            yield from _parts(getattr(value, item.name))
    else:
        raise TypeError(f"{type(value).__name__} has no content key")


@cache
def _source_files(folder: Path) -> tuple[tuple[str, int, int], ...]:
    return tuple(sorted(_walk(folder, folder.name)))


def _walk(folder: Path, name: str) -> Iterator[tuple[str, int, int]]:
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.is_dir():
                if entry.name != "__pycache__":
                    yield from _walk(Path(entry.path), f"{name}/{entry.name}")
            else:
                status = entry.stat()
                yield f"{name}/{entry.name}", status.st_size, status.st_mtime_ns


def _pack(arrays: Arrays) -> bytes:
    buffer = BytesIO()
    for name, array in arrays.items():
        buffer.write(len(name.encode()).to_bytes(1, "little") + name.encode())
        np.save(buffer, np.asarray(array), allow_pickle=False)
    content = buffer.getvalue()
    return zlib.crc32(content).to_bytes(_CHECKSUM_BYTES, "little") + content


def _unpack(content: bytes) -> dict[str, NDArray[Any]]:
    """Unpack arrays. Raises `ValueError`: the content is damaged."""
    checksum, content = content[:_CHECKSUM_BYTES], content[_CHECKSUM_BYTES:]
    if zlib.crc32(content).to_bytes(_CHECKSUM_BYTES, "little") != checksum:
        raise ValueError("the checksum is wrong")
    buffer, arrays = BytesIO(content), {}
    while length := buffer.read(1):
        name = buffer.read(length[0]).decode()
        arrays[name] = np.load(buffer, allow_pickle=False)
    if not arrays:
        raise ValueError("there are no arrays")
    return arrays


def _remove_oldest(folder: Path) -> None:
    """Remove the entries that were not used for longest until the rest is small enough."""
    entries = [(status.st_mtime_ns, status.st_size, path) for path, status in _entries(folder)]
    total = sum(size for _, size, _ in entries)
    for _, size, path in sorted(entries):
        if total <= MAX_BYTES:
            return
        path.unlink(missing_ok=True)
        total -= size


def _entries(folder: Path) -> Iterable[tuple[Path, os.stat_result]]:
    for path in folder.glob(f"*{_SUFFIX}"):
        with suppress(OSError):  # another process removed it
            yield path, path.stat()
