"""Rows of tasks that are not begun, added many at a time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sqlalchemy import ColumnElement, bindparam, insert, literal_column
from sqlalchemy.orm import Session

from service.storage.database.tables import Table, TaskRow

_NUMBERS = ("attempts", "failures", "losses", "not_before")
_VALUES: dict[str, ColumnElement[Any]] = {
    "render": bindparam("render"),
    "frame": bindparam("frame"),
    "state": literal_column("'ready'"),
    "files": literal_column("'{}'"),
    **{name: literal_column("0") for name in _NUMBERS},
}
_INSERT = insert(Table.metadata.tables[TaskRow.__tablename__]).values(_VALUES)
"""Statement with two parameters a row: those of all columns, as of objects, take several times as long to prepare."""


def add_tasks(session: Session, render_id: str, frames: Sequence[int]) -> None:
    """Add the tasks of a render.

    Args:
        session: a transaction that writes.
        render_id: the render, which is there.
        frames: of the render, each once.
    """
    if frames:
        session.connection().execute(_INSERT, [{"render": render_id, "frame": frame} for frame in frames])
