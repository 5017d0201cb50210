"""Tilted planes of focus: the tilt and swing of the lens that gives one, and the way back.

A thin lens whose axis is the unit vector n (x right, y up, z forward), before a film that stays square to the view axis at
distance v, is focused, in the direction of slopes s = (X/z, Y/z), at inverse depth

    w(s) = (n_x·s_x + n_y·s_y + n_z) / f − 1 / v

(the thin lens equation along n for a point and its image, divided by the point's depth). So a plane ``w = w0 + g·s`` needs
``n_x = f·g_x`` and ``n_y = f·g_y``, whatever its distance; the film then stands where w0 says. This holds Scheimpflug's rule and
Merklinger's hinge rule ("Focusing the View Camera", 1996, ch. 4 and 5): the plane meets the plane through the pupil that is
parallel to the film, z = 0, at a distance of ``1/|g| = f / sin(angle)``.

The lens is swung about the camera's +Y axis (positive looks to the left), then tilted about the camera's +X axis (positive looks
up). Over many frames planes are arrays ``(n, 3)`` of w0, slope_x and slope_y, as in `render.model.focal_surface.FocalPlane`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from render.errors import SettingsError
from render.focus.plane_fit import (
    PlaneFit,
    PlaneFits,
    as_plane,
    as_row,
    column_of,
    fit_planes,
    fit_targets,
    limit_plane,
    limit_planes,
    plane_through,
)
from render.model.arrays import DoubleArray
from render.model.focal_surface import FocalPlane

__all__ = [
    "PlaneFit",
    "PlaneFits",
    "fit_planes",
    "fit_targets",
    "hinge_m",
    "lens_axes",
    "lens_axis",
    "limit_plane",
    "limit_planes",
    "plane_of",
    "plane_through",
    "planes_of",
    "tilt_and_swing",
    "tilts_and_swings",
]


def lens_axes(planes: DoubleArray, focal_lengths_mm: ArrayLike) -> DoubleArray:
    """``(n, 3)`` unit axes (x right, y up, z forward) of the lenses that give the planes.

    Args:
        planes: ``(n, 3)``.
        focal_lengths_mm: ``(n,)`` or one for all.

    Raises:
        SettingsError: no lens of that focal length turns so far: the plane comes nearer to it than its focal length.
    """
    across = planes[:, 1:] * (column_of(focal_lengths_mm, len(planes)) / 1000)[:, None]
    turned = (across**2).sum(axis=1)
    if not (turned < 1).all():
        frame = int(np.argmin(turned < 1))
        away_m = 1 / np.hypot(*planes[frame, 1:])
        raise SettingsError(
            f"no tilt gives a plane of focus that passes {away_m:.3g} m beside the lens: expected more than its focal length",
            code="bad_tilt",
        )
    return np.concatenate([across, np.sqrt(1 - turned)[:, None]], axis=1)


def lens_axis(plane: FocalPlane, focal_length_mm: float) -> DoubleArray:
    """``(3,)`` the unit axis of the lens that gives a plane (`lens_axes`).

    Args:
        plane: the plane.
        focal_length_mm: of the lens.

    Raises:
        SettingsError: see `lens_axes`.
    """
    return np.asarray(lens_axes(as_row(plane), focal_length_mm)[0])


def tilts_and_swings(planes: DoubleArray, focal_lengths_mm: ArrayLike) -> DoubleArray:
    """``(n, 2)`` tilt and swing in radians of the lenses that give the planes.

    Args:
        planes: ``(n, 3)``.
        focal_lengths_mm: ``(n,)`` or one for all.

    Raises:
        SettingsError: see `lens_axes`.
    """
    axes = lens_axes(planes, focal_lengths_mm)
    return np.stack([np.arctan2(axes[:, 1], axes[:, 2]), np.arcsin(-axes[:, 0])], axis=1)


def tilt_and_swing(plane: FocalPlane, focal_length_mm: float) -> tuple[float, float]:
    """Tilt and swing in radians of the lens that gives a plane (`tilts_and_swings`).

    Args:
        plane: the plane.
        focal_length_mm: of the lens.

    Raises:
        SettingsError: see `lens_axes`.
    """
    tilt, swing = tilts_and_swings(as_row(plane), focal_length_mm)[0].tolist()
    return tilt, swing


def planes_of(
    tilts_rad: ArrayLike, swings_rad: ArrayLike, focus_distances_m: ArrayLike, focal_lengths_mm: ArrayLike
) -> DoubleArray:
    """``(n, 3)`` the planes of lenses that are turned by hand.

    Args:
        tilts_rad: ``(n,)`` or one for all; positive looks up.
        swings_rad: the same for the swing; positive looks to the left.
        focus_distances_m: where the planes meet the view axis; 0 or infinite for those parallel to it.
        focal_lengths_mm: of the lenses.
    """
    tilt, swing, distance, focal = np.broadcast_arrays(
        *(
            np.atleast_1d(np.asarray(a, np.float64))
            for a in (tilts_rad, swings_rad, focus_distances_m, focal_lengths_mm)
        )
    )
    w0 = np.where(distance > 0, 1 / np.where(distance > 0, distance, 1.0), 0.0)
    across = np.stack([-np.sin(swing), np.cos(swing) * np.sin(tilt)], axis=1) * 1000 / focal[:, None]
    return np.concatenate([w0[:, None], across], axis=1)


def plane_of(tilt_rad: float, swing_rad: float, focus_distance_m: float, focal_length_mm: float) -> FocalPlane:
    """The plane of a lens that is turned by hand (`planes_of`).

    Args:
        tilt_rad: positive looks up.
        swing_rad: positive looks to the left.
        focus_distance_m: where the plane meets the view axis; 0 or infinite for one parallel to it.
        focal_length_mm: of the lens.
    """
    return as_plane(planes_of(tilt_rad, swing_rad, focus_distance_m, focal_length_mm)[0])


def hinge_m(plane: FocalPlane) -> float:
    """Distance from the pupil's centre to the hinge: the line in the plane z = 0 about which the focal plane swings.

    Args:
        plane: plane of focus.

    Returns:
        ``f / sin(angle)`` in metres; infinite for an upright plane.
    """
    steepness = math.hypot(plane.slope_x, plane.slope_y)
    return 1 / steepness if steepness > 0 else math.inf
