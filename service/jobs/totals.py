"""Totals over all renders."""

from __future__ import annotations

from collections.abc import Collection

from sqlalchemy import BigInteger, Engine, cast, func, select

from service.models.renders import TaskState
from service.storage.database.connection import transaction
from service.storage.database.tables import FactRow, RenderRow


class RenderTotals:
    """Totals over the renders of a database. Any thread may use it; every method raises `OutputError` where it cannot be used.

    Args:
        engine: of the database.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def stored_bytes(self, project: str) -> int:
        """Return the size of what the renders of a project have stored, with their products, bytes."""
        stored = func.sum(RenderRow.stored_bytes + RenderRow.product_bytes)
        total = cast(func.coalesce(stored, 0), BigInteger)
        with transaction(self._engine, only_reads=True) as session:
            return session.scalar(select(total).where(RenderRow.project == project)) or 0

    def numbers(self) -> dict[TaskState, int]:
        """Return the number of tasks in each state."""
        states: tuple[TaskState, ...] = ("ready", "running", "done", "failed", "canceled")
        sums = select(*(func.coalesce(func.sum(getattr(RenderRow, state)), 0) for state in states))
        with transaction(self._engine, only_reads=True) as session:
            return dict(zip(states, session.execute(sums).one(), strict=True))

    def database_id(self) -> str:
        """Return the id of the database."""
        with transaction(self._engine, only_reads=True) as session:
            return session.get_one(FactRow, "id").value

    def those_there(self, render_ids: Collection[str]) -> set[str]:
        """Return those of some ids that are renders."""
        with transaction(self._engine, only_reads=True) as session:
            return set(session.scalars(select(RenderRow.id).where(RenderRow.id.in_(render_ids))))

    def shots_in_bucket(self) -> set[str]:
        """Return the hashes of the shots that renders need."""
        hashes = select(RenderRow.files).where(RenderRow.files.is_not(None)).distinct()
        with transaction(self._engine, only_reads=True) as session:
            return {each for each in session.scalars(hashes) if each is not None}
