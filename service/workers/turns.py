"""Turns of viewers at something that one viewer uses at a time: who has used the least is next.

Start-time fair queueing (Goyal, Vin & Cheng 1996, section 2): what a viewer has used is summed, and a viewer who comes, or comes
back, begins with the sum of the one who was served last, so that nobody saves up time while away. Nobody waits for long after one
dear turn, either: a viewer is at most `MAX_DEBT` usual turns behind the one who was served last.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Hashable
from statistics import median

MAX_DEBT = 2.0
"""Most that a viewer has used more than the one who was served last, as a number of usual turns.

A viewer of dear pictures so gets at least half as many as the others do.
"""
_USUAL_OF = 15
"""Number of turns of which the usual one is the median."""


class Turns:
    """Time that each viewer has used, s.

    Attributes:
        usual_s: time of a usual turn, s: the median of the last ones; 0 before the first.
    """

    def __init__(self) -> None:
        self.usual_s = 0.0
        self._last_s: deque[float] = deque(maxlen=_USUAL_OF)
        self._used_s: dict[Hashable, float] = {}
        self._now_s = 0.0
        self._unpriced: list[Hashable] = []  # viewers who owe a usual turn, from before there was one

    def used_s(self, viewer: Hashable) -> float:
        """Return the time that a viewer has used, as far as it counts; the viewer with the least is next."""
        return self._used_s.get(viewer, self._now_s)

    def arrive(self, viewer: Hashable) -> None:
        """Note that a viewer waits: one who is not known begins with the sum of the one who was served last."""
        self._used_s.setdefault(viewer, self._now_s)

    def begin(self, viewer: Hashable) -> None:
        """Note that it is a viewer's turn."""
        self.arrive(viewer)
        self._now_s = max(self._now_s, self._used_s[viewer])

    def charge(self, viewer: Hashable, cost_s: float) -> None:
        """Add the time that a viewer's turn took, s."""
        self._last_s.append(cost_s)
        self.usual_s = median(self._last_s)
        self._add(viewer, cost_s)
        while self._unpriced:
            self._add(self._unpriced.pop(), self.usual_s)

    def charge_usual(self, viewer: Hashable, cost_s: float) -> None:
        """Add the time that a viewer's turn took, s, but no more than a usual turn: the rest served others, too."""
        if self._last_s:
            self._add(viewer, min(cost_s, self.usual_s))
        else:
            self._unpriced.append(viewer)

    def _add(self, viewer: Hashable, cost_s: float) -> None:
        """Add to what a viewer has used, and bound the debts of all: they shrink where turns have become cheaper."""
        self._used_s[viewer] = self.used_s(viewer) + cost_s
        most_s = self._now_s + MAX_DEBT * self.usual_s
        self._used_s = {name: min(used_s, most_s) for name, used_s in self._used_s.items()}

    def forget_others(self, present: Collection[Hashable]) -> None:
        """Forget the viewers that are not present, except for those who have used more than the one served last."""
        self._used_s = {
            viewer: used for viewer, used in self._used_s.items() if viewer in present or used > self._now_s
        }
