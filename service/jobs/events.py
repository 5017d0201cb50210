"""Events of renders and of their tasks."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy.orm import Session

from service.jobs.states import state_of
from service.storage.database.tables import RenderRow, TaskRow
from service.storage.events import EventLog, NewEvent

_COUNTS = ("count", "ready", "running", "done", "failed", "canceled")


def render_event(render: RenderRow, kind: str) -> NewEvent:
    """Return the event that something has happened to a render."""
    data = {"name": render.name, "state": state_of(render), **{name: getattr(render, name) for name in _COUNTS}}
    return NewEvent("renders", kind, render.project, render.shot, render.id, data)


def task_event(render: RenderRow, task: TaskRow, *, worker: str, error: str | None = None) -> NewEvent:
    """Return the event that a task has another state.

    Args:
        render: its render.
        task: the task.
        worker: who works on it, or did.
        error: what went wrong.
    """
    data = {"frame": task.frame, "state": task.state, "attempt": task.attempts, "worker": worker, "error": error}
    counts = {name: getattr(render, name) for name in _COUNTS}
    return NewEvent("tasks", "task-changed", render.project, render.shot, render.id, data | counts)


@contextmanager
def noted(events: EventLog, session: Session, render: RenderRow) -> Iterator[None]:
    """Add an event at the end, if the state of a render is another one then."""
    before = state_of(render)
    yield
    if state_of(render) != before:
        events.add(session, render_event(render, "render-changed"))
