"""Files of the frames that renders have drawn."""

from __future__ import annotations

import hashlib
import secrets
from contextlib import suppress
from pathlib import Path

from render.files import sync_folder, write_atomic
from render.removal import remove_tree
from service.storage.database.tables import FileEntry, TaskRow

FOLDER = "renders"
_ASIDE = "removed-"


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

    def products(self, render_id: str) -> Path:
        """Return the folder of what is made of the frames of a render, such as movies; it is removed with them."""
        return self._folder / render_id / "products"

    def write(self, path: Path, content: bytes) -> FileEntry:
        """Write a file of a frame beside its place and move it there: writing it twice does no harm.

        Raises:
            OutputError: it cannot be written.
            OSError: its folder cannot be made.
        """
        if not path.parent.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            sync_folder(self._folder)
        write_atomic(path, content)
        sync_folder(path.parent)  # the database says soon that it is there
        return {"size_bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}

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

    def remove_attempt(self, render_id: str, frame: int, attempt: int) -> None:
        """Remove what an attempt at a frame has stored; it is no error if there is nothing."""
        for path in (self._folder / render_id).glob(f"{frame}.{attempt}.*"):
            path.unlink(missing_ok=True)

    def has(self, path: Path, entry: FileEntry | None) -> bool:
        """Return whether a file of a frame is there, of the size that it was stored with."""
        return entry is not None and path.is_file() and path.stat().st_size == entry["size_bytes"]

    def has_all(self, task: TaskRow) -> bool:
        """Return whether all files of a frame are there."""
        paths = {suffix: self.path(task.render, task.frame, task.attempts, suffix) for suffix in task.files}
        return bool(paths) and all(self.has(path, task.files[suffix]) for suffix, path in paths.items())
