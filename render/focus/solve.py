"""From focus points to one focus distance.

The circle of confusion grows in proportion to the difference in *inverse* depth (DESIGN section 2), so the distance
that blurs all points least is sought there: it minimises

    E(w_f) = Σ a_i · (|w_i − w_f| − d_i)²        w = 1 / depth, a_i the weight

where ``d_i`` is 0 for a point that must be sharp and, for one that must be soft by a circle of confusion, the
difference in inverse depth which gives it. (A point that must be soft by a distance asks for focus that far behind it,
and ``w_i`` is there.) With sharp points alone this is their weighted mean inverse depth: one point gets the focus
whole, and a cross-fade of weights racks from one to the other at the pace at which an eye sees blur change.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from render.errors import SettingsError

DoubleArray = NDArray[np.float64]

PointKind = Literal["sharp", "soft"]

PointState = Literal["used", "by_hand", "disabled", "zero_weight", "lost", "behind_camera", "outside_frame", "pinhole"]
"""What became of a focus point: it counts, or why it does not.

``by_hand``: no point was asked, as the camera is focused by hand. ``lost``: it has no place, as its target is missing.
``behind_camera``: it, or the focus that it asks for, is not in front. ``pinhole``: it should be soft, but a pinhole makes
nothing soft.
"""

STATES: tuple[PointState, ...] = get_args(PointState)

_INFINITE_DEPTH_M = 1e100
"""Stands for an infinite depth where its logarithm is taken."""

_TIE = 1e-12
"""Energies closer than this share of the weights' sum × w² are held equal: rounding must not choose."""


@dataclass(frozen=True)
class FocusTarget:
    """One focus point as the lens sees it at one time.

    Attributes:
        name: the focus point's name.
        depth_m: along the view axis, positive in front of the camera; NaN where the point has no place.
        weight: how much it counts, 0 or more.
        kind: whether it must be ``sharp`` or ``soft``.
        blur_mm: wanted diameter of a soft point's circle of confusion on the film; 0 leaves it to ``surface_offset_m``.
        surface_offset_m: for a soft point, how far behind it the focus shall lie; negative is before it.
        enabled: whether it counts at all.
        in_frame: whether it lies inside the picture.
    """

    name: str
    depth_m: float
    weight: float = 1.0
    kind: PointKind = "sharp"
    blur_mm: float = 0.0
    surface_offset_m: float = 0.0
    enabled: bool = True
    in_frame: bool = True

    @property
    def is_blurred(self) -> bool:
        """Whether it must be soft by a circle of confusion."""
        return self.kind == "soft" and self.blur_mm > 0

    @property
    def aim_m(self) -> float:
        """Depth at which it would have the focus: its own, or off it where it must be soft by a distance."""
        return self.depth_m + self.surface_offset_m if self.kind == "soft" and self.blur_mm == 0 else self.depth_m


@dataclass(frozen=True)
class FocusSolution:
    """The focus distance, and whose it is.

    Attributes:
        focus_distance_m: depth of the plane of focus; infinite for infinity.
        source: ``points`` where points decided, ``camera`` where the camera's own distance was kept.
        reason: one sentence that says why.
        shares: for each given point, its share of the weight that decided, 0 to 1; they add up to 1, or to 0 where no
            point counts.
        states: for each given point, what became of it.
    """

    focus_distance_m: float
    source: Literal["points", "camera"]
    reason: str
    shares: tuple[float, ...] = ()
    states: tuple[PointState, ...] = ()


def solve_focus(
    points: Sequence[FocusTarget],
    camera_distance_m: float = math.inf,
    *,
    coc_slope_mm_m: float = 0.0,
    keep_outside: bool = False,
    near_priority: float = 0.0,
) -> FocusSolution:
    """The focus distance that serves the points best: weighted least squares in inverse depth.

    Points that are disabled, of no weight, without a place, behind the camera or outside the picture do not count.

    Args:
        points: the focus points.
        camera_distance_m: the camera's own focus distance, kept when no point counts; 0 or infinite is infinity. It
            also decides between two answers that serve equally well (a soft point may lie before or behind the focus).
        coc_slope_mm_m: `render.optics.depth_of_field.coc_slope_mm_m`, the growth of the circle of confusion; 0 for a
            pinhole.
        keep_outside: let points outside the picture count too.
        near_priority: an exponent p that makes nearer points count more: weights are multiplied by (1 / depth in m)^p.

    Returns:
        The solution.

    Raises:
        SettingsError: a weight, a blur or the near priority is negative or not finite, or an offset is not finite.
    """
    _check("near priority of the focus", near_priority)
    camera_w = 1 / camera_distance_m if camera_distance_m > 0 else 0.0
    states = tuple(_state(point, coc_slope_mm_m, keep_outside) for point in points)
    used = [point for point, state in zip(points, states, strict=True) if state == "used"]
    if not used:
        reason = _why_none(points, states)
        return FocusSolution(1 / camera_w if camera_w else math.inf, "camera", reason, (0.0,) * len(points), states)
    weights = _counts(used, near_priority)
    inverse_depths = np.array([1 / point.aim_m for point in used])
    offsets = np.array([point.blur_mm / coc_slope_mm_m if point.is_blurred else 0.0 for point in used])
    w = _least_squares(weights, inverse_depths, offsets, camera_w)
    shares = iter(weights)
    names = ", ".join(point.name for point in used)
    return FocusSolution(
        focus_distance_m=1 / w if w > 0 else math.inf,
        source="points",
        reason=f"focused by {names}",
        shares=tuple(float(next(shares)) if state == "used" else 0.0 for state in states),
        states=states,
    )


def _counts(points: Sequence[FocusTarget], near_priority: float) -> DoubleArray:
    """How much each point counts; the sum is 1. By logarithms, so that no weight and no exponent overflows."""
    depths = np.array([min(point.depth_m, _INFINITE_DEPTH_M) for point in points])
    logs = np.log([point.weight for point in points]) - near_priority * np.log(depths)
    counts = np.exp(logs - logs.max())
    return np.asarray(counts / counts.sum())


def _state(point: FocusTarget, coc_slope_mm_m: float, keep_outside: bool) -> PointState:
    _check(f"weight of focus point {point.name!r}", point.weight)
    _check(f"blur in mm of focus point {point.name!r}", point.blur_mm)
    _check(f"size of the surface offset in m of focus point {point.name!r}", abs(point.surface_offset_m))
    rules: tuple[tuple[PointState, bool], ...] = (
        ("disabled", not point.enabled),
        ("zero_weight", point.weight == 0),
        ("lost", math.isnan(point.depth_m)),
        ("behind_camera", point.depth_m <= 0 or point.aim_m <= 0),
        ("outside_frame", not point.in_frame and not keep_outside),
        ("pinhole", point.is_blurred and coc_slope_mm_m == 0),
    )
    return next((state for state, holds in rules if holds), "used")


def _least_squares(weights: DoubleArray, w: DoubleArray, offsets: DoubleArray, camera_w: float) -> float:
    """The exact minimiser of ``Σ a (|w − x| − d)²`` over ``x ≥ 0``.

    Between two neighbouring soft points every absolute value has a fixed sign and the sum is one parabola; so each
    stretch has one best place, its parabola's vertex or the nearer end, and the best of those few is the answer.
    """
    bounds = [0.0, *sorted(set(w[offsets > 0].tolist())), math.inf]
    places = []
    for low, high in pairwise(bounds):
        farther = w <= low
        wanted = np.where(farther, w + offsets, w - offsets)
        places.append(min(max(float(np.average(wanted, weights=weights)), low), high))
    energies = [float(np.sum(weights * (np.abs(w - place) - offsets) ** 2)) for place in places]
    slack = _TIE * float(np.sum(weights * (w + offsets) ** 2))
    best = min(energies) + slack
    equally_good = [place for place, energy in zip(places, energies, strict=True) if energy <= best]
    return float(min(equally_good, key=lambda place: abs(place - camera_w)))


def _why_none(points: Sequence[FocusTarget], states: Sequence[PointState]) -> str:
    if not points:
        return "there is no focus point, so the camera's own focus distance is kept"
    told = ", ".join(f"{p.name} ({s.replace('_', ' ')})" for p, s in zip(points, states, strict=True))
    return f"no focus point counts, so the camera's own focus distance is kept: {told}"


def _check(what: str, value: float) -> None:
    if not (math.isfinite(value) and value >= 0):
        raise SettingsError(
            f"the {what} must be a finite number of 0 or more, but it is {value:g}", code="bad_focus_point"
        )
