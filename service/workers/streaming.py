"""Signals by which the service interrupts a stream that a worker is running.

A worker receives calls over its pipe, but only between two of them. While it runs a stream it reads two numbers in shared memory:
the stream that was cancelled, and how many calls wait for the worker.
"""

from __future__ import annotations

import ctypes
import mmap
import time

from service.workers.shared_memory import create_shared

CROWD = 2
"""Calls that wait for a worker, more than which are a crowd."""


class Signals:
    """Shared memory that the service writes and a running worker reads.

    Args:
        descriptor: of the memory, from `create_memory`; it may be closed afterwards.
    """

    def __init__(self, descriptor: int) -> None:
        self._numbers = (ctypes.c_uint64 * 2).from_buffer(mmap.mmap(descriptor, _BYTES))

    @property
    def cancelled_stream(self) -> int:
        """Serial number of the stream that was cancelled last; 0 is none."""
        return self._numbers[0]

    @cancelled_stream.setter
    def cancelled_stream(self, serial: int) -> None:
        self._numbers[0] = serial

    @property
    def queue_length(self) -> int:
        """Number of calls that wait for the worker."""
        return self._numbers[1]

    @queue_length.setter
    def queue_length(self, count: int) -> None:
        self._numbers[1] = count


_BYTES = 2 * ctypes.sizeof(ctypes.c_uint64)


def create_memory() -> int:
    """Create the memory of a `Signals` and return its descriptor, which the caller closes."""
    return create_shared("pullfocus-signals", _BYTES)


class StaleCheck:
    """Decides, in the worker, whether a stream must end here. Its generator function calls it between its pieces of work.

    A cancelled stream ends at once. A stream ends for other calls that wait once it has yielded an item and its grace time is
    over, because long work without a new item would block everyone else.

    Args:
        signals: from the service.
        serial: the stream's number.
        has_yielded: whether an earlier, interrupted run yielded an item.
        grace_s: time that it may keep others waiting.

    Attributes:
        has_yielded: whether the stream has yielded an item; set by the caller.
        has_ended: whether it has returned True.
    """

    def __init__(self, signals: Signals, serial: int, *, has_yielded: bool, grace_s: float) -> None:
        self._signals = signals
        self._serial = serial
        self._grace_until_s = time.monotonic() + grace_s
        self.has_yielded = has_yielded
        self.has_ended = False

    @property
    def is_crowded(self) -> bool:
        """Whether so many calls wait that a quick item is better than a good one."""
        return self._signals.queue_length > CROWD

    def __call__(self) -> bool:
        """Return True where the stream must end."""
        may_interrupt = self.has_yielded and time.monotonic() >= self._grace_until_s
        is_interrupted = may_interrupt and self._signals.queue_length > 0
        self.has_ended = self.has_ended or is_interrupted or self._signals.cancelled_stream == self._serial
        return self.has_ended
