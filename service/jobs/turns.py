"""Turns of tasks: which one a worker claims next."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from itertools import count

from sqlalchemy import ColumnElement, select
from sqlalchemy.orm import InstrumentedAttribute, Session, aliased

from service.jobs.states import is_done
from service.storage.database.tables import AttemptRow, RenderNeedRow, RenderRow, TaskRow

MOST_FAILED_EACH = 3
"""Frames of a render that one worker may fail before the others draw the rest."""
MOST_PAUSE_S = 300.0
"""Time that no pause of a task or render is longer than."""
LOOKS = 16
"""Renders that are looked at together for a task or product."""

_BY_TURN = (RenderRow.priority.desc(), RenderRow.created_at, RenderRow.id)


def next_task(
    session: Session, now: float, worker: str, present: Collection[str], home: str | None = None, *, has_bucket: bool
) -> TaskRow | None:
    """Return the task whose turn it is; None where all wait or there is none.

    Args:
        session: a transaction that writes.
        now: the present time, s since 1970.
        worker: who claims it.
        present: all workers that there are; see `service.jobs.queue.RenderQueue.claim`.
        home: id of the data folder: renders whose shots are in another one, and not in a bucket, are left out. None for none.
        has_bucket: whether renders whose shots are in a bucket can be drawn.
    """
    for render_id in by_turn(session, (RenderRow.ready > 0) & may_begin(now, home, has_bucket=has_bucket)):
        left = _left_to_others(session, render_id, worker, present)
        if left is None:
            continue
        ready = select(TaskRow).where(
            TaskRow.render == render_id, TaskRow.state == "ready", _has_come(TaskRow.not_before, now)
        )
        task = session.scalar(ready.where(TaskRow.frame.not_in(left)).order_by(TaskRow.frame).limit(1))
        if task is not None:  # else all of its frames pause
            return task
    return None


def may_begin(now: float, home: str | None, *, has_bucket: bool) -> ColumnElement[bool]:
    """Return the condition that something of a render may be begun, as far as it has something; see `next_task`."""
    needed = aliased(RenderRow)
    unmet = select(RenderNeedRow).join(needed, needed.id == RenderNeedRow.needs).where(~is_done(needed))
    is_met = ~unmet.where(RenderNeedRow.render == RenderRow.id).exists()
    may = (RenderRow.wanted == "run") & _has_come(RenderRow.not_before, now) & is_met
    if home is not None:
        may &= RenderRow.home.is_(None) | (RenderRow.home == home) | RenderRow.files.is_not(None)
    return may if has_bucket else may & RenderRow.files.is_(None)


def by_turn(session: Session, is_meant: ColumnElement[bool]) -> Iterator[str]:
    """Yield the renders of a condition in turn. They are read some at a time: mostly the first one has what is looked for."""
    meant = select(RenderRow.id).where(is_meant).order_by(*_BY_TURN)
    for first in count(0, LOOKS):
        found = session.scalars(meant.offset(first).limit(LOOKS)).all()
        yield from found
        if len(found) < LOOKS:
            return


def _has_come(time: InstrumentedAttribute[float], now: float) -> ColumnElement[bool]:
    """Return whether a pause is over; one that ends much later was begun before the clock was set back."""
    return (time <= now) | (time > now + MOST_PAUSE_S)


def _left_to_others(session: Session, render_id: str, worker: str, present: Collection[str]) -> Collection[int] | None:
    """Return the frames of a render that a worker leaves to others; None for all of them."""
    others = set(present) - {worker}
    if not others:
        return ()
    of_them = (AttemptRow.render == render_id) & AttemptRow.worker.in_([worker, *others])
    query = select(AttemptRow.worker, AttemptRow.frame).where(of_them, AttemptRow.outcome == "failed")
    failed: dict[str, set[int]] = {}
    for name, frame in session.execute(query):
        failed.setdefault(name, set()).add(frame)
    own = failed.get(worker, set())
    able = {name for name in others if len(failed.get(name, ())) < MOST_FAILED_EACH}
    if len(own) >= MOST_FAILED_EACH and able:
        return None
    return {frame for frame in own if any(frame not in failed.get(name, ()) for name in able)}
