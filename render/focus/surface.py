"""Evaluation of the focal surface: inverse depth in focus and relative pupil radius over the picture.

`render/shaders/trace/focal_surface.comp` is the same for the tracer; a test compares the two. The interpolation is
Shepard's
(1968), which is moving least squares with constants (Lancaster & Salkauskas 1981): it never leaves the range of its values, so
that it never requests a focus outside the points' range, as a fit of higher order would between and beyond them.
"""

from __future__ import annotations

import numpy as np

from render.model.arrays import DoubleArray
from render.model.focal_surface import Controls, FocalPlane, FocalSurface, HalfLens

NEAREST_SLOPE = 1e-7
"""Distances are no smaller than this, far below any pixel: a place's own weight stays finite, and its value all but alone."""


def on_plane(plane: FocalPlane, slopes: DoubleArray) -> DoubleArray:
    """Inverse depth ``(...)`` of a plane at slopes ``(..., 2)``."""
    return np.asarray(plane.w0 + plane.slope_x * slopes[..., 0] + plane.slope_y * slopes[..., 1])


def focused_at(surface: FocalSurface, slopes: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Inverse depth in focus and relative pupil radius at slopes.

    Args:
        surface: the surface.
        slopes: ``(..., 2)`` of object space, x right, y up.

    Returns:
        ``(...)`` w in 1/m, which is not above 0 where a tilted plane is passed at its vanishing line, and ``(...)`` the radius of
        the pupil there relative to the lens's own.
    """
    slopes = np.asarray(slopes, np.float64)
    w, log_pupil = on_plane(surface.plane, slopes), np.zeros(slopes.shape[:-1])
    if surface.controls is not None and surface.blend > 0:
        values, influence = interpolate(surface.controls, slopes)
        share = surface.blend * influence
        w = w + share * (values[..., 0] - w)
        log_pupil = -share * values[..., 1]
    for half in surface.halves:
        w = w + beyond_edge(half, slopes) * (half.w - w)
    if surface.bends is not None:
        values, influence = interpolate(surface.bends, slopes)
        w = w + influence * values[..., 0]
    return w, np.exp(log_pupil)


def interpolate(controls: Controls, slopes: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Interpolated values, and the share by which they apply.

    Args:
        controls: the control points.
        slopes: ``(..., 2)``.

    Returns:
        ``(..., m)`` values, 0 where no point reaches, and ``(...)`` from 0, where none does, to 1: 1 everywhere where one reaches
        everywhere, and at every place that has a weight.
    """
    away = slopes[..., None, :] - controls.places
    d2 = np.maximum((away**2).sum(-1), NEAREST_SLOPE**2)
    with np.errstate(divide="ignore"):
        reach = np.where(
            controls.falloffs > 0, np.clip(1 - d2 / np.maximum(controls.falloffs, 1e-30) ** 2, 0, 1) ** 2, 1.0
        )
    lit = controls.weights * reach
    nearest = np.where(lit > 0, d2, np.inf).min(axis=-1, keepdims=True, initial=np.inf)
    shares = lit * (np.where(np.isfinite(nearest), nearest, 1.0) / d2) ** (controls.exponent / 2)
    total = shares.sum(-1)
    values = (shares[..., None] * controls.values).sum(-2) / np.maximum(total, 1e-300)[..., None]
    influence = 1 - np.prod(np.where(controls.weights > 0, 1 - reach, 1.0), axis=-1)
    return np.where(total[..., None] > 0, values, 0.0), np.where(total > 0, influence, 0.0)


def beyond_edge(half: HalfLens, slopes: DoubleArray) -> DoubleArray:
    """Share ``(...)`` by which positions ``(..., 2)`` lie behind a half lens: 0 before its edge, 1 beyond."""
    along = slopes[..., 0] * half.direction[0] + slopes[..., 1] * half.direction[1] - half.offset
    t = np.clip(along / max(half.width, 1e-9) + 0.5, 0, 1)
    return np.asarray(t * t * (3 - 2 * t))
