"""Model of an assistant's hand on the focus ring: its start, delay and speed, and the ring's stops.

Each step is a function of the whole shot, settled at its first time: a frame's focus does not depend on the order in
which frames are computed. No step overshoots: the result never leaves the range of the requests up to then.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from render.errors import SettingsError
from render.focus.smoothing import check_samples, over_time
from render.model.arrays import DoubleArray


@dataclass(frozen=True)
class FocusRing:
    """Focus ring: its turn for each focus distance.

    It turns in proportion to inverse depth, from 0 at infinity to its throw at close focus: a plain helicoid moves the lens in
    proportion to the turn, and the lens has to move by ``f² / (z - f)``, all but ``f² · w`` but for the closest focus.

    Attributes:
        throw_rad: turn from infinity to close focus (lens:focusThrow).
        close_focus_m: depth of the nearest focus, from the entrance pupil.
    """

    throw_rad: float
    close_focus_m: float

    def __post_init__(self) -> None:
        """Check the numbers.

        Raises:
            SettingsError: one is not above 0.
        """
        if not (0 < self.throw_rad < math.inf and 0 < self.close_focus_m < math.inf):
            raise SettingsError(
                "a focus ring needs a throw and a close focus above 0, got "
                f"{self.throw_rad:g} rad and {self.close_focus_m:g} m",
                code="bad_lens_setting",
            )

    def turn_rad(self, w: ArrayLike) -> DoubleArray:
        """Turn of the ring from infinity for foci at inverse depths in 1/m, of any shape."""
        return np.asarray(w, np.float64) * self.throw_rad * self.close_focus_m

    def w_at(self, turn_rad: ArrayLike) -> DoubleArray:
        """Inverse depths in 1/m of the focus for turns of the ring, of any shape."""
        return np.asarray(turn_rad, np.float64) / (self.throw_rad * self.close_focus_m)


def track(
    times_s: ArrayLike, w_target: ArrayLike, *, lag_s: ArrayLike = 0.0, dead_zone_w: ArrayLike = 0.0
) -> DoubleArray:
    """Focus of a hand that follows a target: a dead zone in which blur is not seen, then a delay.

    The eye lets the target go by up to the dead zone and then takes the focus along, so that the target is never farther
    off than that ("play", Krasnosel'skii & Pokrovskii 1983): while the target stays within it, the focus stands still. The
    hand comes after by two equal delays of first order, together as long as the lag: it starts and stops softly, goes behind a
    steady target by just the lag, and does not pass a target that stops, as one critically damped.

    Args:
        times_s: ``(n,)`` rising; the hand stands on the target at the first.
        w_target: ``(n,)`` wanted focus in 1/m, joined by straight lines.
        lag_s: how late the hand comes; one, or ``(n,)``.
        dead_zone_w: how far the target may be from the focus before the focus moves, 1/m; one, or ``(n,)``. A circle of
            confusion in mm over `coc_slope_mm_m`.

    Returns:
        ``(n,)`` in 1/m.

    Raises:
        SettingsError: times do not rise, a target is not finite, or a setting is negative or not finite.
    """
    t, target = check_samples(times_s, w_target)
    seen = _seen(target, over_time("dead zone", dead_zone_w, t))
    return _follow(t, seen, over_time("lag in seconds", lag_s, t))


def limit_speed(times_s: ArrayLike, ring: ArrayLike, max_per_s: ArrayLike) -> DoubleArray:
    """Turn of the ring at limited speed: it arrives late, and then stays at the requested turn.

    Args:
        times_s: ``(n,)`` rising; the ring starts at the first request.
        ring: ``(n,)`` wanted turn, in any unit.
        max_per_s: how much it can turn in a second, in that unit; 0 sets no bound; one, or ``(n,)``.

    Returns:
        ``(n,)``.

    Raises:
        SettingsError: times do not rise, a turn is not finite, or the bound is negative.
    """
    t, requested_ring = check_samples(times_s, ring)
    speed = over_time("fastest turn of the focus ring", max_per_s, t)
    most = np.where(speed[1:] > 0, speed[1:] * np.diff(t), np.inf)
    turn = [float(requested_ring[0])]
    for to, reach in zip(requested_ring[1:].tolist(), most.tolist(), strict=True):
        turn.append(min(max(to, turn[-1] - reach), turn[-1] + reach))
    return np.array(turn)


def limits(w: ArrayLike, close_focus_m: float = 0.0) -> DoubleArray:
    """Inverse depths that the ring reaches: from infinity, 0, to close focus.

    Args:
        w: wanted focus in 1/m, of any shape; below 0 would be beyond infinity.
        close_focus_m: depth of the nearest focus, from the entrance pupil; 0 sets no limit.

    Raises:
        SettingsError: the close focus is negative or not a number.
    """
    if not close_focus_m >= 0:
        raise SettingsError(f"the close focus in m must be 0 or more, got {close_focus_m:g}", code="bad_lens_setting")
    return np.clip(np.asarray(w, np.float64), 0.0, 1 / close_focus_m if close_focus_m > 0 else math.inf)


def _seen(target: DoubleArray, zone: DoubleArray) -> DoubleArray:
    focus = [float(target[0])]
    for low, high in zip((target - zone)[1:].tolist(), (target + zone)[1:].tolist(), strict=True):
        focus.append(min(max(focus[-1], low), high))
    return np.array(focus)


def _follow(t: DoubleArray, target: DoubleArray, lag_s: DoubleArray) -> DoubleArray:
    """Two first-order delays in a row, solved exactly for a target that is linear between times."""
    first = second = float(target[0])
    hand = [second]
    steps = zip(np.diff(t).tolist(), target[:-1].tolist(), target[1:].tolist(), lag_s[1:].tolist(), strict=True)
    for step_s, start, end, lag in steps:
        delay = lag / 2
        if delay <= 1e-9 * step_s:
            first = second = end
        else:
            late = (end - start) / step_s * delay  # lag of each of the two behind a steadily moving target
            decay, ahead = math.exp(-step_s / delay), first - start + late
            second = end - 2 * late + (second - start + 2 * late + step_s / delay * ahead) * decay
            first = end - late + ahead * decay
        hand.append(second)
    return np.array(hand)
