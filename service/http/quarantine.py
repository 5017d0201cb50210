"""Quarantine: a shot that ended too many worker processes is not opened again until somebody releases it."""

from __future__ import annotations

import logging
import threading
import time

from render.errors import NotFoundError, OutputError
from service.http.errors import ServiceError
from service.storage.blames import Blames, read_blames, write_blames
from service.storage.store import ShotRecord, ShotStore
from service.workers.errors import End

log = logging.getLogger("pullfocus.service")

REASONS = {
    "memory": "it takes more memory than a worker may have",
    "crash": "it is damaged in a way that ends the process which reads it",
    "cpu": "it takes more processor time than a worker may have",
    "timeout": "it takes longer than a worker may",
    "disk": "it fills more of the disk than a worker may",
    "threads": "it starts more threads than a worker may",
    "unsafe": "its worker sent what no worker sends",
}


FORGET_S = 86_400.0
"""Time after which a shot that has ended few workers has a clean sheet again: one bad request a month is no reason."""


class Quarantine:
    """The shots of a store that may not be opened. Any thread may use it.

    Args:
        store: the shots.
        max_blames: times that a shot may end a worker.
    """

    def __init__(self, store: ShotStore, max_blames: int) -> None:
        self._store = store
        self._max_blames = max_blames
        self._lock = threading.Lock()

    def reason(self, record: ShotRecord) -> str | None:
        """Return why a shot is in quarantine, or None."""
        blames = read_blames(record.folder)
        return REASONS.get(blames.reason, "unknown") if blames.count >= self._max_blames else None

    def is_blamed(self, record: ShotRecord) -> bool:
        """Whether a shot has ended a worker, be it too few for the quarantine."""
        return read_blames(record.folder).count > 0

    def check(self, record: ShotRecord) -> None:
        """Raise `ServiceError` 423 where a shot is in quarantine."""
        reason = self.reason(record)
        if reason is not None:
            detail = f"Shot {record.id!r} is in quarantine: {reason}. Delete it, or release it to try again."
            raise ServiceError(423, "quarantined", detail, path=record.id)

    def blame(self, shot_id: str, end: End) -> None:
        """Note that a shot has ended a worker. Where the note cannot be written, it is logged alone."""
        with self._lock:
            try:
                record = self._store.get(shot_id)
                before, now_s = read_blames(record.folder), time.time()
                is_old = before.count < self._max_blames and abs(now_s - before.last_s) > FORGET_S
                count = 1 if is_old else before.count + 1
                log.error("shot %s has ended a worker (%s), time %d of %d", shot_id, end, count, self._max_blames)
                write_blames(record.folder, Blames(count, end, now_s))
            except NotFoundError:  # an upload that was not accepted, or a shot that was removed
                return
            except OutputError as error:
                log.error("it cannot be noted that shot %s has ended a worker (%s): %s", shot_id, end, error)

    def release(self, record: ShotRecord) -> None:
        """Let a shot be opened again. Raises `OSError`: the note cannot be removed."""
        with self._lock:
            write_blames(record.folder, Blames())
