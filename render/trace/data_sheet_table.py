"""Lens table of a data sheet: the errors from `render.optics.data_sheet` as polynomials."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from render.model.arrays import DoubleArray
from render.model.data_sheet import DataSheet
from render.model.lens import AberrationScales
from render.optics.data_sheet import SheetErrors, sheet_errors
from render.trace.lens_fit import LOW, NodeRays, PupilFit, Region, pupil_nodes
from render.trace.lens_table import BOUND, LIGHT, PolynomialTable
from render.trace.prescription_table import enclosing_region

HEIGHTS = 64
_GRID = 61  # points across the pupil that find its open part


def make_data_sheet_table(
    sheet: DataSheet,
    scales: AberrationScales,
    *,
    focal_length_mm: float,
    pupil_radius_m: float,
    last_slope: float,
    wavelengths_nm: Sequence[float],
) -> PolynomialTable:
    """Make the lens table of a data sheet.

    Args:
        sheet: measurements.
        scales: factors on its errors.
        focal_length_mm: focal length of the lens.
        pupil_radius_m: at the f-number used; not 0.
        last_slope: field of the picture's farthest corner, slope in object space.
        wavelengths_nm: one part of the table for each.
    """
    slopes = np.linspace(0.0, last_slope, HEIGHTS)
    f_stop = focal_length_mm / (2000 * pupil_radius_m)
    errors = sheet_errors(
        sheet, slopes * focal_length_mm, focal_length_mm=focal_length_mm, f_stop=f_stop, scales=scales
    )
    regions = _regions(errors)
    nodes = pupil_nodes()
    points = np.array([region.on_stop(nodes) for region in regions])
    rims = errors.clearance(points, 1), errors.clearance(points, -1)
    kept = np.maximum(errors.light, 1e-6) ** (scales.vignetting - 1)
    weight = kept * errors.natural * [region.area for region in regions]
    fit = PupilFit(nodes, LOW)
    rows = []
    for wavelength in wavelengths_nm:
        off = -errors.landing_mm(points, wavelength) * errors.stretch[:, None] / focal_length_mm
        off[..., 0] += (errors.seen - slopes)[:, None]
        rows.append(
            [
                fit.row(_node_rays(off[h], points[h] * pupil_radius_m, rims[0][h], rims[1][h], weight[h]), region)
                for h, region in enumerate(regions)
            ]
        )
    return _table(np.array(rows), errors.light * kept, last_slope)


def _node_rays(
    slope: DoubleArray, pupil_m: DoubleArray, front: DoubleArray, rear: DoubleArray, weight: float
) -> NodeRays:
    count = len(slope)
    return NodeRays(slope, pupil_m, front, rear, np.full(count, weight), np.ones(count, bool))


def _regions(errors: SheetErrors) -> list[Region]:
    """Open part of the pupil at each field height."""
    line, turn = np.linspace(-1.0, 1.0, _GRID), np.linspace(0.0, np.pi, 2 * _GRID + 1)
    grid = np.stack(np.meshgrid(line, line[_GRID // 2 :]), axis=-1).reshape(-1, 2)
    edge = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    grid = np.concatenate([grid[np.hypot(*grid.T) <= 1], edge])
    blocked = np.maximum(errors.clearance(grid, 1), errors.clearance(grid, -1)) > 0
    return [enclosing_region(grid[~row], len(grid), 2 / (_GRID - 1)) for row in blocked]


def _table(rows: DoubleArray, light: DoubleArray, last_slope: float) -> PolynomialTable:
    rows[..., LIGHT] = light
    bounds = np.abs(rows[..., BOUND : BOUND + 4])
    return PolynomialTable(
        rows.astype(np.float32),
        last_slope,
        pupil_reach_m=float((bounds[..., 2] + bounds[..., 3]).max()),
        slope_reach=float((bounds[..., 0] + bounds[..., 1]).max()),
        slope_degree=LOW.slope,
        pupil_degree=LOW.pupil,
    )
