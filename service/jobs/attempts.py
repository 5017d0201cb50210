"""Attempts at the frames of renders: how they begin and end, and when a frame is tried again.

A frame that *failed* could not be drawn: an error that may pass, such as a full disk, is tried again up to `MOST_FAILURES` times.
A frame that was *lost* says nothing about itself: its worker, its scheduler or its service is gone. It is drawn again up to
`MOST_LOSSES` times.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass

from sqlalchemy import select
from sqlalchemy.orm import Session

from service.jobs.events import noted, task_event
from service.jobs.frame_logs import append_log
from service.jobs.product_states import settle_products
from service.jobs.states import move, note_end
from service.models.renders import TaskState
from service.storage.database.tables import AttemptRow, RenderRow, TaskRow
from service.storage.events import EventLog
from service.workers.output import log_line

MOST_FAILURES = 3
"""Errors that may pass after which a task has failed."""
MOST_LOSSES = 10
"""Losses of workers after which a task has failed."""
BACK_OFF_S = 2.0
"""Pause before a task is tried again; twice as long each time."""
MOST_BACK_OFF_S = 60.0
MOST_LEASE_S = 600.0
"""Time that no lease is longer than: one that ends later was given before the clock was set back."""
MAX_ERROR = 4000
"""Length of an error's text."""


@dataclass(frozen=True)
class Attempts:
    """Begins and ends attempts, in transactions that write.

    Attributes:
        events: takes down what changes.
        clock: tells the time in a transaction, s since 1970.
        holder: of the leases, such as the service of a data folder.
    """

    events: EventLog
    clock: Callable[[Session], float]
    holder: str

    def begin(self, session: Session, render: RenderRow, task: TaskRow, worker: str, lease_s: float) -> None:
        """Give a worker the lease of a task."""
        now = self.clock(session)
        task.attempts += 1
        with noted(self.events, session, render):
            move(render, task, "running")
            render.started_at = render.started_at or now
        task.worker, task.holder, task.lease_until = worker, self.holder, now + lease_s
        self.events.add(session, task_event(render, task, worker=worker))
        session.add(AttemptRow(render=render.id, frame=task.frame, number=task.attempts, worker=worker, started_at=now))

    def end(
        self,
        session: Session,
        render: RenderRow,
        task: TaskRow,
        state: TaskState,
        outcome: str,
        error: str | None,
        log: str = "",
    ) -> None:
        """End an attempt; a task that is ready again is canceled where its render is. `log` is the end of its log."""
        now = self.clock(session)
        attempt = session.get_one(AttemptRow, (task.render, task.frame, task.attempts))
        attempt.ended_at, attempt.outcome, attempt.error = now, outcome, error and error[:MAX_ERROR]
        last = "" if error is None else log_line(f"{outcome}: {attempt.error}", now)
        if log or last:
            append_log(session, render, attempt, log + last)
        task.worker = task.holder = task.lease_until = None
        with noted(self.events, session, render):
            move(render, task, "canceled" if state == "ready" and render.wanted == "cancel" else state)
            settle_products(render)
            self.events.add(session, task_event(render, task, worker=attempt.worker, error=attempt.error))
        if state == "done":
            render.busy_s += max(0.0, now - attempt.started_at)
        note_end(render, now)

    def fail(self, session: Session, render: RenderRow, task: TaskRow, error: str, log: str, *, may_pass: bool) -> None:
        """End an attempt that could not draw its frame."""
        task.failures += 1
        has_failed = not may_pass or task.failures >= MOST_FAILURES
        self._try_again(session, render, task, "failed", error, log, task.failures, has_failed=has_failed)

    def lose(self, session: Session, render: RenderRow, task: TaskRow, error: str, log: str = "") -> None:
        """End an attempt whose worker is gone."""
        task.losses += 1
        has_failed = task.losses >= MOST_LOSSES
        self._try_again(session, render, task, "lost", error, log, task.losses, has_failed=has_failed)

    def end_lost(self, session: Session) -> None:
        """Take tasks back whose leases have run out, or end so late that the clock was set back."""
        now = self.clock(session)
        is_over = (TaskRow.lease_until < now) | (TaskRow.lease_until > now + MOST_LEASE_S)
        for task in session.scalars(select(TaskRow).where(TaskRow.state == "running", is_over)).all():
            self.lose(session, session.get_one(RenderRow, task.render), task, "the worker is gone")

    def take_back(
        self, session: Session, kept: Collection[tuple[str, int, int]], lease_s: float, *, is_shared: bool
    ) -> None:
        """Take back what this holder does not work on any more; it counts as no loss.

        Args:
            session: the transaction.
            kept: render, frame and attempt of what it works on.
            lease_s: of these from now on, as the database may have been away for longer than a lease.
            is_shared: whether others hold leases, too.
        """
        left = select(TaskRow).where(TaskRow.state == "running")
        for task in session.scalars(left.where(TaskRow.holder == self.holder) if is_shared else left).all():
            if (task.render, task.frame, task.attempts) in kept:
                task.lease_until = self.clock(session) + lease_s
                continue
            render = session.get_one(RenderRow, task.render)
            self.end(session, render, task, "ready", "given-back", "the service ended")

    def _try_again(
        self,
        session: Session,
        render: RenderRow,
        task: TaskRow,
        outcome: str,
        error: str,
        log: str,
        tries: int,
        *,
        has_failed: bool,
    ) -> None:
        self.end(session, render, task, "failed" if has_failed else "ready", outcome, error, log)
        task.not_before = self.clock(session) + back_off_of(tries)


def back_off_of(tries: int) -> float:
    """Return the pause after some failures or losses, s."""
    return min(BACK_OFF_S * 2.0 ** (tries - 1), MOST_BACK_OFF_S)
