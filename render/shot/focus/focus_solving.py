"""From what a camera and its focus points say over time to where its lens is focused: the one place that knows the focus modes.

which points count, and how much · where they want the focus · whether they set the stop · the hand that follows over time
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from render.errors import CameraError, SettingsError
from render.focus.expressive import soft_sides
from render.focus.smoothing import points_share, smoothed
from render.focus.solve import STATES, FocusSolutions
from render.focus.timeline import drive
from render.focus.tracking import tracked
from render.model.arrays import DoubleArray
from render.model.focal_surface import FocalPlane
from render.model.lens_law import LensLaw
from render.optics.focus_law import focus_laws
from render.shot.focus.focus_reading import FocusReading
from render.shot.focus.focus_request import (
    authored_tilt,
    distances_m,
    faded_points,
    is_smoothed,
    own_f_stops,
    own_w,
    request_focus,
)
from render.shot.focus.focus_ring import close_focus_depth_m, focus_ring
from usd_schemas import FocusData


@dataclass(frozen=True, eq=False)
class FocusTrack:
    """Where a lens is focused at n times, and for whom.

    Attributes:
        times: ``(n,)`` USD time codes, rising.
        planes: ``(n, 3)`` w on the axis in 1/m, and its change with the slope to the right and up.
        wanted_w: ``(n,)`` w on the axis that was asked for, before the hand that follows.
        slowed_w: ``(n,)`` by how much the hand is behind as the ring turns no faster, 1/m.
        f_stops: ``(n,)``.
        fades: ``(n, k)`` how much of each point is there, 0 to 1.
        points_w: ``(n, k)`` inverse depths at which a focal surface takes the points to be, 1/m: where they are, but for a hand
            that follows; NaN without a place.
        sides: ``(n, k)`` on which side of each soft point the focal surface passes (`render.focus.expressive.soft_sides`).
        solutions: whose focus it is.
        notes: n sentences on what could not be done as asked, empty where all could.
    """

    times: DoubleArray
    planes: DoubleArray
    wanted_w: DoubleArray
    slowed_w: DoubleArray
    f_stops: DoubleArray
    fades: DoubleArray
    points_w: DoubleArray
    sides: DoubleArray
    solutions: FocusSolutions
    notes: tuple[str, ...]

    def plane(self, index: int) -> FocalPlane:
        """The plane of focus at one of the times."""
        w0, right, up = self.planes[index].tolist()
        return FocalPlane(w0, right, up)


def keeps_sides(reading: FocusReading) -> bool:
    """Whether a soft point must stay on its side of the focal surface, which only the whole shot says."""
    return reading.focus[0].mode == "surface" and bool(reading.targets.is_blurred.any())


def follows_over_time(focus: FocusData) -> bool:
    """Whether the focus at one time depends on other times."""
    return max(focus.smoothing, focus.lag, focus.dead_zone, focus.max_speed) > 0


def solved(reading: FocusReading) -> FocusTrack:
    """Where the lens is focused.

    Raises:
        CameraError: a number of the camera or of a point has no meaning.
        InputError: the camera's lens is none.
    """
    try:
        return _by_hand(reading) if reading.focus[0].mode == "manual" else _by_points(reading)
    except SettingsError as error:  # the numbers are the shot's, not the caller's
        path = reading.cameras[0].path
        raise CameraError(f"camera {path}: {error.detail}", code=error.code, path=path) from error


def _by_hand(reading: FocusReading) -> FocusTrack:
    """The camera's own distance, its lens tilted as authored."""
    camera_w, (count, points) = own_w(reading), reading.visible.shape
    reason = "the focus mode is manual, so the camera's own focus distance is kept"
    solutions = FocusSolutions(
        focus_distance_m=distances_m(camera_w),
        shares=np.zeros((count, points)),
        state_codes=np.full((count, points), STATES.index("by_hand"), np.int8),
        sources=("camera",) * count,
        reasons=(reason,) * count,
        limits=("",) * count,
    )
    planes = np.column_stack([camera_w, authored_tilt(reading)])
    return FocusTrack(
        reading.times,
        planes,
        camera_w,
        np.zeros(count),
        own_f_stops(reading),
        np.zeros((count, points)),
        _points_w(reading),
        np.ones((count, points)),
        solutions,
        ("",) * count,
    )


def _by_points(reading: FocusReading) -> FocusTrack:
    targets, law = reading.targets, focus_laws(reading.cameras)
    asked = request_focus(reading, targets, law)
    fades = faded_points(reading, targets)
    planes, f_stops = asked.planes, asked.f_stops
    if is_smoothed(reading):
        there, seen = fades > 0, np.ones(fades.shape)
        crossing = replace(targets, weights=targets.weights * fades, enabled=there, in_frame=there, visible=seen)
        crossed = request_focus(reading, crossing, law)
        share = points_share(fades * (targets.weights > 0))
        own = np.column_stack([own_w(reading), authored_tilt(reading)])
        planes = share[:, None] * crossed.planes + (1 - share)[:, None] * own
        f_stops = share * crossed.f_stops + (1 - share) * own_f_stops(reading)
    stopped = law.at_stops(f_stops if law.frames > 1 else f_stops[:1])
    driven, slowed_w = _driven(reading, stopped, planes)
    points_w = _followed_points(reading, stopped)
    sides = _sides(reading, law, driven)
    notes = tuple(asked.notes)
    return FocusTrack(
        reading.times, driven, planes[:, 0], slowed_w, f_stops, fades, points_w, sides, asked.solutions, notes
    )


def _sides(reading: FocusReading, law: LensLaw, planes: DoubleArray) -> DoubleArray:
    """``(n, k)`` on which side of each soft point the focal surface passes: one for all the times, lest its blur jump."""
    targets = reading.targets
    growth = law.coc_slope_mm_m(planes[:, 0])[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        w = np.where(targets.depths_m > 0, 1 / targets.depths_m, np.nan) - targets.field_shifts_w * targets.extents
        off = np.where(targets.is_blurred, targets.blurs_mm * targets.extents / growth, 0.0)
        base = planes[:, :1] + (planes[:, None, 1:] * targets.slopes).sum(-1)
    return np.broadcast_to(soft_sides(w, base, off), w.shape)


def _driven(reading: FocusReading, law: LensLaw, planes: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """The planes that the hand on the lens makes of those that are wanted, and by how much it is too slow for them."""
    if not any(follows_over_time(focus) for focus in reading.focus):
        return planes, np.zeros(len(planes))
    seconds, keys = reading.seconds, reading.key_seconds
    smoothing, lag, speed = (_setting(reading, name) for name in ("smoothing", "lag", "max_speed"))
    pulled = partial(_pulled, reading, law, planes[:, 0], close_focus_m=close_focus_depth_m(reading.cameras[0]))
    ring = focus_ring(reading.cameras[0], float(reading.throws_deg[0]))
    driven = planes.copy()
    driven[:, 0] = pulled(ring=ring, max_speed_rad_s=np.radians(speed))
    for column in (1, 2):
        level = smoothed(seconds, planes[:, column], smoothing, exact_at_s=keys)
        driven[:, column] = tracked(seconds, level, lag_s=lag)
    return driven, np.abs(driven[:, 0] - pulled())


def _followed_points(reading: FocusReading, law: LensLaw) -> DoubleArray:
    """``(n, k)`` where a focal surface takes the points to be: each is followed by a hand of its own, that no ring slows."""
    w = _points_w(reading)
    if reading.focus[0].mode != "surface" or not any(follows_over_time(focus) for focus in reading.focus):
        return w
    for column in w.T:
        there = np.isfinite(column)
        if there.any():
            whole = np.interp(reading.times, reading.times[there], column[there])
            column[there] = _pulled(reading, law, whole)[there]
    return w


def _points_w(reading: FocusReading) -> DoubleArray:
    depths_m = reading.targets.depths_m
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(depths_m > 0, 1 / depths_m, np.nan)


def _pulled(reading: FocusReading, law: LensLaw, w: DoubleArray, **ring: Any) -> DoubleArray:
    """What a hand makes of the focus that is wanted, ``(n,)`` 1/m."""
    growth, zone_mm = law.coc_slope_mm_m(w), _setting(reading, "dead_zone")
    return drive(
        reading.seconds,
        w,
        exact_at_s=reading.key_seconds,
        smoothing_s=_setting(reading, "smoothing"),
        lag_s=_setting(reading, "lag"),
        dead_zone_w=np.where(growth > 0, zone_mm / np.where(growth > 0, growth, 1.0), 0.0),
        **ring,
    )


def _setting(reading: FocusReading, name: str) -> DoubleArray:
    return np.array([getattr(focus, name) for focus in reading.focus], np.float64)
