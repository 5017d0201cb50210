"""Shots of renders in a bucket, by their content, so that every service that shares the bucket can draw them.

::

    shots/HASH/files.json    the list of the files, stored after them; HASH is that of the list
    shots/HASH/SHA256        a file, by the hash of its content

A shot stays in the bucket for as long as a render needs it, and for a day at least. A service that draws it keeps a copy in its
data folder.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Collection
from contextlib import AbstractContextManager
from pathlib import Path
from weakref import WeakValueDictionary

from render.errors import InputError
from service.jobs.shot_files import FileList, ListedFile, ShotFiles, list_files
from service.storage.bucket import Bucket

FOLDER = "shots"
_LIST = "files.json"
FRESH_S = 12 * 3600.0
"""Age of a list up to which a shot is not stored again."""
KEPT_S = 24 * 3600.0
"""Age of a list from which on a shot that no render needs is removed; a shot that is sent meanwhile makes it younger."""


class ShotArchive:
    """The shots of renders in a bucket. Any thread may use it.

    Args:
        bucket: that has them.
        copies: shots that were fetched.
    """

    def __init__(self, bucket: Bucket, copies: ShotFiles) -> None:
        self._bucket = bucket
        self._copies = copies
        self._fetching: WeakValueDictionary[str, threading.Lock] = WeakValueDictionary()
        self._lock = threading.Lock()

    def store(self, folder: Path) -> str:
        """Store a shot where the bucket does not have it.

        Args:
            folder: of its files.

        Returns:
            The hash of the shot.

        Raises:
            OSError: a file cannot be read.
            UnavailableError: the bucket cannot be used.
        """
        files = list_files(folder)
        place = f"{FOLDER}/{files.hash}"
        there = self._bucket.sizes(place)
        missing = {file.sha256: file.path for file in files.files if there.get(file.sha256) != file.size_bytes}
        age_s = self._bucket.age_s(f"{place}/{_LIST}")
        if not missing and age_s is not None and age_s < FRESH_S:
            return files.hash
        for sha256, path in missing.items():
            self._bucket.put(f"{place}/{sha256}", folder / path)
        listed = [[file.path, file.size_bytes, file.sha256] for file in files.files]
        self._bucket.put(f"{place}/{_LIST}", json.dumps(listed).encode())
        return files.hash

    def fetch(self, shot_hash: str) -> None:
        """Copy a shot to this machine where it is not.

        Args:
            shot_hash: of the shot.

        Raises:
            InputError: the bucket does not have it as a whole.
            UnavailableError: the bucket cannot be used.
            OSError: it cannot be copied.
        """
        with self._lock:
            fetching = self._fetching.setdefault(shot_hash, threading.Lock())
        with fetching:
            with self._copies.use(shot_hash) as folder:
                if folder is not None:
                    return
            files = self._list_of(shot_hash)
            token = self._copies.begin()
            try:
                for file in files.files:
                    self._copies.receive(token, file.path, b"")
                    for part in self._bucket.parts(f"{FOLDER}/{shot_hash}/{file.sha256}"):
                        self._copies.receive(token, file.path, part)
            except BaseException:
                self._copies.abandon(token)
                raise
            self._copies.end(token, files)

    def use(self, shot_hash: str) -> AbstractContextManager[Path | None]:
        """Keep the copy of a shot until the end of the block; see `service.jobs.shot_files.ShotFiles.use`."""
        return self._copies.use(shot_hash)

    def forget(self, needed: Collection[str]) -> None:
        """Remove shots that no render needs.

        Args:
            needed: hashes of those that one needs.

        Raises:
            UnavailableError: the bucket cannot be used.
        """
        for shot_hash in self._bucket.folders(FOLDER):
            place = f"{FOLDER}/{shot_hash}"
            if shot_hash in needed:
                continue
            names = sorted(self._bucket.sizes(place), key=lambda name: name != _LIST)  # what has no list is not there
            telling = names[:1] if _LIST in names else names  # it may be stored by another service just now
            ages_s = [self._bucket.age_s(f"{place}/{name}") for name in telling]
            if all(age_s is None or age_s > KEPT_S for age_s in ages_s):
                self._bucket.delete(f"{place}/{name}" for name in names)

    def _list_of(self, shot_hash: str) -> FileList:
        """Return the list of the files of a shot. Raises `InputError`: there is none, or it is damaged."""
        content = self._bucket.read(f"{FOLDER}/{shot_hash}/{_LIST}")
        try:
            files = FileList(tuple(ListedFile(*file) for file in json.loads(content or b"")))
        except (ValueError, TypeError):
            files = None
        if files is None or files.hash != shot_hash:
            raise InputError("the shot of the render is gone from the bucket, or damaged", code="shot_gone")
        return files
