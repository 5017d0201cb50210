"""From what a camera and its focus points say over time to where its lens is focused: the one place that knows the focus modes.

which points count, and how much · where they want the focus · whether they set the stop · the hand that follows over time
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from render.errors import CameraError, SettingsError
from render.focal_surface import FocalPlane
from render.focus.best_stop import StopSolutions, stops_for
from render.focus.influence import SEEN
from render.focus.plane_fit import fit_targets, limit_planes
from render.focus.points import FocusTargets
from render.focus.smoothing import faded, points_share, smoothed
from render.focus.solve import STATES, FocusSolutions, solve_distances
from render.focus.tilt import planes_of
from render.focus.timeline import drive
from render.focus.tracking import tracked
from render.lens_law import LensLaw
from render.optics.depth_of_field import default_coc_limit_mm
from render.optics.focus_law import focus_laws
from render.optics.thin_lens import focus_w
from render.scene import Camera
from render.shot.focus_reading import FocusReading
from render.shot.ring import close_focus_depth_m, focus_ring
from usd_schemas import FocusData

DoubleArray = NDArray[np.float64]

_NOT_HELD = "no f-number of the lens holds all points within their circles of confusion"


@dataclass(frozen=True, eq=False)
class FocusTrack:
    """Where a lens is focused at n times, and for whom.

    Attributes:
        times: ``(n,)`` USD time codes, rising.
        planes: ``(n, 3)`` w on the axis in 1/m, and its change with the slope to the right and up.
        wanted_w: ``(n,)`` w on the axis that was asked for, before the hand that follows.
        f_stops: ``(n,)``.
        fades: ``(n, k)`` how much of each point is there, 0 to 1.
        solutions: whose focus it is.
        notes: n sentences on what could not be done as asked, empty where all could.
    """

    times: DoubleArray
    planes: DoubleArray
    wanted_w: DoubleArray
    f_stops: DoubleArray
    fades: DoubleArray
    solutions: FocusSolutions
    notes: tuple[str, ...]

    def plane(self, index: int) -> FocalPlane:
        """The plane of focus at one of the times."""
        w0, right, up = self.planes[index].tolist()
        return FocalPlane(w0, right, up)


def follows_over_time(focus: FocusData) -> bool:
    """Whether the focus at one time depends on other times."""
    return max(focus.smoothing, focus.lag, focus.dead_zone, focus.max_speed) > 0


def coc_limit_mm(camera: Camera, focus: FocusData) -> float:
    """Largest diameter of a circle of confusion on the film that counts as sharp."""
    if focus.circle_of_confusion > 0:
        return focus.circle_of_confusion
    return default_coc_limit_mm(camera.horizontal_aperture_mm, camera.vertical_aperture_mm)


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
    own_w, (count, points) = _own_w(reading), reading.visible.shape
    reason = "the focus mode is manual, so the camera's own focus distance is kept"
    solutions = FocusSolutions(
        focus_distance_m=_distances(own_w),
        shares=np.zeros((count, points)),
        state_codes=np.full((count, points), STATES.index("by_hand"), np.int8),
        sources=("camera",) * count,
        reasons=(reason,) * count,
        limits=("",) * count,
    )
    planes = np.column_stack([own_w, _authored_tilt(reading)])
    return FocusTrack(
        reading.times, planes, own_w, _f_stops(reading), np.zeros((count, points)), solutions, ("",) * count
    )


def _by_points(reading: FocusReading) -> FocusTrack:
    targets, law, own_w = reading.targets, focus_laws(reading.cameras), _own_w(reading)
    wanted = _wanted(reading, targets, law, own_w)
    fades = _fades(reading, targets)
    w, f_stops = wanted.focus.focus_w, wanted.f_stops
    if _is_smoothed(reading):
        crossing = replace(targets, weights=targets.weights * fades, enabled=fades > 0, in_frame=fades > 0)
        share = points_share(fades * (targets.weights > 0))
        crossed = _wanted(reading, crossing, law, own_w)
        w = share * crossed.focus.focus_w + (1 - share) * own_w
        f_stops = share * crossed.f_stops + (1 - share) * _f_stops(reading)
    planes = np.column_stack([w, _authored_tilt(reading)])
    notes = ["" if held else _NOT_HELD for held in wanted.holds.tolist()]
    if reading.focus[0].mode == "tiltPlane":
        _tilt_through_points(reading, targets, wanted.focus.shares, law, planes, notes)
    driven = _driven(reading, law.at_stops(f_stops if law.frames > 1 else f_stops[:1]), planes)
    return FocusTrack(reading.times, driven, planes[:, 0], f_stops, fades, wanted.focus, tuple(notes))


def _wanted(reading: FocusReading, targets: FocusTargets, law: LensLaw, own_w: DoubleArray) -> StopSolutions:
    """What the points want of a lens that is tilted as authored: of the focus on its axis, and of the stop where they set it."""
    tilt = (_authored_tilt(reading)[:, None] * np.nan_to_num(targets.slopes)).sum(-1)
    if tilt.any():
        with np.errstate(divide="ignore", invalid="ignore"):
            on_axis = 1 / (1 / targets.depths_m - tilt)
        targets = replace(targets, depths_m=np.where(targets.depths_m > 0, on_axis, targets.depths_m))
    focus, keep_outside = reading.focus[0], reading.focus[0].off_screen == "keep"
    solved_m = solve_distances(
        targets,
        _distances(own_w),
        law=law,
        keep_outside=keep_outside,
        near_priority=np.array([focus.near_priority for focus in reading.focus]),
        occluded=focus.occluded,
    )
    sets_stop = np.array([focus.solve_stop for focus in reading.focus])
    held = StopSolutions(solved_m, _f_stops(reading), np.ones(len(own_w), np.bool_))
    if not sets_stop.any():
        return held
    limits_mm = [coc_limit_mm(camera, focus) for camera, focus in zip(reading.cameras, reading.focus, strict=True)]
    split = stops_for(
        targets,
        law,
        limits_mm,
        camera_distances_m=_distances(own_w),
        f_stop_range=reading.f_stop_range,
        keep_outside=keep_outside,
        occluded=focus.occluded,
    )
    return _chosen(sets_stop, split, held)


def _chosen(first: NDArray[np.bool_], one: StopSolutions, other: StopSolutions) -> StopSolutions:
    """The one's frames where ``first`` holds, the other's elsewhere."""
    a, b = one.focus, other.focus

    def told(ours: tuple[str, ...], theirs: tuple[str, ...]) -> tuple[Any, ...]:
        return tuple(x if is_first else y for x, y, is_first in zip(ours, theirs, first.tolist(), strict=True))

    focus = FocusSolutions(
        focus_distance_m=np.where(first, a.focus_distance_m, b.focus_distance_m),
        shares=np.where(first[:, None], a.shares, b.shares),
        state_codes=np.where(first[:, None], a.state_codes, b.state_codes).astype(np.int8),
        sources=told(a.sources, b.sources),
        reasons=told(a.reasons, b.reasons),
        limits=told(a.limits, b.limits),
    )
    return StopSolutions(focus, np.where(first, one.f_stops, other.f_stops), np.where(first, one.holds, other.holds))


def _fades(reading: FocusReading, targets: FocusTargets) -> DoubleArray:
    """How much of each point is there: switches and what is seen of it, crossing over focus:smoothing."""
    there = targets.enabled & (targets.in_frame | (reading.focus[0].off_screen == "keep"))
    share = np.where(there, 1.0, 0.0)
    if reading.focus[0].occluded == "fade":
        share = share * np.clip(targets.visible, 0, 1)
    elif reading.focus[0].occluded == "ignore":
        share = np.where(targets.visible < SEEN, 0.0, share)
    with np.errstate(invalid="ignore"):
        usable = (targets.depths_m > 0) & (targets.aims_m > 0)
    if not _is_smoothed(reading):
        return np.where(usable, share, 0.0)
    return faded(share, reading.seconds, np.array([f.smoothing for f in reading.focus]), usable=usable)


def _tilt_through_points(
    reading: FocusReading,
    targets: FocusTargets,
    shares: DoubleArray,
    law: LensLaw,
    planes: DoubleArray,
    notes: list[str],
) -> None:
    """Put the planes through the points in place, where they drive the tilt and any of them counts."""
    asked = np.array([tilt.from_focus_points for tilt in reading.tilts]) & shares.any(axis=1)
    fits, w = fit_targets(targets, shares, law.coc_slope_mm_m(planes[:, 0]))
    focal_mm = np.array([camera.focal_length_mm for camera in reading.cameras])
    most = np.radians([tilt.max_angle for tilt in reading.tilts])
    slopes = np.where((shares > 0)[..., None], targets.slopes, 0.0)
    kept, changed = limit_planes(fits.planes, focal_mm, most, slopes, w, shares)
    planes[asked] = kept[asked]
    for i in np.flatnonzero(asked):
        fit = fits.at(int(i))
        told = [fit.reason] if fit.rank < 3 else []
        if changed[i]:
            told.append(
                f"the lens tilts by {reading.tilts[i].max_angle:g} degrees at most, so the plane misses some points"
            )
        notes[i] = "; ".join([notes[i], *told] if notes[i] else told)


def _driven(reading: FocusReading, law: LensLaw, planes: DoubleArray) -> DoubleArray:
    """The planes that the hand on the lens makes of those that are wanted."""
    if not any(follows_over_time(focus) for focus in reading.focus):
        return planes
    seconds, keys = reading.seconds, reading.key_seconds
    smoothing, lag, zone_mm, speed = (
        np.array([getattr(focus, name) for focus in reading.focus])
        for name in ("smoothing", "lag", "dead_zone", "max_speed")
    )
    growth = law.coc_slope_mm_m(planes[:, 0])
    driven = planes.copy()
    driven[:, 0] = drive(
        seconds,
        planes[:, 0],
        exact_at_s=keys,
        smoothing_s=smoothing,
        lag_s=lag,
        dead_zone_w=np.where(growth > 0, zone_mm / np.where(growth > 0, growth, 1.0), 0.0),
        ring=focus_ring(reading.cameras[0], float(reading.throws_deg[0])),
        max_speed_rad_s=np.radians(speed),
        close_focus_m=close_focus_depth_m(reading.cameras[0]),
    )
    for column in (1, 2):
        level = smoothed(seconds, planes[:, column], smoothing, exact_at_s=keys)
        driven[:, column] = tracked(seconds, level, lag_s=lag)
    return driven


def _authored_tilt(reading: FocusReading) -> DoubleArray:
    """``(n, 2)`` change of w with the slope to the right and up of the lens as its tilt and swing are authored."""
    tilts = np.radians([[tilt.tilt, tilt.swing] for tilt in reading.tilts])
    focal_mm = np.array([camera.focal_length_mm for camera in reading.cameras])
    return planes_of(tilts[:, 0], tilts[:, 1], math.inf, focal_mm)[:, 1:]


def _own_w(reading: FocusReading) -> DoubleArray:
    return np.array([focus_w(camera) for camera in reading.cameras])


def _distances(w: DoubleArray) -> DoubleArray:
    return np.where(w > 0, 1 / np.where(w > 0, w, 1.0), np.inf)


def _f_stops(reading: FocusReading) -> DoubleArray:
    return np.array([camera.f_stop for camera in reading.cameras])


def _is_smoothed(reading: FocusReading) -> bool:
    return any(focus.smoothing > 0 for focus in reading.focus)
