"""The best stop: the focus and the widest f-number that hold every point within its circle of confusion.

A focus puller's split, between any number of points. Point i may have a circle of c_i, and has ``K(x)·|w_i − x| / N`` for a focus
at x (`render.model.lens_law`). So the least f-number belongs to the focus that minimises the largest ``|w_i − x| / c_i``, the
middle of
the extremes where all circles are alike (K does not move it, since it is the same for all). Two points weigh against each other
there, the split's near and far one. They are found by taking, for a guess of t, those whose ranges ``w ± t·c`` lie farthest apart
and enlarging t until these touch; t only grows and each pair comes up once, so that ends after few rounds.

For two points, one circle and a thin lens: x is the middle of their inverse depths and ``N = f²·|w_near − w_far| / (2·c)``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from render.errors import SettingsError
from render.focus.influence import STATES, Occluded, state_codes, strengths
from render.focus.points import FocusTargets
from render.focus.solve import FocusLimit, FocusSolutions, FocusSource, why
from render.model.arrays import BoolArray, DoubleArray
from render.model.lens_law import LensLaw

WIDEST_OF_ALL = 0.5
"""No lens in air that is free of coma opens wider than f/0.5 (Abbe's sine condition)."""

_HELD = 1 + 1e-9


@dataclass(frozen=True, eq=False)
class Split:
    """Focus and f-number for points ``(n, k)``.

    Attributes:
        w: ``(n,)`` inverse depth of the focus, 1/m.
        f_stops: ``(n,)``.
        excess: ``(n,)`` largest circle of confusion relative to its point's limit; 1 where the points set the
            f-number.
        decides: ``(n, k)`` shares of the two points that decide the focus; all 0 where there is no point.
        limits: ``(n,)`` -1 where the focus would lie farther than the lens reaches, 1 where nearer, else 0.
    """

    w: DoubleArray
    f_stops: DoubleArray
    excess: DoubleArray
    decides: DoubleArray
    limits: NDArray[np.int8]

    @property
    def holds(self) -> BoolArray:
        """Mask ``(n,)`` of frames in which every point keeps to its circle."""
        return np.asarray(self.excess <= _HELD)


@dataclass(frozen=True, eq=False)
class StopSolutions:
    """Focus distances and f-numbers over n frames, and the points that decide them.

    Attributes:
        focus: the distances; shares are those of the two points that decide.
        f_stops: ``(n,)``.
        holds: ``(n,)`` whether every point keeps to its circle of confusion.
    """

    focus: FocusSolutions
    f_stops: DoubleArray
    holds: BoolArray


def split(
    w: ArrayLike,
    circles_mm: ArrayLike,
    law: LensLaw,
    *,
    counting: ArrayLike = True,
    f_stop_range: tuple[float, float] = (0.0, 0.0),
) -> Split:
    """Split focus and f-number between k points for n frames, for any lens.

    Args:
        w: ``(n, k)`` inverse depths, 1/m; below 0 where a tilted lens would be focused there for a point to be sharp.
        circles_mm: ``(n, k)`` or less: diameter on the film that each may have.
        law: of the lens, for each frame or one for all. Its f-numbers are kept where points leave them free: where there is none,
            or all are equally far.
        counting: ``(n, k)`` or less: which points count.
        f_stop_range: f-numbers wide open and stopped down; 0 leaves an end unbounded. A lens of glass opens no wider than it can.

    Raises:
        SettingsError: a number is out of range.
    """
    w = np.asarray(w, np.float64)
    circles = np.broadcast_to(np.asarray(circles_mm, np.float64), w.shape)
    counts = np.broadcast_to(np.asarray(counting, np.bool_), w.shape)
    _check(w, circles, counts, f_stop_range)
    some = counts.any(axis=1)
    empty_column = np.zeros((len(w), 1))  # columns for frames without points
    w, circles = np.concatenate([w, empty_column], axis=1), np.concatenate([circles, empty_column + 1], axis=1)
    counts = np.concatenate([counts, empty_column > 0], axis=1)
    near, far, tension = _pair(w, circles, counts)
    pull = [np.take_along_axis(circles, at[:, None], axis=1)[:, 0] for at in (near, far)]
    wished = np.where(some, np.take_along_axis(w, near[:, None], axis=1)[:, 0] - tension * pull[0], 0.0)
    x = np.clip(wished, law.far_w, law.near_w)
    tension = np.max(np.where(counts, np.abs(w - x[:, None]) / circles, 0.0), axis=1, initial=0.0)
    needed = np.where(tension > 0, law.slope_at_f1_mm_m(x) * tension, law.f_stops)
    widest = np.maximum(np.maximum(f_stop_range[0], WIDEST_OF_ALL), law.widest_f_stops)
    narrowest = np.maximum(f_stop_range[1] or math.inf, widest)
    f_stops = np.where(some & (needed > 0), np.clip(needed, widest, narrowest), law.f_stops)
    decides = np.zeros(w.shape)
    rows = np.flatnonzero(some)
    part = np.where(near == far, 1.0, pull[1] / (pull[0] + pull[1]))
    decides[rows, near[rows]] = part[rows]
    decides[rows, far[rows]] += (1 - part)[rows]
    return Split(
        w=x,
        f_stops=f_stops,
        excess=np.where(tension > 0, law.slope_at_f1_mm_m(x) * tension / np.where(f_stops > 0, f_stops, np.inf), 0.0),
        decides=decides[:, :-1],
        limits=(some * (np.sign(wished - x) * (np.abs(wished - x) > 1e-12 * np.abs(x)))).astype(np.int8),
    )


def stops_for(
    targets: FocusTargets,
    law: LensLaw,
    coc_limits_mm: ArrayLike,
    *,
    camera_distances_m: ArrayLike = math.inf,
    tilts: ArrayLike = 0.0,
    f_stop_range: tuple[float, float] = (0.0, 0.0),
    keep_outside: bool = False,
    occluded: Occluded = "keep",
) -> StopSolutions:
    """Focus distances and f-numbers that hold focus points: a sharp one within its blur, or the limit where it has none; a soft
    one at its blur at most, or within the limit where it is soft by a distance.

    A point whose weight (faded and beside others, as seen) is below 1, or below the heaviest point's where none has 1, may have
    a circle that much larger, so that points come and go without a jump. Where none counts, the camera's own focus and f-number
    are kept.

    Args:
        targets: k focus points over n frames.
        law: of the lens, at the camera's own f-numbers.
        coc_limits_mm: ``(n,)`` or one for all: diameter on the film that counts as sharp.
        camera_distances_m: ``(n,)`` or one for all; 0 or infinite is infinity.
        tilts: ``(n, 2)`` of the plane of focus of a lens that is tilted, or 0, as in `render.focus.solve.solve_distances`.
        f_stop_range: f-numbers wide open and stopped down; 0 leaves an end unbounded.
        keep_outside: let points outside the picture count too.
        occluded: what becomes of hidden points, as in `render.focus.solve.solve_distances`.

    Raises:
        SettingsError: a number is out of range.
    """
    if law.frames not in (1, targets.frames):
        raise SettingsError(f"a focus law of {law.frames} frames does not go with {targets.frames} frames of points")
    codes = state_codes(targets, np.ones(1, np.bool_), keep_outside=keep_outside, occluded=occluded)
    weights = strengths(targets, codes == STATES.index("used"), occluded)
    full = np.clip(weights.max(axis=1, keepdims=True, initial=0.0), np.finfo(np.float64).tiny, 1.0)
    counting = weights > 1e-12 * full
    limits_mm = np.broadcast_to(np.asarray(coc_limits_mm, np.float64), (targets.frames,))[:, None]
    circles = np.where(targets.blurs_mm > 0, targets.blurs_mm, limits_mm)
    circles = circles / np.where(counting, np.minimum(weights / full, 1.0), 1.0)
    best = split(targets.axis_w(tilts), circles, law, counting=counting, f_stop_range=f_stop_range)
    some = counting.any(axis=1)
    own_m = np.broadcast_to(np.asarray(camera_distances_m, np.float64), some.shape)
    own_m = np.where(own_m > 0, own_m, np.inf)
    with np.errstate(divide="ignore"):
        distances_m = np.where(some, 1 / best.w, own_m)
    sources: list[FocusSource] = ["points" if by_points else "camera" for by_points in some.tolist()]
    limits: list[FocusLimit] = [_LIMITS[end] for end in best.limits.tolist()]
    focus = FocusSolutions(
        focus_distance_m=distances_m,
        shares=best.decides,
        state_codes=codes,
        sources=tuple(sources),
        reasons=tuple(_reason(targets, codes, best, frame) for frame in range(targets.frames)),
        limits=tuple(limits),
    )
    return StopSolutions(focus, best.f_stops, best.holds)


def _pair(
    w: DoubleArray, circles: DoubleArray, counts: BoolArray
) -> tuple[NDArray[np.intp], NDArray[np.intp], DoubleArray]:
    """Indices of the two points that decide, the nearer first, and the focus's distance from each in circles: ``(n,)`` each."""
    near_w, far_w = np.where(counts, w, -np.inf), np.where(counts, w, np.inf)
    rows = np.arange(len(w))
    tension = np.zeros(len(w))
    while True:
        near = np.argmax(near_w - tension[:, None] * circles, axis=1)
        far = np.argmin(far_w + tension[:, None] * circles, axis=1)
        apart = w[rows, near] - w[rows, far]
        larger = np.maximum(apart / (circles[rows, near] + circles[rows, far]), 0.0)
        grows = larger > tension * (1 + 1e-13)
        if not grows.any():
            return near, far, tension
        tension = np.where(grows, larger, tension)


def _reason(targets: FocusTargets, codes: NDArray[np.int8], best: Split, frame: int) -> str:
    deciding = [targets.names[i] for i in np.flatnonzero(best.decides[frame]).tolist()]
    if not deciding:
        return why(targets.names, codes[frame], False)
    f_stop, excess = best.f_stops[frame], best.excess[frame]
    summary = f"split between {' and '.join(deciding)}" if len(deciding) > 1 else f"focused by {deciding[0]}"
    if best.holds[frame]:
        return f"{summary} at f/{f_stop:.3g}, which holds every point within its circle of confusion"
    return (
        f"{summary} at f/{f_stop:.3g}, as far as the lens stops down: circles of confusion are up to {excess:.3g} times what "
        "they may be"
    )


def _check(w: DoubleArray, circles: DoubleArray, counts: BoolArray, f_stop_range: tuple[float, float]) -> None:
    if not np.isfinite(w[counts]).all():
        raise SettingsError("the best stop needs points at finite inverse depths")
    if not (np.isfinite(circles[counts]).all() and (circles[counts] > 0).all()):
        raise SettingsError("the circles of confusion that points may have must be finite and above 0 mm")
    widest, narrowest = f_stop_range
    if not (widest >= 0 and narrowest >= 0 and (narrowest == 0 or narrowest >= widest)):
        raise SettingsError(
            f"a lens's f-numbers must go from wide open to stopped down (0 leaves an end open), got {widest:g} to "
            f"{narrowest:g}"
        )


_LIMITS: dict[int, FocusLimit] = {-1: "infinity", 0: "", 1: "close_focus"}
