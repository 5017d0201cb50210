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
from render.trace.lens_fit import (
    FULL,
    LOW,
    SLOPE_DEGREES,
    Degrees,
    NodeRays,
    PupilFit,
    Region,
    mean_light,
    pupil_nodes,
    row_length,
    slope_errors,
)
from render.trace.lens_table import BOUND, LIGHT, REGION, SLOPE_T, WEIGHT, PolynomialTable
from render.trace.open_pupil import clearances

if TYPE_CHECKING:  # so that a process without GL can ask where a lens is sharpest
    from render.trace.surface_tracer import SurfaceTracer, TracedLens

HEIGHTS = (48, 96, 192)
"""Field heights of a table: the fewest that hold the rays between them."""
MAX_SLOPE = 4.5
"""Slope limit of 77 degrees from the axis, beyond which one perspective picture cannot be drawn; the lens is dark there."""
FILM_ERROR_MM = 0.004
"""Greatest error of a ray on the film, mm, that a table is refined for: a fifth of a pixel of 36 mm over 1920."""
PUPIL_ERROR = 1.5e-3
"""Greatest error on the entrance pupil relative to its radius: the relative error of a circle of confusion at its edge."""
_GRID = 41
_MARGIN = 0.8
"""Share of `FILM_ERROR_MM` that rays may be off which a fit goes through: between them it is worse."""
_PAYS = 0.8
"""Share of its error that a refinement must leave at most to be worth it."""
_FINE_NODES = (224, 36)
"""Nodes of the half pupil, and on its rim, for polynomials above the seventh degree."""
_CHECKED_NODES, _CHECKED_HEIGHTS, _CHECKED_CHANGES = (90, 21), 8, 4
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
    maker = _TableMaker(tracer, lens, last_slope, focus_w, wavelengths_nm)
    fit, count, rows, error_mm = maker.refined()
    if scales.chromatic != 1 or changes_shape(scales):
        rows = maker.rows(fit, count, scales)
    return _table(extend_dark_rows(_normalize_light(rows, scales.vignetting)), last_slope, fit.degrees, error_mm)


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


class _TableMaker:
    """Fits a lens, and checks the fit against rays that it does not know."""

    def __init__(
        self,
        tracer: SurfaceTracer,
        lens: FocusedLens,
        last_slope: float,
        focus_w: float,
        wavelengths_nm: Sequence[float],
    ) -> None:
        self._tracer, self._lens, self._last_slope = tracer, lens, last_slope
        self._focus_w, self._wavelengths_nm = focus_w, wavelengths_nm
        self._regions: dict[int, list[Region]] = {}
        self._kept: dict[tuple[object, ...], dict[int, tuple[NodeRays, ...]]] = {}

    def refined(self) -> tuple[PupilFit, int, DoubleArray, float]:
        """Fit, number of heights, rows and error on the film, refined where it pays until the error is small enough.

        More heights cost no ray of the picture anything, so they come first.
        """
        fit, count = self.sufficient_fit(), HEIGHTS[0]
        rows = self.rows(fit, count)
        error_mm = self.film_error_mm(rows, fit.degrees)
        may_double = True
        while error_mm > FILM_ERROR_MM:
            if may_double and count < HEIGHTS[-1]:
                other, more = fit, 2 * count
            elif fit.degrees.slope < SLOPE_DEGREES[-1]:
                degree = SLOPE_DEGREES[SLOPE_DEGREES.index(fit.degrees.slope) + 1]
                other, more = PupilFit(pupil_nodes(*_FINE_NODES), Degrees(degree, fit.degrees.pupil)), count
            else:
                break
            left_mm = self.film_error_mm(self._rows_to_check(other, more), other.degrees)
            if left_mm < _PAYS * error_mm:
                fit, count, rows, error_mm = other, more, self.rows(other, more), left_mm
            elif other is fit:
                may_double = False
            else:
                break
        return fit, count, rows, error_mm

    def sufficient_fit(self) -> PupilFit:
        """Lowest degrees that fit the lens well enough: each term costs every ray of the picture."""
        low = PupilFit(pupil_nodes(), LOW)
        _, rays = self._traced(HEIGHTS[0], low.nodes)
        pupil_m = max(low.residual(r)[1] for part in rays for r in part)
        holds = pupil_m * 1000 <= PUPIL_ERROR * self._lens.entrance_pupil_radius_mm
        pupil = LOW.pupil if holds else FULL.pupil
        for degree in SLOPE_DEGREES:
            fine = degree > FULL.slope
            fit = PupilFit(pupil_nodes(*_FINE_NODES) if fine else low.nodes, Degrees(degree, pupil))
            if fine and len(rays[0][0].front) != len(fit.nodes):
                _, rays = self._traced(HEIGHTS[0], fit.nodes)
            worst = max(fit.residual(r)[0] for part in rays for r in part)
            if worst * self._lens.image_scale_mm <= _MARGIN * FILM_ERROR_MM:
                break
        return fit

    def rows(self, fit: PupilFit, count: int, scales: AberrationScales | None = None) -> DoubleArray:
        """Rows ``(wavelengths, count, n)``, with factors on the lens's errors."""
        reference = (D_LINE_NM,) if scales is not None and scales.chromatic != 1 else ()
        regions, rays = self._traced(count, fit.nodes, reference)
        if scales is not None:
            if reference:
                rays = scale_chromatic(rays, scales.chromatic)
            rays = [
                [scale_rays(r, part[0], region, fit.nodes, scales) for r, region in zip(part, regions, strict=True)]
                for part in rays
            ]
        return np.array([[fit.row(r, region) for r, region in zip(part, regions, strict=True)] for part in rays])

    def film_error_mm(self, rows: DoubleArray, degrees: Degrees) -> float:
        """Largest error on the film between the fit's nodes and half way between its heights, where both neighbours are lit."""
        count = rows.shape[1]
        slopes = np.linspace(0.0, self._last_slope, count)
        places = _places_to_check(rows[0, :, REGION : REGION + 3])
        if not len(places):
            return 0.0
        heights = (slopes[places] + slopes[places + 1]) / 2
        blended = (rows[:, places] + rows[:, places + 1]) / 2
        nodes = pupil_nodes(*_CHECKED_NODES)
        regions = [Region(*row[REGION : REGION + 3]) for row in blended[0]]
        traced = _trace_nodes(self._tracer, self._lens, heights, regions, nodes, self._wavelengths_nm)
        exact = _node_rays(traced, heights, regions, self._focus_w, 1.0)
        seen = slopes + rows[len(rows) // 2, :, SLOPE_T]
        radial = np.gradient(seen, slopes)  # slope in object space per slope of the ideal lens: radially, and around
        around = np.divide(seen, slopes, out=radial.copy(), where=slopes > 0)
        worst = 0.0
        for part, fitted in zip(exact, blended, strict=True):
            off = slope_errors(fitted, nodes, degrees.slope) - np.array([r.slope for r in part])
            off /= np.stack([radial[places], around[places]], axis=1)[:, None]
            is_open = np.array([r.passed & (r.front <= 0) & (r.rear <= 0) for r in part])
            is_open &= np.array([np.hypot(*region.on_stop(nodes).T) <= 1 for region in regions])
            worst = max(worst, float(np.hypot(off[..., 0], off[..., 1])[is_open].max(initial=0.0)))
        return worst * self._lens.image_scale_mm

    def _rows_to_check(self, fit: PupilFit, count: int) -> DoubleArray:
        """Rows ``(wavelengths, count, n)`` of which those are fitted that `film_error_mm` reads; others have their region alone.

        A refinement that does not pay needs no more.
        """
        regions = self._open(count)
        shapes = np.array([[region.centre, region.along, region.across] for region in regions])
        places = _places_to_check(shapes)
        read = np.unique(np.clip(places + np.arange(-1, 3)[:, None], 0, count - 1))  # and the slopes beside them
        rows = np.full((len(self._wavelengths_nm), count, row_length(fit.degrees.slope)), np.nan)
        rows[..., REGION : REGION + 3] = shapes
        for k, part in enumerate(self._traced_at(count, fit.nodes, read)):
            for h, rays in zip(read, part, strict=True):
                rows[k, h] = fit.row(rays, regions[h])
        is_dark = rows[0, np.union1d(places, places + 1), REGION + 1] == 0  # few rays get through what is open
        return self.rows(fit, count) if is_dark.any() else rows

    def _open(self, count: int) -> list[Region]:
        """Open regions of field heights."""
        if count not in self._regions:
            slopes = np.linspace(0.0, self._last_slope, count)
            self._regions[count] = _open_regions(self._tracer, self._lens, slopes)
        return self._regions[count]

    def _traced(
        self, count: int, nodes: DoubleArray, more_nm: Sequence[float] = ()
    ) -> tuple[list[Region], list[list[NodeRays]]]:
        return self._open(count), self._traced_at(count, nodes, np.arange(count), more_nm)

    def _traced_at(
        self, count: int, nodes: DoubleArray, heights: NDArray[np.int64], more_nm: Sequence[float] = ()
    ) -> list[list[NodeRays]]:
        """Rays by wavelength, at some of the heights; each is traced once."""
        kept = self._kept.setdefault((count, len(nodes), tuple(more_nm)), {})
        missing = [int(h) for h in heights if int(h) not in kept]
        if missing:
            slopes = np.linspace(0.0, self._last_slope, count)[missing]
            regions = [self._open(count)[h] for h in missing]
            wavelengths = (*self._wavelengths_nm, *more_nm)
            traced = _trace_nodes(self._tracer, self._lens, slopes, regions, nodes, wavelengths)
            rays = _node_rays(traced, slopes, regions, self._focus_w, self._lens.stop_radius_mm**2)
            kept.update(zip(missing, zip(*rays, strict=True), strict=True))
        return [list(part) for part in zip(*(kept[int(h)] for h in heights), strict=True)]


def _places_to_check(regions: DoubleArray) -> NDArray[np.int64]:
    """Rows to look behind: some evenly spaced, and those where the open region ``(heights, 3)`` changes most.

    They are among those that are lit and have a lit one behind.
    """
    lit = np.flatnonzero(regions[:, 1] > 1.01 * _PADDING)  # others are open nowhere
    between = np.intersect1d(lit, lit - 1)
    if not len(between):
        return between
    even = between[np.linspace(0, len(between) - 1, _CHECKED_HEIGHTS).round().astype(int)]
    change = np.abs(regions[between + 1] - regions[between]).sum(axis=1)
    return np.union1d(even, between[np.argsort(change)[-_CHECKED_CHANGES:]])


def _table(rows: DoubleArray, last_slope: float, degrees: Degrees, error_mm: float) -> PolynomialTable:
    bounds = np.abs(rows[..., BOUND : BOUND + 4])
    return PolynomialTable(
        rows.astype(np.float32),
        last_slope,
        pupil_reach_m=float((bounds[..., 2] + bounds[..., 3]).max()),
        slope_reach=float((bounds[..., 0] + bounds[..., 1]).max()),
        slope_degree=degrees.slope,
        pupil_degree=degrees.pupil,
        film_error_mm=error_mm,
    )


def _open_regions(tracer: SurfaceTracer, lens: FocusedLens, slopes: DoubleArray) -> list[Region]:
    """Open part of the stop for each field height, which changes smoothly with the height."""
    line = np.linspace(-1, 1, _GRID)
    square = np.stack(np.meshgrid(line, line[_GRID // 2 :], indexing="ij"), axis=-1)
    on_disc = np.hypot(*np.moveaxis(square, -1, 0)) <= 1 + 1e-9
    stops = square.reshape(-1, 2)

    def clearance(heights: NDArray[np.int64], points: NDArray[np.int64]) -> DoubleArray:
        traced = _trace(tracer, lens, slopes[heights], stops[points], (D_LINE_NM,))
        return np.asarray(np.where(traced.passed & _drawable(traced), np.maximum(traced.front, traced.rear), np.nan)[0])

    return [
        Region() if (values[on_disc] <= 0).all() else enclosing_region(_open_points(square, values), -1, _PADDING)
        for values in clearances(clearance, len(slopes), on_disc)
    ]


def _open_points(square: DoubleArray, clearance: DoubleArray) -> DoubleArray:
    """Points ``(n, 2)`` of a grid that are open, and those between neighbours where the clearance, taken as linear, is 0."""
    found = [square[clearance <= 0]]
    for axis in (0, 1):
        count = len(clearance[0]) if axis else len(clearance)
        (a, b), (p, q) = (
            (np.take(values, range(count - 1), axis), np.take(values, range(1, count), axis))
            for values in (clearance, square)
        )
        crosses = (a <= 0) != (b <= 0)
        crosses &= np.isfinite(a) & np.isfinite(b)
        part = (a[crosses] / (a[crosses] - b[crosses]))[:, None]
        found.append(p[crosses] + part * (q[crosses] - p[crosses]))
    return np.concatenate(found)


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
    stretched = half * np.linspace(1.0, 1.6, 121)
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
