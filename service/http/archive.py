"""Unpacks untrusted zip archives without trusting their headers.

An entry may not leave the folder (``..``, absolute paths, drive letters), must be a file or a folder (no links), and may not
occur twice. Bytes are counted as they are unpacked, against a limit and against the archive's own size, which stops a zip bomb
whatever sizes it declares. The central directory is measured before it is read, because it alone could fill the memory.
"""

from __future__ import annotations

import stat
import struct
import zipfile
import zlib
from pathlib import Path, PurePosixPath
from typing import IO

from service.http.errors import ServiceError
from service.http.settings import MEBIBYTE, Settings

CHUNK_BYTES = MEBIBYTE
# The ratio is checked from this size on: text compresses well, and a small archive does no harm.
RATIO_FLOOR_BYTES = 64 * MEBIBYTE
# Files that desktop systems add to archives.
CLUTTER = ("__MACOSX", ".DS_Store", "Thumbs.db", "desktop.ini")
# End of central directory record; .ZIP File Format Specification 6.3.10, section 4.3.16.
END_RECORD = struct.Struct("<4s4H2LH")
ENTRY_BYTES = 46 + 512  # a central directory entry with a long name
ENCRYPTED = 0x1
# Exceptions that Python's zipfile raises for damaged archives, found by experiment. OSError means our own disk.
DAMAGE = (
    zipfile.BadZipFile,
    zlib.error,
    EOFError,
    struct.error,
    ValueError,
    RuntimeError,
    OverflowError,
)


def unpack(file: IO[bytes], name: str, folder: Path, settings: Settings) -> None:
    """Unpack a zip archive into a folder.

    Args:
        file: the archive, seekable.
        name: the archive's name, for messages.
        folder: an empty folder; the caller removes what a refused archive leaves in it.
        settings: limits of archives.

    Raises:
        ServiceError: 413 or 422 that names the entry and says what is wrong with it.
    """
    archive_bytes = _measure(file, name, settings)
    budget = _Budget(archive_bytes, name, settings)
    try:
        with zipfile.ZipFile(file) as archive:
            entries = archive.infolist()
            if len(entries) > settings.max_archive_entries:
                raise _too_many(name, settings)
            for entry in entries:
                _unpack_entry(archive, entry, folder, budget)
    except DAMAGE as error:
        raise ServiceError(422, "bad_archive", f"{name} is damaged: {error}.", path=name) from error


def _too_many(name: str, settings: Settings) -> ServiceError:
    detail = f"{name} holds more than {settings.max_archive_entries} entries."
    return ServiceError(413, "archive_too_large", detail, path=name)


def _measure(file: IO[bytes], name: str, settings: Settings) -> int:
    """Return the archive's size in bytes, after checking the size of its central directory."""
    size = file.seek(0, 2)
    tail_start = max(0, size - END_RECORD.size - 0xFFFF - 20)
    file.seek(tail_start)
    tail = file.read()
    at = tail.rfind(b"PK\x05\x06")
    # Python's zipfile prefers a record at the very end; both must read the same one.
    if tail[-END_RECORD.size :][:4] == b"PK\x05\x06" and tail[-2:] == b"\0\0":
        at = len(tail) - END_RECORD.size
    if at < 0 or at + END_RECORD.size > len(tail):
        raise ServiceError(422, "bad_archive", f"{name} is no zip archive, or its end is missing.", path=name)
    if tail[max(0, at - 20) :][:4] == b"PK\x06\x07":
        detail = f"{name} is a ZIP64 archive; expected a plain one, which holds 4 GiB and 65535 entries."
        raise ServiceError(422, "bad_archive", detail, path=name)
    directory_bytes = END_RECORD.unpack_from(tail, at)[5]
    if directory_bytes > settings.max_archive_entries * ENTRY_BYTES:
        raise _too_many(name, settings)
    return size


class _Budget:
    """Limit of the bytes and the folders that an archive may unpack to."""

    def __init__(self, archive_bytes: int, name: str, settings: Settings) -> None:
        self._name = name
        self._total = 0
        self._folders: set[PurePosixPath] = set()
        self._most_folders = settings.max_archive_entries
        self._limit = settings.max_unpacked_mb * MEBIBYTE
        self._ratio_limit = max(RATIO_FLOOR_BYTES, archive_bytes * settings.max_archive_ratio)

    def spend(self, count: int, entry: str) -> None:
        """Count unpacked bytes. Raises `ServiceError` 413 where they are too many."""
        self._total += count
        if self._total > min(self._limit, self._ratio_limit):
            reached = min(self._limit, self._ratio_limit) // MEBIBYTE
            detail = f"{self._name} unpacks to more than the {reached} MiB that it may; stopped at {entry}."
            raise ServiceError(413, "archive_too_large", detail, path=entry)

    def make_folder(self, path: PurePosixPath, entry: str) -> None:
        """Count a folder and those that it lies in. Raises `ServiceError` 413 where they are too many."""
        while path.parts and path not in self._folders:
            self._folders.add(path)
            path = path.parent
        if len(self._folders) > self._most_folders:
            detail = f"{self._name} unpacks to more than {self._most_folders} folders; stopped at {entry}."
            raise ServiceError(413, "archive_too_large", detail, path=entry)


def _unpack_entry(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, folder: Path, budget: _Budget) -> None:
    path = safe_path(entry)
    if path is None:
        return
    target = folder / path
    try:
        budget.make_folder(path if entry.is_dir() else path.parent, entry.filename)
        if entry.is_dir():
            target.mkdir(parents=True, exist_ok=True)
            return
        target.parent.mkdir(parents=True, exist_ok=True)
        with archive.open(entry) as source, target.open("xb") as out:
            while chunk := source.read(CHUNK_BYTES):
                budget.spend(len(chunk), entry.filename)
                out.write(chunk)
    except (FileExistsError, NotADirectoryError, IsADirectoryError) as error:
        raise _refused(entry, "comes twice, or is a file and a folder") from error


def safe_path(entry: zipfile.ZipInfo) -> PurePosixPath | None:
    """Return the path of an entry, relative to the folder; None for files that desktop systems add.

    Raises:
        ServiceError: 422, the entry would leave the folder, is no plain file, or is encrypted.
    """
    name = entry.filename.replace("\\", "/")  # as some Windows tools write them
    parts = [part for part in name.split("/") if part not in ("", ".")]
    if name.startswith("/") or (parts and ":" in parts[0]):
        raise _refused(entry, "has an absolute name; expected names inside the archive")
    if ".." in parts:
        raise _refused(entry, "leaves the archive's folder by '..'")
    if any(len(part.encode()) > 255 for part in parts) or len(name.encode()) > 2000:
        raise _refused(entry, "has a name that is too long")
    if any(ord(letter) < 32 or ord(letter) == 127 for letter in name):
        raise _refused(entry, "has control characters in its name")
    mode = stat.S_IFMT(entry.external_attr >> 16)
    if mode not in (0, stat.S_IFREG, stat.S_IFDIR):
        raise _refused(entry, "is a link or a special file; expected files and folders")
    if entry.flag_bits & ENCRYPTED:
        raise _refused(entry, "is encrypted")
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise _refused(entry, "is compressed in a way that is not taken; expected 'stored' or 'deflated'")
    if not parts or parts[0] in CLUTTER or parts[-1] in CLUTTER:
        return None
    return PurePosixPath(*parts)


def _refused(entry: zipfile.ZipInfo, why: str) -> ServiceError:
    shown = entry.filename[:200]
    return ServiceError(422, "unsafe_archive", f"The entry {shown!r} {why}.", path=shown)
