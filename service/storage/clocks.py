"""Clocks for what is kept for days, on a machine whose wall clock may be set while the service runs."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta


def _wall_clock() -> datetime:
    return datetime.now(UTC)


@dataclass(frozen=True)
class Clocks:
    """The wall clock, and the time since the start of the service, which nobody sets.

    Attributes:
        wall: returns the time, with a zone.
        steady: seconds that never go back and never jump.
    """

    wall: Callable[[], datetime] = _wall_clock
    steady: Callable[[], float] = time.monotonic
    _began: datetime = field(init=False)
    _began_s: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_began", self.wall())
        object.__setattr__(self, "_began_s", self.steady())

    @property
    def running_s(self) -> float:
        """Seconds since the start."""
        return self.steady() - self._began_s

    def earlier(self) -> datetime:
        """Return the time of the wall clock, or what it would show had nobody set it forward since the start."""
        return min(self.wall(), self._unset())

    def later(self) -> datetime:
        """Return the time of the wall clock, or what it would show had nobody set it back since the start."""
        return max(self.wall(), self._unset())

    def _unset(self) -> datetime:
        return self._began + timedelta(seconds=self.running_s)
