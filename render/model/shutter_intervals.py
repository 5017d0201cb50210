"""When the shutter of a long exposure is open: ``1:241`` opens it at frame 1 and closes it at frame 241, ten seconds later at 24
frames a second; ``1:25,49:73`` opens it twice on one piece of film; ``1:241x2`` looks at intervals of two frames.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from itertools import pairwise

from render.errors import SettingsError
from render.model.frame_spec import MAX_FRAMES

MAX_MOMENTS = 32
"""Most moments of an interval whose number of moments is measured."""
MIN_RAYS = 4
"""Fewest rays of such a moment: with fewer, a trail shows beads however close its moments are."""
MAX_ND_STOPS = 40
"""Strongest filter, in stops. More than any glass takes: solar filters take 17."""

_NUMBER = r"([+-]?(?:\d+\.?\d*|\.\d+))"
_INTERVAL = re.compile(rf"{_NUMBER}:{_NUMBER}(?:x{_NUMBER})?")
_SLACK = 1e-6  # of an interval: what rounding leaves over is no interval of its own


@dataclass(frozen=True)
class ShutterInterval:
    """Once open and closed again.

    Attributes:
        first: USD time code at which the shutter opens.
        last: at which it closes.
        step: length of the intervals that the time is divided in; the last one may be shorter.

    Raises:
        SettingsError: it closes before or as it opens, or the intervals have no length or are too many.
    """

    first: float
    last: float
    step: float = 1.0

    def __post_init__(self) -> None:
        if not all(map(math.isfinite, (self.first, self.last, self.step))):
            raise SettingsError("a long exposure needs finite frames", code="bad_shutter")
        if not self.last > self.first:
            raise SettingsError(
                f"a shutter cannot close before it opens: it opens at {self.first:g} and closes at {self.last:g}",
                code="bad_shutter",
            )
        if not self.step > 0:
            raise SettingsError(f"intervals of a long exposure must be longer than 0 frames, got {self.step:g}")
        if (self.last - self.first) / self.step > MAX_FRAMES:
            raise SettingsError(
                f"a long exposure from {self.first:g} to {self.last:g} has more intervals than the {MAX_FRAMES:,} "
                "that one command takes"
            )

    def intervals(self) -> list[tuple[float, float]]:
        """Begin and end of each interval, one beginning where the other ends: no time between them is lost."""
        count = max(1, math.ceil((self.last - self.first) / self.step - _SLACK))
        ends = [*(self.first + i * self.step for i in range(count)), self.last]
        return list(pairwise(ends))


def parse_shutter_intervals(spec: str) -> list[ShutterInterval]:
    """The openings that are typed, in their order.

    Args:
        spec: such as ``1:241`` or ``1:25,49:73x2``.

    Raises:
        SettingsError: it cannot be read, or a shutter closes before it opens.
    """
    return [_parse_interval(part.strip(), spec) for part in spec.split(",")]


def _parse_interval(part: str, spec: str) -> ShutterInterval:
    match = _INTERVAL.fullmatch(part)
    if match is None:
        raise SettingsError(
            f"the long exposure {spec!r} cannot be read at {part!r}: expected when the shutter opens and closes, such as 1:241"
        )
    return ShutterInterval(float(match[1]), float(match[2]), float(match[3]) if match[3] else 1.0)
