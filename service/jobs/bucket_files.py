"""Files of the frames that renders have drawn, in a bucket that several services share.

::

    renders/RENDER/FRAME.ATTEMPT.SUFFIX    a file of a frame
    removed/RENDER                         the render was removed: its files are to be removed, too

A file that is asked for is copied to the data folder first, where it stays for a day.
"""

from __future__ import annotations

import time
from collections.abc import Collection, Sequence
from contextlib import suppress
from pathlib import Path

from service.jobs.files import FOLDER, FolderFiles, entry_of, lost_among, name_of
from service.storage.bucket import Bucket
from service.storage.database.tables import FileEntry, TaskRow

_REMOVED = "removed"


class BucketFiles:
    """The files of renders in a bucket; see `service.jobs.files.FrameFiles`.

    Args:
        bucket: that has them.
        data: the data folder.
    """

    def __init__(self, bucket: Bucket, data: Path) -> None:
        self._bucket = bucket
        self._copies = FolderFiles(data)
        self._folder = data / FOLDER

    def products(self, render_id: str) -> Path:
        """Return the folder of products, which each service makes for itself."""
        return self._copies.products(render_id)

    def write(self, render_id: str, frame: int, attempt: int, suffix: str, content: bytes) -> FileEntry:
        """Store a file in the bucket."""
        self._bucket.put(_object(render_id, frame, attempt, suffix), content)
        return entry_of(content)

    def find(self, render_id: str, frame: int, attempt: int, suffix: str, entry: FileEntry | None) -> Path | None:
        """Return a copy of the file."""
        copy = self._copies.find(render_id, frame, attempt, suffix, entry)
        if copy is not None or entry is None:
            return copy
        path = self._copies.path(render_id, frame, attempt, suffix)
        path.parent.mkdir(parents=True, exist_ok=True)
        is_there = self._bucket.fetch(_object(render_id, frame, attempt, suffix), entry["sha256"], path)
        return path if is_there else None

    def lost(self, render_id: str, tasks: Sequence[TaskRow]) -> list[int]:
        """Return the frames that are not in the bucket as a whole."""
        return lost_among(tasks, self._bucket.sizes(f"{FOLDER}/{render_id}"))

    def set_aside(self, render_id: str) -> None:
        """Note in the bucket that the render was removed."""
        self._bucket.put(f"{_REMOVED}/{render_id}", b"removed")
        self._copies.set_aside(render_id)

    def remove_set_aside(self) -> None:
        """Remove the files of renders that were removed."""
        for render_id in self._bucket.sizes(_REMOVED):
            names = self._bucket.sizes(f"{FOLDER}/{render_id}")
            self._bucket.delete(f"{FOLDER}/{render_id}/{name}" for name in names)
            self._bucket.delete([f"{_REMOVED}/{render_id}"])
        self._copies.remove_set_aside()

    def remove_attempt(self, render_id: str, frame: int, attempt: int, suffixes: Collection[str]) -> None:
        """Remove the files of an attempt from the bucket."""
        self._bucket.delete(_object(render_id, frame, attempt, suffix) for suffix in suffixes)

    def forget_copies(self, age_s: float) -> None:
        """Remove copies and products that are older than a time, s. Raises `OSError`."""
        oldest = time.time() - age_s
        for path in self._folder.rglob("*"):
            with suppress(FileNotFoundError):
                if path.is_file() and path.stat().st_mtime < oldest:
                    path.unlink()


def _object(render_id: str, frame: int, attempt: int, suffix: str) -> str:
    return f"{FOLDER}/{render_id}/{name_of(frame, attempt, suffix)}"
