"""Files of the frames that renders have drawn, in the data folder."""

from __future__ import annotations

import hashlib
import secrets
from collections.abc import Collection, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Protocol

from render.files import sync_folder, write_atomic
from render.removal import remove_tree
from service.storage.database.tables import FileEntry, TaskRow

FOLDER = "renders"
_ASIDE = "removed-"


class FrameFiles(Protocol):
    """Files of frames: those of the data folder (`FolderFiles`), or of a bucket (`service.jobs.bucket_files.BucketFiles`).

    Attributes:
        counts_products: whether products stay, so that they count among what a project stores.
    """

    counts_products: bool

    def products(self, render_id: str) -> Path:
        """Return the folder of what is made of the frames of a render, such as movies; it is removed with them."""
        ...

    def write(self, render_id: str, frame: int, attempt: int, suffix: str, content: bytes) -> FileEntry:
        """Store a file of a frame as a whole: storing it twice does no harm.

        Args:
            render_id: the render.
            frame: number of the frame.
            attempt: number of the attempt that has drawn it.
            suffix: of the file.
            content: all of its bytes.

        Raises:
            OutputError: it cannot be stored.
            OSError: its folder cannot be made.
        """
        ...

    def find(self, render_id: str, frame: int, attempt: int, suffix: str, entry: FileEntry | None) -> Path | None:
        """Return a file with what an attempt at a frame has stored; None where it is gone or damaged.

        Args:
            render_id: the render.
            frame: number of the frame.
            attempt: number of the attempt.
            suffix: of the file.
            entry: what was stored; None for nothing.

        Raises:
            OutputError: it cannot be looked for now.
        """
        ...

    def lost(self, render_id: str, tasks: Sequence[TaskRow]) -> list[int]:
        """Return those frames of a render, among its tasks that are done, whose files are not all there. Raises `OutputError`."""
        ...

    def set_aside(self, render_id: str) -> None:
        """Set the frames of a render aside, for `remove_set_aside`. Raises `OutputError`, `OSError`."""
        ...

    def remove_set_aside(self) -> None:
        """Remove the frames that were set aside, now or before the service was killed. Raises `OutputError`, `OSError`."""
        ...

    def remove(self, render_id: str) -> None:
        """Remove the files of a render that was set aside and is forgotten. Raises `OutputError`, `OSError`."""
        ...

    def remove_attempt(self, render_id: str, frame: int, attempt: int, suffixes: Collection[str]) -> None:
        """Remove what an attempt at a frame has stored; it is no error if there is nothing. Raises `OutputError`, `OSError`."""
        ...


class FolderFiles:
    """The files of a data folder's renders, a folder for each render; see `FrameFiles`.

    Args:
        data: the data folder.
    """

    counts_products = True

    def __init__(self, data: Path) -> None:
        self._folder = data / FOLDER

    def path(self, render_id: str, frame: int, attempt: int, suffix: str) -> Path:
        """Return the path of what an attempt at a frame has drawn."""
        return self._folder / render_id / name_of(frame, attempt, suffix)

    def products(self, render_id: str) -> Path:
        """Return the folder of products."""
        return self._folder / render_id / "products"

    def write(self, render_id: str, frame: int, attempt: int, suffix: str, content: bytes) -> FileEntry:
        """Write a file beside its place and move it there."""
        path = self.path(render_id, frame, attempt, suffix)
        if not path.parent.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            sync_folder(self._folder)
        write_atomic(path, content)
        sync_folder(path.parent)  # the database says soon that it is there
        return entry_of(content)

    def find(self, render_id: str, frame: int, attempt: int, suffix: str, entry: FileEntry | None) -> Path | None:
        """Return the file where it has the size that it was stored with."""
        path = self.path(render_id, frame, attempt, suffix)
        is_there = entry is not None and path.is_file() and path.stat().st_size == entry["size_bytes"]
        return path if is_there else None

    def lost(self, render_id: str, tasks: Sequence[TaskRow]) -> list[int]:
        """Return the frames that are not there as a whole."""
        folder = self._folder / render_id
        sizes = {path.name: path.stat().st_size for path in folder.glob("*.*") if path.is_file()}
        return lost_among(tasks, sizes)

    def set_aside(self, render_id: str) -> None:
        """Rename the folder of the render."""
        with suppress(FileNotFoundError):
            (self._folder / render_id).rename(self._folder / f"{_ASIDE}{render_id}-{secrets.token_hex(4)}")

    def remove_set_aside(self) -> None:
        """Remove the folders that were set aside."""
        for folder in self._folder.glob(f"{_ASIDE}*"):
            if folder.is_dir():
                remove_tree(folder)
            else:
                folder.unlink(missing_ok=True)

    def remove(self, render_id: str) -> None:
        """Remove what was set aside."""
        self.remove_set_aside()

    def remove_attempt(self, render_id: str, frame: int, attempt: int, suffixes: Collection[str]) -> None:
        """Remove the files of an attempt."""
        for suffix in suffixes:
            self.path(render_id, frame, attempt, suffix).unlink(missing_ok=True)


def name_of(frame: int, attempt: int, suffix: str) -> str:
    """Return the name of a file of a frame."""
    return f"{frame}.{attempt}.{suffix}"


def entry_of(content: bytes) -> FileEntry:
    """Return what the database keeps of a file."""
    return {"size_bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}


def lost_among(tasks: Sequence[TaskRow], sizes: dict[str, int]) -> list[int]:
    """Return the frames that are done and of which files are missing or of another size.

    Args:
        tasks: of a render.
        sizes: of the files that are there, by name.
    """

    def is_whole(task: TaskRow) -> bool:
        wanted = {name_of(task.frame, task.attempts, suffix): entry for suffix, entry in task.files.items()}
        return bool(wanted) and all(sizes.get(name) == entry["size_bytes"] for name, entry in wanted.items())

    return [task.frame for task in tasks if task.state == "done" and not is_whole(task)]
