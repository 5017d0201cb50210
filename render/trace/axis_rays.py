"""On-axis rays of any lens, from its table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray
from render.trace.lens_fit import FULL, even_basis, odd_basis, slope_errors
from render.trace.lens_table import FRONT_RIM, PUPIL_S, PUPIL_T, REGION, GridTable, PolynomialTable


@dataclass(frozen=True, eq=False)
class LensErrors:
    """A lens with errors before a picture.

    Attributes:
        table: of its rays.
        pupil_m: radius of the pupil by the f-number.
        focal_px: focal length in pixels.
        own_squeeze: squeeze that the table's rays have themselves; 1 where they are narrowed by that of the camera.
    """

    table: PolynomialTable | GridTable
    pupil_m: float
    focal_px: float
    own_squeeze: float = 1.0


@dataclass(frozen=True, eq=False)
class AxisRays:
    """The rays of a lens on its axis, through points of the iris.

    Attributes:
        slope: ``(n, 2)`` slope error in the plane of focus, x right and y down.
        pupil_m: ``(n, 2)`` points in the plane of the entrance pupil, metres.
    """

    slope: DoubleArray
    pupil_m: DoubleArray


def trace_axis_rays(table: PolynomialTable | GridTable, stops: DoubleArray) -> AxisRays:
    """The rays of the middle wavelength; those that the lens blocks are left out.

    Args:
        table: of the lens.
        stops: ``(n, 2)`` points of the iris, of unit radius, x right and y down.
    """
    if isinstance(table, GridTable):
        return _of_grid(table, stops)
    row = table.rows[len(table.rows) // 2, 0].astype(np.float64)
    inner = (stops - [row[REGION], 0.0]) / row[REGION + 1 : REGION + 3]
    inner = inner[np.hypot(*inner.T) <= 1 + 1e-6]
    odd = np.sign(inner[:, 1:])  # rows are of the half pupil; the other one mirrors it
    half = np.abs(inner * [0.0, 1.0]) + inner * [1.0, 0.0]

    mirror = np.column_stack([np.ones(len(half)), odd[:, 0]])
    along = even_basis(half, FULL.pupil) @ row[PUPIL_T:PUPIL_S]
    pupil = np.stack([along, odd_basis(half, FULL.pupil) @ row[PUPIL_S:FRONT_RIM]], axis=1)
    return AxisRays(slope_errors(row[None], half, table.slope_degree)[0] * mirror, pupil * mirror)


def open_axes(table: PolynomialTable) -> tuple[float, float]:
    """Half axes of the open part of the iris on the axis, across and down, relative to its radius."""
    row = table.rows[len(table.rows) // 2, 0]
    return float(row[REGION + 1]), float(row[REGION + 2])


def axis_key(table: PolynomialTable | GridTable) -> bytes:
    """Cache key of the part of a table that `trace_axis_rays` reads."""
    if isinstance(table, PolynomialTable):
        return bytes(table.rows[len(table.rows) // 2, 0].tobytes())
    field = table.axis_field
    read = table.rays[len(table.rays) // 2, field], table.light[len(table.light) // 2, field]
    return b"".join(values.tobytes() for values in read)


def _of_grid(table: GridTable, stops: DoubleArray) -> AxisRays:
    """Joined linearly between the grid's points, in the field that is nearest the axis."""
    field = table.axis_field
    rays = table.rays[len(table.rays) // 2, field].astype(np.float64)
    passes = table.light[len(table.light) // 2, field, ..., 1] <= 0
    side = len(rays)
    at = np.clip((stops + 1) / 2 * (side - 1), 0, side - 1)
    low = np.minimum(at.astype(np.int64), side - 2)
    part = at - low
    total, is_open = np.zeros((len(stops), 4)), np.ones(len(stops), bool)
    for right in (0, 1):
        for down in (0, 1):
            share = np.abs(1 - right - part[:, 0]) * np.abs(1 - down - part[:, 1])
            place = low[:, 1] + down, low[:, 0] + right
            total += share[:, None] * rays[place]
            is_open &= passes[place] | (share < 1e-9)
    return AxisRays(total[is_open, :2], total[is_open, 2:])
