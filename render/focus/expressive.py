"""Expressive focal surface through focus points, which no lens can make (Lee, Eisemann & Seidel 2010, section 5.2).

This makes the data of `render.model.focal_surface`; `render.focus.surface` evaluates it, and the tracer does so for each pixel.

A focus point comes and goes by its *fade*, from 1 (there) to 0 (not there): as it is switched, hidden, or leaves the picture.
The surface changes continuously with it, everywhere at once, and for a fade of 0 it is the surface without the point. A smaller
weight alone would not do that: at its place a point wins over all others whatever its weight, so that the others' surface would
be left with a spike that grows thin but never low. So as a point fades its region shrinks with it, by its weight and its
falloff, and its value relaxes toward that of the stronger points at its position (`_relax_values`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from render.errors import SettingsError
from render.focus.overlap import OVERLAP_FRAME_WIDTHS, overlap_shares
from render.focus.surface import NEAREST_SLOPE, on_plane
from render.model.arrays import BoolArray, DoubleArray, IndexArray
from render.model.focal_surface import MAX_CONTROLS, Controls, FocalPlane

FADING_REACH_FRAME_WIDTHS = 2.0
"""Reach, in frame widths, of a half-faded point whose reach is unlimited: from most places of the picture, all of it."""

FADING_WEIGHT = 0.05
"""A weight below this share of the largest fades its point too, so that a weight keyed down to 0 makes no step at the end."""

_ABSENT = 1e-6
"""Fades below this are none."""

_LEAST_PRIORITY = 1e-6
"""Near priority makes no point count less than this share of the nearest: else far ones were lost to rounding."""


@dataclass(frozen=True, eq=False)
class SurfacePoints:
    """Focus points at one time, as input of the focal surface: k of each.

    Attributes:
        names: for messages.
        slopes: ``(k, 2)`` where they stand on the screen, x right, y up; not finite behind the camera.
        depths_m: ``(k,)`` along the view axis; NaN without a place.
        weights: ``(k,)`` α of Lee et al.: how large the region is in which the point has its way; 0 equals absence.
        soft: ``(k,)`` whether they must be soft and not sharp.
        blurs_mm: ``(k,)`` wanted diameter of a soft point's circle of confusion on the film; 0 leaves it to the offset.
        surface_offsets_m: ``(k,)`` for a soft point, how far behind it the focus shall lie; negative is before it.
        falloffs: ``(k,)`` frame widths at which their influence ends; 0 reaches everywhere.
        extents: ``(k,)`` depth of field around them relative to the lens's own, above 0.
        fades: ``(k,)`` from 0, not there, to 1.
        field_shifts_w: ``(k,)`` by how much the lens is sharpest nearer at each than where it is focused, 1/m.
    """

    names: Sequence[str]
    slopes: DoubleArray
    depths_m: DoubleArray
    weights: DoubleArray
    soft: BoolArray
    blurs_mm: DoubleArray
    surface_offsets_m: DoubleArray
    falloffs: DoubleArray
    extents: DoubleArray
    fades: DoubleArray
    field_shifts_w: DoubleArray

    def __post_init__(self) -> None:
        """Check shapes and ranges.

        Raises:
            SettingsError: a number is out of range; the message names the point.
        """
        count = len(self.names)
        if np.shape(self.slopes) != (count, 2) or any(len(getattr(self, field)) != count for field in _COLUMNS):
            raise SettingsError(f"every column of a focal surface's {count} focus points must be as long")
        for field, (what, low) in _RANGES.items():
            for name, value in zip(self.names, getattr(self, field), strict=True):
                if not (math.isfinite(value) and value >= low):
                    raise SettingsError(
                        f"the {what} of focus point {name!r} must be a finite number"
                        f"{'' if math.isinf(low) else f' of at least {low:g}'}, but it is {value:g}",
                        code="bad_focus_point",
                    )


_COLUMNS = (
    "depths_m",
    "weights",
    "soft",
    "blurs_mm",
    "surface_offsets_m",
    "falloffs",
    "extents",
    "fades",
    "field_shifts_w",
)
_RANGES = {
    "weights": ("weight", 0.0),
    "blurs_mm": ("blur in mm", 0.0),
    "surface_offsets_m": ("surface offset in m", -math.inf),
    "falloffs": ("falloff in frame widths", 0.0),
    "extents": ("extent", 1e-6),
    "fades": ("fade", 0.0),
}


def focal_controls(
    points: SurfacePoints,
    *,
    plane: FocalPlane,
    coc_slope_mm_m: float,
    frame_width: float,
    exponent: float = 3.0,
    near_priority: float = 0.0,
    sides: DoubleArray | None = None,
) -> Controls | None:
    """Control points of the focal surface that focus points request.

    At the place of a point that is all there, the surface has the focus that the point wants (`target_w`) and its extent,
    exactly. Soft points that overlap sharp ones on the screen fade with their distance to them (`render.focus.overlap`), and
    points of hardly any weight (`FADING_WEIGHT`) with their weight. Of more points than a surface has room for (`MAX_CONTROLS`)
    the strongest are taken.

    Args:
        points: at one time.
        plane: focus of the lens without them, which remains where none reaches, and as they fade.
        coc_slope_mm_m: growth of the circle of confusion with inverse depth, in mm of diameter for 1/m; 0 for a pinhole.
        frame_width: width of the film gate, slopes (`Frame`).
        exponent: β of Lee et al.: how local the points are; 2 to 4 look natural.
        near_priority: an exponent p that makes nearer points count more: weights are multiplied by (1 / depth in m)^p.
        sides: ``(k,)`` of each soft point, from `soft_sides`, to keep it from one frame to the next; None finds it.

    Returns:
        Values are w in 1/m and the natural logarithm of the extent; None where no point counts.

    Raises:
        SettingsError: the exponent is out of range.
    """
    targets = target_w(points, plane, coc_slope_mm_m, sides)
    is_placed = np.isfinite(targets) & np.isfinite(points.slopes).all(-1) & (points.weights > 0)
    heaviest = np.max(points.weights, where=is_placed, initial=0.0)
    fades = np.where(is_placed, np.minimum(points.fades, 1.0), 0.0)
    fades = fades * np.minimum(points.weights / max(heaviest * FADING_WEIGHT, 1e-300), 1.0)
    fades = fades * _overlap_shares(points, fades, frame_width)
    order = np.argsort(-fades, kind="stable")
    order = order[fades[order] > _ABSENT]
    if len(order) == 0:
        return None
    weights = _prior_weights(points, order, near_priority)
    strongest = np.sort(np.argsort(-weights * fades[order], kind="stable")[:MAX_CONTROLS])
    order, weights = order[strongest], weights[strongest]
    places, fades = points.slopes[order], fades[order]
    base = np.stack([on_plane(plane, places), np.zeros(len(order))], axis=-1)
    controls = Controls(
        places,
        np.stack([targets[order], np.log(points.extents[order])], axis=-1),
        weights * fades**exponent,  # at the edge of a region α/d^β equals the others': the region shrinks with the fade
        _fading_falloffs(points.falloffs[order] * frame_width, fades, FADING_REACH_FRAME_WIDTHS * frame_width),
        exponent,
    )
    return _relax_values(controls, fades, base)


def _prior_weights(points: SurfacePoints, order: IndexArray, near_priority: float) -> DoubleArray:
    """Weights of the points in the given order, larger for nearer points; at most 1."""
    near = np.asarray(1 / points.depths_m[order])
    weights = points.weights[order] / points.weights[order].max()
    return np.asarray(weights * np.maximum((near / max(near.max(), 1e-300)) ** near_priority, _LEAST_PRIORITY))


def target_w(
    points: SurfacePoints, plane: FocalPlane, coc_slope_mm_m: float, sides: DoubleArray | None = None
) -> DoubleArray:
    """Inverse depth of the focus that each point requests.

    A sharp point requests its own depth. A soft one requests a focus beside it: by its offset along the view axis, or, where its
    blur is given, by the distance that gives that circle of confusion with the pupil scaled by its extent.

    Args:
        points: at one time.
        plane: where the lens is focused without them.
        coc_slope_mm_m: growth of the circle of confusion with inverse depth; 0 for a pinhole.
        sides: as in `focal_controls`.

    Returns:
        ``(k,)`` 1/m; NaN where a point has no place, is behind the camera, or wants what cannot be: focus behind the camera, or
        blur of a pinhole.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        shifts = (
            points.field_shifts_w * points.extents
        )  # a smaller pupil leaves the curved field as far off, so more of w
        w = np.where(points.depths_m > 0, 1 / points.depths_m, np.nan)
        is_blurred = points.soft & (points.blurs_mm > 0)
        off = np.where(is_blurred, points.blurs_mm * points.extents / coc_slope_mm_m, 0.0)
        aims_m = points.depths_m + np.where(points.soft & ~is_blurred, points.surface_offsets_m, 0.0)
        aims = np.where(aims_m > 0, 1 / aims_m, np.nan)
        base = on_plane(plane, points.slopes)
        if sides is None:
            sides = soft_sides(w[None] - shifts, base[None], off[None])
        targets = np.where(is_blurred, np.where(np.isfinite(off), w + sides * off, np.nan), np.where(w > 0, aims, w))
        return targets - shifts


def soft_sides(w: DoubleArray, base_w: DoubleArray, off: DoubleArray) -> DoubleArray:
    """Side of each soft point on which the focus lies, over one frame or a whole shot.

    It goes to the side on which the lens is focused anyway, so that the surface bends as little as may be; but to the near side
    where the far one lies beyond infinity. A point that is followed through a shot must keep its side, or its blur would jump.

    Args:
        w: ``(frames, k)`` inverse depths of the points, 1/m; NaN without a place.
        base_w: ``(frames, k)`` where the lens is focused at their places without them.
        off: ``(frames, k)`` how far from the points the focus must be, 1/m.

    Returns:
        ``(k,)`` 1 where the focus goes before the point, -1 where it goes behind it.
    """
    with np.errstate(invalid="ignore"):
        goes_before = np.nansum(base_w - w, axis=0) >= 0
        return np.where(goes_before | (w - off < 0).any(axis=0), 1.0, -1.0)


def _overlap_shares(points: SurfacePoints, fades: DoubleArray, frame_width: float) -> DoubleArray:
    """Shares ``(k,)`` of their influence that soft points keep beside sharp ones, as in solving for one distance."""
    reaches = np.full((1, len(fades)), OVERLAP_FRAME_WIDTHS * frame_width)
    strengths = (points.weights * fades)[None]
    sharp = (strengths > 0) & ~points.soft
    return np.asarray(overlap_shares(points.slopes[None], reaches, strengths, points.soft, sharp)[0])


def _fading_falloffs(falloffs: DoubleArray, fades: DoubleArray, half_faded: float) -> DoubleArray:
    """Falloffs ``(k,)`` of fading points, from near 0 to their own; those of 0 reach ``half_faded`` at a fade of a half."""
    everywhere = np.divide(fades * half_faded, 1 - fades, out=np.zeros_like(fades), where=fades < 1)
    return np.where(falloffs > 0, falloffs * fades, everywhere)


def _relax_values(controls: Controls, fades: DoubleArray, base: DoubleArray) -> Controls:
    """Relax the values of fading control points toward those of stronger points at their positions.

    A point of fade ``g`` has its own value by the share ``g``, and else the surface of those that are more there than it: each
    of them as far as ``1 − g / its own fade``. So for g toward 0 that is the whole surface of the others, and the order in which
    points overtake each other in fading makes no step.

    Args:
        controls: fades falling.
        fades: ``(k,)``.
        base: ``(k, m)`` values where there is nothing.
    """
    values = controls.values.copy()
    for i in np.flatnonzero(fades < 1):
        stronger = 1 - fades[i] / fades[:i]
        d2 = np.maximum(((controls.places[:i] - controls.places[i]) ** 2).sum(-1), NEAREST_SLOPE**2)
        squared = np.where(controls.falloffs[:i] > 0, controls.falloffs[:i], np.inf) ** 2
        reach = np.clip(1 - d2 / squared, 0, 1) ** 2
        lit = controls.weights[:i] * stronger * reach
        without = base[i]
        if (lit > 0).any():
            shares = lit * (d2[lit > 0].min() / d2) ** (controls.exponent / 2)
            held = 1 - np.prod(1 - stronger * reach)
            without = without + held * (shares @ values[:i] / shares.sum() - without)
        values[i] = without + fades[i] * (values[i] - without)
    return Controls(controls.places, values, controls.weights, controls.falloffs, controls.exponent)
