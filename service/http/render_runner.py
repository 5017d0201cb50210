"""Draws the frames of renders, one after the other, where nothing else is wanted."""

from __future__ import annotations

import asyncio
import logging
import os
import secrets
import socket
from contextlib import suppress

from starlette.concurrency import run_in_threadpool

from render.errors import GraphicsError, OutputError, PullfocusError
from service.http.errors import ServiceError
from service.http.frame_requests import frame_request
from service.http.service import Service
from service.models.frames import FrameQuery
from service.picture.calls import frames as frame_calls
from service.renders.queue import Claim
from service.storage.store import ShotRecord
from service.workers.calls import call
from service.workers.errors import QueueFullError, StoppingError, UnfitError, WorkerError
from service.workers.jobs import Client

log = logging.getLogger("pullfocus.service")

LEASE_S = 60.0
"""Time after which a worker is taken for gone. It tells three times within it that it is there."""
PAUSE_S = 1.0
"""Longest time between two looks for frames."""
BUSY_PAUSE_S = 15.0
"""Time for which a frame waits that the service has no room for, or whose owner has used up the processor time of a day."""


async def run_renders(service: Service) -> None:
    """Draw the frames of renders until the service stops."""
    worker = f"{socket.gethostname()}-{os.getpid()}-{secrets.token_hex(2)}"
    while True:
        try:
            claim = await run_in_threadpool(service.renders.claim, worker, LEASE_S)
        except Exception:
            log.exception("the queue of renders cannot be read")
            claim = None
        if claim is None:
            with suppress(TimeoutError):
                await asyncio.wait_for(service.renders_sent.wait(), PAUSE_S)
            service.renders_sent.clear()
        else:
            await _work_on(service, claim)


async def _work_on(service: Service, claim: Claim) -> None:
    """Draw a frame and note what became of it."""
    queue = service.renders
    drawing = asyncio.create_task(_draw(service, claim))
    holding = asyncio.create_task(_hold(service, claim, drawing))
    try:
        await drawing
    except asyncio.CancelledError:
        # Here, as nothing that is awaited may be finished before the service is.
        queue.give_back(claim, "the render was canceled, or the service stops")
        if _is_cancelling():
            raise
    except (QueueFullError, StoppingError, ServiceError) as error:
        await run_in_threadpool(queue.give_back, claim, str(error), BUSY_PAUSE_S)
    except (PullfocusError, WorkerError, OSError) as error:
        log.warning("frame %d of render %s could not be drawn: %s", claim.frame, claim.render, error)
        await run_in_threadpool(queue.fail, claim, str(error), may_pass=_may_pass(error))
    except Exception as error:
        log.exception("frame %d of render %s could not be drawn", claim.frame, claim.render)
        await run_in_threadpool(queue.fail, claim, repr(error), may_pass=False)
    finally:
        holding.cancel()


def _is_cancelling() -> bool:
    """Return whether the present task is being cancelled, and not one that it waits for."""
    task = asyncio.current_task()
    return task is not None and task.cancelling() > 0


async def _hold(service: Service, claim: Claim, drawing: asyncio.Task[None]) -> None:
    """Extend the lease of a frame while it is drawn; stop that once nobody wants it."""
    while True:
        await asyncio.sleep(LEASE_S / 3)
        try:
            is_wanted = await run_in_threadpool(service.renders.extend, claim, LEASE_S)
        except Exception:
            log.exception("the lease of frame %d of render %s cannot be extended", claim.frame, claim.render)
            continue
        if not is_wanted:
            drawing.cancel()


async def _draw(service: Service, claim: Claim) -> None:
    """Draw a frame and store it."""
    record = _shot_of(service, claim)
    query = FrameQuery.model_validate(claim.request | {"time": claim.frame})
    cost, limits = service.admission.check(record.id, query)
    client = Client(claim.owner, claim.render)
    service.quotas.check_work(client)
    content = await service.lanes.long.result(
        call(frame_calls.render_frame, frame_request(record, claim.edits, query, limits), query.format, False),
        service.place_of(record),
        client,
        estimate_s=cost.ordinary_s,
    )
    stored = await run_in_threadpool(service.render_files.write, claim.render, claim.frame, query.format, content)
    await run_in_threadpool(service.renders.finish, claim, stored.size_bytes, stored.sha256)


def _shot_of(service: Service, claim: Claim) -> ShotRecord:
    """Return the shot of a render. Raises `NotFoundError`: it was deleted, or another one has its id now."""
    record = service.store.get(claim.shot)
    if record.created_at.isoformat() != claim.shot_created_at:
        raise PullfocusError(f"shot {claim.shot!r} is another one than when the render was sent", code="shot_replaced")
    return record


def _may_pass(error: Exception) -> bool:
    """Return whether another try may succeed."""
    if isinstance(error, PullfocusError):
        return isinstance(error, GraphicsError | OutputError)
    return not isinstance(error, UnfitError)
