"""Files of renders that are fetched: each is there whole and compared with its hash, or not there."""

from __future__ import annotations

import hashlib
import os
import re
import stat
import uuid
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, NamedTuple

from .errors import AnswerError, FileError
from .models import Render, RenderedFile, RenderTask

SUFFIXES = {"image/x-exr": "exr", "image/png": "png", "image/jpeg": "jpeg"}
"""Suffix of a frame's file, by the type of the answer: nothing that the service sends is a part of a path as it is."""
_MOST_NAME_BYTES = 200


class StoredFile(NamedTuple):
    """A file of a frame that the service has stored.

    Attributes:
        frame: the frame.
        file: the file.
    """

    frame: int
    file: RenderedFile


def files_of(task: RenderTask) -> list[StoredFile]:
    """Return the files of a frame that is done. Raises `AnswerError`: the service names none, or an unknown format."""
    unknown = [file.format for file in task.files if file.format not in SUFFIXES.values()]
    if unknown or not task.files:
        told = f"in the unknown format {unknown[0][:80]!r}" if unknown else "but names no file of it"
        raise AnswerError(f"the service says that frame {task.frame} is done, {told}")
    return [StoredFile(task.frame, file) for file in task.files]


def file_stem(render: Render) -> str:
    """Return the name of a render's files before the number of the frame, as the service gives it."""
    last = re.split(r"[/\\]", render.name)[-1]
    plain = re.sub(r"[^\w.\- ]", "_", last).lstrip(".")[-120:]
    return plain.encode()[:_MOST_NAME_BYTES].decode(errors="ignore") or "render"


def file_name(render: Render, frame: int, suffix: str) -> str:
    """Return the name of a frame's file."""
    return f"{file_stem(render)}.{frame:04d}.{suffix}"


def find_fetched(folder: Path, render: Render, stored: StoredFile) -> Path | None:
    """Find a file of a frame that was fetched before; None where there is none of the same content.

    Args:
        folder: that the frames go to.
        render: of the frame.
        stored: the file.

    Raises:
        FileError: a file cannot be read.
    """
    path = folder / file_name(render, stored.frame, stored.file.format)
    try:
        status = path.stat()
        if stat.S_ISREG(status.st_mode) and status.st_size == stored.file.size_bytes:
            with path.open("rb") as file:
                if hashlib.file_digest(file, "sha256").hexdigest() == stored.file.sha256:
                    return path
    except FileNotFoundError:
        return None
    except OSError as error:
        raise _failed(path, error) from error
    return None


class FetchedFile:
    """A file while it is fetched, under another name in its folder. It is a `Sink`.

    Args:
        folder: the folder, which is made where it is missing.
        what: names it in errors.
        expected: its size and hash; None where the service tells neither.
    """

    def __init__(self, folder: Path, what: str, expected: RenderedFile | None) -> None:
        self._folder = folder
        self._what = what
        self._expected = expected
        self._part = folder / f".{uuid.uuid4().hex}.part"
        self._file: BinaryIO | None = None
        self._hash = hashlib.sha256()
        self._written = 0

    def __enter__(self) -> FetchedFile:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._file is not None:
            self._file.close()
            self._part.unlink(missing_ok=True)

    def restart(self) -> None:
        """Drop what is written. Raises `FileError`: the folder takes no files."""
        self._hash, self._written = hashlib.sha256(), 0
        try:
            if self._file is None:
                self._folder.mkdir(parents=True, exist_ok=True)
                self._file = self._part.open("xb")
            self._file.seek(0)
            self._file.truncate()
        except OSError as error:
            raise _failed(self._folder, error) from error

    def write(self, chunk: bytes) -> None:
        """Write a part. Raises `AnswerError`: it is more than the file has; `FileError`: the disk takes no more."""
        assert self._file is not None, "restart comes first"
        self._written += len(chunk)
        if self._expected is not None and self._written > self._expected.size_bytes:
            size = self._expected.size_bytes
            raise AnswerError(f"the file of {self._what} is longer than the {size:,} bytes that it has")
        self._hash.update(chunk)
        try:
            self._file.write(chunk)
        except OSError as error:
            raise _failed(self._folder, error) from error

    def keep(self, name: str) -> Path:
        """Give the file its name, once it is whole and on the disk.

        Args:
            name: within the folder; a file of that name is replaced.

        Raises:
            AnswerError: it is not the file whose hash the service tells.
            FileError: it cannot be written.
        """
        assert self._file is not None, "restart comes first"
        if self._expected is not None and not self._is(self._expected):
            raise AnswerError(f"the file of {self._what} is damaged: its hash is another; fetch it again")
        path = self._folder / name
        try:
            self._file.flush()
            os.fsync(self._file.fileno())
            self._file.close()
            self._part.replace(path)
        except OSError as error:
            raise _failed(path, error) from error
        self._file = None
        return path

    def _is(self, expected: RenderedFile) -> bool:
        return self._written == expected.size_bytes and self._hash.hexdigest() == expected.sha256


def _failed(path: Path, error: OSError) -> FileError:
    return FileError(f"{path} cannot be read or written: {error.strerror or error}")
