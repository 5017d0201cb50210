"""Upkeep of the workers' caches: what they begin with is made once, and workers that fill the disk are ended."""

from __future__ import annotations

import asyncio
import logging
import os
import threading
from dataclasses import replace
from pathlib import Path

from starlette.concurrency import run_in_threadpool

from render.errors import PullfocusError
from service.http.service import Service
from service.picture.calls import warming
from service.workers.calls import call
from service.workers.errors import WorkerError
from service.workers.places import NOWHERE
from service.workers.process import NotBegunError, WorkerProcess

log = logging.getLogger("pullfocus.service")

FILL_S = 300.0
"""Time that the drawing of the demo shot may take."""
RETRY_S = 600.0
"""Time until it is tried again."""
PASSES = 2
"""Times that it is drawn: a driver compiles some shaders in another way where it finds others compiled."""
LOOK_PAUSE_S = 5.0
"""Time between two looks at how much of the disk the workers have filled."""
NICENESS = 15
"""Priority of the worker that draws it: users come first."""


async def fill_caches(service: Service) -> None:
    """Have the demo shot drawn where no cache holds its compiled shaders yet. Failure costs the users time alone."""
    has_failed = False
    while True:
        try:
            await run_in_threadpool(service.caches.fill_base, lambda folder: _fill(service, folder))
            return
        except (PullfocusError, WorkerError, NotBegunError, OSError) as error:
            if not has_failed:
                log.warning(
                    "shaders cannot be compiled in advance, so that the first picture of each shot will be late: %s",
                    error,
                )
            has_failed = True
        await asyncio.sleep(RETRY_S)


async def end_full_workers(service: Service) -> None:
    """End the workers that fill the disk, now and then."""
    while True:
        await asyncio.sleep(LOOK_PAUSE_S)
        await run_in_threadpool(service.pool.end_full)


def _fill(service: Service, folder: Path) -> None:
    for _ in range(PASSES):
        _draw_demo(service, folder)


def _draw_demo(service: Service, folder: Path) -> None:
    role = replace(service.lanes.live.role, name="warming", niceness=NICENESS)
    process = WorkerProcess(service.pool.template, role, NOWHERE, cache=folder)
    limit = threading.Timer(FILL_S, process.kill, ["timeout"])
    limit.start()
    try:
        process.call(call(warming.draw_demo), FILL_S * (os.cpu_count() or 1))
    finally:
        limit.cancel()
        process.close()
