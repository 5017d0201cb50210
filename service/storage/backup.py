"""Backup of a data folder in one archive, also while a service works in it.

::

    NAME.tar.gz    the files of the folder at their relative paths, without the lock and files that are being written
        manifest.json    written last: {"format": 1, "files": {path: SHA-256}}

Uploaded files never change, and other files are replaced as a whole. Of a shot's edits the backup holds one moment: the index of
the history is read before and after them, and again where it has changed. A shot that is deleted meanwhile is not in the backup.
The database of renders is copied by SQLite, before the frames that it knows of.
"""

from __future__ import annotations

import errno
import hashlib
import io
import json
import os
import sqlite3
import stat
import tarfile
import uuid
from contextlib import closing, suppress
from pathlib import Path

from render.errors import InputError, OutputError
from render.files import check_writable
from service.storage.database.file import DATABASE
from service.storage.edit_files import EDITS, HISTORY, INDEX, states_of_index
from service.storage.migration import layout_of
from service.storage.restore import MANIFEST, verify

FORMAT = 1
_READ = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
_ATTEMPTS = 1000  # an edit takes milliseconds to write


def back_up(data: Path, archive: Path) -> int:
    """Write a backup, and read it again to see that it is whole.

    Args:
        data: the data folder.
        archive: the file to write; it is there as a whole or not at all.

    Returns:
        The number of files in it.

    Raises:
        InputError: there is no data folder, or a file of it cannot be read.
        OutputError: the archive cannot be written.
    """
    if not (data / "shots").is_dir():
        raise InputError(
            f"{data} is no data folder of the service: it has no folder `shots`", code="no_data", path=str(data)
        )
    layout_of(data)
    check_writable(archive)
    part = archive.with_name(f".{archive.name[:100]}.{uuid.uuid4().hex}.part")
    try:
        sums = _write(data, part)
        verify(part)
        os.replace(part, archive)
    except OSError as error:
        raise OutputError(f"the backup {archive} cannot be written: {error}", path=str(archive)) from error
    finally:
        part.unlink(missing_ok=True)
    return len(sums)


def _write(data: Path, part: Path) -> dict[str, str]:
    sums: dict[str, str] = {}
    with open(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:  # it holds keys
        with tarfile.open(fileobj=file, mode="w:gz", compresslevel=3) as tar:
            _add_all(tar, data, sums)
            manifest = json.dumps({"format": FORMAT, "files": sums}, indent=1).encode()
            _add_bytes(tar, MANIFEST, manifest, 0o600, {})
        file.flush()
        os.fsync(file.fileno())
    return sums


def _top(data: Path) -> list[Path]:
    """Return what a backup holds: all but the lock, and the files that SQLite has beside a database."""
    left_out = {"lock", MANIFEST, "fetched", *(f"{DATABASE}-{part}" for part in ("wal", "shm", "journal"))}
    names = sorted((path.name for path in data.iterdir()), key=lambda name: (name != DATABASE, name))
    return [data / name for name in names if name not in left_out]


def _add_all(tar: tarfile.TarFile, data: Path, sums: dict[str, str]) -> None:
    """Add the folder to an archive, at any depth. What has gone since its folder was listed is left out."""
    left = _top(data)[::-1]
    while left:
        path = left.pop()
        with suppress(FileNotFoundError):
            mode = path.lstat().st_mode
            if stat.S_ISDIR(mode):
                left += _add_folder(tar, data, path, sums)[::-1]
            elif path == data / DATABASE and stat.S_ISREG(mode):
                _add_bytes(tar, DATABASE, _database_at_one_moment(path), 0o600, sums)
            elif stat.S_ISREG(mode) and not _is_unfinished(path.relative_to(data)):
                _add_file(tar, data, path, sums)


def _database_at_one_moment(path: Path) -> bytes:
    """Read a database that may be written meanwhile. Raises `InputError`: it is none."""
    try:
        with closing(sqlite3.connect(path)) as source, closing(sqlite3.connect(":memory:")) as copy:
            source.backup(copy)
            return copy.serialize()
    except sqlite3.Error as error:
        raise InputError(f"the database {path} cannot be read: {error}", path=str(path)) from error


def _is_unfinished(path: Path) -> bool:
    """Whether a file of the service is being written, by its path in the data folder; uploaded files have any name."""
    return path.suffix == ".part" and path.parts[2:3] != ("files",)  # shots/ID/files/..., trash/ID.STAMP/files/...


def _add_folder(tar: tarfile.TarFile, data: Path, folder: Path, sums: dict[str, str]) -> list[Path]:
    """Add a folder, and where it is that of a shot's edits what is in it. Returns what has to be added from it, in order."""
    entry = tarfile.TarInfo(str(folder.relative_to(data)))
    entry.type, entry.mode = tarfile.DIRTYPE, 0o700
    tar.addfile(entry)
    if folder.name == "edits" and folder.parent.parent.parent == data:  # shots/ID/edits, trash/ID/edits
        for file, content in edits_at_one_moment(folder).items():
            _add_bytes(tar, str((folder / file).relative_to(data)), content, 0o600, sums)
        return []
    names = sorted((path.name for path in folder.iterdir()), key=lambda name: (name == "shot.json", name))
    return [folder / name for name in names]  # the record of a shot comes last, as where it is accepted


def edits_at_one_moment(folder: Path) -> dict[str, bytes]:
    """Read the edits of a shot with their history as they were at one moment.

    Args:
        folder: of the edits.

    Returns:
        Contents by paths in the folder.

    Raises:
        InputError: they do not stand still, or a state that the index names is missing.
    """
    for _ in range(_ATTEMPTS):
        index = _read(folder / HISTORY / INDEX)
        edits = _read(folder / EDITS)
        names = [f"{HISTORY}/{name}" for name in _states(index)]
        states = {name: _read(folder / name) for name in names}
        if _read(folder / HISTORY / INDEX) == index and None not in states.values():
            found = {**states, f"{HISTORY}/{INDEX}": index, EDITS: edits}
            return {name: content for name, content in found.items() if content is not None}
    raise InputError(
        f"the edits in {folder} cannot be read as a whole: a state of their history is missing", path=str(folder)
    )


def _states(index: bytes | None) -> list[str]:
    """Names of the files of the states in an index. A damaged index is kept as it is, and its states with it are not known."""
    try:
        return [f"{revision}.usda" for revision in states_of_index(index or b'{"states": []}') if revision.isalnum()]
    except (ValueError, KeyError, TypeError):
        return []


def _read(file: Path) -> bytes | None:
    """Read a file that a worker wrote; None where there is none, or a link or a pipe in its place."""
    if file.parent.is_symlink():
        return None
    try:
        with open(os.open(file, _READ), "rb") as opened:
            return opened.read() if stat.S_ISREG(os.fstat(opened.fileno()).st_mode) else None
    except OSError as error:
        if error.errno in (errno.ENOENT, errno.ELOOP, errno.ENOTDIR, errno.EISDIR):
            return None
        raise


def _add_file(tar: tarfile.TarFile, data: Path, path: Path, sums: dict[str, str]) -> None:
    name = str(path.relative_to(data))
    with open(os.open(path, _READ), "rb") as file:
        state = os.fstat(file.fileno())
        entry = tarfile.TarInfo(name)
        entry.size, entry.mode = state.st_size, state.st_mode & 0o666
        summing = _Summing(file)
        tar.addfile(entry, summing)  # type: ignore[arg-type]  # it reads and does nothing else
    sums[name] = summing.sum.hexdigest()


def _add_bytes(tar: tarfile.TarFile, name: str, content: bytes, mode: int, sums: dict[str, str]) -> None:
    entry = tarfile.TarInfo(name)
    entry.size, entry.mode = len(content), mode
    tar.addfile(entry, io.BytesIO(content))
    sums[name] = hashlib.sha256(content).hexdigest()


class _Summing:
    """A file that sums up what is read from it."""

    def __init__(self, file: io.BufferedReader) -> None:
        self._file = file
        self.sum = hashlib.sha256()

    def read(self, size: int) -> bytes:
        """Read a part."""
        content = self._file.read(size)
        self.sum.update(content)
        return content
