"""Work of the processor done aside, so that whoever waits for something newer need not wait for it."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from typing import TypeVar

from render.gl.cancellation import CancellationPoint

_LOOK_S = 0.01
Made = TypeVar("Made")


def aside(work: Callable[[], Made], cancellation: CancellationPoint) -> Made:
    """Do work that needs neither the device nor the stage in a thread, and let the cancellation beat meanwhile.

    Args:
        work: has no effect but its result, which is dropped where it is left: it then ends by itself, unheard.
        cancellation: that is watched.

    Returns:
        What it made.

    Raises:
        Cancelled: nobody waits for it any more.
    """
    threads = ThreadPoolExecutor(1, "pullfocus-aside")
    try:
        made = threads.submit(work)
        while not wait([made], _LOOK_S).done:
            cancellation.poll()
        return made.result()
    finally:
        threads.shutdown(wait=False)
