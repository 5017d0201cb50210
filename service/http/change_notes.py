"""Notes of what changes in shots, for those who follow events."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import suppress

from starlette.concurrency import run_in_threadpool
from starlette.requests import HTTPConnection

from render.errors import NotFoundError, OutputError, StageError
from render.model.edit_history import revision_of
from service.http.service import Service, ServiceDep
from service.models.events import Kind
from service.storage.events import NewEvent
from service.storage.store import ShotRecord


async def note_shot(service: Service, record: ShotRecord, kind: Kind) -> None:
    """Note what has happened to a shot."""
    event = NewEvent("shots", kind, record.project, record.id, data={"name": record.name})
    await run_in_threadpool(service.events.note, event)


async def note_edits(connection: HTTPConnection, service: ServiceDep) -> AsyncIterator[None]:
    """Note that a request has changed the edits of its shot, before it is answered (a dependency of routes that edit)."""
    shot = connection.path_params.get("shot")
    before = await run_in_threadpool(_revision, service, shot)
    yield
    after = await run_in_threadpool(_revision, service, shot)
    if before and after and before != after:
        record, revision = after
        event = NewEvent("edits", "edits-changed", record.project, record.id, data={"revision": revision})
        await run_in_threadpool(service.events.note, event)


def _revision(service: Service, shot: str | None) -> tuple[ShotRecord, str] | None:
    """Return a shot with the revision of its edits; None where there is none, or its edits cannot be read."""
    if shot is None:
        return None
    try:
        record = service.store.get(shot)
        return record, revision_of(record.edit_text())
    except (NotFoundError, StageError, OSError):
        return None


async def note_presence(service: Service) -> None:
    """Note who looks at shots, whenever that changes, one event after another: the last one tells who is there."""
    with suppress(OutputError, OSError):  # as of a full disk
        await _note_empty_shots(service)
    while True:
        await _note_viewers(service, await service.presence.next_change())


async def _note_viewers(service: Service, shot: str) -> None:
    """Note who looks at a shot now; a shot that is gone needs none."""
    try:
        record = service.store.get(shot)
    except NotFoundError:
        return
    data = {"viewers": service.presence.names(shot)}
    event = NewEvent("presence", "presence-changed", record.project, shot, data=data)
    await run_in_threadpool(service.events.note, event)


async def _note_empty_shots(service: Service) -> None:
    """Note that nobody looks at the shots any more that somebody looked at when an earlier service ended."""
    for row in await run_in_threadpool(service.events.last_of_each_shot, "presence"):
        if row.shot is not None and row.data["viewers"] and not service.presence.names(row.shot):
            await _note_viewers(service, row.shot)
