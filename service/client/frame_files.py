"""Files of frames that are fetched: each is there whole and compared with its hash, or not there."""

from __future__ import annotations

import hashlib
import os
import re
import stat
import uuid
from pathlib import Path
from types import TracebackType
from typing import BinaryIO

from .errors import AnswerError, FileError
from .models import Render, RenderTask

SUFFIXES = {"image/x-exr": "exr", "image/png": "png", "image/jpeg": "jpeg"}
"""Suffix of a frame's file, by the type of the answer: nothing that the service sends is a part of a path as it is."""
_MOST_NAME_BYTES = 200


def file_stem(render: Render) -> str:
    """Return the name of a render's files before the number of the frame, as the service gives it."""
    last = re.split(r"[/\\]", render.name)[-1]
    plain = re.sub(r"[^\w.\- ]", "_", last).lstrip(".")[-120:]
    return plain.encode()[:_MOST_NAME_BYTES].decode(errors="ignore") or "render"


def file_name(render: Render, frame: int, suffix: str) -> str:
    """Return the name of a frame's file."""
    return f"{file_stem(render)}.{frame:04d}.{suffix}"


def find_fetched(folder: Path, render: Render, task: RenderTask) -> Path | None:
    """Find the file of a frame that was fetched before; None where there is none of the same content.

    Args:
        folder: that the frames go to.
        render: of the frame.
        task: the frame.

    Raises:
        FileError: a file cannot be read.
    """
    for suffix in SUFFIXES.values():
        path = folder / file_name(render, task.frame, suffix)
        try:
            status = path.stat()
            if stat.S_ISREG(status.st_mode) and status.st_size == task.size_bytes:
                with path.open("rb") as file:
                    if hashlib.file_digest(file, "sha256").hexdigest() == task.sha256:
                        return path
        except FileNotFoundError:
            continue
        except OSError as error:
            raise _failed(path, error) from error
    return None


class FrameFile:
    """A frame's file while it is fetched, under another name in its folder. It is a `Sink`.

    Args:
        folder: the folder, which is made where it is missing.
        task: the frame, which is stored.

    Raises:
        AnswerError: the service tells no size or hash.
    """

    def __init__(self, folder: Path, task: RenderTask) -> None:
        if task.size_bytes is None or task.sha256 is None:
            raise AnswerError(f"the service says that frame {task.frame} is done, but not how large its file is")
        self._folder = folder
        self._frame, self._size, self._sha256 = task.frame, task.size_bytes, task.sha256
        self._part = folder / f".{uuid.uuid4().hex}.part"
        self._file: BinaryIO | None = None
        self._hash = hashlib.sha256()
        self._written = 0

    def __enter__(self) -> FrameFile:
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
        """Write a part. Raises `AnswerError`: it is more than the frame has; `FileError`: the disk takes no more."""
        assert self._file is not None, "restart comes first"
        self._written += len(chunk)
        if self._written > self._size:
            raise AnswerError(f"the file of frame {self._frame} is longer than the {self._size:,} bytes that it has")
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
        if self._written != self._size or self._hash.hexdigest() != self._sha256:
            raise AnswerError(f"the file of frame {self._frame} is damaged: its hash is another; fetch it again")
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


def _failed(path: Path, error: OSError) -> FileError:
    return FileError(f"{path} cannot be read or written: {error.strerror or error}")
