"""Work in the background that is begun piece by piece, for as long as a service runs."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable, Collection
from contextlib import suppress
from typing import TypeVar

from starlette.concurrency import run_in_threadpool

Claimed = TypeVar("Claimed")


async def keep_busy(
    begin_one: Callable[[], Awaitable[bool]],
    wait: Callable[[], Awaitable[None]],
    on_failure: Callable[[], None],
    tasks: Collection[asyncio.Task[None]],
    *,
    log: logging.Logger,
    complaint: str,
) -> None:
    """Begin pieces of work until this is cancelled; then cancel those under way and wait for their ends.

    A failure, as of a disk that is full, is logged where the try before had none, and the work goes on after a wait.

    Args:
        begin_one: begins the next piece; returns whether there was one.
        wait: waits until there may be more.
        on_failure: called when `begin_one` has failed, which may still have claimed something.
        tasks: those under way, as they are by then.
        log: gets the failures.
        complaint: what it says of them.
    """
    has_failed = False
    try:
        while True:
            try:
                is_busy = await begin_one()
                has_failed = False
            except Exception:
                if not has_failed:
                    log.exception(complaint)
                has_failed, is_busy = True, False
                on_failure()
            if not is_busy:
                await wait()
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def claim_work(
    claim: Callable[[], Claimed | None], give_back: Callable[[Claimed], object], log: logging.Logger
) -> Claimed | None:
    """Claim a piece of work in a thread. One that comes when this is cancelled is given back.

    Args:
        claim: claims it in the database; returns None where there is none.
        give_back: lets another service claim it.
        log: gets a failure to give it back, after which its lease runs out.
    """
    claiming = asyncio.ensure_future(run_in_threadpool(claim))
    try:
        return await asyncio.shield(claiming)
    except asyncio.CancelledError:
        try:
            claimed = await claiming
            if claimed is not None:
                give_back(claimed)
        except Exception:
            log.exception("work that was claimed while the service stopped cannot be given back")
        raise


async def wait_for(wake: asyncio.Event, most_s: float) -> None:
    """Wait until an event is set, which is then cleared, or for some time."""
    with suppress(TimeoutError):
        async with asyncio.timeout(most_s):  # `asyncio.wait_for` of Python 3.11 may swallow a cancellation
            await wake.wait()
    wake.clear()
