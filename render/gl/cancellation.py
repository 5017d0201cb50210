"""Cancellation of long GPU work: a newer request need not wait for an older one to finish.

Long work is divided into pieces and calls `CancellationPoint.poll` between them. A poll costs nothing while nothing can cancel
the work. Within `CancellationPoint.cancel_when` the pieces are small, the device finishes each, and the first poll after the work
has become stale raises `Cancelled`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

PIECE_MS = 12.0
"""Target time of one piece of cancellable work: a third of the longest wait that a newer request should have."""


class Cancelled(Exception):  # noqa: N818 - not an error
    """Work was cancelled part way. Its partial results must not be used."""


class CancellationPoint:
    """The point between two pieces of GPU work at which the work can be cancelled; one for each context.

    Args:
        finish: returns when the device has executed every command it was given.
    """

    def __init__(self, finish: Callable[[], None]) -> None:
        self._finish = finish
        self._is_stale: Callable[[], bool] | None = None
        self._began = 0.0

    @property
    def is_cancellable(self) -> bool:
        """True within `cancel_when`: work should be divided into small pieces."""
        return self._is_stale is not None

    @contextmanager
    def cancel_when(self, is_stale: Callable[[], bool]) -> Iterator[None]:
        """Make the work within the context cancellable.

        Args:
            is_stale: polled between pieces; True cancels the work.
        """
        self._is_stale, self._began = is_stale, perf_counter()
        try:
            yield
        finally:
            self._is_stale = None

    def poll(self) -> float:
        """End one piece of work.

        Returns:
            Time of the piece in milliseconds; 0 where the work is not cancellable.

        Raises:
            Cancelled: the work is stale.
        """
        if self._is_stale is None:
            return 0.0
        self._finish()
        took = 1000 * (perf_counter() - self._began)
        is_stale = self._is_stale()
        self._began = perf_counter()
        if is_stale:
            raise Cancelled
        return took


NEVER_CANCELLED = CancellationPoint(lambda: None)
"""Cancellation point of work that always runs to its end."""


class PieceSize:
    """Size of the next piece of even work, adapted to the measured time of earlier pieces.

    Args:
        first: units of work in the first piece.
        least: lower bound.
    """

    def __init__(self, first: int, least: int = 1) -> None:
        self.units = first
        self._least = least

    def cut(self, count: int, cancellation: CancellationPoint) -> Iterator[tuple[int, int]]:
        """Cut work into pieces that follow each other, from a first unit to one past the last; all of it is one piece where it
        cannot be cancelled. The work can be cancelled after each piece, whose time is learnt.

        Args:
            count: number of units.
            cancellation: cancellation point of the work.

        Raises:
            Cancelled: the work is stale.
        """
        first = 0
        while first < count:
            end = min(first + self.units, count) if cancellation.is_cancellable else count
            yield first, end
            took_ms = cancellation.poll()
            if 2 * (end - first) >= self.units:  # small pieces do not predict the time of large ones
                self.learn(end - first, took_ms)
            first = end

    def learn(self, units: int, took_ms: float) -> None:
        """Adapt to a finished piece, which may have been smaller than `units`.

        Args:
            units: size of the piece.
            took_ms: its time; 0 is ignored.
        """
        if took_ms > 0:
            self.units = int(max(self._least, min(2 * self.units, units * PIECE_MS / took_ms)))
