"""Trash: shots that were deleted, kept for some days so that they can be restored.

::

    DATA/trash/ID.STAMP/...     the folder of a shot as it was, with the time at which it was deleted

A shot comes here and goes back by one rename of its folder, so it is always in one place as a whole. An entry without a record
(``shot.json``) is being removed.

A shot is not removed too early because the clock of the machine was set: its deletion is stamped with the later, and its time is
over by the earlier, of the wall clock and the one that has run on since the start. Nothing is due for the first hour after a
start, in which a machine that begins with a wrong clock may have it set.
"""

from __future__ import annotations

import errno
import logging
import os
import re
import threading
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

from render.errors import NotFoundError
from render.files import sync_folder
from render.model.edit_history import revision_of
from render.removal import remove_tree
from service.edit_context import EditContext, edits_tag
from service.storage.clocks import Clocks
from service.storage.store import RECORD, TRASH, ShotRecord, read_record

log = logging.getLogger("pullfocus.service")

ENTRY_PATTERN = re.compile(r"([a-z0-9][a-z0-9-]{0,63})\.([0-9]{20})")
STAMP = "%Y%m%d%H%M%S%f"
SETTLING_S = 3600.0
"""Time after a start in which nothing is due, s."""


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
        data: the data folder, opened by a `service.storage.store.ShotStore`.
        days: for which a shot is kept; 0 removes it at once.
        clocks: tell the time.
    """

    def __init__(self, data: Path, days: int, clocks: Clocks | None = None) -> None:
        self._shots = data / "shots"
        self._folder = data / TRASH
        self._days = days
        self._clocks = clocks or Clocks()
        self._lock = threading.Lock()

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
        entry = self._read(self._folder / entry_id) if _is_entry(entry_id) else None
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
        stamp = self._clocks.later().astimezone(UTC).strftime(STAMP)
        moved = replace(record, folder=self._folder / f"{record.id}.{stamp}")
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
            self._sync()
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
            self._sync()

    def _sync(self) -> None:
        for folder in (self._folder, self._shots):
            sync_folder(folder)

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
        if not (folder / RECORD).is_file():
            return True
        age_days = (self._clocks.earlier() - _deleted_at(folder.name)) / timedelta(days=1)
        return age_days >= self._days and self._clocks.running_s >= SETTLING_S

    def _remove(self, folder: Path) -> None:
        with self._lock:  # an entry without a record is not restored
            (folder / RECORD).unlink(missing_ok=True)
        try:
            remove_tree(folder)
        except OSError as error:  # it is tried again when the trash is emptied next
            log.error("%s cannot be removed from the trash as a whole: %s", folder.name, error)

    def _folders(self) -> list[Path]:
        return [path for path in self._folder.iterdir() if _is_entry(path.name)]

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


def _is_entry(name: str) -> bool:
    """Whether a name is that of an entry. A folder whose stamp is no time is left alone."""
    if not ENTRY_PATTERN.fullmatch(name):
        return False
    try:
        _deleted_at(name)
    except ValueError:
        return False
    return True


def _deleted_at(entry_id: str) -> datetime:
    return datetime.strptime(entry_id.rpartition(".")[2], STAMP).replace(tzinfo=UTC)
