"""Packing of shots for their upload: a file as it is, a folder as a zip archive."""

from __future__ import annotations

import os
import stat
import tempfile
import zipfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, cast

from .errors import FileError


@dataclass(frozen=True)
class Package:
    """A shot that is ready to be sent.

    Attributes:
        name: of the file; its suffix tells the kind.
        file: open for reading.
        root: root layer within an archive; None lets the service find it.
    """

    name: str
    file: BinaryIO
    root: str | None


def open_package(path: Path, name: str | None, root: str | None, files: Sequence[Path] | None) -> Package:
    """Open the file of a shot, or pack a folder.

    Args:
        path: a USD file or a zip archive, which goes as it is, or a folder.
        name: of the shot; that of the file or folder when left out.
        root: root layer within the folder or archive.
        files: of a folder: those that are packed, relative to it; None packs all but hidden ones.

    Raises:
        FileError: a file cannot be read, or the folder not packed.
    """
    try:
        if path.is_dir():
            chosen = sorted(_all_files(path)) if files is None else files
            return Package(f"{name or path.resolve().name or 'shot'}.zip", _pack(path, chosen), root)
        if not stat.S_ISREG(path.stat().st_mode):
            raise FileError(f"{path} is neither a file nor a folder")
        sent = f"{name}{path.suffix}" if name else path.name
        sent.encode()
        return Package(sent, path.open("rb"), root)
    except UnicodeEncodeError as error:
        raise FileError(
            f"the name of {path!s} is no UTF-8: give another name".encode(errors="replace").decode()
        ) from error
    except ValueError as error:
        raise FileError(f"{path!s} cannot be read: {error}") from error
    except OSError as error:
        raise FileError(f"{error.filename or path}: {error.strerror or error}") from error


def _all_files(folder: Path) -> Iterator[Path]:
    """Return the files below a folder, relative to it; names that begin with a dot are left out."""

    def refuse(error: OSError) -> None:
        raise error

    for place, folders, names in os.walk(folder, onerror=refuse):
        folders[:] = [name for name in folders if not name.startswith(".")]
        for name in folders:
            if os.path.islink(os.path.join(place, name)):
                raise FileError(f"{os.path.join(place, name)} is a link to a folder; copy the folder, or push a .zip")
        for name in names:
            if not name.startswith("."):
                yield Path(place, name).relative_to(folder)


def _pack(folder: Path, files: Iterable[Path]) -> BinaryIO:
    """Return a zip archive of files, at its beginning. It has no name on the disk."""
    inside = folder.resolve()
    with ExitStack() as stack:
        out = cast(BinaryIO, stack.enter_context(tempfile.TemporaryFile()))
        with (
            _explained(folder),
            zipfile.ZipFile(
                out, "w", zipfile.ZIP_DEFLATED, allowZip64=False, compresslevel=1, strict_timestamps=False
            ) as archive,
        ):
            for file in files:
                source = folder / file
                if not source.resolve().is_relative_to(inside):
                    raise FileError(f"{source} leads out of the folder {folder}; copy what it names into it")
                if not stat.S_ISREG(source.stat().st_mode):
                    raise FileError(f"{source} is no plain file")
                archive.write(source, file.as_posix())
            if not archive.namelist():
                raise FileError(f"the folder {folder} is empty")
        out.seek(0)
        stack.pop_all()  # it stays open
    return out


@contextmanager
def _explained(folder: Path) -> Iterator[None]:
    try:
        yield
    except (zipfile.LargeZipFile, ValueError, RuntimeError) as error:  # a name that no archive has; a loop of links
        raise FileError(f"the folder {folder} cannot be packed: {error}") from error
