"""How long a picture has been waited for, and what for."""

from __future__ import annotations

from time import perf_counter

from render.pictures.progressive.request import Timing


class Clock:
    """Runs from when it is made."""

    def __init__(self) -> None:
        self._began = self._noted = perf_counter()
        self._spent: dict[str, float] = {}

    @property
    def total_ms(self) -> float:
        """Since it was made."""
        return 1000 * (perf_counter() - self._began)

    def note(self, part: str) -> float:
        """Count what has passed since the last call as this part's; what it was, in milliseconds."""
        now = perf_counter()
        took_ms, self._noted = 1000 * (now - self._noted), now
        self._spent[part] = self._spent.get(part, 0.0) + took_ms
        return took_ms

    def timing(self) -> Timing:
        """All that was noted."""
        parts = {f"{part}_ms": spent for part, spent in self._spent.items()}
        return Timing(total_ms=self.total_ms, **parts)
