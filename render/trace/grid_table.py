"""The table of a lens without symmetry: a thick lens whose surfaces carry height fields."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from render.lens import HeightField
from render.optics.focusing import FocusedLens
from render.scene import DoubleArray, FloatArray
from render.trace.lens_table import GridTable
from render.trace.surface_tracer import SurfaceTracer, TracedLens

FIELDS = 13
PUPIL_SIDE = 48
MAX_SLOPE = 4.5


def grid_table(
    tracer: SurfaceTracer,
    lens: FocusedLens,
    height_field: HeightField,
    last_slope: float,
    focus_w: float,
    wavelengths_nm: Sequence[float],
) -> GridTable:
    """Trace a focused lens with height fields on its first and last surface.

    Args:
        tracer: of the device.
        lens: as focused without its heights.
        height_field: the heights.
        last_slope: field of the picture's farthest corner, slope in object space.
        focus_w: inverse depth of the plane of focus, 1/m.
        wavelengths_nm: one part of the table for each.
    """
    line = np.linspace(-last_slope, last_slope, FIELDS)
    fields = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)  # x right, y down, rows first
    side = np.linspace(-1, 1, PUPIL_SIDE)
    stops = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    down_to_up = np.array([1.0, -1.0])
    traced = tracer.trace(
        lens,
        np.repeat(-fields * down_to_up, len(stops), axis=0) * lens.image_scale_mm,
        np.tile(stops * down_to_up, (len(fields), 1))
        * lens.stop_radius_mm
        * np.sign(lens.first.entrance_pupil_magnification),
        wavelengths_nm,
        height_field,
    )
    rays, light = _by_field(traced, fields, stops, focus_w)
    is_open = light[..., 1] <= 0
    return GridTable(
        rays.reshape(len(wavelengths_nm), len(fields), PUPIL_SIDE, PUPIL_SIDE, 4),
        light.reshape(len(wavelengths_nm), len(fields), PUPIL_SIDE, PUPIL_SIDE, 2),
        (FIELDS, FIELDS),
        (last_slope, last_slope),
        pupil_reach_m=float(np.hypot(rays[..., 2], rays[..., 3])[is_open].max(initial=0.0)),
        slope_reach=float(np.hypot(rays[..., 0], rays[..., 1])[is_open].max(initial=0.0)),
    )


def _by_field(
    traced: TracedLens, fields: DoubleArray, stops: DoubleArray, focus_w: float
) -> tuple[FloatArray, FloatArray]:
    """``(k, fields, stops, 4)`` slope error and pupil point, y down, and ``(k, fields, stops, 2)`` weight and clearance."""
    shape = (len(traced.slope), len(fields), len(stops))
    down_to_up = np.array([1.0, -1.0])
    pupil = (traced.pupil_mm * down_to_up / 1000).reshape(*shape, 2)
    slope = (traced.slope * down_to_up).reshape(*shape, 2) + pupil * focus_w - fields[:, None, :]
    on_disc = np.hypot(*stops.T) <= 1 + 1e-9
    drawable = traced.passed & (np.hypot(traced.slope[..., 0], traced.slope[..., 1]) <= MAX_SLOPE)
    clearance = np.where(drawable, np.maximum(traced.front, traced.rear), 1.0).reshape(shape)
    centre = np.argmin(np.hypot(*fields.T))
    lit = on_disc & (clearance[0, centre] <= 0)
    weight = traced.weight.reshape(shape)
    weight = weight / max(weight[0, centre][lit].sum() / max(on_disc.sum(), 1), 1e-300)
    rays = np.concatenate([slope, pupil], axis=-1)
    rays[~drawable.reshape(shape)] = 0.0
    return rays.astype(np.float32), np.stack([weight, clearance], axis=-1).astype(np.float32)
