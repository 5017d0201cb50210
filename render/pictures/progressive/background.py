"""Work of the processor in a background thread, so that it can be cancelled like work of the device."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from typing import TypeVar

from render.gl.cancellation import CancellationPoint

_POLL_S = 0.01
Result = TypeVar("Result")


def run_in_background(work: Callable[[], Result], cancellation: CancellationPoint) -> Result:
    """Run work that needs neither the device nor the stage in a thread, and poll the cancellation point meanwhile.

    Args:
        work: has no effect but its result. Where it is cancelled it runs on to its end, and the result is dropped.
        cancellation: the point that is polled.

    Raises:
        Cancelled: the work is stale.
    """
    threads = ThreadPoolExecutor(1, "pullfocus-background")
    try:
        result = threads.submit(work)
        while not wait([result], _POLL_S).done:
            cancellation.poll()
        return result.result()
    finally:
        threads.shutdown(wait=False)
