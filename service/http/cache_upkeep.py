"""Upkeep of the workers: the caches that they begin with are made once, and those that use too much are ended."""

from __future__ import annotations

import asyncio
import logging

from starlette.concurrency import run_in_threadpool

from render.errors import PullfocusError
from service.http.service import Service
from service.picture.cache_filling import fill_cache
from service.workers.errors import WorkerError
from service.workers.process import NotBegunError

log = logging.getLogger("pullfocus.service")

RETRY_S = 600.0
"""Time until it is tried again."""
LOOK_PAUSE_S = 5.0
"""Time between two looks at what the workers use."""


async def fill_caches(service: Service, *, tells: bool = True) -> bool:
    """Have the demo shot drawn where no cache holds its compiled shaders yet. Failure costs the users time alone.

    Args:
        service: whose caches they are.
        tells: whether a failure is logged.

    Returns:
        Whether there is a cache that holds them.
    """
    role = service.lanes.live.role
    try:
        await run_in_threadpool(
            service.caches.fill_base, lambda folder: fill_cache(service.pool.template, role, folder)
        )
        return True
    except (PullfocusError, WorkerError, NotBegunError, OSError) as error:
        if tells:
            log.warning("shaders cannot be compiled in advance, so that the first picture of a shot is late: %s", error)
        return False


async def retry_filling(service: Service) -> None:
    """Try now and then to fill the caches, until it is done."""
    is_filled = False
    while not is_filled:
        await asyncio.sleep(RETRY_S)
        is_filled = await fill_caches(service, tells=False)


async def end_greedy_workers(service: Service) -> None:
    """End the workers that fill the disk, or use what their limits do not count, now and then."""
    while True:
        await asyncio.sleep(LOOK_PAUSE_S)
        await run_in_threadpool(service.pool.end_full)
        await run_in_threadpool(service.pool.end_greedy)
