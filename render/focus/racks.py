"""Racks: the focus goes over from one thing to another, eased, and no faster than the hand can turn the ring.

A rack is eased in the ring's turn, which is in proportion to inverse depth (`FocusRing`); an eye sees blur change at that pace
too. Each ease is one cubic from 0 to 1 (a Bezier segment of a spline is the same), given by its slopes at both ends.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from render.errors import SettingsError
from render.focus.tracking import FocusRing
from render.model.arrays import DoubleArray

Ease = Literal["linear", "smooth", "in", "out"]
EASES: tuple[Ease, ...] = get_args(Ease)

_END_SLOPES: dict[Ease, tuple[float, float]] = {"linear": (1, 1), "smooth": (0, 0), "in": (0, 2), "out": (2, 0)}
_FASTEST: dict[Ease, float] = {"linear": 1.0, "smooth": 1.5, "in": 2.0, "out": 2.0}
"""The steepest slope of each ease."""


@dataclass(frozen=True)
class Rack:
    """One rack; before it the focus is at its start, after it at its end.

    Attributes:
        start_s: when the ring starts to turn.
        end_s: end of the rack: later than requested where the hand is too slow.
        requested_end_s: requested end.
        start_w: focus before, 1/m.
        end_w: focus after, 1/m.
        ease: ease of the motion.
    """

    start_s: float
    end_s: float
    requested_end_s: float
    start_w: float
    end_w: float
    ease: Ease

    @property
    def is_stretched(self) -> bool:
        """Whether the hand needs longer than requested."""
        return self.end_s > self.requested_end_s

    def at(self, times_s: ArrayLike) -> DoubleArray:
        """Focus in 1/m at times of any shape."""
        through = (np.asarray(times_s, np.float64) - self.start_s) / (self.end_s - self.start_s)
        share = ease_progress(self.ease, through)
        return np.asarray(self.start_w * (1 - share) + self.end_w * share)


def rack(
    start_s: float,
    start_w: float,
    end_s: float,
    end_w: float,
    ease: Ease = "smooth",
    *,
    ring: FocusRing | None = None,
    max_speed_rad_s: float = 0.0,
) -> Rack:
    """Rack that keeps its start and ends later where the hand would have to turn too fast.

    Args:
        start_s: when the ring starts to turn.
        start_w: focus before, 1/m; 0 is infinity.
        end_s: when it shall be at rest.
        end_w: focus after, 1/m.
        ease: ``linear``, ``smooth`` (starts and ends softly), ``in`` (starts softly) or ``out`` (ends softly).
        ring: how far the ring turns; None bounds nothing.
        max_speed_rad_s: how fast the hand turns it; 0 sets no bound.

    Raises:
        SettingsError: it does not end after its start, a focus is behind the lens, or the ease is unknown.
    """
    if ease not in EASES:
        raise SettingsError(f"the ease of a rack must be one of {', '.join(EASES)}, got {ease!r}", code="bad_rack")
    if not (math.isfinite(start_s) and math.isfinite(end_s) and start_s < end_s):
        raise SettingsError(f"a rack must end after its start, got {start_s:g} s to {end_s:g} s", code="bad_rack")
    if not all(math.isfinite(w) and w >= 0 for w in (start_w, end_w)):
        raise SettingsError(
            f"a rack goes between depths in front of the lens, got {start_w:g} and {end_w:g} 1/m", code="bad_rack"
        )
    if not (math.isfinite(max_speed_rad_s) and max_speed_rad_s >= 0):
        raise SettingsError(f"the fastest turn of the ring must be 0 or more, got {max_speed_rad_s:g}", code="bad_rack")
    needed_s = 0.0
    if ring is not None and max_speed_rad_s > 0:
        needed_s = _FASTEST[ease] * float(np.abs(ring.turn_rad(end_w - start_w))) / max_speed_rad_s
    return Rack(start_s, max(end_s, start_s + needed_s), end_s, start_w, end_w, ease)


def ease_progress(ease: Ease, through: ArrayLike) -> DoubleArray:
    """Progress of a rack, 0 to 1, for the share of its time that has passed; constant before and after."""
    u = np.clip(np.asarray(through, np.float64), 0.0, 1.0)
    start, end = _END_SLOPES[ease]
    return np.asarray(u * (start + u * ((3 - 2 * start - end) + u * (start + end - 2))))
