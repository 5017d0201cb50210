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


def _product_event(render: RenderRow, name: str) -> NewEvent:
    """Return the event that a product of a render has another state."""
    entry = render.products[name]
    data = {"product": name, "state": entry["state"], "attempt": entry["attempts"], "error": entry["error"]}
    return NewEvent("renders", "product-changed", render.project, render.shot, render.id, data)


@contextmanager
def noted(events: EventLog, session: Session, render: RenderRow) -> Iterator[None]:
    """Add events at the end of those products of a render that have another state then, and of the render if it has."""
    before, products = state_of(render), _attempts_at(render)
    yield
    for name, attempt in _attempts_at(render).items():
        if products.get(name) != attempt:
            events.add(session, _product_event(render, name))
    if state_of(render) != before:
        events.add(session, render_event(render, "render-changed"))


def _attempts_at(render: RenderRow) -> dict[str, tuple[str, int]]:
    """Return the state of each product of a render, and the number of the last attempt at it."""
    return {name: (entry["state"], entry["attempts"]) for name, entry in render.products.items()}
