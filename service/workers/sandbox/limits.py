"""Limits of a process on what it may use (``setrlimit``), which every kernel enforces."""

from __future__ import annotations

import math
import os
import resource
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Limits:
    """Largest amounts that one process may use.

    Attributes:
        memory_bytes: private memory, that of libraries and thread stacks included; an allocation beyond it fails (`MemoryError`
            in Python, ``std::bad_alloc`` in C++). The limit is on data, since drivers of GPUs reserve addresses by the
            terabyte; memory shared with a device or with another process is not counted.
        cpu_s: seconds of processor time from the start of the process on, all threads together, after which SIGXCPU ends it.
            None for a worker that serves many calls: see `allow_cpu`.
        file_bytes: size of any one file that it writes; a write beyond it fails (EFBIG).
        descriptors: open files.
        processes: processes and threads that the user may start besides those that run now. The kernel counts all programs of a
            user together and does not bind root, so this serves only where there is no filter of system calls, which forbids new
            processes altogether: see `limit_processes`.
    """

    memory_bytes: int
    cpu_s: int | None
    file_bytes: int
    descriptors: int
    processes: int


def set_limits(limits: Limits) -> None:
    """Limit this process for the rest of its life, but for processes. A limit that it has already stays where it is lower.

    Args:
        limits: the limits.
    """
    _lower(resource.RLIMIT_CORE, 0)
    _lower(resource.RLIMIT_DATA, limits.memory_bytes)
    _lower(resource.RLIMIT_FSIZE, limits.file_bytes)
    _lower(resource.RLIMIT_NOFILE, limits.descriptors)
    if limits.cpu_s is not None:
        _lower(resource.RLIMIT_CPU, limits.cpu_s, limits.cpu_s + 1)  # at the second the kernel sends SIGKILL


def limit_processes(more: int) -> None:
    """Limit the processes and threads of this process's user to those that run now and some more.

    Args:
        more: number of those that may start.
    """
    _lower(resource.RLIMIT_NPROC, _tasks_of_user() + more)


def allow_cpu(seconds: float) -> None:
    """Let this process use so many more seconds of processor time from now on; then SIGXCPU ends it.

    Args:
        seconds: all threads together; the kernel counts whole seconds, so up to one more is allowed.
    """
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    until = math.ceil(time.process_time() + seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (until if hard == resource.RLIM_INFINITY else min(until, hard), hard))


def _tasks_of_user() -> int:
    """Count the user's processes and threads, as far as they are visible."""
    count = 0
    for process in Path("/proc").glob("[0-9]*/task"):
        with suppress(OSError):  # it has just ended
            status = process.stat()
            count += status.st_nlink - 2 if status.st_uid == os.getuid() else 0
    return count


def _lower(kind: int, soft: int, hard: int | None = None) -> None:
    """Set a limit and its hard limit, which only root can raise again."""
    present = resource.getrlimit(kind)
    resource.setrlimit(kind, (_least(soft, present[0]), _least(soft if hard is None else hard, present[1])))


def _least(wanted: int, present: int) -> int:
    return wanted if present == resource.RLIM_INFINITY else min(wanted, present)
