"""Files of the frames that renders have drawn, in a bucket that several services share.

::

    renders/RENDER/FRAME.ATTEMPT.SUFFIX    a file of a frame

A file that is asked for is copied to a folder of copies first, where it stays for a day after it was asked for last. Frames that
the data folder had before there was a bucket stay there, and are found, too.
"""

from __future__ import annotations

import os
import time
from collections.abc import Collection, Sequence
from contextlib import suppress
from pathlib import Path

from service.jobs.files import FOLDER, FolderFiles, entry_of, lost_among, name_of
from service.storage.bucket import Bucket
from service.storage.database.tables import FileEntry, TaskRow


class BucketFiles:
    """The files of renders in a bucket; see `service.jobs.files.FrameFiles`.

    Args:
        bucket: that has them.
        data: the data folder.
        copies: folder of copies and of products.
    """

    counts_products = False

    def __init__(self, bucket: Bucket, data: Path, copies: Path) -> None:
        self._bucket = bucket
        self._earlier = FolderFiles(data)
        self._copies = FolderFiles(copies)
        self._folder = copies / FOLDER

    def products(self, render_id: str) -> Path:
        """Return the folder of products, which each service makes for itself."""
        return self._copies.products(render_id)

    def write(self, render_id: str, frame: int, attempt: int, suffix: str, content: bytes) -> FileEntry:
        """Store a file in the bucket."""
        self._bucket.put(_object(render_id, frame, attempt, suffix), content)
        return entry_of(content)

    def find(self, render_id: str, frame: int, attempt: int, suffix: str, entry: FileEntry | None) -> Path | None:
        """Return a copy of the file, or what the data folder has."""
        place = render_id, frame, attempt, suffix
        copy = self._copies.find(*place, entry)
        if copy is not None:
            with suppress(FileNotFoundError):
                os.utime(copy)
                return copy
        earlier = self._earlier.find(*place, entry)
        if earlier is not None or entry is None:
            return earlier
        path = self._copies.path(render_id, frame, attempt, suffix)
        path.parent.mkdir(parents=True, exist_ok=True)
        is_there = self._bucket.fetch(_object(render_id, frame, attempt, suffix), entry["sha256"], path)
        return path if is_there else None

    def lost(self, render_id: str, tasks: Sequence[TaskRow]) -> list[int]:
        """Return the frames that are neither in the bucket nor in the data folder as a whole."""
        earlier = set(self._earlier.lost(render_id, tasks))
        return [frame for frame in lost_among(tasks, self._bucket.sizes(f"{FOLDER}/{render_id}")) if frame in earlier]

    def set_aside(self, render_id: str) -> None:
        """Set aside what this service has of the render; `remove` looks after the bucket."""
        self._earlier.set_aside(render_id)
        self._copies.set_aside(render_id)

    def remove_set_aside(self) -> None:
        """Remove what was set aside here."""
        self._earlier.remove_set_aside()
        self._copies.remove_set_aside()

    def remove(self, render_id: str) -> None:
        """Remove the files of the render from the bucket, and what was set aside."""
        names = self._bucket.sizes(f"{FOLDER}/{render_id}")
        self._bucket.delete(f"{FOLDER}/{render_id}/{name}" for name in names)
        self.remove_set_aside()

    def render_ids(self) -> set[str]:
        """Return the ids of the renders of which the bucket has files. Raises `UnavailableError`."""
        return set(self._bucket.folders(FOLDER))

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
