"""Turns of viewers at something that one viewer uses at a time: who has used the least is next.

Start-time fair queueing (Goyal, Vin & Cheng 1996, section 2): what a viewer has used is summed, and a viewer who comes, or comes
back, begins with the sum of the one who was served last, so that nobody saves up time while away.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable


class Turns:
    """Time that each viewer has used, s."""

    def __init__(self) -> None:
        self._used_s: dict[Hashable, float] = {}
        self._now_s = 0.0

    def used_s(self, viewer: Hashable) -> float:
        """Return the time that a viewer has used, as far as it counts; the viewer with the least is next."""
        return max(self._used_s.get(viewer, 0.0), self._now_s)

    def begin(self, viewer: Hashable) -> None:
        """Note that it is a viewer's turn."""
        self._now_s = self._used_s[viewer] = self.used_s(viewer)

    def charge(self, viewer: Hashable, cost_s: float) -> None:
        """Add the time that a viewer's turn took, s."""
        self._used_s[viewer] = self.used_s(viewer) + cost_s

    def forget_others(self, present: Collection[Hashable]) -> None:
        """Forget the viewers that are not present, except for those who have used more than the one served last."""
        self._used_s = {
            viewer: used for viewer, used in self._used_s.items() if viewer in present or used > self._now_s
        }
