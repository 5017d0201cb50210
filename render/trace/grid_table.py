"""The table of a lens without symmetry: a thick lens whose surfaces carry height fields.

Factors on spherical aberration, coma, astigmatism, field curvature and distortion act on the lens below its heights: the errors
from the heights have no such kinds, and stay. Factors on colour errors and vignetting act on the whole.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.lens import AberrationScales, HeightField
from render.optics.glass import D_LINE_NM
from render.optics.prescription.focusing import FocusedLens
from render.trace.aberration_scales import ErrorChange, changes_shape, defocus, error_change
from render.trace.lens_fit import pupil_nodes
from render.trace.lens_table import GridTable
from render.trace.surface_tracer import SurfaceTracer, TracedLens

FIELDS = 13
PUPIL_SIDE = 48
MAX_SLOPE = 4.5


_DOWN_TO_UP = np.array([1.0, -1.0])


def make_grid_table(
    tracer: SurfaceTracer,
    lens: FocusedLens,
    height_field: HeightField,
    last_slope: float,
    focus_w: float,
    wavelengths_nm: Sequence[float],
    scales: AberrationScales,
    *,
    fields_across: int = FIELDS,
    pupil_side: int = PUPIL_SIDE,
) -> GridTable:
    """Trace a focused lens with height fields on its first and last surface.

    Args:
        tracer: of the device.
        lens: as focused without its heights.
        height_field: the heights.
        last_slope: field of the picture's farthest corner, slope in object space.
        focus_w: inverse depth of the plane of focus, 1/m.
        wavelengths_nm: one part of the table for each.
        scales: factors on its errors.
        fields_across: number of fields across and down; odd, so that one is on the axis.
        pupil_side: number of pupil points across and down.
    """
    line = np.linspace(-last_slope, last_slope, fields_across)
    fields = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)  # x right, y down, rows first
    side = np.linspace(-1, 1, pupil_side)
    stops = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    reference = (D_LINE_NM,) if scales.chromatic != 1 else ()
    traced = _trace(tracer, lens, fields, stops, (*wavelengths_nm, *reference), height_field)
    slope, pupil, passes = _by_field(traced, fields, stops, focus_w)
    if reference:
        passes = passes[:-1] & passes[-1]
        slope, pupil = (part[-1] + scales.chromatic * (part[:-1] - part[-1]) for part in (slope, pupil))
    if changes_shape(scales):
        slope = slope + _shape_change(tracer, lens, fields, stops, focus_w, wavelengths_nm, scales)
    light = _light(traced, stops, passes, scales.vignetting)
    rays = np.where(passes[..., None], np.concatenate([slope, pupil], axis=-1), 0.0)
    is_open = light[..., 1] <= 0
    return GridTable(
        rays.astype(np.float32).reshape(len(wavelengths_nm), len(fields), pupil_side, pupil_side, 4),
        light.astype(np.float32).reshape(len(wavelengths_nm), len(fields), pupil_side, pupil_side, 2),
        (fields_across, fields_across),
        (last_slope, last_slope),
        pupil_reach_m=float(np.hypot(rays[..., 2], rays[..., 3])[is_open].max(initial=0.0)),
        slope_reach=float(np.hypot(rays[..., 0], rays[..., 1])[is_open].max(initial=0.0)),
    )


def _trace(
    tracer: SurfaceTracer,
    lens: FocusedLens,
    fields: DoubleArray,
    stops: DoubleArray,
    wavelengths_nm: Sequence[float],
    height_field: HeightField | None,
) -> TracedLens:
    """Rays of every field through every point of the stop in units of its radius; the film's image is inverted."""
    upright = np.sign(lens.first.entrance_pupil_magnification)
    film = np.repeat(-fields * _DOWN_TO_UP, len(stops), axis=0) * lens.image_scale_mm
    on_stop = np.tile(stops * _DOWN_TO_UP, (len(fields), 1)) * lens.stop_radius_mm * upright
    return tracer.trace(lens, film, on_stop, wavelengths_nm, height_field)


def _by_field(
    traced: TracedLens, fields: DoubleArray, stops: DoubleArray, focus_w: float
) -> tuple[DoubleArray, DoubleArray, NDArray[np.bool_]]:
    """``(k, fields, stops, 2)`` slope errors and pupil points (m), y down, and which rays get through and can be drawn."""
    shape = (len(traced.slope), len(fields), len(stops))
    pupil = (traced.pupil_mm * _DOWN_TO_UP / 1000).reshape(*shape, 2)
    slope = (traced.slope * _DOWN_TO_UP).reshape(*shape, 2) + pupil * focus_w - fields[:, None, :]
    passes = traced.passed & (np.hypot(traced.slope[..., 0], traced.slope[..., 1]) <= MAX_SLOPE)
    return slope, pupil, passes.reshape(shape)


def _shape_change(
    tracer: SurfaceTracer,
    lens: FocusedLens,
    fields: DoubleArray,
    stops: DoubleArray,
    focus_w: float,
    wavelengths_nm: Sequence[float],
    scales: AberrationScales,
) -> DoubleArray:
    """``(k, fields, stops, 2)``: what scaling does to the slope errors of the lens without its heights."""
    heights, height_of = np.unique(np.round(np.hypot(*fields.T), 12), return_inverse=True)
    nodes = pupil_nodes()
    upper = np.stack([heights, np.zeros(len(heights))], axis=1)
    slope, _, passes = _by_field(_trace(tracer, lens, upper, nodes, wavelengths_nm, None), upper, nodes, focus_w)
    change = np.zeros((len(wavelengths_nm), len(fields), len(stops), 2))
    for part, passed, changed in zip(slope, passes, change, strict=True):
        by_height = _changes(part, passed, nodes, scales)
        for field, own in zip(range(len(fields)), height_of, strict=True):
            if (found := by_height[own]) is not None:
                x, y = fields[field] / heights[own] if heights[own] > 0 else (1.0, 0.0)
                turn = np.array([[x, -y], [y, x]])  # columns along and across the plane of field and axis
                changed[field] = found.at(stops @ turn) @ turn.T
    return change


def _changes(
    slope: DoubleArray, passes: NDArray[np.bool_], nodes: DoubleArray, scales: AberrationScales
) -> list[ErrorChange | None]:
    """Changes of slope errors ``(heights, nodes, 2)`` per field height; None where part of the pupil is dark, which no
    basis fits.
    """
    if not passes[0].all():
        return [None] * len(slope)
    on_axis = defocus(slope[0], nodes)
    return [
        error_change(errors, nodes, on_axis, scales) if passed.all() else None
        for errors, passed in zip(slope, passes, strict=True)
    ]


def _light(traced: TracedLens, stops: DoubleArray, passes: NDArray[np.bool_], vignetting: float) -> DoubleArray:
    """``(k, fields, stops, 2)`` weight, relative to the light on the axis, and clearance, below 0 where a ray passes.

    All wavelengths have the light of the first one on the axis; ``vignetting`` is the share of the fields' loss that is kept.
    """
    clearance = np.maximum(traced.front, traced.rear)[: len(passes)].reshape(passes.shape)
    clearance = np.where(passes, clearance, 1.0)
    weight = traced.weight[: len(passes)].reshape(passes.shape)
    on_disc = np.hypot(*stops.T) <= 1 + 1e-9
    light = np.where(clearance[0] <= 0, weight[0], 0.0)[:, on_disc].mean(axis=-1)
    on_axis = max(light[len(light) // 2], 1e-300)
    kept = np.maximum(light / on_axis, 1e-6) ** (vignetting - 1) / on_axis
    return np.stack([weight * kept[:, None], clearance], axis=-1)
