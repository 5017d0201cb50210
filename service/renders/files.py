"""Files of the frames that renders have drawn."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import NamedTuple

from render.files import write_atomic
from render.removal import remove_tree

FOLDER = "renders"


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
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomic(path, content)
        return StoredFrame(len(content), hashlib.sha256(content).hexdigest())

    def remove(self, render_id: str) -> None:
        """Remove all frames of a render."""
        folder = self._folder / render_id
        if folder.exists():
            remove_tree(folder)
