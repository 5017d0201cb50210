"""Memory that the service shares with a worker process."""

from __future__ import annotations

import fcntl
import os

_SEALS = 0x1 | 0x2 | 0x4
"""``F_SEAL_SEAL``, ``F_SEAL_SHRINK`` and ``F_SEAL_GROW`` of Linux, which Python 3.11 does not name."""


def create_shared(name: str, size_bytes: int) -> int:
    """Create memory whose size stays as it is, and return its descriptor, which the caller closes.

    A worker that shrank it would end the service, and one that made it larger might fill the memory of the machine.

    Args:
        name: for people, in the list of a process's files.
        size_bytes: of the memory.
    """
    descriptor = os.memfd_create(name, os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    os.ftruncate(descriptor, size_bytes)
    fcntl.fcntl(descriptor, fcntl.F_ADD_SEALS, _SEALS)
    return descriptor
