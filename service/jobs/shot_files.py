"""Files of shots on machines that draw frames, by their content.

::

    FOLDER/shots/HASH/files/...    the files of a shot; HASH is that of its list of files
    FOLDER/parts/TOKEN/...         files that are being received

A file of a shot never changes, so that a shot which is there as a whole needs no further look. The shots that were used last are
kept, within a budget.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import secrets
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from render.errors import InputError, OutputError
from render.removal import remove_tree

PART_BYTES = 4 << 20
"""Bytes that are sent at a time."""
_TOKEN = re.compile("[0-9a-f]{16}")


@dataclass(frozen=True)
class ListedFile:
    """A file of a shot.

    Attributes:
        path: relative to the shot's files, with slashes.
        size_bytes: of the file.
        sha256: of its content, in hexadecimal digits.
    """

    path: str
    size_bytes: int
    sha256: str


@dataclass(frozen=True)
class FileList:
    """The files of a shot.

    Attributes:
        files: in the order of their paths.
    """

    files: tuple[ListedFile, ...]

    @property
    def hash(self) -> str:
        """Return the hash of the list, which is another one for every other shot."""
        text = json.dumps([[file.path, file.size_bytes, file.sha256] for file in self.files])
        return hashlib.sha256(text.encode()).hexdigest()[:32]

    @property
    def size_bytes(self) -> int:
        """Return the size of all files."""
        return sum(file.size_bytes for file in self.files)


def list_files(folder: Path) -> FileList:
    """List the files of a shot.

    Args:
        folder: of its files.

    Raises:
        OSError: one cannot be read.
    """
    files = []
    for path in sorted(folder.rglob("*")):
        if path.is_file() and not path.is_symlink():
            with path.open("rb") as file:
                digest = hashlib.file_digest(file, "sha256").hexdigest()
            files.append(ListedFile(path.relative_to(folder).as_posix(), path.stat().st_size, digest))
    return FileList(tuple(files))


def read_part(folder: Path, file: ListedFile, offset: int) -> bytes:
    """Read a part of a file of a shot. Raises `OSError`."""
    with (folder / file.path).open("rb") as opened:
        opened.seek(offset)
        return opened.read(PART_BYTES)


class ShotFiles:
    """The shots that a machine keeps. Any thread may use it.

    Args:
        folder: created when missing; what was being received is removed.
        most_bytes: size of the shots that are kept while none of them is drawn.

    Raises:
        OutputError: the folder cannot be written.
    """

    def __init__(self, folder: Path, most_bytes: int) -> None:
        self._shots, self._parts = folder / "shots", folder / "parts"
        self._most_bytes = most_bytes
        self._lock, self._forgetting = threading.Lock(), threading.Lock()
        self._used: dict[str, int] = {}
        try:
            if self._parts.exists():
                remove_tree(self._parts)
            for made in (self._shots, self._parts):
                made.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(f"the folder {folder} cannot be written: {error.strerror}", path=str(folder)) from error

    @contextmanager
    def use(self, shot_hash: str) -> Iterator[Path | None]:
        """Keep a shot until the end of the block.

        Args:
            shot_hash: that of its list of files.

        Yields:
            The folder of the shot; None where it is not there.
        """
        folder = self._shots / shot_hash
        with self._lock:
            is_there = folder.is_dir()
            if is_there:
                self._used[shot_hash] = self._used.get(shot_hash, 0) + 1
                os.utime(folder)
        try:
            yield folder if is_there else None
        finally:
            if is_there:
                with self._lock:
                    self._used[shot_hash] -= 1
                    if not self._used[shot_hash]:
                        del self._used[shot_hash]

    def begin(self) -> str:
        """Begin to receive a shot; return the token of what is received."""
        token = secrets.token_hex(8)
        (self._parts / token / "files").mkdir(parents=True)
        return token

    def receive(self, token: str, path: str, content: bytes) -> None:
        """Receive the next part of a file.

        Args:
            token: of `begin`.
            path: of the file, as in the list.
            content: the part.

        Raises:
            InputError: the path leads out of the shot.
            OSError: it cannot be written.
        """
        parts = PurePosixPath(path)
        if parts.is_absolute() or not parts.parts or ".." in parts.parts:
            raise InputError(f"a file of a shot lies in its folder, got {path[:200]!r}", code="bad_path", path=path)
        target = self._part(token) / "files" / parts
        target.parent.mkdir(parents=True, exist_ok=True)
        with target.open("ab") as file:
            file.write(content)

    def abandon(self, token: str) -> None:
        """Drop what was received of a shot. Raises `OSError`: it cannot be removed."""
        remove_tree(self._part(token))

    def end(self, token: str, expected: FileList) -> None:
        """Keep a shot that was received as a whole, and forget others beyond the budget.

        Args:
            token: of `begin`.
            expected: its files.

        Raises:
            InputError: it is not what was expected.
            OSError: it cannot be kept.
        """
        folder = self._part(token)
        try:
            if list_files(folder / "files") != expected:
                raise InputError("a shot was not received as it was sent", code="bad_shot")
            with self._lock:
                target = self._shots / expected.hash
                if not target.exists():
                    folder.rename(target)
        finally:
            if folder.exists():
                remove_tree(folder)
        self._forget(expected.hash)

    def _part(self, token: str) -> Path:
        """Return the folder of what is received. Raises `InputError`: there is none."""
        if not _TOKEN.fullmatch(token):
            raise InputError(f"a token of a shot is expected, got {token[:40]!r}", code="bad_token")
        return self._parts / token

    def _forget(self, newest: str) -> None:
        """Remove the shots that were not used for longest, while all are larger than the budget."""
        with self._forgetting:
            total = 0
            for folder in sorted(self._shots.iterdir(), key=lambda folder: folder.stat().st_mtime, reverse=True):
                total += sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
                if total > self._most_bytes and folder.name != newest:
                    self._remove(folder)

    def _remove(self, folder: Path) -> None:
        """Remove a shot that nobody uses. Those who begin to use another one wait for a rename, no more."""
        moved = self._parts / secrets.token_hex(8)
        with self._lock:
            if folder.name in self._used:
                return
            folder.rename(moved)
        remove_tree(moved)
