"""Queues of renders, and the clock that their tests set."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from sqlalchemy.orm import Session

from service.jobs.claims import NewRender
from service.jobs.queue import RenderQueue
from service.storage.database.connection import open_database, time_of
from service.storage.events import EventLog


def new_render(frames: Sequence[int]) -> NewRender:
    """A render of a shot that no test draws."""
    return NewRender(
        name="dailies",
        project="default",
        owner="key:a",
        owner_label="Mara",
        idempotency_key=None,
        digest="digest",
        shot="demo",
        shot_created_at="2026",
        files=None,
        root="shot.usda",
        edits="#usda 1.0",
        revision="rev",
        request={},
        frames=frames,
        priority=50,
    )


class Clock:
    """A clock that a test sets."""

    def __init__(self) -> None:
        self.now = 1000.0

    def __call__(self, _session: Session) -> float:
        return self.now


def opened(
    folder: Path,
    database: str = "",
    clock: Callable[[Session], float] = time_of,
    holder: str = "",
    *,
    has_bucket: bool = False,
) -> RenderQueue:
    """A queue over the database of a folder, or of an address."""
    engine = open_database(folder, database)
    return RenderQueue(engine, EventLog(engine, clock), clock, holder, has_bucket=has_bucket)
