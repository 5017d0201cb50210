"""Lens table of a prescription: the open pupil at each field height, and the rays that leave it.

Field heights are slopes of the ideal lens: the film point that a pixel stands for is its slope times the image scale of the lens
as focused, so that by default the picture's framing does not change with focus, and with breathing it does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.lens import AberrationScales
from render.optics.glass import D_LINE_NM
from render.optics.prescription.focusing import FocusedLens
from render.trace.aberration_scales import changes_shape, defocus, error_change
from render.trace.lens_fit import FULL, LOW, Degrees, NodeRays, PupilFit, Region, mean_light, pupil_nodes
from render.trace.lens_table import BOUND, LIGHT, REGION, WEIGHT, PolynomialTable

if TYPE_CHECKING:  # so that a process without GL can ask where a lens is sharpest
    from render.trace.surface_tracer import SurfaceTracer, TracedLens

HEIGHTS = 48
MAX_SLOPE = 4.5
"""Slope limit of 77 degrees from the axis, beyond which one perspective picture cannot be drawn; the lens is dark there."""
FILM_ERROR_MM = 0.004
"""Greatest error of a fitted ray on the film, mm, at which polynomials of a lower degree are accepted: a fifth of a
pixel of 36 mm over 1920.
"""
PUPIL_ERROR = 1.5e-3
"""Greatest error on the entrance pupil relative to its radius: the relative error of a circle of confusion at its edge."""
_GRID = 41
_PADDING = 1.0 / _GRID


def make_prescription_table(
    tracer: SurfaceTracer,
    lens: FocusedLens,
    last_slope: float,
    focus_w: float,
    wavelengths_nm: Sequence[float],
    scales: AberrationScales,
) -> PolynomialTable:
    """Trace and fit a focused lens.

    Args:
        tracer: of the device.
        lens: as focused.
        last_slope: field of the picture's farthest corner, slope in object space.
        focus_w: inverse depth of the plane of focus, 1/m.
        wavelengths_nm: one part of the table for each.
        scales: factors on its errors.
    """
    slopes = np.linspace(0.0, last_slope, HEIGHTS)
    regions = _open_regions(tracer, lens, slopes)
    nodes = pupil_nodes()
    reference = (D_LINE_NM,) if scales.chromatic != 1 else ()
    traced = _trace_nodes(tracer, lens, slopes, regions, nodes, (*wavelengths_nm, *reference))
    rays = _node_rays(traced, slopes, regions, focus_w, lens.stop_radius_mm**2)
    if reference:
        rays = scale_chromatic(rays, scales.chromatic)
    rays = [
        [scale_rays(r, part[0], region, nodes, scales) for r, region in zip(part, regions, strict=True)]
        for part in rays
    ]
    fit = _sufficient_fit(rays, lens)
    rows = np.array([[fit.row(r, region) for r, region in zip(part, regions, strict=True)] for part in rays])
    return _table(extend_dark_rows(_normalize_light(rows, scales.vignetting)), last_slope, fit.degrees)


def _normalize_light(rows: DoubleArray, vignetting: float) -> DoubleArray:
    """Normalize the rows' weights to the light on the axis; ``vignetting`` is the share of its loss that is kept.

    All wavelengths get the light of the middle one, so that white stays neutral.
    """
    middle = rows[len(rows) // 2]
    light = mean_light(middle)
    kept = np.maximum(light / light[0], 1e-6) ** (vignetting - 1) / light[0]
    rows = rows.copy()
    rows[..., WEIGHT:REGION] *= kept[:, None]
    rows[..., LIGHT] = light * kept
    return rows


def extend_dark_rows(rows: DoubleArray) -> DoubleArray:
    """Extend the shape of the last lit row into the dark rows behind it.

    So light alone fades where a picture's rays stand between the two, at the edge of the image circle; their directions do not
    turn back toward those of an empty row, nor to those of rays that find a way far outside of it.
    """
    rows = rows.copy()
    for part in rows:
        is_dark = (part[:, LIGHT] <= 0) | (part[:, REGION + 1] <= 0)
        last_lit = np.maximum.accumulate(np.where(is_dark, 0, np.arange(len(part))))
        part[:] = part[last_lit]
        part[is_dark, WEIGHT:REGION] = 0.0
        part[is_dark, LIGHT] = 0.0
    return rows


def _sufficient_fit(rays: list[list[NodeRays]], lens: FocusedLens) -> PupilFit:
    """Lowest degrees that fit the lens well enough: each term costs every ray of the picture."""
    low = PupilFit(pupil_nodes(), LOW)
    residuals = np.array([low.residual(r) for part in rays for r in part])
    slope_error, pupil_error = residuals.max(axis=0)
    slope_holds = slope_error * lens.image_scale_mm <= FILM_ERROR_MM
    pupil_holds = pupil_error * 1000 <= PUPIL_ERROR * lens.entrance_pupil_radius_mm
    slope = LOW.slope if slope_holds else FULL.slope
    return PupilFit(low.nodes, Degrees(slope, LOW.pupil if pupil_holds else FULL.pupil))


def _table(rows: DoubleArray, last_slope: float, degrees: Degrees) -> PolynomialTable:
    bounds = np.abs(rows[..., BOUND : BOUND + 4])
    return PolynomialTable(
        rows.astype(np.float32),
        last_slope,
        pupil_reach_m=float((bounds[..., 2] + bounds[..., 3]).max()),
        slope_reach=float((bounds[..., 0] + bounds[..., 1]).max()),
        slope_degree=degrees.slope,
        pupil_degree=degrees.pupil,
    )


def _open_regions(tracer: SurfaceTracer, lens: FocusedLens, slopes: DoubleArray) -> list[Region]:
    """Open part of the stop for each field height."""
    line = np.linspace(-1, 1, _GRID)
    disc = np.stack(np.meshgrid(line, line[_GRID // 2 :], indexing="ij"), axis=-1).reshape(-1, 2)
    disc = disc[np.hypot(*disc.T) <= 1 + 1e-9]
    stops = np.tile(disc, (len(slopes), 1))
    traced = _trace(tracer, lens, np.repeat(slopes, len(disc)), stops, (D_LINE_NM,))
    is_open = traced.passed & _drawable(traced) & (traced.front <= 0) & (traced.rear <= 0)
    return [enclosing_region(disc[row], len(disc), _PADDING) for row in is_open[0].reshape(len(slopes), len(disc))]


def enclosing_region(is_open: DoubleArray, all_points: int, padding: float) -> Region:
    """Smallest ellipse on the tangential axis around the open points of the half disc.

    Args:
        is_open: ``(m, 2)`` open points.
        all_points: number of all points.
        padding: spacing of the points, in units of the stop's radius, which is added all around.
    """
    if len(is_open) == all_points:
        return Region()
    if len(is_open) == 0:
        return Region(0.0, padding, padding, clipped=True)
    x, y = is_open.T
    low, high = max(x.min() - padding, -1.0), min(x.max() + padding, 1.0)
    centre, half = (low + high) / 2, (high - low) / 2
    stretched = half * np.linspace(1.0, 1.6, 25)
    across = np.array(
        [np.sqrt((y**2 / np.maximum(1 - ((x - centre) / along) ** 2, 1e-9)).max()) for along in stretched]
    )
    across += padding
    best = int(np.argmin(stretched * across))
    if stretched[best] * across[best] >= 1.0:
        return Region(clipped=True)
    return Region(float(centre), float(stretched[best]), float(across[best]), clipped=True)


def _trace_nodes(
    tracer: SurfaceTracer,
    lens: FocusedLens,
    slopes: DoubleArray,
    regions: list[Region],
    nodes: DoubleArray,
    wavelengths_nm: Sequence[float],
) -> TracedLens:
    stops = np.concatenate([region.on_stop(nodes) for region in regions])
    return _trace(tracer, lens, np.repeat(slopes, len(nodes)), stops, wavelengths_nm)


def _trace(
    tracer: SurfaceTracer, lens: FocusedLens, slopes: DoubleArray, stops: DoubleArray, wavelengths_nm: Sequence[float]
) -> TracedLens:
    """Trace rays of field heights ``(n,)`` through stop points ``(n, 2)`` in units of its radius; the film's image is
    inverted.
    """
    film = np.stack([-slopes * lens.image_scale_mm, np.zeros(len(slopes))], axis=1)
    upright = np.sign(lens.first.entrance_pupil_magnification)
    return tracer.trace(lens, film, upright * stops * lens.stop_radius_mm, wavelengths_nm)


def _node_rays(
    traced: TracedLens, slopes: DoubleArray, regions: list[Region], focus_w: float, stop_mm2: float
) -> list[list[NodeRays]]:
    """Node rays by wavelength and field height; a weight is that of ``stop_mm2`` of the stop, spread over the region's disc."""
    wavelengths = len(traced.slope)
    pupil_m = traced.pupil_mm / 1000
    at_focus = traced.slope + pupil_m * focus_w
    drawable = traced.passed & _drawable(traced)

    def part(values: NDArray[Any], k: int, h: int) -> NDArray[Any]:
        return np.asarray(values.reshape(wavelengths, len(slopes), -1, *values.shape[2:])[k, h])

    return [
        [
            NodeRays(
                slope=part(at_focus, k, h) - [slopes[h], 0.0],
                pupil_m=part(pupil_m, k, h),
                front=part(traced.front, k, h),
                rear=part(traced.rear, k, h),
                weight=part(traced.weight, k, h) * stop_mm2 * region.area,
                passed=part(drawable, k, h),
            )
            for h, region in enumerate(regions)
        ]
        for k in range(wavelengths)
    ]


def _drawable(traced: TracedLens) -> NDArray[np.bool_]:
    return np.asarray(np.hypot(traced.slope[..., 0], traced.slope[..., 1]) <= MAX_SLOPE)


def scale_chromatic(rays: list[list[NodeRays]], factor: float) -> list[list[NodeRays]]:
    """Scale the distance of all wavelengths from the last one."""
    return [
        [
            replace(
                r,
                slope=base.slope + factor * (r.slope - base.slope),
                pupil_m=base.pupil_m + factor * (r.pupil_m - base.pupil_m),
                passed=r.passed & base.passed,
            )
            for r, base in zip(part, rays[-1], strict=True)
        ]
        for part in rays[:-1]
    ]


def scale_rays(
    rays: NodeRays, axis: NodeRays, region: Region, nodes: DoubleArray, scales: AberrationScales
) -> NodeRays:
    """Scale each kind of error of a field height's rays; ``axis`` are the rays of height 0 at the same nodes."""
    if not changes_shape(scales):
        return rays
    if not (rays.passed.all() and axis.passed.all()):
        return rays  # half the pupil is dark here: there are no powers of it to tell apart
    on_axis = defocus(axis.slope, nodes)
    on_stop = region.on_stop(nodes)
    return replace(rays, slope=rays.slope + error_change(rays.slope, on_stop, on_axis, scales).at(on_stop))
