"""Storage that several services share: a bucket with the frames of renders and their shots."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from service.jobs.bucket_files import BucketFiles
from service.jobs.shot_archive import ShotArchive
from service.jobs.shot_files import ShotFiles
from service.storage.bucket import Bucket

_FETCHED = "fetched"


@dataclass(frozen=True)
class SharedStorage:
    """Contents of a bucket.

    Attributes:
        bucket: that has it.
        frames: of renders.
        shots: of renders.
    """

    bucket: Bucket
    frames: BucketFiles
    shots: ShotArchive

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
        return cls(bucket, BucketFiles(bucket, data), ShotArchive(bucket, ShotFiles(data / _FETCHED, fetched_bytes)))
