"""The shot that was worked on last is drawn when the service starts, so that who goes on with it finds it open."""

from __future__ import annotations

import logging
from contextlib import suppress

from starlette.concurrency import run_in_threadpool

from render.errors import PullfocusError
from service.http.errors import ServiceError
from service.http.frame_requests import frame_request
from service.http.service import Service
from service.models.frames import PictureQuery
from service.picture.calls import live
from service.stage.calls import shots
from service.storage.store import ShotRecord
from service.workers.calls import call
from service.workers.errors import WorkerError

log = logging.getLogger("pullfocus.service")


async def draw_last_shot(service: Service) -> None:
    """Have previews of the shot drawn that was added or edited last, unless somebody has pictures drawn by then.

    Failure costs its next viewer time alone. A shot that has ended a worker is left alone, as each start would count against it.
    """
    record = None
    try:
        record = await run_in_threadpool(_last_shot, service)
        if record is not None and not service.quarantine.is_blamed(record):
            await _draw(service, record)
    except (PullfocusError, ServiceError, WorkerError, OSError, ValueError) as error:
        log.info("shot %s was not drawn in advance: %s", record.id if record else "?", error)


async def _draw(service: Service, record: ShotRecord) -> None:
    """Have a coarse preview drawn where nobody draws, and then a whole one unless somebody waits by then."""
    shot = await service.call_stage(shots.describe_shot, record)
    picture = PictureQuery(time=shot.frame_range.start)
    edits = await run_in_threadpool(record.edit_text)
    request = frame_request(record, edits, picture, service.admission.check_preview(picture))
    lane = service.lanes.live
    if lane.running > 0 or lane.waiting > 0:
        return
    await lane.result(call(live.draw_ahead, request), service.place_of(record))
    if lane.waiting == 0:
        await lane.result(call(live.draw_ahead, request), service.place_of(record))


def _last_shot(service: Service) -> ShotRecord | None:
    return max(service.store.list(), key=_worked_on_s, default=None)


def _worked_on_s(record: ShotRecord) -> float:
    """Return when a shot was added or edited last, s since the epoch."""
    worked_on_s = record.created_at.timestamp()
    with suppress(OSError):  # no edits yet
        worked_on_s = max(worked_on_s, record.edits.stat().st_mtime)
    return worked_on_s
