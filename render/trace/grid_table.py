"""The tables of lenses without rotational symmetry: those whose surfaces carry height fields, and those with cylinders. Lenses
with openings or obscurations have them too: a pupil that is a ring, or not round, is no part of an ellipse.

Of a lens with height fields, factors on spherical aberration, coma, astigmatism, field curvature and distortion act on the lens
below its heights: the errors from the heights have no such kinds, and stay. Of a lens with cylinders these five do not act at
all. Factors on colour errors and vignetting act on the whole.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.lens import AberrationScales, HeightField
from render.optics.glass import D_LINE_NM
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.outlines import is_centred, without_outlines
from render.trace.aberration_scales import ErrorChange, changes_shape, defocus, error_change
from render.trace.lens_fit import pupil_nodes
from render.trace.lens_table import GridTable
from render.trace.surface_tracer import RAY_BYTES, SurfaceTracer, TracedLens

FIELDS = 13
PUPIL_SIDE = 48
QUARTER_FIELDS = 13, 9
"""Fields across and down of a quarter of the picture."""
CYLINDER_PUPIL_SIDE = 32
POLYGON_PUPIL_SIDE = 96
MAX_SLOPE = 4.5
MOST_BYTES = 2_005_401_600
"""Limit on the buffer of all rays of a table: devices hold less than 2 GiB in one."""


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
    stops = _square(pupil_side)
    traced = _trace(tracer, lens, fields, stops, _traced_nm(wavelengths_nm, scales), height_field)
    slope, pupil, passes = _by_field(traced, fields, stops, focus_w)
    slope, pupil, passes = _with_chromatic(slope, pupil, passes, scales.chromatic)
    if changes_shape(scales):
        slope = slope + _shape_change(tracer, lens, fields, stops, focus_w, wavelengths_nm, scales)
    light = _light(traced, stops, passes, scales.vignetting, len(fields) // 2)
    return _table(slope, pupil, passes, light, (fields_across, fields_across), (last_slope, last_slope), mirrored=False)


def make_asymmetric_table(
    tracer: SurfaceTracer,
    lens: FocusedLens,
    squeeze: float,
    last_slope: tuple[float, float],
    focus_w: float,
    wavelengths_nm: Sequence[float],
    scales: AberrationScales,
    *,
    fields_across: tuple[int, int] = QUARTER_FIELDS,
    pupil_side: int | None = None,
) -> GridTable:
    """Trace a focused lens with cylinders, openings or obscurations.

    Where none of these is beside the axis, it is the same left and right, and up and down. Openings and obscurations take their
    light out of the picture: a lens with them is as much darker than one of its f-number.

    Args:
        tracer: of the device.
        lens: as focused.
        squeeze: by which the picture is stretched back; 1 of a lens without cylinders.
        last_slope: field of the picture's farthest edges, from side to side and up and down: slopes in object space.
        focus_w: inverse depth of the plane of focus, 1/m.
        wavelengths_nm: one part of the table for each.
        scales: factors on its errors; with cylinders, only those on colour errors and vignetting act.
        fields_across: number of fields from the axis to the right, and down.
        pupil_side: number of pupil points across and down; by default more where there are edges of openings, and fewer where
            the rays of many wavelengths would exceed `MOST_BYTES`.
    """
    mirrored, outlined = is_centred(lens.prescription), bool(lens.prescription.outlines)
    if not mirrored:
        fields_across = 2 * fields_across[0] - 1, 2 * fields_across[1] - 1
    ends = zip(last_slope, fields_across, strict=True)
    lines = (np.linspace(0.0 if mirrored else -last, last, count) for last, count in ends)
    fields = np.stack(np.meshgrid(*lines), axis=-1).reshape(-1, 2)
    traced_nm = _traced_nm(wavelengths_nm, scales)
    side = pupil_side or fit_pupil_side(_pupil_side(lens, mirrored=mirrored), len(fields), len(traced_nm))
    stops = _square(side)
    traced = _trace(tracer, lens, fields, stops, traced_nm, None, squeeze)
    slope, pupil, passes = _by_field(traced, fields, stops, focus_w)
    slope, pupil, passes = _with_chromatic(slope, pupil, passes, scales.chromatic)
    if changes_shape(scales) and not lens.prescription.is_anamorphic:
        slope = slope + _shape_change(tracer, lens, fields, stops, focus_w, wavelengths_nm, scales)
    axis = 0 if mirrored else len(fields) // 2
    whole = _light_on_axis(tracer, lens, stops, wavelengths_nm[0]) if outlined else None
    light = _light(traced, stops, passes, scales.vignetting, axis, whole)
    return _table(slope, pupil, passes, light, fields_across, last_slope, mirrored=mirrored)


def fit_pupil_side(side: int, fields: int, wavelengths: int) -> int:
    """Lower the number of pupil points across to one whose rays fit into `MOST_BYTES`.

    Args:
        side: number of them where there is room; even.
        fields: number of fields.
        wavelengths: number of wavelengths that are traced at once.

    Returns:
        An even number.
    """
    most = math.isqrt(MOST_BYTES // (fields * wavelengths * RAY_BYTES))
    return min(side, most - most % 2)


def _pupil_side(lens: FocusedLens, *, mirrored: bool) -> int:
    """Points across the pupil: more where there are edges, and most for the arms of spiders, where a quarter stands for all."""
    if lens.prescription.polygons and mirrored:
        return POLYGON_PUPIL_SIDE
    return PUPIL_SIDE if lens.prescription.outlines else CYLINDER_PUPIL_SIDE


def _light_on_axis(tracer: SurfaceTracer, lens: FocusedLens, stops: DoubleArray, wavelength_nm: float) -> float:
    """Light on the axis of the lens without openings and obscurations."""
    plain = replace(lens, prescription=without_outlines(lens.prescription))
    traced = _trace(tracer, plain, np.zeros((1, 2)), stops, (wavelength_nm,), None)
    is_open = traced.passed[0] & (np.maximum(traced.front, traced.rear)[0] <= 0)
    return float(np.where(is_open, traced.weight[0], 0.0)[_on_disc(stops)].mean())


def _on_disc(stops: DoubleArray) -> NDArray[np.bool_]:
    return np.asarray(np.hypot(*stops.T) <= 1 + 1e-9)


def _square(side: int) -> DoubleArray:
    """Points ``(side², 2)`` of the square around the unit disc, rows first."""
    line = np.linspace(-1, 1, side)
    return np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)


def _traced_nm(wavelengths_nm: Sequence[float], scales: AberrationScales) -> tuple[float, ...]:
    """Wavelengths to trace: with a factor on colour errors, last the line from which they are counted."""
    return (*wavelengths_nm, D_LINE_NM) if scales.chromatic != 1 else tuple(wavelengths_nm)


def _with_chromatic(
    slope: DoubleArray, pupil: DoubleArray, passes: NDArray[np.bool_], factor: float
) -> tuple[DoubleArray, DoubleArray, NDArray[np.bool_]]:
    """Scale the distance of all wavelengths from the last one, which is left out."""
    if factor == 1:
        return slope, pupil, passes
    slope, pupil = (part[-1] + factor * (part[:-1] - part[-1]) for part in (slope, pupil))
    return slope, pupil, passes[:-1] & passes[-1]


def _table(
    slope: DoubleArray,
    pupil: DoubleArray,
    passes: NDArray[np.bool_],
    light: DoubleArray,
    fields: tuple[int, int],
    last_slope: tuple[float, float],
    *,
    mirrored: bool,
) -> GridTable:
    rays = np.where(passes[..., None], np.concatenate([slope, pupil], axis=-1), 0.0)
    is_open = light[..., 1] <= 0
    side = round(np.sqrt(rays.shape[2]))
    shape = (*rays.shape[:2], side, side)
    return GridTable(
        rays.astype(np.float32).reshape(*shape, 4),
        light.astype(np.float32).reshape(*shape, 2),
        fields,
        last_slope,
        pupil_reach_m=float(np.hypot(rays[..., 2], rays[..., 3])[is_open].max(initial=0.0)),
        slope_reach=float(np.hypot(rays[..., 0], rays[..., 1])[is_open].max(initial=0.0)),
        mirrored=mirrored,
    )


def _trace(
    tracer: SurfaceTracer,
    lens: FocusedLens,
    fields: DoubleArray,
    stops: DoubleArray,
    wavelengths_nm: Sequence[float],
    height_field: HeightField | None,
    squeeze: float = 1.0,
) -> TracedLens:
    """Rays of every field through every point of the stop in units of its radius; the film's image is inverted."""
    upright = np.sign(lens.first.entrance_pupil_magnification)
    scale_mm = np.array([lens.image_scale_mm / squeeze, lens.image_scale_mm])
    film = np.repeat(-fields * _DOWN_TO_UP, len(stops), axis=0) * scale_mm
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


def _light(
    traced: TracedLens,
    stops: DoubleArray,
    passes: NDArray[np.bool_],
    vignetting: float,
    axis: int,
    whole: float | None = None,
) -> DoubleArray:
    """``(k, fields, stops, 2)`` weight, relative to the light on the axis, and clearance, below 0 where a ray passes.

    All wavelengths have the light of the first one on the axis; ``vignetting`` is the share of the fields' loss that is kept,
    ``axis`` the field on the axis, ``whole`` the light there that stands for the f-number, where it is not all that passes.
    """
    clearance = np.maximum(traced.front, traced.rear)[: len(passes)].reshape(passes.shape)
    clearance = np.where(passes, clearance, 1.0)
    weight = traced.weight[: len(passes)].reshape(passes.shape)
    light = np.where(clearance[0] <= 0, weight[0], 0.0)[:, _on_disc(stops)].mean(axis=-1)
    on_axis = max(light[axis] or whole or 0.0, 1e-300)  # an obscuration may darken the axis alone
    kept = np.maximum(light / on_axis, 1e-6) ** (vignetting - 1) / max(whole or on_axis, 1e-300)
    return np.stack([weight * kept[:, None], clearance], axis=-1)
