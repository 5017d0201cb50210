"""Field focus: the inverse depth at which a lens is sharpest over the field, relative to its focus: field curvature and
the spot's best focus.

It is `render.trace.sharpness` without a device or a picture, for readouts and for the focus solver. Rays of glass are
traced in float64, a few for each field height, at a few focus distances between which the shift is interpolated
linearly: it changes little from one to the next. Height fields are left out, as they have no symmetry.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.data_sheet import DataSheet
from render.model.lens import AberrationScales, Lens, LensModel, Prescription, SeidelErrors
from render.optics.distortion import chief_rays
from render.optics.focus_law import focus_law, round_focal_length
from render.optics.glass import D_LINE_NM
from render.optics.prescription.focusing import FocusedLens, focus_lens
from render.optics.prescription.meridians import upright
from render.optics.prescription.mounting import has_surfaces, scale_to
from render.optics.prescription.principal_rays import principal_rays
from render.optics.prescription.stop_rays import rays_from_film
from render.optics.pupil_power import is_drawn, own_scales
from render.optics.spectrum import THREE_LINES
from render.optics.thin_lens import focus_w
from render.optics.view import PinholeView
from render.trace.data_sheet_table import make_data_sheet_table
from render.trace.drawn_power import slope_errors
from render.trace.lens_fit import NodeRays, PupilFit, Region, mean_light, pupil_nodes
from render.trace.lens_table import LIGHT, PolynomialTable
from render.trace.prescription_table import MAX_SLOPE, enclosing_region, extend_dark_rows, scale_chromatic, scale_rays
from render.trace.seidel_table import make_seidel_table
from render.trace.sharpness import find_least_spread, rays_of_heights

HEIGHTS = 13
_COARSE = (60, 24)
_FINE = (80, 20)
"""Nodes of the half pupil and on its rim: a coarse set that finds the open part, and a fine set for the fit."""
_PADDING = 0.15  # spacing of the coarse nodes, relative to the stop's radius
_STEP_FOCAL_LENGTHS = 0.02
"""Step between traced focus distances, in focal length over focus distance: 0.4 1/m for 50 mm."""
_WITHIN = 1 - 1e-6  # share of the nearest focus, which rounding might put out of reach


@dataclass(frozen=True, eq=False)
class FieldFocus:
    """Field focus for heights from the axis outward; constant beyond the last.

    Attributes:
        heights: ``(h,)`` slopes of the ideal lens: positions in the picture.
        seen: ``(h,)`` slopes in object space seen there, growing, with distortion.
        shift_w: ``(h,)`` difference between the sharpest inverse depth and the focus, 1/m.
        pupil: ``(h,)`` radius of the pupil seen from there (of a disc with the same spread as its rays) over that of the beam on
            the axis.
    """

    heights: DoubleArray
    seen: DoubleArray
    shift_w: DoubleArray
    pupil: DoubleArray

    def at(self, slopes: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
        """Shift and relative pupil radius ``(...)`` of objects at slopes ``(..., 2)`` in object space."""
        height = np.hypot(slopes[..., 0], slopes[..., 1])
        return np.interp(height, self.seen, self.shift_w), np.interp(height, self.seen, self.pupil)


def field_focus(camera: Camera, focus_w_per_m: float | None = None) -> FieldFocus | None:
    """Field focus of the camera's lens over its film gate; None for a lens without errors.

    Args:
        camera: with its lens.
        focus_w_per_m: focus, 1/m; by default the camera's. Clamped to the lens's range.

    Raises:
        InputError: the prescription is not a lens.
    """
    return _FocusInterpolator(camera).at(focus_w(camera) if focus_w_per_m is None else focus_w_per_m)


def field_shifts_w(camera: Camera, slopes: DoubleArray, focus_w_per_m: DoubleArray) -> DoubleArray:
    """Focus errors ``(k,)`` of k objects in 1/m, if the lens were focused as if it had no field curvature.

    Args:
        camera: with its lens.
        slopes: ``(k, 2)`` slopes of the objects in object space; not finite for none, whose shift is 0.
        focus_w_per_m: ``(k,)`` focus of the lens for each.

    Raises:
        InputError: the prescription is not a lens.
    """
    lens = _FocusInterpolator(camera)
    shifts = np.zeros(len(slopes))
    if lens.has_errors:
        for i in np.flatnonzero(np.isfinite(slopes).all(axis=-1) & np.isfinite(focus_w_per_m)):
            field = lens.at(float(focus_w_per_m[i]))
            shifts[i] = 0.0 if field is None else field.at(slopes[i])[0]
    return shifts


@dataclass(frozen=True)
class _Errors:
    """Parameters that a lens's errors depend on; equal lenses have equal errors."""

    model: LensModel
    prescription: Prescription | None
    seidel: SeidelErrors | None
    data_sheet: DataSheet | None
    scales: AberrationScales
    pupil_power: tuple[float, ...]
    expressive_blend: float

    @classmethod
    def from_lens(cls, lens: Lens) -> _Errors:
        seidel = lens.seidel if lens.model == "seidel" else None
        sheet = lens.data_sheet if lens.model == "dataSheet" else None
        glass = lens.prescription
        if glass is not None and glass.is_anamorphic:
            glass = upright(glass)  # the focus of the picture is that from top to bottom
        return cls(lens.model, glass, seidel, sheet, lens.scales, lens.pupil_power, lens.expressive_blend)

    @property
    def lens(self) -> Lens:
        return Lens(
            self.model,
            prescription=self.prescription,
            seidel=self.seidel,
            data_sheet=self.data_sheet,
            scales=self.scales,
            pupil_power=self.pupil_power,
            expressive_blend=self.expressive_blend,
        )

    @property
    def wavelengths_nm(self) -> tuple[float, ...]:
        """Wavelengths at which sharpness is measured and from which colour errors are scaled."""
        middle = THREE_LINES.wavelengths_nm[1]
        return {0.0: (D_LINE_NM,), 1.0: (middle,)}.get(self.scales.chromatic, (middle, D_LINE_NM))


class _FocusInterpolator:
    """Field focus of a camera's lens at any focus.

    Glass is traced at a rounded focal length and then scaled, so that a zoom traces few lenses.
    """

    def __init__(self, camera: Camera) -> None:
        self._errors, self._f_stop, self._corner_slope = _Errors.from_lens(camera.lens), camera.f_stop, 0.0
        self._focal_mm, self._scale = camera.focal_length_mm, 1.0
        self._is_glass = has_surfaces(camera)
        thin_errors = camera.lens.has_thin_errors
        self.has_errors = camera.f_stop > 0 and (self._is_glass or thin_errors or is_drawn(camera.lens))
        self._kept: dict[int, FieldFocus] = {}
        if not self.has_errors:
            return
        self._corner_slope = _corner_slope(camera)
        if self._is_glass:
            self._focal_mm = _traced_focal_length(camera)
            self._scale = camera.focal_length_mm / self._focal_mm
            self._diagonal_mm = _round_length(camera.covered_mm / self._scale)
            self._near_w = float(focus_law(camera).near_w[0]) * self._scale * _WITHIN

    def at(self, w: float) -> FieldFocus | None:
        """Field focus at an inverse depth, 1/m; None for a lens without errors."""
        if not self.has_errors:
            return None
        if not self._is_glass:
            return _thin_field_focus(self._errors, self._focal_mm, self._f_stop, self._corner_slope)
        step_w = _STEP_FOCAL_LENGTHS * 1000 / self._focal_mm
        at = min(max(w * self._scale, 0.0), self._near_w) / step_w
        low, high = (self._node(int(at) + i, step_w) for i in (0, 1))
        last = min(int(at) + 1, self._near_w / step_w)
        share = (at - int(at)) / (last - int(at)) if last > int(at) else 0.0
        seen, shift, pupil = (
            (1 - share) * getattr(low, name) + share * getattr(high, name) for name in ("seen", "shift_w", "pupil")
        )
        return FieldFocus(low.heights, seen, shift / self._scale, pupil)

    def _node(self, index: int, step_w: float) -> FieldFocus:
        if index not in self._kept:
            w = min(index * step_w, self._near_w)
            self._kept[index] = _trace_glass(
                self._errors, self._focal_mm, self._f_stop, self._diagonal_mm, self._corner_slope, w
            )
        return self._kept[index]


@lru_cache(maxsize=256)
def _trace_glass(
    errors: _Errors, focal_length_mm: float, f_stop: float, diagonal_mm: float, reach: float, w: float
) -> FieldFocus:
    if errors.prescription is None:
        raise ValueError("a lens of glass has a prescription")
    lens = focus_lens(
        scale_to(errors.prescription, focal_length_mm, diagonal_mm / 2), 1 / w if w > 0 else math.inf, f_stop
    )
    heights = np.linspace(0.0, reach, HEIGHTS)
    coarse, fine = pupil_nodes(*_COARSE), pupil_nodes(*_FINE)
    whole = _rays(lens, heights, [Region()] * HEIGHTS, coarse, w, D_LINE_NM)
    regions = [_open_region(rays, coarse) for rays in whole]
    traced = [_rays(lens, heights, regions, fine, w, wavelength) for wavelength in errors.wavelengths_nm]
    rays = scale_chromatic(traced, errors.scales.chromatic)[0] if len(traced) > 1 else traced[0]
    scales = own_scales(errors.lens)
    rays = [scale_rays(r, rays[0], region, fine, scales) for r, region in zip(rays, regions, strict=True)]
    fit = PupilFit(fine)
    rows = np.array([[fit.row(r, region) for r, region in zip(rays, regions, strict=True)]])
    rows[..., LIGHT] = mean_light(rows[0])
    chief = principal_rays(lens)
    seen = _distort(heights, chief.heights_mm / lens.image_scale_mm, chief.slopes + chief.pupil_mm / 1000 * w)
    table = PolynomialTable(extend_dark_rows(rows).astype(np.float32), reach, 0.0, 0.0)
    return _from_table(errors, table, seen, focal_length_mm, lens.entrance_pupil_radius_mm)


def _from_table(
    errors: _Errors, table: PolynomialTable, seen: DoubleArray, focal_length_mm: float, pupil_radius_mm: float
) -> FieldFocus:
    """Field focus from a lens table, with drawn power added to it; ``seen`` is without the factor on distortion."""
    slope, pupil, is_open = rays_of_heights(table)
    if is_drawn(errors.lens):
        slope = slope + slope_errors(errors.lens, focal_length_mm, pupil_radius_mm / 1000, pupil)
    shift, radius = find_least_spread(slope, pupil, is_open.astype(np.float64))
    heights = np.linspace(0.0, table.last_slope, len(shift))
    scaled = np.maximum.accumulate(heights + errors.scales.distortion * (seen - heights))
    return FieldFocus(heights, scaled, shift, radius * 1000 / pupil_radius_mm)


def _distort(heights: DoubleArray, ideal: DoubleArray, seen: DoubleArray) -> DoubleArray:
    """Slopes seen at ``heights``, from chief rays given at the heights ``ideal``; beyond the last of them the
    distortion stays.
    """
    inside = np.clip(heights, 1e-9 * ideal[-1], ideal[-1])
    return np.asarray(heights * np.interp(inside, ideal, np.maximum.accumulate(seen)) / inside)


def _open_region(rays: NodeRays, nodes: DoubleArray) -> Region:
    is_open = rays.passed & (rays.front <= 0) & (rays.rear <= 0)
    return enclosing_region(nodes[is_open], len(nodes), _PADDING)


def _rays(
    lens: FocusedLens, heights: DoubleArray, regions: list[Region], nodes: DoubleArray, w: float, wavelength_nm: float
) -> list[NodeRays]:
    """Rays by field height, all of equal weight."""
    upright = np.sign(lens.first.entrance_pupil_magnification)
    film = np.repeat(np.stack([-heights * lens.image_scale_mm, 0 * heights], axis=1), len(nodes), axis=0)
    on_stop = np.concatenate([region.on_stop(nodes) for region in regions])
    found = rays_from_film(lens, film, upright * on_stop, wavelength_nm)
    shape = (len(heights), len(nodes))
    slope, pupil_m = found.slope.reshape(*shape, 2), found.pupil_mm.reshape(*shape, 2) / 1000
    drawable = (found.passed & (np.hypot(*found.slope.T) <= MAX_SLOPE)).reshape(shape)
    front, rear = found.front.reshape(shape), found.rear.reshape(shape)
    return [
        NodeRays(
            slope=slope[i] + pupil_m[i] * w - [height, 0.0],
            pupil_m=pupil_m[i],
            front=front[i],
            rear=rear[i],
            weight=np.ones(len(nodes)),
            passed=drawable[i],
        )
        for i, height in enumerate(heights)
    ]


@lru_cache(maxsize=256)
def _thin_field_focus(errors: _Errors, focal_length_mm: float, f_stop: float, reach: float) -> FieldFocus:
    """Field focus of a lens without surfaces, which is the same wherever it is focused."""
    scales, wavelengths, radius_m = (
        own_scales(errors.lens),
        errors.wavelengths_nm[:1],
        focal_length_mm / (2000 * f_stop),
    )
    lens = {"focal_length_mm": focal_length_mm, "pupil_radius_m": radius_m, "last_slope": reach}
    if errors.data_sheet is not None:
        table = make_data_sheet_table(errors.data_sheet, scales, **lens, wavelengths_nm=wavelengths)
    else:
        table = make_seidel_table(errors.seidel or SeidelErrors(), scales, **lens, wavelengths_nm=wavelengths)
    camera = Camera(np.eye(4), focal_length_mm, f_stop=f_stop, lens=replace(errors.lens, scales=AberrationScales()))
    chief, heights = chief_rays(camera), np.linspace(0.0, reach, table.rows.shape[1])
    seen = heights if chief is None else _distort(heights, chief.ideal, chief.seen)
    return _from_table(errors, table, seen, focal_length_mm, focal_length_mm / (2 * f_stop))


def _corner_slope(camera: Camera) -> float:
    """Slope of the gate's farthest corner, a little rounded up."""
    view = PinholeView.from_camera(camera, 1, 1)
    slope = math.hypot(max(view.cx, 1 - view.cx) / view.fx, max(view.cy, 1 - view.cy) / view.fy)
    return 2 ** (math.ceil(8 * math.log2(slope)) / 8)


def _traced_focal_length(camera: Camera) -> float:
    prescription = camera.lens.prescription
    if prescription is None:
        raise ValueError("a lens of glass has a prescription")
    return round_focal_length(prescription, camera.focal_length_mm)


def _round_length(length_mm: float) -> float:
    return float(f"{length_mm:.2g}")
