"""Storage that several services share: a bucket with the frames of renders and their shots."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from pathlib import Path

from render.errors import SettingsError
from service.jobs.bucket_files import BucketFiles
from service.jobs.shot_archive import ShotArchive
from service.jobs.shot_files import ShotFiles
from service.storage.bucket import Bucket

FETCHED = "fetched"
"""Folder of what was copied from the bucket, within the data folder."""
_OWNER = "database-id"


@dataclass(frozen=True)
class SharedStorage:
    """Contents of a bucket.

    Attributes:
        bucket: that has it.
        frames: of renders.
        shots: of renders.
        fetching: locks of shots that are being fetched, by hash.
    """

    bucket: Bucket
    frames: BucketFiles
    shots: ShotArchive
    fetching: dict[str, asyncio.Lock]

    @classmethod
    def open(cls, bucket: Bucket, data: Path, fetched_bytes: int) -> SharedStorage:
        """Open a bucket.

        Args:
            bucket: that is looked at first.
            data: folder of copies, a service's own.
            fetched_bytes: size of the shots that are kept there.

        Raises:
            OutputError: the bucket cannot be used, or the folder cannot be written.
        """
        bucket.check()
        fetched = data / FETCHED
        return cls(
            bucket, BucketFiles(bucket, data, fetched), ShotArchive(bucket, ShotFiles(fetched, fetched_bytes)), {}
        )

    def claim(self, database_id: str) -> None:
        """Have the bucket belong to a database: what no render of it needs is removed from the bucket.

        Args:
            database_id: of the database.

        Raises:
            SettingsError: it belongs to another one.
            OutputError: the bucket cannot be used.
        """
        if self.bucket.put_new(_OWNER, database_id.encode()):
            return
        if self.bucket.read(_OWNER) != database_id.encode():
            detail = f"the bucket {self.bucket.name} belongs to another database of renders; choose another prefix"
            raise SettingsError(detail, code="bad_bucket")
