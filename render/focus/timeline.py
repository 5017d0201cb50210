"""Drive of the focus: from the requested focus over time to the lens's focus."""

from __future__ import annotations

from numpy.typing import ArrayLike

from render.focus.smoothing import check_samples, smooth
from render.focus.tracking import FocusRing, limit_speed, limits, track
from render.model.arrays import DoubleArray


def drive(
    times_s: ArrayLike,
    w: ArrayLike,
    *,
    exact_at_s: ArrayLike = (),
    smoothing_s: ArrayLike = 0.0,
    lag_s: ArrayLike = 0.0,
    dead_zone_w: ArrayLike = 0.0,
    ring: FocusRing | None = None,
    max_speed_rad_s: ArrayLike = 0.0,
    close_focus_m: float = 0.0,
) -> DoubleArray:
    """Focus of a lens driven by an assistant, from the requested focus.

    In this order:

    1. limits: the request is clamped to the ring's stops (`limits`). It comes first because a hand that waits
       beyond a stop would be late in coming back; what follows leaves the limits nowhere, as none of it overshoots.
    2. smoothing (`smooth`): exact at keys.
    3. dead zone, then lag (`track`): small wandering of the target is let go; the hand comes late, at keys too.
    4. speed (`limit_speed`): the ring turns no faster than the hand can, where the ring is known.

    What is at rest is not moved by any of them: after a target has stood still for a while, the focus is on it (within
    the dead zone).

    Args:
        times_s: ``(n,)`` rising, from the first frame of the shot: everything is settled there, so that a frame has the
            same focus whichever is looked at first.
        w: ``(n,)`` wanted focus, 1/m; 0 is infinity.
        exact_at_s: ``(k,)`` times of keys at which smoothing is exact (see `smooth`).
        smoothing_s: focus:smoothing; one, or ``(n,)``.
        lag_s: focus:lag; one, or ``(n,)``.
        dead_zone_w: focus:deadZone in 1/m: the circle of confusion over its growth; one, or ``(n,)``.
        ring: how far the ring turns; None where the lens has no throw or no close focus, and then nothing bounds its speed.
        max_speed_rad_s: focus:maxSpeed; 0 sets no bound; one, or ``(n,)``.
        close_focus_m: depth of the nearest focus, from the entrance pupil; 0 sets no limit.

    Returns:
        ``(n,)`` focus, 1/m.

    Raises:
        SettingsError: times do not rise, a wanted focus is not finite, or a setting is negative or not finite.
    """
    t, requested_w = check_samples(times_s, w)
    focus = smooth(t, limits(requested_w, close_focus_m), smoothing_s, exact_at_s=exact_at_s)
    focus = track(t, focus, lag_s=lag_s, dead_zone_w=dead_zone_w)
    return focus if ring is None else limit_speed(t, focus, ring.w_at(max_speed_rad_s))
