"""Plane of focus and f-number that the focus points of a camera request over time, before smoothing and following."""

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
from render.focus.smoothing import fade_weights
from render.focus.solve import FocusSolutions, kept_within, solve_distances
from render.model.arrays import DoubleArray
from render.model.lens_law import LensLaw
from render.shot.focus.inputs import FocusInputs, coc_limit_mm

_NOT_HELD = "no f-number of the lens holds all points within their circles of confusion"


@dataclass(frozen=True, eq=False)
class FocusRequest:
    """Focus requested of the lens at n times.

    Attributes:
        planes: ``(n, 3)`` w on the axis in 1/m, and its change with the slope to the right and up.
        f_stops: ``(n,)``.
        solutions: whose focus it is.
        notes: n sentences on what could not be done as requested, empty where all could.
    """

    planes: DoubleArray
    f_stops: DoubleArray
    solutions: FocusSolutions
    notes: list[str]


def request_focus(inputs: FocusInputs, targets: FocusTargets, law: LensLaw) -> FocusRequest:
    """Solve the plane of focus that serves the points best and, where they set it, the f-number.

    Args:
        inputs: of the camera.
        targets: its points, such as with faded weights.
        law: of its lens.
    """
    focus, camera_w, tilt = inputs.focus[0], inputs.camera_w, inputs.tilt_gradients
    solutions = solve_distances(
        targets,
        distances_m(camera_w),
        law=law,
        tilts=tilt,
        keep_outside=focus.off_screen == "keep",
        near_priority=inputs.setting("near_priority"),
        occluded=focus.occluded,
    )
    planes, notes = np.column_stack([solutions.focus_w, tilt]), [""] * len(camera_w)
    if focus.mode == "tiltPlane":
        is_tilted, reasons = _tilt_through_points(inputs, targets, solutions.shares, law, planes, notes)
        solutions = kept_within(solutions, planes[:, 0], is_tilted, targets.names, law)
        solutions = replace(solutions, reasons=tuple(map(_join, solutions.reasons, reasons)))
        planes[:, 0] = np.where(is_tilted, solutions.focus_w, planes[:, 0])
    request = FocusRequest(planes, inputs.camera_f_stops, solutions, notes)
    return _with_stops(inputs, targets, law, request) if any(f.solve_stop for f in inputs.focus) else request


def _with_stops(inputs: FocusInputs, targets: FocusTargets, law: LensLaw, request: FocusRequest) -> FocusRequest:
    """Replace distance and f-number by those that hold all points, at the times when the points set the stop."""
    focus = inputs.focus[0]
    split = stops_for(
        targets,
        law,
        [coc_limit_mm(camera, focus) for camera, focus in zip(inputs.cameras, inputs.focus, strict=True)],
        tilts=request.planes[:, 1:],
        camera_distances_m=distances_m(inputs.camera_w),
        f_stop_range=inputs.f_stop_range,
        keep_outside=focus.off_screen == "keep",
        occluded=focus.occluded,
    )
    sets_stop = np.array([focus.solve_stop for focus in inputs.focus])
    planes = request.planes.copy()
    planes[sets_stop, 0] = split.focus.focus_w[sets_stop]
    held = split.holds | ~sets_stop
    return FocusRequest(
        planes,
        np.where(sets_stop, split.f_stops, request.f_stops),
        _select(sets_stop, split.focus, request.solutions),
        [_join(note, "" if holds else _NOT_HELD) for note, holds in zip(request.notes, held.tolist(), strict=True)],
    )


def _select(is_first: NDArray[np.bool_], first: FocusSolutions, second: FocusSolutions) -> FocusSolutions:
    """Take the first solution at the times where ``is_first`` holds, the second elsewhere."""

    def select(a: tuple[str, ...], b: tuple[str, ...]) -> tuple[Any, ...]:
        return tuple(x if takes_a else y for x, y, takes_a in zip(a, b, is_first.tolist(), strict=True))

    return FocusSolutions(
        focus_distance_m=np.where(is_first, first.focus_distance_m, second.focus_distance_m),
        shares=np.where(is_first[:, None], first.shares, second.shares),
        state_codes=np.where(is_first[:, None], first.state_codes, second.state_codes).astype(np.int8),
        sources=select(first.sources, second.sources),
        reasons=select(first.reasons, second.reasons),
        limits=select(first.limits, second.limits),
    )


def fade_points(inputs: FocusInputs, targets: FocusTargets) -> DoubleArray:
    """Compute ``(n, k)`` how much of each point counts, 0 to 1: its switch and its visibility, faded over focus:smoothing.

    Args:
        inputs: of the camera.
        targets: its points.
    """
    counts = targets.enabled & (targets.in_frame | (inputs.focus[0].off_screen == "keep"))
    share = np.where(counts, 1.0, 0.0)
    if inputs.focus[0].occluded == "fade":
        share = share * np.clip(targets.visible, 0, 1)
    elif inputs.focus[0].occluded == "ignore":
        share = np.where(targets.visible < SEEN, 0.0, share)
    with np.errstate(invalid="ignore"):
        usable = (targets.depths_m > 0) & (targets.aims_m > 0)
    if not inputs.is_smoothed:
        return np.where(usable, share, 0.0)
    return fade_weights(share, inputs.seconds, inputs.setting("smoothing_s"), usable=usable)


def _tilt_through_points(
    inputs: FocusInputs,
    targets: FocusTargets,
    shares: DoubleArray,
    law: LensLaw,
    planes: DoubleArray,
    notes: list[str],
) -> tuple[NDArray[np.bool_], list[str]]:
    """Fit ``planes`` through the points, in place, at the times when they drive the tilt and any of them counts.

    Returns:
        ``(n,)`` true at those times, and n sentences on what the points determine where that is less than a plane.
    """
    is_fitted = np.array([tilt.driven_by_points for tilt in inputs.tilts]) & shares.any(axis=1)
    fits, w = fit_targets(targets, shares, law.coc_slope_mm_m(planes[:, 0]))
    focal_mm = np.array([camera.focal_length_mm for camera in inputs.cameras])
    max_angles_rad = np.radians([tilt.max_angle_deg for tilt in inputs.tilts])
    slopes = np.where((shares > 0)[..., None], targets.slopes, 0.0)
    limited, changed = limit_planes(fits.planes, focal_mm, max_angles_rad, slopes, w, shares)
    planes[is_fitted] = limited[is_fitted]
    for i in np.flatnonzero(is_fitted & changed):
        notes[i] = _join(notes[i], _limit_note(limited[i], float(focal_mm[i]), inputs.tilts[i].max_angle_deg))
    is_underdetermined = is_fitted & (fits.ranks < 3)
    return np.asarray(is_fitted), [
        fits.at(i).reason if few else "" for i, few in enumerate(is_underdetermined.tolist())
    ]


def _limit_note(plane: DoubleArray, focal_length_mm: float, max_angle_deg: float) -> str:
    turned_deg = math.degrees(math.asin(min(focal_length_mm / 1000 * math.hypot(plane[1], plane[2]), 1.0)))
    if turned_deg > max_angle_deg * (1 - 1e-6):
        return f"the lens tilts by {max_angle_deg:g} degrees at most, so the plane misses some points"
    return "the plane through the points meets the view axis behind the camera, so it is laid along the axis and misses some"


def _join(*sentences: str) -> str:
    return "; ".join(sentence for sentence in sentences if sentence)


def distances_m(w: DoubleArray) -> DoubleArray:
    """``(n,)`` depths for inverse depths; infinite for 0."""
    return np.where(w > 0, 1 / np.where(w > 0, w, 1.0), np.inf)
