"""Trash: shots that were deleted, kept for some days so that they can be restored.

::

    DATA/trash/ID.STAMP/...     the folder of a shot as it was, with the time at which it was deleted

A shot comes here and goes back by one rename of its folder, so it is always in one place as a whole. An entry without a record
(``shot.json``) is being removed.
"""

from __future__ import annotations

import errno
import os
import re
import shutil
import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

from render.errors import NotFoundError
from render.model.edit_history import revision_of
from service.edit_context import EditContext, edits_tag
from service.storage.store import RECORD, ShotRecord, read_record

ENTRY_PATTERN = re.compile(r"([a-z0-9][a-z0-9-]{0,63})\.([0-9]{20})")
STAMP = "%Y%m%d%H%M%S%f"


@dataclass(frozen=True)
class TrashedShot:
    """A shot in the trash.

    Attributes:
        id: of the entry: the shot's id, a dot and the time at which it was deleted.
        record: the shot; its folder is the one in the trash.
        deleted_at: time at which it was deleted.
        removed_at: time from which it is removed for good.
    """

    id: str
    record: ShotRecord
    deleted_at: datetime
    removed_at: datetime


class Trash:
    """The trash of one data folder. Any thread may use it.

    Args:
        data: the data folder.
        days: for which a shot is kept; 0 removes it at once.
        now: the time.

    Raises:
        OSError: its folder cannot be created.
    """

    def __init__(self, data: Path, days: int, now: Callable[[], datetime] = lambda: datetime.now(UTC)) -> None:
        self._shots = data / "shots"
        self._folder = data / "trash"
        self._days = days
        self._now = now
        self._lock = threading.Lock()
        self._folder.mkdir(exist_ok=True)

    def entries(self) -> list[TrashedShot]:
        """Return the shots in the trash, the one that was deleted last first."""
        return sorted(
            filter(None, map(self._read, self._folders())), key=lambda entry: (entry.deleted_at, entry.id), reverse=True
        )

    def get(self, entry_id: str) -> TrashedShot:
        """Return a shot in the trash.

        Raises:
            NotFoundError: there is none of this id.
        """
        entry = self._read(self._folder / entry_id) if ENTRY_PATTERN.fullmatch(entry_id) else None
        if entry is None:
            raise not_in_trash(entry_id)
        return entry

    def put(self, record: ShotRecord, condition: EditContext) -> None:
        """Move a shot to the trash.

        Args:
            record: the shot.
            condition: holds for the revision of its edits, also of those that were made until it was moved.

        Raises:
            ChangedMeanwhileError: the condition does not hold; the shot stays where it is.
            NotFoundError: the shot was deleted meanwhile.
        """
        _check(record, condition)
        moved = replace(record, folder=self._folder / f"{record.id}.{self._now().astimezone(UTC).strftime(STAMP)}")
        with self._lock:
            try:
                os.rename(record.folder, moved.folder)
            except FileNotFoundError as error:
                raise NotFoundError(
                    f"There is no shot {record.id!r}.", code="shot_not_found", path=record.id
                ) from error
            try:
                _check(moved, condition)
            except BaseException:
                os.rename(moved.folder, record.folder)
                raise
        if self._days == 0:
            self._remove(moved.folder)

    def restore(self, entry: TrashedShot) -> None:
        """Move a shot back to where it was.

        Raises:
            FileExistsError: there is a shot of its id again.
            NotFoundError: it was restored or removed meanwhile.
        """
        with self._lock:
            folder = self.get(entry.id).record.folder
            try:
                os.rename(folder, self._shots / entry.record.id)
            except OSError as error:
                if error.errno in (errno.EEXIST, errno.ENOTEMPTY):
                    raise FileExistsError(error.errno, error.strerror) from error
                raise

    def remove(self, entry: TrashedShot) -> None:
        """Remove a shot from the trash for good.

        Raises:
            NotFoundError: it was restored or removed meanwhile.
        """
        self._remove(self.get(entry.id).record.folder)

    def empty(self) -> int:
        """Remove what has been here for long enough, and what is left of interrupted removals. Returns the number of entries."""
        due = [folder for folder in self._folders() if self._is_due(folder)]
        for folder in due:
            self._remove(folder)
        return len(due)

    def _is_due(self, folder: Path) -> bool:
        age_days = (self._now() - _deleted_at(folder.name)) / timedelta(days=1)
        return age_days >= self._days or not (folder / RECORD).is_file()

    def _remove(self, folder: Path) -> None:
        with self._lock:  # an entry without a record is not restored
            (folder / RECORD).unlink(missing_ok=True)
        shutil.rmtree(folder, ignore_errors=True)

    def _folders(self) -> list[Path]:
        return [path for path in self._folder.iterdir() if ENTRY_PATTERN.fullmatch(path.name)]

    def _read(self, folder: Path) -> TrashedShot | None:
        shot_id = folder.name.rpartition(".")[0]
        record = read_record(folder, shot_id)
        if record is None:
            return None
        deleted_at = _deleted_at(folder.name)
        days = min(self._days, (datetime.max.replace(tzinfo=UTC) - deleted_at).days)
        return TrashedShot(folder.name, record, deleted_at, deleted_at + timedelta(days=days))


def not_in_trash(entry_id: str) -> NotFoundError:
    """Return the error of a shot that is not in the trash, or not for the one who asks."""
    shown = entry_id[:100]
    return NotFoundError(f"There is no {shown!r} in the trash.", code="not_in_trash", path=shown)


def _check(record: ShotRecord, condition: EditContext) -> None:
    condition.check_tag(edits_tag(revision_of(record.edit_text())), f"shot {record.id!r}")


def _deleted_at(entry_id: str) -> datetime:
    return datetime.strptime(entry_id.rpartition(".")[2], STAMP).replace(tzinfo=UTC)
