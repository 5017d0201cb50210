"""Where long work on a device can be left: whoever waits for something newer need not wait for what is old.

Work that takes long is done in pieces, and between them the pulse beats. It costs nothing until somebody watches it; then the
pieces are small, each is waited for, and the first beat after the work has become stale ends it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

PIECE_MS = 12.0
"""What a piece of watched work should take: a third of what a newer request is to wait at most."""


class Interrupted(Exception):  # noqa: N818 - it is no error
    """Work was left half done, since nobody waits for it any more. Nothing that it made may be used."""


class Pulse:
    """Of one device."""

    def __init__(self, finish: Callable[[], None]) -> None:
        """``finish`` returns when the device has done all that it was asked."""
        self._finish = finish
        self._is_stale: Callable[[], bool] | None = None
        self._began = 0.0

    @property
    def is_watched(self) -> bool:
        """Whether work should be done in small pieces."""
        return self._is_stale is not None

    @contextmanager
    def watched(self, is_stale: Callable[[], bool]) -> Iterator[None]:
        """Watch the work that is done within.

        Args:
            is_stale: whether it is wanted no more.
        """
        self._is_stale, self._began = is_stale, perf_counter()
        try:
            yield
        finally:
            self._is_stale = None

    def beat(self) -> float:
        """End a piece of work.

        Returns:
            What it took in milliseconds; 0 where nobody watches.

        Raises:
            Interrupted: the work is stale.
        """
        if self._is_stale is None:
            return 0.0
        self._finish()
        took = 1000 * (perf_counter() - self._began)
        is_stale = self._is_stale()
        self._began = perf_counter()
        if is_stale:
            raise Interrupted
        return took


UNWATCHED = Pulse(lambda: None)
"""Of work that nobody ever leaves half done."""


class PieceSize:
    """How large pieces of even work should be, learnt from what they take.

    Args:
        first: units of work in the first piece.
        least: no piece is smaller.
    """

    def __init__(self, first: int, least: int = 1) -> None:
        self.units = first
        self._least = least

    def learn(self, units: int, took_ms: float) -> None:
        """Take note of a piece; it may have been smaller than was asked."""
        if took_ms > 0:
            self.units = int(max(self._least, min(2 * self.units, units * PIECE_MS / took_ms)))
