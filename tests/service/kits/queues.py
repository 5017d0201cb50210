"""Queues of renders, and the clock that their tests set."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from sqlalchemy.orm import Session

from service.jobs.claims import NewRender
from service.jobs.queue import RenderQueue
from service.storage.database.connection import open_database, time_of
from service.storage.database.tables import FileEntry
from service.storage.events import EventLog

LEASE_S = 60.0
FILES: dict[str, FileEntry] = {"exr": {"size_bytes": 7, "sha256": "hash"}, "png": {"size_bytes": 3, "sha256": "other"}}


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


def render(frames=(1, 2, 3), priority=50, key=None, name="dailies", digest="digest") -> NewRender:
    return replace(
        new_render(frames), name=name, idempotency_key=key, digest=digest, priority=priority, request={"rays": 4}
    )


def drawn(queue: RenderQueue, worker="one") -> tuple[str, int] | None:
    """Claim and finish the next frame."""
    claim = queue.claim(worker, LEASE_S)
    if claim is None:
        return None
    assert queue.finish(claim, FILES, 24)
    return claim.render, claim.frame


def states(queue: RenderQueue, render_id: str) -> list[str]:
    return [task.state for task, _ in queue.tasks(render_id)]


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
