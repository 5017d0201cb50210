"""What focus points ask of a lens over time: which of them are there, where they want its plane of focus, and its stop."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from render.focus.best_stop import stops_for
from render.focus.influence import SEEN
from render.focus.plane_fit import fit_targets, limit_planes
from render.focus.points import FocusTargets
from render.focus.smoothing import faded
from render.focus.solve import FocusSolutions, kept_within, solve_distances
from render.focus.tilt import planes_of
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.lens_law import LensLaw
from render.optics.depth_of_field import default_coc_limit_mm
from render.optics.thin_lens import focus_w
from render.shot.focus.focus_reading import FocusReading
from usd_schemas import FocusData

_NOT_HELD = "no f-number of the lens holds all points within their circles of confusion"


def coc_limit_mm(camera: Camera, focus: FocusData) -> float:
    """Largest diameter of a circle of confusion on the film that counts as sharp."""
    if focus.circle_of_confusion > 0:
        return focus.circle_of_confusion
    return default_coc_limit_mm(camera.horizontal_aperture_mm, camera.vertical_aperture_mm)


@dataclass(frozen=True, eq=False)
class FocusRequest:
    """What the points ask of the lens at n times; `FocusTrack` says what each means."""

    planes: DoubleArray
    f_stops: DoubleArray
    solutions: FocusSolutions
    notes: list[str]


def request_focus(reading: FocusReading, targets: FocusTargets, law: LensLaw) -> FocusRequest:
    """Where the points want the plane of focus and, where they set it, the stop."""
    focus, camera_w, tilt = reading.focus[0], own_w(reading), authored_tilt(reading)
    solutions = solve_distances(
        targets,
        distances_m(camera_w),
        law=law,
        tilts=tilt,
        keep_outside=focus.off_screen == "keep",
        near_priority=np.array([focus.near_priority for focus in reading.focus]),
        occluded=focus.occluded,
    )
    planes, notes = np.column_stack([solutions.focus_w, tilt]), [""] * len(camera_w)
    if focus.mode == "tiltPlane":
        tilted, fixed = _tilt_through_points(reading, targets, solutions.shares, law, planes, notes)
        solutions = kept_within(solutions, planes[:, 0], tilted, targets.names, law)
        solutions = replace(solutions, reasons=tuple(map(_joined, solutions.reasons, fixed)))
        planes[:, 0] = np.where(tilted, solutions.focus_w, planes[:, 0])
    made = FocusRequest(planes, own_f_stops(reading), solutions, notes)
    return _with_stops(reading, targets, law, made) if any(f.solve_stop for f in reading.focus) else made


def _with_stops(reading: FocusReading, targets: FocusTargets, law: LensLaw, asked: FocusRequest) -> FocusRequest:
    """The same, with the distance along the axis and the f-number that hold all points where the points set the stop."""
    focus = reading.focus[0]
    split = stops_for(
        targets,
        law,
        [coc_limit_mm(camera, focus) for camera, focus in zip(reading.cameras, reading.focus, strict=True)],
        tilts=asked.planes[:, 1:],
        camera_distances_m=distances_m(own_w(reading)),
        f_stop_range=reading.f_stop_range,
        keep_outside=focus.off_screen == "keep",
        occluded=focus.occluded,
    )
    sets_stop = np.array([focus.solve_stop for focus in reading.focus])
    planes = asked.planes.copy()
    planes[sets_stop, 0] = split.focus.focus_w[sets_stop]
    held = split.holds | ~sets_stop
    return FocusRequest(
        planes,
        np.where(sets_stop, split.f_stops, asked.f_stops),
        _chosen(sets_stop, split.focus, asked.solutions),
        [_joined(note, "" if holds else _NOT_HELD) for note, holds in zip(asked.notes, held.tolist(), strict=True)],
    )


def _chosen(first: NDArray[np.bool_], a: FocusSolutions, b: FocusSolutions) -> FocusSolutions:
    """The one's frames where ``first`` holds, the other's elsewhere."""

    def told(ours: tuple[str, ...], theirs: tuple[str, ...]) -> tuple[Any, ...]:
        return tuple(x if is_first else y for x, y, is_first in zip(ours, theirs, first.tolist(), strict=True))

    return FocusSolutions(
        focus_distance_m=np.where(first, a.focus_distance_m, b.focus_distance_m),
        shares=np.where(first[:, None], a.shares, b.shares),
        state_codes=np.where(first[:, None], a.state_codes, b.state_codes).astype(np.int8),
        sources=told(a.sources, b.sources),
        reasons=told(a.reasons, b.reasons),
        limits=told(a.limits, b.limits),
    )


def faded_points(reading: FocusReading, targets: FocusTargets) -> DoubleArray:
    """How much of each point is there: switches and what is seen of it, crossing over focus:smoothing."""
    there = targets.enabled & (targets.in_frame | (reading.focus[0].off_screen == "keep"))
    share = np.where(there, 1.0, 0.0)
    if reading.focus[0].occluded == "fade":
        share = share * np.clip(targets.visible, 0, 1)
    elif reading.focus[0].occluded == "ignore":
        share = np.where(targets.visible < SEEN, 0.0, share)
    with np.errstate(invalid="ignore"):
        usable = (targets.depths_m > 0) & (targets.aims_m > 0)
    if not is_smoothed(reading):
        return np.where(usable, share, 0.0)
    return faded(share, reading.seconds, np.array([f.smoothing for f in reading.focus]), usable=usable)


def _tilt_through_points(
    reading: FocusReading,
    targets: FocusTargets,
    shares: DoubleArray,
    law: LensLaw,
    planes: DoubleArray,
    notes: list[str],
) -> tuple[NDArray[np.bool_], list[str]]:
    """Put the planes through the points in place, where they drive the tilt and any of them counts.

    Returns:
        ``(n,)`` where that is, and n sentences on what the points fix where that is less than a plane.
    """
    asked = np.array([tilt.from_focus_points for tilt in reading.tilts]) & shares.any(axis=1)
    fits, w = fit_targets(targets, shares, law.coc_slope_mm_m(planes[:, 0]))
    focal_mm = np.array([camera.focal_length_mm for camera in reading.cameras])
    most = np.radians([tilt.max_angle for tilt in reading.tilts])
    slopes = np.where((shares > 0)[..., None], targets.slopes, 0.0)
    kept, changed = limit_planes(fits.planes, focal_mm, most, slopes, w, shares)
    planes[asked] = kept[asked]
    for i in np.flatnonzero(asked & changed):
        notes[i] = _joined(notes[i], _why_limited(kept[i], float(focal_mm[i]), reading.tilts[i].max_angle))
    fewer = asked & (fits.ranks < 3)
    return np.asarray(asked), [fits.at(i).reason if few else "" for i, few in enumerate(fewer.tolist())]


def _why_limited(plane: DoubleArray, focal_length_mm: float, max_angle_deg: float) -> str:
    turned_deg = math.degrees(math.asin(min(focal_length_mm / 1000 * math.hypot(plane[1], plane[2]), 1.0)))
    if turned_deg > max_angle_deg * (1 - 1e-6):
        return f"the lens tilts by {max_angle_deg:g} degrees at most, so the plane misses some points"
    return "the plane through the points meets the view axis behind the camera, so it is laid along the axis and misses some"


def _joined(*sentences: str) -> str:
    return "; ".join(sentence for sentence in sentences if sentence)


def authored_tilt(reading: FocusReading) -> DoubleArray:
    """``(n, 2)`` change of w with the slope to the right and up of the lens as its tilt and swing are authored."""
    tilts = np.radians([[tilt.tilt, tilt.swing] for tilt in reading.tilts])
    focal_mm = np.array([camera.focal_length_mm for camera in reading.cameras])
    return planes_of(tilts[:, 0], tilts[:, 1], math.inf, focal_mm)[:, 1:]


def own_w(reading: FocusReading) -> DoubleArray:
    """``(n,)`` the camera's own focus, 1/m."""
    return np.array([focus_w(camera) for camera in reading.cameras])


def distances_m(w: DoubleArray) -> DoubleArray:
    """``(n,)`` depths for inverse depths; infinite for 0."""
    return np.where(w > 0, 1 / np.where(w > 0, w, 1.0), np.inf)


def own_f_stops(reading: FocusReading) -> DoubleArray:
    """``(n,)`` the camera's own f-numbers."""
    return np.array([camera.f_stop for camera in reading.cameras])


def is_smoothed(reading: FocusReading) -> bool:
    """Whether points come and go softly."""
    return any(focus.smoothing > 0 for focus in reading.focus)
