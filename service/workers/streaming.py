"""Work that answers more than once, each time better, and that can be told to stop while it is at it.

A worker hears of requests over its pipe, but only between two of them. What it must know while it works is two numbers in
memory that it shares with the service: which stream is no longer wanted, and how many others wait for the worker.
"""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable
from multiprocessing.context import SpawnContext
from typing import Any

IsStale = Callable[[], bool]
"""Polled by a generator function between its pieces of work; True once it must end."""


class Signals:
    """What the service tells a worker that is at work. Each is one word of shared memory, written by the service alone.

    Args:
        context: by which the worker's process is started; it takes these along.
    """

    def __init__(self, context: SpawnContext) -> None:
        self._dropped: Any = context.RawValue(ctypes.c_uint64, 0)
        self._waiting: Any = context.RawValue(ctypes.c_uint64, 0)

    @property
    def dropped(self) -> int:
        """Number of the stream that nobody wants any more; 0 is none."""
        return int(self._dropped.value)

    @dropped.setter
    def dropped(self, serial: int) -> None:
        self._dropped.value = serial

    @property
    def waiting(self) -> int:
        """How many requests wait for the worker."""
        return int(self._waiting.value)

    @waiting.setter
    def waiting(self, count: int) -> None:
        self._waiting.value = count


class Patience:
    """Whether a stream goes on, as its worker sees it.

    It ends at once when nobody wants it any more. It makes way for others once it has shown something, and has had its time:
    work that goes on for long without showing anything new would keep everybody else waiting.

    Args:
        signals: of the service.
        serial: the stream's number.
        has_shown: whether it has shown something before, and was interrupted.
        patience_s: how long others wait for it nevertheless.
    """

    def __init__(self, signals: Signals, serial: int, *, has_shown: bool, patience_s: float) -> None:
        self._signals = signals
        self._serial = serial
        self._until_s = time.monotonic() + patience_s
        self.has_shown = has_shown
        self.has_ended = False

    def __call__(self) -> bool:
        """Whether the work is to end here."""
        others = self._signals.waiting > 0 and self.has_shown and time.monotonic() >= self._until_s
        self.has_ended = self.has_ended or others or self._signals.dropped == self._serial
        return self.has_ended
