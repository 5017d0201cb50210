"""Upkeep of the workers: the caches that they begin with are made once, and those that use too much are ended."""

from __future__ import annotations

import asyncio
import logging
import os
import threading
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from starlette.concurrency import run_in_threadpool

from render.errors import PullfocusError
from service.http.service import Service
from service.picture.calls import state, warming
from service.workers.calls import Call, call
from service.workers.errors import WorkerError
from service.workers.folders import remove_tree
from service.workers.places import NOWHERE
from service.workers.process import NotBegunError, WorkerProcess

Reply = TypeVar("Reply")
log = logging.getLogger("pullfocus.service")

FILL_S = 300.0
"""Time that one drawing of the demo shot may take."""
RETRY_S = 600.0
"""Time until it is tried again."""
PASSES = 2
"""Times that it is drawn: a driver compiles some shaders in another way where it finds others compiled."""
LOOK_PAUSE_S = 5.0
"""Time between two looks at what the workers use."""
NICENESS = 15
"""Priority of the worker that draws it: users come first."""


async def fill_caches(service: Service, *, tells: bool = True) -> bool:
    """Have the demo shot drawn where no cache holds its compiled shaders yet. Failure costs the users time alone.

    Args:
        service: whose caches they are.
        tells: whether a failure is logged.

    Returns:
        Whether there is a cache that holds them.
    """
    try:
        await run_in_threadpool(service.caches.fill_base, lambda folder: _fill(service, folder))
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


def _fill(service: Service, folder: Path) -> None:
    """Have a cache folder filled by workers that see nothing else."""
    shot = folder / "shot"
    shot.mkdir(mode=0o700)
    root = shot / _run(service, folder, call(warming.write_shot, shot))
    for _ in range(PASSES):
        _run(service, folder, call(warming.draw, root))
    remove_tree(shot)


def _run(service: Service, folder: Path, work: Call[state.PictureWorkerState, Reply]) -> Reply:
    """Run a call in a worker of its own, which ends with it."""
    role = replace(service.lanes.live.role, name="warming", niceness=NICENESS)
    process = WorkerProcess(service.pool.template, role, NOWHERE, cache=folder)
    limit = threading.Timer(FILL_S, process.kill, ["timeout"])
    limit.start()
    try:
        return process.call(work, FILL_S * (os.cpu_count() or 1))
    finally:
        limit.cancel()
        process.close()
