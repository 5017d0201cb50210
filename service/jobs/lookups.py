"""Lookups about renders that answers to their owners need."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence

from sqlalchemy import Engine, select
from sqlalchemy.orm import Session

from render.errors import NotFoundError
from service.jobs.errors import ConflictError
from service.jobs.states import find_render, is_done
from service.storage.database.connection import transaction
from service.storage.database.tables import AttemptRow, RenderNeedRow, RenderRow, TaskRow


class RenderLookups:
    """Lookups in a database of renders. Any thread may use it; every method raises `OutputError` where it cannot be used.

    Args:
        engine: of the database.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def edits(self, render_id: str) -> str:
        """Return the text of the edit layer that a render keeps. Raises `NotFoundError`."""
        with transaction(self._engine, only_reads=True) as session:
            return find_render(session, render_id).edits

    def unmet_needs(self, render_ids: Collection[str]) -> Mapping[str, Sequence[str]]:
        """Return which renders some wait for that are not done yet; those that wait for none are left out."""
        unmet = select(RenderNeedRow).join(RenderRow, RenderRow.id == RenderNeedRow.needs).where(~is_done(RenderRow))
        found: defaultdict[str, set[str]] = defaultdict(set)
        with transaction(self._engine, only_reads=True) as session:
            for row in session.scalars(unmet.where(RenderNeedRow.render.in_(render_ids))):
                found[row.render].add(row.needs)
        return {render: sorted(needs) for render, needs in found.items()}

    def last_task(self, render_id: str) -> TaskRow:
        """Return the task that was done last. Raises `NotFoundError`: there is no such render, or none of its frames is done."""
        is_its = (AttemptRow.render == TaskRow.render) & (AttemptRow.frame == TaskRow.frame)
        is_last = is_its & (AttemptRow.number == TaskRow.attempts)
        done = select(TaskRow).join(AttemptRow, is_last).where(TaskRow.render == render_id, TaskRow.state == "done")
        with transaction(self._engine, only_reads=True) as session:
            find_render(session, render_id)
            task = session.scalar(done.order_by(AttemptRow.ended_at.desc(), TaskRow.frame.desc()).limit(1))
            if task is None:
                detail = f"no frame of render {render_id!r} is done yet"
                raise NotFoundError(detail, code="frame_not_found", path="render")
            return task


def sent_before(session: Session, owner: str, idempotency_key: str, digest: str) -> RenderRow | None:
    """Return the render that an owner sent with a key before; None where there is none. Raises `ConflictError`: another one."""
    same = select(RenderRow).where(RenderRow.owner == owner, RenderRow.idempotency_key == idempotency_key)
    before = session.scalar(same)
    if before is not None and before.digest != digest:
        raise ConflictError(
            "this idempotency key was sent with another render before; send a new key with a new render",
            code="idempotency_key_reused",
        )
    return before
