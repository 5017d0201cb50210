"""Clock of one picture: the time since its request, and the time of each part of the work."""

from __future__ import annotations

from time import perf_counter

from render.pictures.progressive.request import Timing


class Clock:
    """Runs from its construction."""

    def __init__(self) -> None:
        self._began = self._noted = perf_counter()
        self._spent: dict[str, float] = {}

    @property
    def total_ms(self) -> float:
        """Milliseconds since construction."""
        return 1000 * (perf_counter() - self._began)

    def note(self, part: str) -> float:
        """Count the time since the last call as this part's, and return it in milliseconds."""
        now = perf_counter()
        spent_ms, self._noted = 1000 * (now - self._noted), now
        self._spent[part] = self._spent.get(part, 0.0) + spent_ms
        return spent_ms

    def timing(self) -> Timing:
        """Give the times noted so far."""
        parts = {f"{part}_ms": spent for part, spent in self._spent.items()}
        return Timing(total_ms=self.total_ms, **parts)
