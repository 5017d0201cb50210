"""Sharpest inverse depth of each pixel, and growth of its circle of confusion: the curved surface of focus."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.optics.view import PinholeView
from render.trace.lens_fit import FULL, even_basis, odd_basis, open_rays, pupil_nodes, slope_errors
from render.trace.lens_table import FRONT_RIM, PUPIL_S, PUPIL_T, WEIGHT, GridTable, PolynomialTable
from render.trace.picture_focus import PictureFocus
from render.trace.rays import RayBundle

_NODES = 256


@dataclass(frozen=True, eq=False)
class Sharpness:
    """Sharpness of each pixel, ``(height, width)``.

    Attributes:
        w: inverse depth at which the pixel is sharpest, 1/m.
        pupil_m: radius of the pupil that the pixel sees: a disc with the same spread as its rays.
    """

    w: DoubleArray
    pupil_m: DoubleArray


def measure_sharpness(bundle: RayBundle, focus: PictureFocus, view: PinholeView) -> Sharpness:
    """Fit the least spread of each pixel's rays: ``s(w) = δ + X·(w - w_f)`` is least where ``w = w_f - ⟨δ·X⟩ / ⟨X·X⟩``."""
    x, y = np.meshgrid(np.arange(view.width) + 0.5, np.arange(view.height) + 0.5)
    w_f, pupil = focus.at(np.stack([x, y], axis=-1))
    if bundle.table is None:
        return Sharpness(w_f, pupil * max(bundle.pupil_m))
    if isinstance(bundle.table, GridTable):
        shift, radius = _over_fields(bundle.table, (x - view.cx) / view.fx, (y - view.cy) / view.fy)
        return Sharpness(w_f + shift / pupil, pupil * radius)
    heights = np.linspace(0.0, bundle.table.last_slope, bundle.table.rows.shape[1])
    shift, radius = _over_heights(bundle.table)
    height = np.hypot((x - view.cx) / view.fx, (y - view.cy) / view.fy)
    return Sharpness(w_f + np.interp(height, heights, shift) / pupil, pupil * np.interp(height, heights, radius))


def _over_heights(table: PolynomialTable) -> tuple[DoubleArray, DoubleArray]:
    """``(heights,)`` shift of the sharpest w and radius of the pupil, at the middle wavelength."""
    slope, pupil, is_open = rays_of_heights(table)
    shift, radius = find_least_spread(slope, pupil, is_open.astype(np.float64))
    return np.where(table.rows[len(table.rows) // 2, :, WEIGHT] > 0, shift, 0.0), radius


def rays_of_heights(table: PolynomialTable) -> tuple[DoubleArray, DoubleArray, NDArray[np.bool_]]:
    """``(heights, nodes, 2)`` slope errors and pupil points all over the pupil, at the middle wavelength, tangential first; and
    ``(heights, nodes)`` which of these rays get through."""
    rows = table.rows[len(table.rows) // 2].astype(np.float64)
    half = pupil_nodes(_NODES, rim=0)
    nodes = np.concatenate([half, half * [1.0, -1.0]])  # spread is relative to the middle of the whole disc
    along = rows[:, PUPIL_T:PUPIL_S] @ even_basis(nodes, FULL.pupil).T
    pupil = np.stack([along, rows[:, PUPIL_S:FRONT_RIM] @ odd_basis(nodes, FULL.pupil).T], axis=-1)
    return slope_errors(rows, nodes, table.slope_degree), pupil, open_rays(rows, nodes)


def _over_fields(table: GridTable, x: DoubleArray, y: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """The same for each pixel's nearest field point."""
    middle = len(table.rays) // 2
    fields = table.rays.shape[1]
    rays = table.rays[middle].reshape(fields, -1, 4).astype(np.float64)
    light = table.light[middle].reshape(fields, -1, 2)
    side = np.linspace(-1.0, 1.0, table.rays.shape[2])
    on_disc = (np.hypot(*np.meshgrid(side, side)) <= 1).ravel()  # beyond it there is only the iris
    passing = np.where(on_disc & (light[..., 1] <= 0), light[..., 0], 0.0).astype(np.float64)
    shift, radius = find_least_spread(rays[..., :2], rays[..., 2:], passing)
    field = table.nearest_fields(x, y)
    return shift[field], radius[field]


def find_least_spread(slope: DoubleArray, pupil: DoubleArray, weight: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Inverse depth of least spread of the rays of fields.

    Args:
        slope: ``(fields, rays, 2)`` slope errors in the plane of focus.
        pupil: ``(fields, rays, 2)`` where the rays cross the pupil, m.
        weight: ``(fields, rays)``.

    Returns:
        ``(fields,)`` by how much its w exceeds that of the plane of focus, 1/m, 0 where no ray counts; and ``(fields,)`` the
        radius of the disc with the same spread on the pupil, m.
    """
    total = np.maximum(weight.sum(axis=1), 1e-300)[:, None, None]
    around = pupil - (pupil * weight[..., None]).sum(axis=1, keepdims=True) / total
    moment = (around**2).sum(-1)
    power = (moment * weight).sum(axis=1)
    shift = -((slope * around).sum(-1) * weight).sum(axis=1) / np.maximum(power, 1e-300)
    return np.where(power > 0, shift, 0.0), np.sqrt(2 * power / total[:, 0, 0])
