"""A pool of workers for tests, which need neither USD nor GL."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from service.workers.forking import Template
from service.workers.lane import Lane
from service.workers.pool import WorkerPool
from service.workers.roles import role
from service.workers.sandbox import Limits
from tests.service.conftest import until
from tests.service.workers.fake_work import Tally

WAIT_S = 60
LIMITS = Limits(memory_bytes=1 << 30, cpu_s=None, file_bytes=1 << 20, descriptors=64, processes=64)


@contextmanager
def tally_pool(**options: Any) -> Iterator[WorkerPool]:
    """Run a pool whose workers count their calls."""
    pool = WorkerPool(Template("tests.service.workers.fake_work", {}), **{"max_bytes": 1 << 30} | options)
    try:
        yield pool
    finally:
        pool.close()


@contextmanager
def tally_lane(pool: WorkerPool, *, options: dict[str, Any] | None = None, **lane: Any) -> Iterator[Lane[Tally]]:
    """Run a lane; ``options`` are those of its role."""
    made = Lane(role("tally", Tally, LIMITS, **options or {}), pool, **{"max_waiting": 3, "timeout_s": WAIT_S} | lane)
    try:
        yield made
    finally:
        made.close()


def wait_until_idle(lane: Lane[Tally]) -> None:
    """Wait until no job of a lane waits or runs."""
    until(lambda: not lane.waiting and not lane.running)
