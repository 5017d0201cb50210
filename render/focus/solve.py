"""From focus points to focus distances, frame by frame.

The circle of confusion grows in proportion to the difference in *inverse* depth (DESIGN section 2), so the focus
is solved for there: it minimises

    E(w_f) = Σ a_i · (s(w_f)·|w_i − w_f| − c_i)²        w = 1 / depth, a_i the weight

where s is the growth of the circle of confusion and ``c_i`` is 0 for a point that must be sharp and, for one that must be soft by
a circle of confusion, that circle. (A point that must be soft by a distance requests a focus that far behind it, which is its
``w_i``.) With sharp points alone and a thin lens this is their weighted mean inverse depth: one point gets the focus whole, and a
cross-fade of weights racks from one to the other at the pace at which an eye sees blur change.

All is done for all frames at once, on arrays of frames by points (`render.focus.least_squares`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from render.errors import SettingsError
from render.focus.influence import STATES, Occluded, PointState, point_weights, state_codes
from render.focus.least_squares import BestFocus, best_focus
from render.focus.points import FocusTarget, FocusTargets
from render.model.arrays import BoolArray, DoubleArray
from render.model.lens_law import LensLaw

__all__ = [
    "STATES",
    "FocusLimit",
    "FocusSolution",
    "FocusSolutions",
    "FocusSource",
    "FocusTarget",
    "FocusTargets",
    "Occluded",
    "PointState",
    "kept_within",
    "solve_distances",
    "solve_focus",
    "why",
]


FocusSource = Literal["points", "camera"]
FocusLimit = Literal["", "close_focus", "infinity"]


@dataclass(frozen=True)
class FocusSolution:
    """Focus distance at one time, and the source that decides it.

    Attributes:
        focus_distance_m: depth of the plane of focus; infinite for infinity.
        source: ``points`` where points decided, ``camera`` where the camera's own distance was kept.
        reason: reason in one sentence.
        shares: for each given point, its share of the weight that decided, 0 to 1; they add up to 1, or to 0 where no
            point counts.
        states: for each given point, what became of it.
        limit: end of the lens's range that the focus was clamped to, where the points request more.
    """

    focus_distance_m: float
    source: FocusSource
    reason: str
    shares: tuple[float, ...] = ()
    states: tuple[PointState, ...] = ()
    limit: FocusLimit = ""


@dataclass(frozen=True, eq=False)
class FocusSolutions:
    """Focus distances over n frames, and the points that decide them; see `FocusSolution`.

    Attributes:
        focus_distance_m: ``(n,)``.
        shares: ``(n, k)``.
        state_codes: ``(n, k)`` int8 indices into `STATES`.
        sources: n sources.
        reasons: n sentences.
        limits: n limits.
    """

    focus_distance_m: DoubleArray
    shares: DoubleArray
    state_codes: NDArray[np.int8]
    sources: tuple[FocusSource, ...]
    reasons: tuple[str, ...]
    limits: tuple[FocusLimit, ...]

    @property
    def focus_w(self) -> DoubleArray:
        """Inverse depths ``(n,)`` of the focus, 1/m; 0 is infinity."""
        return np.asarray(1 / self.focus_distance_m)

    @property
    def states(self) -> NDArray[np.str_]:
        """States ``(n, k)`` of the points."""
        return np.array(STATES)[self.state_codes]

    def at(self, frame: int) -> FocusSolution:
        """The solution at one frame.

        Args:
            frame: index of it.
        """
        return FocusSolution(
            focus_distance_m=float(self.focus_distance_m[frame]),
            source=self.sources[frame],
            reason=self.reasons[frame],
            shares=tuple(self.shares[frame].tolist()),
            states=tuple(STATES[code] for code in self.state_codes[frame].tolist()),
            limit=self.limits[frame],
        )


def solve_distances(
    targets: FocusTargets,
    camera_distances_m: ArrayLike = math.inf,
    coc_slopes_mm_m: ArrayLike = 0.0,
    *,
    law: LensLaw | None = None,
    tilts: ArrayLike = 0.0,
    keep_outside: bool = False,
    near_priority: ArrayLike = 0.0,
    occluded: Occluded = "keep",
) -> FocusSolutions:
    """Solve for the focus distances of least error: weighted least squares of circles of confusion.

    Points that are disabled, of no weight, without a place, behind the camera or outside the picture do not count. Soft points
    that overlap sharp ones on the screen count less (`render.focus.overlap`).

    Args:
        targets: k focus points over n frames.
        camera_distances_m: ``(n,)`` or one for all: the camera's own focus distances, kept when no point counts; 0 or
            infinite is infinity. They also decide between two answers that serve equally well (a soft point may lie before or
            behind the focus).
        coc_slopes_mm_m: ``(n,)`` or one for all: `render.optics.depth_of_field.coc_slope_mm_m`, the growth of the circle of
            confusion of a thin lens that focuses anywhere and does not breathe; 0 for a pinhole.
        law: of any other lens, for each frame or one for all, in place of the slopes. Where it ends the focus ends, and the
            solution says so.
        tilts: ``(n, 2)`` of the plane of focus of a lens that is tilted (`render.focus.points.FocusTargets.axis_w`), or 0. The
            focus distance is then where that plane meets the view axis.
        keep_outside: let points outside the picture count too.
        near_priority: ``(n,)`` or one for all: an exponent p that makes nearer points count more: weights are multiplied by
            (1 / depth in m)^p.
        occluded: of points that something stands before: ``keep`` them, ``ignore`` those of which less than half is seen, or
            ``fade``: multiply weights by the visible share.

    Returns:
        The solutions.

    Raises:
        SettingsError: the near priority is negative or not finite, or an array has the wrong number of frames.
    """
    law = law or LensLaw.even(_frames(coc_slopes_mm_m, targets.frames, "growths of the circle of confusion"))
    if law.frames not in (1, targets.frames):
        raise SettingsError(f"a focus law of {law.frames} frames does not go with {targets.frames} frames of points")
    own_m = _frames(camera_distances_m, targets.frames, "camera distances")
    own_w = np.where(own_m > 0, 1 / np.where(own_m > 0, own_m, 1.0), 0.0)
    codes = state_codes(targets, law.f_stops > 0, keep_outside=keep_outside, occluded=occluded)
    used = codes == STATES.index("used")
    shares = point_weights(targets, used, _frames(near_priority, targets.frames, "near priorities"), occluded)
    decided = np.asarray(shares.any(axis=1))
    circles = np.where(used & targets.is_blurred, targets.blurs_mm, 0.0)
    best = best_focus(shares, np.where(used, targets.axis_w(tilts), 0.0), circles, law, own_w)
    w = np.where(decided, best.w, own_w)
    sources: list[FocusSource] = ["points" if by_points else "camera" for by_points in decided.tolist()]
    limits = tuple(_limits(best, decided))
    return FocusSolutions(
        focus_distance_m=np.where(w > 0, 1 / np.where(w > 0, w, 1.0), np.inf),
        shares=shares,
        state_codes=codes,
        sources=tuple(sources),
        reasons=_reasons(targets.names, codes, decided, limits, law),
        limits=limits,
    )


def kept_within(
    solutions: FocusSolutions, wished_w: DoubleArray, frames: BoolArray, names: Sequence[str], law: LensLaw
) -> FocusSolutions:
    """Solutions refocused in some frames, as near there as the lens reaches.

    Args:
        solutions: for n frames.
        wished_w: ``(n,)`` where else, 1/m.
        frames: ``(n,)`` in which.
        names: of the k points.
        law: of the lens, for each frame or one for all.
    """
    w = np.where(frames, np.clip(wished_w, law.far_w, law.near_w), solutions.focus_w)
    beyond = np.where(frames, np.sign(wished_w - w), 0.0).tolist()
    ends: dict[float, FocusLimit] = {-1.0: "infinity", 0.0: "", 1.0: "close_focus"}
    limits = tuple(
        ends[end] if is_elsewhere else limit
        for end, is_elsewhere, limit in zip(beyond, frames.tolist(), solutions.limits, strict=True)
    )
    decided = np.asarray(solutions.shares.any(axis=1))
    return replace(
        solutions,
        focus_distance_m=np.where(w > 0, 1 / np.where(w > 0, w, 1.0), np.inf),
        limits=limits,
        reasons=_reasons(names, solutions.state_codes, decided, limits, law),
    )


def solve_focus(
    points: Sequence[FocusTarget],
    camera_distance_m: float = math.inf,
    *,
    coc_slope_mm_m: float = 0.0,
    law: LensLaw | None = None,
    keep_outside: bool = False,
    near_priority: float = 0.0,
    occluded: Occluded = "keep",
) -> FocusSolution:
    """Solve for the focus distance of least error at one time (`solve_distances`).

    Args:
        points: the focus points.
        camera_distance_m: see `solve_distances`.
        coc_slope_mm_m: see `solve_distances`.
        law: see `solve_distances`.
        keep_outside: see `solve_distances`.
        near_priority: see `solve_distances`.
        occluded: see `solve_distances`.

    Raises:
        SettingsError: a weight, a blur or the near priority is negative or not finite, or an offset is not finite.
    """
    return solve_distances(
        FocusTargets.at_one_time(points),
        camera_distance_m,
        coc_slope_mm_m,
        law=law,
        keep_outside=keep_outside,
        near_priority=near_priority,
        occluded=occluded,
    ).at(0)


def _limits(best: BestFocus, decided: BoolArray) -> list[FocusLimit]:
    rows = zip(decided.tolist(), best.too_near.tolist(), best.too_far.tolist(), strict=True)
    return [
        "" if not by_points else "close_focus" if near else "infinity" if far else "" for by_points, near, far in rows
    ]


def _reasons(
    names: Sequence[str],
    codes: NDArray[np.int8],
    decided: BoolArray,
    limits: Sequence[FocusLimit],
    law: LensLaw,
) -> tuple[str, ...]:
    """Reason of every frame in a sentence; equal frames share it."""
    near_w, far_w = (np.broadcast_to(ends, len(codes)).tolist() for ends in (law.near_w, law.far_w))
    sentences: dict[tuple[bytes, bool], str] = {}
    reasons = []
    for row, by_points, limit, nearest, farthest in zip(codes, decided.tolist(), limits, near_w, far_w, strict=True):
        key = (row.tobytes(), by_points)
        if key not in sentences:
            sentences[key] = why(names, row, by_points)
        reasons.append(sentences[key] + _at_the_end(limit, nearest, farthest))
    return tuple(reasons)


def why(names: Sequence[str], codes: NDArray[np.int8], by_points: bool) -> str:
    """Reason in one sentence: the points that decide the focus at one time, or why none does.

    Args:
        names: of the k points.
        codes: ``(k,)`` indices into `STATES`.
        by_points: whether any point decided.
    """
    states = [STATES[code] for code in codes.tolist()]
    if by_points:
        return "focused by " + ", ".join(name for name, s in zip(names, states, strict=True) if s == "used")
    if not names:
        return "there is no focus point, so the camera's own focus distance is kept"
    states_text = ", ".join(f"{name} ({s.replace('_', ' ')})" for name, s in zip(names, states, strict=True))
    return f"no focus point counts, so the camera's own focus distance is kept: {states_text}"


def _at_the_end(limit: FocusLimit, near_w: float, far_w: float) -> str:
    if limit == "close_focus":
        return f", but the lens focuses no nearer than {1 / near_w:.4g} m"
    if limit == "infinity":
        return f", but the lens focuses no farther than {f'{1 / far_w:.4g} m' if far_w > 0 else 'infinity'}"
    return ""


def _frames(values: ArrayLike, frames: int, what: str) -> DoubleArray:
    """Column ``(n,)`` from a value per frame, or from one for all."""
    array = np.asarray(values, np.float64)
    if array.shape not in ((), (1,), (frames,)):
        raise SettingsError(f"expected {frames} {what}, one for each frame of the focus points, got {array.shape}")
    return np.broadcast_to(array, (frames,))
