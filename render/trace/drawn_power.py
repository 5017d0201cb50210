"""Lens tables with refractive power over the pupil drawn by hand (`render.optics.pupil_power`).

A ray through the point X of the pupil, whose radius is ρ, is focused nearer by ``Δw(ρ)``: its slope is off by ``−X·Δw(ρ)``. A
thin lens gets a grid over its pupil and shows the drawn curve exactly; so do lenses that have a grid. Lenses with a polynomial
table show it as far as polynomials of the seventh degree can: three bends from the centre to the edge.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import Lens
from render.optics.pupil_power import drawn_defocus
from render.trace.lens_fit import BOUND_MARGIN, even_basis, odd_basis, pupil_nodes
from render.trace.lens_table import (
    BOUND,
    FRONT_RIM,
    PUPIL_S,
    PUPIL_T,
    SLOPE_S,
    SLOPE_T,
    GridTable,
    PolynomialTable,
)

PUPIL_SIDE = 96
_SLOPE_DEGREE, _PUPIL_DEGREE = 7, 5


def make_drawn_lens_table(lens: Lens, *, focal_length_mm: float, pupil_radius_m: float, last_slope: float) -> GridTable:
    """Make the table of a thin lens with drawn power: the same rays for every field.

    Args:
        lens: lens with drawn power.
        focal_length_mm: focal length of the lens.
        pupil_radius_m: pupil radius at the f-number used; not 0.
        last_slope: field of the picture's farthest corner, slope in object space.
    """
    side = np.linspace(-1.0, 1.0, PUPIL_SIDE)
    points = np.stack(np.meshgrid(side, side), axis=-1) * pupil_radius_m
    rays = np.concatenate([slope_errors(lens, focal_length_mm, pupil_radius_m, points), points], axis=-1)
    light = np.stack([np.ones(rays.shape[:2]), np.full(rays.shape[:2], -1.0)], axis=-1)  # the pattern ends at the rim
    on_disc = np.hypot(*np.moveaxis(points, -1, 0)) <= pupil_radius_m
    return GridTable(
        np.broadcast_to(rays, (1, 4, *rays.shape)).astype(np.float32),
        np.broadcast_to(light, (1, 4, *light.shape)).astype(np.float32),
        (2, 2),
        (last_slope, last_slope),
        pupil_reach_m=pupil_radius_m,
        slope_reach=float(np.hypot(rays[..., 0], rays[..., 1])[on_disc].max()),
    )


def add_drawn_power(
    table: PolynomialTable | GridTable, lens: Lens, *, focal_length_mm: float, pupil_radius_m: float
) -> PolynomialTable | GridTable:
    """Add drawn power to a lens's table.

    Args:
        table: of the lens without it.
        lens: with its power.
        focal_length_mm: of the lens.
        pupil_radius_m: of the entrance pupil at the f-number used; not 0.
    """
    if isinstance(table, GridTable):
        rays = table.rays.copy()
        rays[..., :2] += slope_errors(lens, focal_length_mm, pupil_radius_m, rays[..., 2:].astype(np.float64))
        is_open = table.light[..., 1] <= 0
        return replace(
            table, rays=rays, slope_reach=float(np.hypot(rays[..., 0], rays[..., 1])[is_open].max(initial=0.0))
        )
    rows = table.rows.astype(np.float64)
    nodes = pupil_nodes(rim=48)
    even, odd = even_basis(nodes, _SLOPE_DEGREE), odd_basis(nodes, _SLOPE_DEGREE)
    tangential = rows[..., PUPIL_T:PUPIL_S] @ even_basis(nodes, _PUPIL_DEGREE).T
    sagittal = rows[..., PUPIL_S:FRONT_RIM] @ odd_basis(nodes, _PUPIL_DEGREE).T
    points = np.stack([tangential, sagittal], axis=-1)
    drawn_slopes = slope_errors(lens, focal_length_mm, pupil_radius_m, points)
    added_t, added_s = drawn_slopes[..., 0] @ np.linalg.pinv(even).T, drawn_slopes[..., 1] @ np.linalg.pinv(odd).T
    rows[..., SLOPE_T:SLOPE_S] += added_t
    rows[..., SLOPE_S:PUPIL_T] += added_s
    most = BOUND_MARGIN * np.hypot(added_t @ even.T, added_s @ odd.T).max(axis=-1)
    rows[..., BOUND + 1] += most
    return replace(
        table,
        rows=rows.astype(np.float32),
        slope_reach=table.slope_reach + float(most.max()),
        slope_degree=max(table.slope_degree, _SLOPE_DEGREE),
    )


def slope_errors(lens: Lens, focal_length_mm: float, pupil_radius_m: float, points: DoubleArray) -> DoubleArray:
    """``(..., 2)`` of rays through points ``(..., 2)`` of the pupil, metres."""
    radius = np.hypot(points[..., 0], points[..., 1]) / pupil_radius_m
    return -points * drawn_defocus(lens, focal_length_mm, radius)[..., None]
