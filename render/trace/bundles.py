"""From a camera to its rays: the one place that knows the lens models."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np

from render.gl.shaders import ProgramCache
from render.model.camera import Camera
from render.optics.prescription.mounting import has_surfaces, mounted
from render.optics.pupil_power import is_drawn, own_scales
from render.optics.spectrum import Spectrum, spectrum
from render.optics.thin_lens import focus_w, pupil_radius_m
from render.optics.view import PinholeView
from render.trace.data_sheet_table import data_sheet_table
from render.trace.drawn_power import drawn_thin_lens, with_drawn_power
from render.trace.grid_table import grid_table
from render.trace.lens_table import FRONT_RIM, PUPIL_T, SLOPE_T, GridTable, PolynomialTable
from render.trace.prescription_table import prescription_table
from render.trace.rays import RayBundle, RayPattern, thin_lens_bundle
from render.trace.seidel_table import seidel_table
from render.trace.surface_tracer import SurfaceTracer

LensTable = PolynomialTable | GridTable
_KEPT = 8
SHARED_WITHIN_PX = 0.25
"""Wavelengths whose rays stay this near to each other in the layers, in their pixels, share one ray."""


class BundleMaker:
    """Makes ray bundles, keeping the last few lens tables."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._tracer = SurfaceTracer(ctx, programs)
        self._tables: dict[tuple[object, ...], LensTable] = {}

    def bundle(self, camera: Camera, view: PinholeView, pattern: RayPattern, wavelengths: int = 3) -> RayBundle:
        """The rays of the camera's lens.

        Args:
            camera: with its lens.
            view: the picture; tables reach to its corners.
            pattern: where the rays start.
            wavelengths: how many to trace, for a lens with colour errors.

        Raises:
            InputError: the lens is none.
            SettingsError: it does not reach the focus distance, or there are too many wavelengths.
        """
        if camera.f_stop == 0 or not (_has_errors(camera) or is_drawn(camera.lens)):
            return thin_lens_bundle(camera, pattern)
        has_colours = _has_errors(camera) and camera.lens.scales.chromatic != 0
        light = spectrum(wavelengths) if has_colours else spectrum(1)
        table = self._table(camera, view, light)
        return RayBundle(
            pattern,
            (table.pupil_reach_m / camera.lens.squeeze, table.pupil_reach_m),
            table,
            light.rgb,
            camera.lens.transmittance,
            camera.lens.squeeze,
        )

    def _table(self, camera: Camera, view: PinholeView, light: Spectrum) -> LensTable:
        last_slope = corner_slope(view)
        lens = camera.lens
        key = (
            lens.model,
            lens.prescription,
            lens.seidel,
            lens.data_sheet,
            lens.height_field,
            lens.scales,
            lens.pupil_power,
            lens.expressive_blend,
            camera.focal_length_mm,
            camera.f_stop,
            camera.focus_distance_m if has_surfaces(camera) else None,  # errors that are told apart from it stay
            camera.horizontal_aperture_mm,
            camera.vertical_aperture_mm,
            last_slope,
            light.wavelengths_nm,
        )
        if key not in self._tables:
            while len(self._tables) >= _KEPT:
                del self._tables[next(iter(self._tables))]
            self._tables[key] = self._made(camera, last_slope, light)
        return self._tables[key]

    def _made(self, camera: Camera, last_slope: float, light: Spectrum) -> LensTable:
        """The table of the lens's own errors, and of what is drawn."""
        lens, focal_length_mm = camera.lens, camera.focal_length_mm
        if not _has_errors(camera):
            radius_m = pupil_radius_m(camera)
            return drawn_thin_lens(
                lens, focal_length_mm=focal_length_mm, pupil_radius_m=radius_m, last_slope=last_slope
            )
        own = self._own(camera, last_slope, light)
        if not is_drawn(lens):
            return own
        # real glass may not open as far as the f-number says
        radius_m = mounted(camera).entrance_pupil_radius_mm / 1000 if has_surfaces(camera) else pupil_radius_m(camera)
        return with_drawn_power(own, lens, focal_length_mm=focal_length_mm, pupil_radius_m=radius_m)

    def _own(self, camera: Camera, last_slope: float, light: Spectrum) -> LensTable:
        lens = camera.lens
        scales = own_scales(lens)
        if lens.model == "seidel" and lens.seidel is not None:
            return seidel_table(
                lens.seidel,
                scales,
                focal_length_mm=camera.focal_length_mm,
                pupil_radius_m=pupil_radius_m(camera),
                last_slope=last_slope,
                wavelengths_nm=light.wavelengths_nm,
            )
        if lens.model == "dataSheet" and lens.data_sheet is not None:
            return data_sheet_table(
                lens.data_sheet,
                scales,
                focal_length_mm=camera.focal_length_mm,
                pupil_radius_m=pupil_radius_m(camera),
                last_slope=last_slope,
                wavelengths_nm=light.wavelengths_nm,
            )
        if lens.model == "heightField" and lens.height_field is not None:
            return grid_table(
                self._tracer,
                mounted(camera),
                lens.height_field,
                last_slope,
                focus_w(camera),
                light.wavelengths_nm,
                scales,
            )
        return prescription_table(
            self._tracer, mounted(camera), last_slope, focus_w(camera), light.wavelengths_nm, scales
        )


def _has_errors(camera: Camera) -> bool:
    """Whether the lens has errors of its own."""
    return has_surfaces(camera) or camera.lens.has_thin_errors


def corner_slope(view: PinholeView) -> float:
    """Field of the picture's farthest corner: slope in object space, of an ideal lens."""
    x = max(view.cx, view.width - view.cx) / view.fx
    y = max(view.cy, view.height - view.cy) / view.fy
    return float(np.hypot(x, y))


def shared_rays(bundle: RayBundle, f_px: float, w_span: float) -> RayBundle:
    """The bundle with one ray for all wavelengths, where their rays differ by less than anyone could see.

    Args:
        bundle: of any lens.
        f_px: focal length in layer pixels.
        w_span: largest difference to the inverse depth in focus of anything in view, 1/m.
    """
    if not isinstance(bundle.table, PolynomialTable) or len(bundle.rgb) == 1:
        return bundle
    rows = bundle.table.rows
    middle = rows[len(rows) // 2]
    apart = np.abs(rows - middle)
    spread = apart[..., SLOPE_T:PUPIL_T].sum(-1) + apart[..., PUPIL_T:FRONT_RIM].sum(-1) * w_span
    if spread.max() * f_px > SHARED_WITHIN_PX:
        return bundle
    return replace(bundle, table=replace(bundle.table, rows=middle[None]), rgb=np.ones((1, 3)))
