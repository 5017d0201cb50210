"""Upkeep of the bucket of renders, and of what was fetched from it."""

from __future__ import annotations

import asyncio
import logging

from starlette.concurrency import run_in_threadpool

from render.errors import OutputError
from service.http.service import Service
from service.jobs.queue import RenderQueue
from service.jobs.shared_storage import SharedStorage

log = logging.getLogger("pullfocus.service")

PAUSE_S = 3600.0
"""Time between two looks."""
COPIES_S = 24 * 3600.0
"""Time for which copies of frames, and products of them, stay in the data folder."""


async def tidy_bucket(service: Service) -> None:
    """Remove shots from the bucket that no render needs, and copies of frames that are old, now and then."""
    if service.shared is None:
        return
    while True:
        try:
            await run_in_threadpool(_tidy, service.shared, service.renders)
        except (OutputError, OSError) as error:
            log.error("the bucket of renders cannot be tidied up now: %s", error)
        await asyncio.sleep(PAUSE_S)


def _tidy(shared: SharedStorage, renders: RenderQueue) -> None:
    shared.frames.forget_copies(COPIES_S)
    stored = shared.frames.render_ids()
    for render_id in stored - renders.totals.those_there(stored):  # of a service that was killed, or stored too late
        shared.frames.remove(render_id)
    shared.shots.forget(renders.totals.shots_in_bucket())
