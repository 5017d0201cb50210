"""Plane of focus that points request, and the nearest plane that a lens can reach.

Fits are weighted least squares in inverse depth w, in which every plane of the world is affine in the slopes s = (X/z, Y/z): the
circle of confusion of a point is proportional to its w less the plane's. Over many frames planes are arrays ``(n, 3)`` of w0,
slope_x and slope_y, as in `render.model.focal_surface.FocalPlane`; `render.focus.tilt` turns them into tilt and swing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from render.errors import SettingsError
from render.focus.points import FocusTargets
from render.model.arrays import BoolArray, DoubleArray
from render.model.focal_surface import FocalPlane

FLAT_SLOPE = 3e-5
"""Points that spread no farther across a direction than this, a few hundredths of a pixel, say nothing about tilt along it.

There the tilt fades out rather than ends, so that points which come into line do not make the plane jump.
"""


@dataclass(frozen=True)
class PlaneFit:
    """The plane of focus through points at one time.

    Attributes:
        plane: the plane.
        rank: 1 where the points fix a distance alone, 2 where they lie on a line of the picture, so that it is the plane of
            least tilt through them, 3 where they fix a plane; 0 where there are none.
        residual: root of the weighted mean square by which the points' w misses the plane, 1/m.
    """

    plane: FocalPlane
    rank: int
    residual: float

    @property
    def reason(self) -> str:
        """Degrees of freedom that the points fix, in one sentence."""
        return _REASONS[self.rank]


@dataclass(frozen=True, eq=False)
class PlaneFits:
    """Planes of focus over n frames; see `PlaneFit`.

    Attributes:
        planes: ``(n, 3)``.
        ranks: ``(n,)``.
        residuals: ``(n,)``.
    """

    planes: DoubleArray
    ranks: NDArray[np.intp]
    residuals: DoubleArray

    def at(self, frame: int) -> PlaneFit:
        """The fit at one frame.

        Args:
            frame: index of it.
        """
        return PlaneFit(as_plane(self.planes[frame]), int(self.ranks[frame]), float(self.residuals[frame]))


def fit_planes(slopes: ArrayLike, w: ArrayLike, weights: ArrayLike = 1.0) -> PlaneFits:
    """Fit the planes of least blur: weighted least squares in w, with the least tilt where several fit equally.

    Args:
        slopes: ``(n, k, 2)`` places of k points in n frames; positions of weight 0 are ignored.
        w: ``(n, k)`` inverse depths, 1/m.
        weights: ``(n, k)`` or one for all, 0 or more.

    Raises:
        SettingsError: a weight is negative or not finite, or a point that has one has no finite place.
    """
    s, w, weights = _points(slopes, w, weights)
    total = weights.sum(axis=1)
    a = weights / np.where(total > 0, total, 1.0)[:, None]
    middle_s, middle_w = (a[..., None] * s).sum(axis=1), (a * w).sum(axis=1)
    off_s, off_w = s - middle_s[:, None], w - middle_w[:, None]
    spreads, axes = np.linalg.eigh(np.einsum("nk,nki,nkj->nij", a, off_s, off_s))
    spreads = np.maximum(spreads, 0.0)
    along = np.einsum("nij,ni->nj", axes, np.einsum("nk,nk,nki->ni", a, off_w, off_s))
    along *= spreads / (spreads**2 + FLAT_SLOPE**4)
    tilt = np.einsum("nij,nj->ni", axes, along)
    planes = np.concatenate([(middle_w - (tilt * middle_s).sum(axis=1))[:, None], tilt], axis=1)
    ranks = np.where(total > 0, 1 + (spreads > FLAT_SLOPE**2).sum(axis=1), 0)
    return PlaneFits(planes, ranks, _misses(planes, s, w, a))


def plane_through(slopes: ArrayLike, w: ArrayLike, weights: ArrayLike = 1.0) -> PlaneFit:
    """Fit the plane of focus through points at one time (`fit_planes`).

    Args:
        slopes: ``(k, 2)``.
        w: ``(k,)`` inverse depths, 1/m.
        weights: ``(k,)`` or one for all.

    Raises:
        SettingsError: see `fit_planes`.
    """
    return fit_planes(np.asarray(slopes)[None], np.asarray(w)[None], weights).at(0)


def fit_targets(
    targets: FocusTargets, shares: DoubleArray, coc_slopes_mm_m: ArrayLike = 0.0
) -> tuple[PlaneFits, DoubleArray]:
    """Planes that focus points request, sharp and soft ones.

    A soft point wants the plane off it by its circle of confusion, on the side on which the plane through the sharp points passes
    it (the plane through all, where none is sharp); a plane that passes right through it goes behind.

    Args:
        targets: k points over n frames.
        shares: ``(n, k)`` shares of the points, as in `render.focus.solve.FocusSolutions`.
        coc_slopes_mm_m: ``(n,)`` or one for all: growth of the circle of confusion; 0 for a pinhole.

    Returns:
        The planes, and ``(n, k)`` the w that they were fitted to, for `limit_planes`.
    """
    growth = column_of(coc_slopes_mm_m, targets.frames)[:, None]
    blurred = targets.is_blurred & (growth > 0)
    off = np.where(blurred, targets.blurs_mm / np.where(growth > 0, growth, 1.0), 0.0)
    slopes, own_w = np.where((shares > 0)[..., None], targets.slopes, 0.0), targets.aims_w
    sharp = np.where(blurred, 0.0, shares)
    fits = fit_planes(slopes, own_w, np.where(sharp.any(axis=1, keepdims=True), sharp, shares))
    if not off.any():
        return fits, own_w
    passing = fits.planes[:, :1] + (slopes * fits.planes[:, None, 1:]).sum(axis=-1)
    target_w = own_w + np.where(passing > own_w, off, -off)
    return fit_planes(slopes, target_w, shares), target_w


def limit_planes(
    planes: DoubleArray,
    focal_lengths_mm: ArrayLike,
    max_angles_rad: ArrayLike,
    slopes: ArrayLike,
    w: ArrayLike,
    weights: ArrayLike = 1.0,
) -> tuple[DoubleArray, BoolArray]:
    """Limit planes to what a lens can reach, in the direction in which they are tilted.

    A plane that nears the pupil, where it would hold the view axis itself, needs a tilt without end: it is tilted by at most the
    largest angle. A plane that the view axis meets behind the camera cannot be written as a focus distance: it is tilted no
    farther than parallel to the axis. Within these ends, tilt and distance leave the points the least blur.

    Args:
        planes: ``(n, 3)``.
        focal_lengths_mm: ``(n,)`` or one for all.
        max_angles_rad: ``(n,)`` or one for all: how far tilt and swing may turn the lens together, below a right angle.
        slopes: ``(n, k, 2)`` as in `fit_planes`.
        w: ``(n, k)``.
        weights: ``(n, k)`` or one for all.

    Returns:
        ``(n, 3)`` planes, and ``(n,)`` whether each was changed.

    Raises:
        SettingsError: an angle is not from 0 to below a right angle, or see `fit_planes`.
    """
    angle = column_of(max_angles_rad, len(planes))
    if not ((angle >= 0) & (angle < math.pi / 2)).all():
        raise SettingsError(
            f"the largest angle of a lens must be from 0 to below 90 degrees, got {np.degrees(angle).max():g}",
            code="bad_tilt",
        )
    s, w, weights = _points(slopes, w, weights)
    steepest = np.sin(angle) / (column_of(focal_lengths_mm, len(planes)) / 1000)
    steepness = np.hypot(planes[:, 1], planes[:, 2])
    changed = (steepness > steepest) | (planes[:, 0] < 0)
    direction = planes[:, 1:] / np.where(steepness > 0, steepness, 1.0)[:, None]
    along = (s * direction[:, None]).sum(axis=-1)
    w0, tilt = _least_blur(along, w, weights, steepest)
    limit_plane = np.concatenate([w0[:, None], tilt[:, None] * direction], axis=1)
    return np.where(changed[:, None], limit_plane, planes), changed


def limit_plane(
    plane: FocalPlane,
    focal_length_mm: float,
    max_angle_rad: float,
    slopes: ArrayLike,
    w: ArrayLike,
    weights: ArrayLike = 1.0,
) -> tuple[FocalPlane, bool]:
    """Limit a plane to what a lens can reach (`limit_planes`); also return whether it was changed.

    Args:
        plane: the plane.
        focal_length_mm: of the lens.
        max_angle_rad: how far tilt and swing may turn it together.
        slopes: ``(k, 2)`` of the points.
        w: ``(k,)`` of the points.
        weights: ``(k,)`` or one for all.

    Raises:
        SettingsError: see `limit_planes`.
    """
    planes, changed = limit_planes(
        as_row(plane), focal_length_mm, max_angle_rad, np.asarray(slopes)[None], np.asarray(w)[None], weights
    )
    return as_plane(planes[0]), bool(changed[0])


def _least_blur(
    along: DoubleArray, w: DoubleArray, weights: DoubleArray, steepest: DoubleArray
) -> tuple[DoubleArray, DoubleArray]:
    """Minimise ``Σ a (w0 + tilt·along − w)²`` over w0 ≥ 0 and a tilt from 0 to the steepest: ``(n,)`` each.

    The sum is convex, so its least lies inside, or is the least of its least places on the four edges.
    """
    total = weights.sum(axis=1)
    a = weights / np.where(total > 0, total, 1.0)[:, None]
    u, v = (a * along).sum(axis=1), (a * w).sum(axis=1)
    uu, uv = (a * along**2).sum(axis=1), (a * along * w).sum(axis=1)
    spread = uu - u**2
    inside = np.where(spread > FLAT_SLOPE**2, (uv - u * v) / np.maximum(spread, FLAT_SLOPE**2), 0.0)
    on_axis = np.where(uu > 0, uv / np.where(uu > 0, uu, 1.0), 0.0)  # parallel to it: w0 is 0
    tilts = np.stack([np.clip(tilt, 0, steepest) for tilt in (inside, 0 * v, steepest, on_axis)])
    w0s = np.maximum(v - tilts * u, 0.0)
    w0s[3] = 0.0
    blur = w0s**2 + 2 * w0s * (tilts * u - v) + tilts**2 * uu - 2 * tilts * uv
    free = (inside >= 0) & (inside <= steepest) & (v - inside * u >= 0)
    best = np.where(free, 0, np.argmin(blur, axis=0))[None]
    return np.take_along_axis(w0s, best, 0)[0], np.take_along_axis(tilts, best, 0)[0]


def _points(slopes: ArrayLike, w: ArrayLike, weights: ArrayLike) -> tuple[DoubleArray, DoubleArray, DoubleArray]:
    """Positions, w and weights of the points that count."""
    s, w = np.asarray(slopes, np.float64), np.asarray(w, np.float64)
    weights = np.broadcast_to(np.asarray(weights, np.float64), w.shape)
    if not (np.isfinite(weights).all() and (weights >= 0).all()):
        raise SettingsError("the weights of the points of a plane must be finite and 0 or more", code="bad_focus_point")
    counting = weights > 0
    if not (np.isfinite(s[counting]).all() and np.isfinite(w[counting]).all()):
        raise SettingsError("the points of a plane must have finite places", code="bad_focus_point")
    return np.where(counting[..., None], s, 0.0), np.where(counting, w, 0.0), weights


def _misses(planes: DoubleArray, s: DoubleArray, w: DoubleArray, shares: DoubleArray) -> DoubleArray:
    off = w - planes[:, :1] - (s * planes[:, None, 1:]).sum(axis=-1)
    return np.asarray(np.sqrt((shares * off**2).sum(axis=1)))


def column_of(values: ArrayLike, frames: int) -> DoubleArray:
    """Column ``(n,)`` from a value per frame, or from one for all."""
    return np.broadcast_to(np.asarray(values, np.float64), (frames,))


def as_row(plane: FocalPlane) -> DoubleArray:
    """Planes ``(1, 3)`` over one frame."""
    return np.array([[plane.w0, plane.slope_x, plane.slope_y]])


def as_plane(row: DoubleArray) -> FocalPlane:
    """The plane of one frame ``(3,)``."""
    w0, slope_x, slope_y = row.tolist()
    return FocalPlane(w0, slope_x, slope_y)


_REASONS = {
    0: "no point asks for a plane of focus",
    1: "the points ask for one distance, so the plane of focus stands square to the view axis",
    2: "the points lie on one line of the picture, so the plane of focus is the one of least tilt through them",
    3: "the points ask for this plane of focus",
}
