"""Reading of backups: every member is checked before it is written, and every checksum before the folder is put in its place."""

from __future__ import annotations

import fcntl
import glob
import hashlib
import os
import tarfile
import tempfile
import zlib
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import IO

from render.errors import InputError, OutputError
from render.files import sync_file_system, sync_folder
from render.removal import remove_tree
from service.json_text import parse_json
from service.storage.migration import layout_of

MANIFEST = "manifest.json"
_BLOCK = 1024 * 1024
_MAX_MANIFEST = 256 * 1024 * 1024
_KINDS = (tarfile.REGTYPE, tarfile.AREGTYPE, tarfile.DIRTYPE)

Take = Callable[[tarfile.TarInfo, IO[bytes] | None], str]
"""Takes a member: a folder, or a file with its content. Returns the SHA-256 of the content."""


def restore(archive: Path, data: Path) -> int:
    """Make a data folder from a backup. It is there as a whole or not at all.

    Args:
        archive: as `service.storage.backup.back_up` wrote it.
        data: the folder to make; an empty one may be there.

    Returns:
        The number of files.

    Raises:
        InputError: the archive is damaged, is no backup, or is of a newer version.
        OutputError: the folder is not empty, or cannot be written.
    """
    try:
        if data.exists() and any(data.iterdir()):
            raise OutputError(f"{data} is not empty: a backup is restored into a new folder", path=str(data))
        data.parent.mkdir(parents=True, exist_ok=True)
        _remove_interrupted(data)
        beside = Path(tempfile.mkdtemp(prefix=f".{data.name}.", suffix=".part", dir=data.parent))
        lock = _locked(beside)
    except OSError as error:
        raise OutputError(f"{data} cannot be written: {error.strerror}", path=str(data)) from error
    try:
        count = _read_backup(archive, lambda member, content: _write(beside, member, content))
        layout_of(beside)
        sync_file_system(beside)
        beside.rename(data)
        sync_folder(data.parent)
    except OSError as error:
        detail = f"{data} cannot be restored: {error.strerror or error}"
        raise OutputError(detail, path=str(data)) from error
    finally:
        with suppress(OSError):
            remove_tree(beside)
        os.close(lock)
    return count


def _remove_interrupted(data: Path) -> None:
    """Remove what restorations of a folder that were killed have left beside it; one that is in progress has locked its own."""
    for left in data.parent.glob(f".{glob.escape(data.name)}.*.part"):
        with suppress(OSError):
            lock = _locked(left)
            try:
                remove_tree(left)
            finally:
                os.close(lock)


def _locked(folder: Path) -> int:
    """Lock a folder; the lock ends with the process. Returns its descriptor. Raises `BlockingIOError`: it is locked."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(descriptor)
        raise
    return descriptor


def verify(archive: Path) -> int:
    """Read a backup to its end, and compare its files with their checksums. Returns the number of files.

    Raises:
        InputError: as for `restore`.
    """
    return _read_backup(archive, lambda _, content: _sum(content, None))


def _read_backup(archive: Path, take: Take) -> int:
    """Give every member to a function, and compare the files with the manifest. Returns the number of files."""
    sums: dict[str, str] = {}
    seen: set[str] = set()
    manifest: object = None
    try:
        with tarfile.open(archive, mode="r|gz") as tar:
            for member in tar:
                _check(archive, member, seen)
                content = tar.extractfile(member) if member.isreg() else None
                if member.name == MANIFEST and content is not None:
                    manifest = parse_json(content.read(_MAX_MANIFEST))
                    continue
                found = take(member, content)
                if content is not None:
                    sums[member.name] = found
    except FileNotFoundError as error:
        raise InputError(f"there is no file {archive}", path=str(archive)) from error
    except (
        tarfile.TarError,
        EOFError,
        zlib.error,
        ValueError,
        RecursionError,
    ) as error:  # RecursionError: folders without end
        raise InputError(
            f"{archive} is no backup, or is damaged: {error}", code="bad_backup", path=str(archive)
        ) from error
    if not isinstance(manifest, dict) or manifest.get("format") != 1 or not isinstance(manifest.get("files"), dict):
        detail = f"{archive} has no manifest that this version knows: it is cut short, or no backup"
        raise InputError(detail, code="bad_backup", path=str(archive))
    wrong = sorted(
        name for name in sums.keys() | manifest["files"].keys() if sums.get(name) != manifest["files"].get(name)
    )
    if wrong:
        detail = f"{archive} is damaged: {wrong[0]!r} is not what was backed up, of {len(wrong)} such files"
        raise InputError(detail, code="bad_backup", path=str(archive))
    return len(sums)


def _check(archive: Path, member: tarfile.TarInfo, seen: set[str]) -> None:
    """Refuse a member that could be written anywhere but at a place of its own in the folder.

    Raises:
        InputError: it is refused.
    """
    parts = member.name.split("/")
    reason = (
        "is neither a file nor a folder" if member.type not in _KINDS
        else "leads out of the folder" if any(part in ("", ".", "..") for part in parts) or "\0" in member.name
        else "has holes" if member.issparse()  # a few bytes would fill the disk
        else "is there twice" if member.name in seen
        else ""
    )  # fmt: skip
    if reason:
        raise InputError(
            f"{archive} is refused: its member {member.name[:200]!r} {reason}", code="bad_backup", path=str(archive)
        )
    seen.add(member.name)


def _write(folder: Path, member: tarfile.TarInfo, content: IO[bytes] | None) -> str:
    path = folder / member.name
    if content is None:
        path.mkdir(parents=True, exist_ok=True)
        return ""
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, member.mode & 0o666), "wb") as file:
        return _sum(content, file)


def _sum(content: IO[bytes] | None, copy: IO[bytes] | None) -> str:
    """Read a content, write it to a copy if there is one, and return its SHA-256."""
    summed = hashlib.sha256()
    while content is not None and (block := content.read(_BLOCK)):
        summed.update(block)
        if copy is not None:
            copy.write(block)
    return summed.hexdigest()
