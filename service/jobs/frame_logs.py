"""Logs of the attempts at frames: as they grow, and as the database keeps them."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

from sqlalchemy import Engine, delete, func, select, update
from sqlalchemy.orm import Session

from render.errors import NotFoundError
from service.jobs.claims import Claim
from service.jobs.states import find_render
from service.storage.database.connection import transaction
from service.storage.database.tables import AttemptRow, LogRow, RenderRow, TaskRow
from service.workers.output import MOST_OUTPUT, log_line

MOST_LOG = MOST_OUTPUT + (32 << 10)
"""Size of the log of one attempt, bytes: the output of a process and what the service adds to it."""


KEPT_LOGS = 4
"""Logs of a frame that are kept, those of its last attempts: a frame may be tried again as often as one likes."""


class FrameLog:
    """Log of an attempt while it goes on. Any thread may use it."""

    def __init__(self) -> None:
        self._text = ""
        self._read: Callable[[], str] = str
        self._read_length = 0
        self._lock = threading.Lock()

    def add(self, text: str) -> None:
        """Add a line, after the output that there is so far."""
        with self._lock:
            self._pull()
            self._text += log_line(text, time.time())

    def follow(self, read: Callable[[], str]) -> None:
        """Follow the output of a process.

        Args:
            read: returns all whole lines that there are so far.
        """
        with self._lock:
            self._pull()
            self._read, self._read_length = read, 0

    def take(self) -> str:
        """Return what is new since the last call."""
        with self._lock:
            self._pull()
            text, self._text = self._text, ""
            return text

    def put_back(self, text: str) -> None:
        """Take text back that `take` has returned, as it could not be kept."""
        with self._lock:
            self._text = text + self._text

    def _pull(self) -> None:
        output = self._read()
        self._text += output[self._read_length :]
        self._read_length = max(self._read_length, len(output))


@dataclass(frozen=True)
class KeptLog:
    """Log of an attempt as it is kept.

    Attributes:
        attempt: number of the attempt.
        text: its lines.
        has_ended: whether the attempt has ended, so that no line follows.
    """

    attempt: int
    text: str
    has_ended: bool


class FrameLogs:
    """Logs in a database of renders. Any thread may use it; every method raises `OutputError` where it cannot be used.

    Args:
        engine: of the database.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def append(self, claim: Claim, text: str, after_bytes: int | None = None) -> None:
        """Append lines to the log of an attempt; they are lost where the attempt has ended or was removed.

        Args:
            claim: the attempt.
            text: of the lines.
            after_bytes: size of what was appended before. What is there already, by a commit whose answer was lost, is not
                appended again. None appends it as it is.
        """
        with transaction(self._engine) as session:
            attempt = session.get(AttemptRow, (claim.render, claim.frame, claim.attempt))
            if attempt is not None and attempt.outcome is None:
                log = session.get(LogRow, (claim.render, claim.frame, claim.attempt))
                there = 0 if log is None or after_bytes is None else max(0, log.size_bytes - after_bytes)
                rest = text.encode("utf-8", "replace")[there:].decode("utf-8", "ignore")
                append_log(session, session.get_one(RenderRow, claim.render), attempt, rest)

    def read(self, render_id: str, frame: int, attempt: int | None = None) -> KeptLog | None:
        """Return the log of an attempt; None where the frame was not begun yet.

        Args:
            render_id: the render.
            frame: number of the frame.
            attempt: number of the attempt; None for the last one.

        Raises:
            NotFoundError: there is no such render, frame or attempt.
        """
        with transaction(self._engine, only_reads=True) as session:
            render = find_render(session, render_id)
            task = session.get(TaskRow, (render_id, frame))
            if task is None:
                detail = f"render {render_id!r} has no frame {frame}, it has {render.frames[:200]}"
                raise NotFoundError(detail, code="frame_not_found", path="frame")
            wanted = select(AttemptRow).where(AttemptRow.render == render_id, AttemptRow.frame == frame)
            if attempt is not None:
                wanted = wanted.where(AttemptRow.number == attempt)
            found = session.scalar(wanted.order_by(AttemptRow.number.desc()).limit(1))
            if found is None and attempt is not None:
                detail = f"frame {frame} of render {render_id!r} has no attempt {attempt}"
                raise NotFoundError(detail, code="attempt_not_found", path="attempt")
            if found is None:
                return None
            log = session.get(LogRow, (render_id, frame, found.number))
            return KeptLog(found.number, "" if log is None else log.text, found.outcome is not None)


def append_log(session: Session, render: RenderRow, attempt: AttemptRow, text: str) -> None:
    """Append lines to the log of an attempt; what is more than `MOST_LOG` is left out.

    Args:
        session: a transaction that writes.
        render: the render.
        attempt: one of its attempts.
        text: of the lines.
    """
    key = attempt.render, attempt.frame, attempt.number
    log = session.get(LogRow, key)
    if log is None:
        log = LogRow(render=attempt.render, frame=attempt.frame, number=attempt.number, size_bytes=0, text="")
        session.add(log)
        session.flush()
        forget_logs(session, render, attempt.frame, 1, attempt.number - KEPT_LOGS)
    content = text.encode("utf-8", "replace")[: max(0, MOST_LOG - log.size_bytes)]
    is_its = (LogRow.render == key[0]) & (LogRow.frame == key[1]) & (LogRow.number == key[2])
    more = content.decode("utf-8", "ignore")
    session.execute(
        update(LogRow).where(is_its).values(text=LogRow.text + more, size_bytes=log.size_bytes + len(content))
    )
    render.stored_bytes += len(content)


def forget_logs(session: Session, render: RenderRow, frame: int, first: int, last: int | None = None) -> None:
    """Forget the logs of some attempts at a frame.

    Args:
        session: a transaction that writes.
        render: the render.
        frame: number of the frame.
        first: number of the first attempt.
        last: number of the last one; None for the first alone.
    """
    meant = (
        LogRow.render == render.id,
        LogRow.frame == frame,
        LogRow.number.between(first, first if last is None else last),
    )
    render.stored_bytes -= session.scalar(select(func.coalesce(func.sum(LogRow.size_bytes), 0)).where(*meant)) or 0
    session.execute(delete(LogRow).where(*meant))
