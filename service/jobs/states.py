"""States of renders and of their tasks."""

from __future__ import annotations

from sqlalchemy import ColumnElement
from sqlalchemy.orm import Session

from render.errors import NotFoundError
from service.jobs.errors import ConflictError
from service.models.renders import RenderState, TaskState
from service.storage.database.tables import RenderRow, TaskRow


def state_of(render: RenderRow) -> RenderState:
    """Return the state of a render, which follows from what is wanted and from the states of its tasks and products."""
    if render.unended == 0:
        if render.accepted or render.failed + render.canceled + render.products_lacking == 0:
            return "done"
        return "canceled" if render.canceled > 0 or render.wanted == "cancel" else "failed"
    if render.wanted == "cancel":
        return "cancel-requested"
    if render.wanted == "pause":
        return "pause-requested" if render.running + render.products_running > 0 else "paused"
    return "queued" if render.started_at is None else "running"


def is_done(render: type[RenderRow]) -> ColumnElement[bool]:
    """Return the condition that a render is done, as `state_of` says it.

    Args:
        render: the table, or an alias of it.
    """
    is_whole = render.failed + render.canceled + render.products_lacking == 0
    return (render.unended == 0) & (is_whole | render.accepted)


def find_render(session: Session, render_id: str) -> RenderRow:
    """Return a render. Raises `NotFoundError`."""
    render = session.get(RenderRow, render_id)
    if render is None:
        raise not_found(render_id)
    return render


def find_unended(session: Session, render_id: str) -> RenderRow:
    """Return a render that has not ended. Raises `NotFoundError`, `ConflictError`: it has."""
    render = find_render(session, render_id)
    if render.unended == 0:
        raise ConflictError(f"render {render_id!r} has ended: it is {state_of(render)}")
    return render


def note_end(render: RenderRow, now: float) -> None:
    """Note when a render has ended, or that it has not."""
    render.finished_at = now if render.unended == 0 else None


def not_found(render_id: str) -> NotFoundError:
    """Return the error that a render is not there, as far as the sender may know."""
    return NotFoundError(f"There is no render {render_id!r}.", code="render_not_found", path="render")


def move(render: RenderRow, task: TaskRow, state: TaskState) -> None:
    """Put a task into another state, and count it there."""
    setattr(render, task.state, getattr(render, task.state) - 1)
    setattr(render, state, getattr(render, state) + 1)
    task.state = state
