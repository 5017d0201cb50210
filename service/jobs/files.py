"""Files of the frames that renders have drawn."""

from __future__ import annotations

import hashlib
import secrets
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from render.files import sync_folder, write_atomic
from render.removal import remove_tree

FOLDER = "renders"
_ASIDE = "removed-"


class StoredFrame(NamedTuple):
    """A frame that was stored.

    Attributes:
        size_bytes: of the file.
        sha256: of its content, in hexadecimal digits.
    """

    size_bytes: int
    sha256: str


class RenderFiles:
    """The files of a data folder's renders, a folder for each render.

    Args:
        data: the data folder.
    """

    def __init__(self, data: Path) -> None:
        self._folder = data / FOLDER

    def path(self, render_id: str, frame: int, attempt: int, suffix: str) -> Path:
        """Return the path of what an attempt at a frame has drawn."""
        return self._folder / render_id / f"{frame}.{attempt}.{suffix}"

    def write(self, path: Path, content: bytes) -> StoredFrame:
        """Write a frame beside its place and move it there: writing it twice does no harm.

        Raises:
            OutputError: it cannot be written.
            OSError: its folder cannot be made.
        """
        if not path.parent.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            sync_folder(self._folder)
        write_atomic(path, content)
        sync_folder(path.parent)  # the database says soon that it is there
        return StoredFrame(len(content), hashlib.sha256(content).hexdigest())

    def set_aside(self, render_id: str) -> None:
        """Set the frames of a render aside, for `remove_set_aside`; it is no error if there are none."""
        with suppress(FileNotFoundError):
            (self._folder / render_id).rename(self._folder / f"{_ASIDE}{render_id}-{secrets.token_hex(4)}")

    def remove_set_aside(self) -> None:
        """Remove the frames that were set aside, now or before the service was killed."""
        for folder in self._folder.glob(f"{_ASIDE}*"):
            if folder.is_dir():
                remove_tree(folder)
            else:
                folder.unlink(missing_ok=True)

    def has(self, path: Path, size_bytes: int | None) -> bool:
        """Return whether a frame is there, of the size that it was stored with."""
        return path.is_file() and path.stat().st_size == size_bytes
