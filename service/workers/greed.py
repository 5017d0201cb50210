"""Limits on a worker that neither the kernel nor the time of its calls sets.

A worker that a file has taken over runs whatever it likes. Its calls are timed, but it could keep a core busy while it has none;
start threads, which the filter of system calls has to allow; and fill memory that is mapped to be shared, which is no data of a
process.
"""

from __future__ import annotations

import os
from typing import Any

from service.workers.errors import End
from service.workers.process import WorkerProcess

IDLE_CPU_S = 60.0
"""Processor time that a worker may use after a call, until the next one. A cancelled picture is developed to its end, and simpler
levels of large meshes are made meanwhile; so the shot is not blamed."""
MAX_THREADS = 256 + 16 * (os.cpu_count() or 1)
"""Threads of a worker: USD, the driver, image libraries and numpy start up to one each for each core."""


def greed_of(process: WorkerProcess[Any], *, is_idle: bool) -> End | None:
    """Return why a worker has to be ended, or None.

    Args:
        process: the worker.
        is_idle: whether it runs no call.
    """
    if is_idle and process.cpu_s() - process.rested_cpu_s > IDLE_CPU_S:
        return "cpu"
    if process.threads() > MAX_THREADS:
        return "threads"
    return "memory" if process.shared_bytes() > process.role.limits.memory_bytes else None
