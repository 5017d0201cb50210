"""Ray bundles of cameras: the only place that knows all lens models."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np

from render.disk_cache import code_key, content_key, load_arrays, store_arrays
from render.gl.shaders import ProgramCache
from render.model.camera import Camera
from render.optics.prescription.mounting import has_surfaces, mount_lens
from render.optics.pupil_power import is_drawn, own_scales
from render.optics.spectrum import Spectrum, spectrum
from render.optics.thin_lens import focus_w, pupil_radius_m
from render.optics.view import PinholeView
from render.trace.data_sheet_table import make_data_sheet_table
from render.trace.drawn_power import add_drawn_power, make_drawn_lens_table
from render.trace.grid_table import make_asymmetric_table, make_grid_table
from render.trace.lens_table import (
    FRONT_RIM,
    PUPIL_T,
    ROW_LENGTH,
    SLOPE_T,
    LensTable,
    PolynomialTable,
    table_arrays,
    table_from_arrays,
)
from render.trace.prescription_table import make_prescription_table
from render.trace.rays import RayBundle, RayPattern, make_thin_lens_bundle
from render.trace.seidel_table import make_seidel_table
from render.trace.surface_tracer import SurfaceTracer

_KEPT = 8
_STORED = 4
"""Tables that are kept on disk at most: those that the next process starts with. A drag of the focus makes many more."""
_KIND = "lens-table"
_CODE = ("model", "optics", "shaders", "trace")
"""Folders with the code that tables depend on."""
SHARED_WITHIN_PX = 0.25
"""Distance in layer pixels within which the rays of all wavelengths share one ray."""


class BundleMaker:
    """Makes ray bundles, caching the last few lens tables, and the first few also on disk."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._tracer = SurfaceTracer(ctx, programs)
        self._device = ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"]
        self._stored = 0
        self._tables: dict[tuple[object, ...], LensTable] = {}

    def make_bundle(self, camera: Camera, view: PinholeView, pattern: RayPattern, wavelengths: int = 3) -> RayBundle:
        """Make the rays of a camera's lens.

        Args:
            camera: camera with its lens.
            view: view of the picture; tables extend to its corners.
            pattern: ray pattern.
            wavelengths: number of wavelengths to trace, for a lens with colour errors.

        Raises:
            InputError: the prescription is not a lens.
            SettingsError: it does not reach the focus distance, or there are too many wavelengths.
        """
        if camera.f_stop == 0 or not (_has_errors(camera) or is_drawn(camera.lens)):
            return make_thin_lens_bundle(camera, pattern)
        has_colours = _has_errors(camera) and camera.lens.scales.chromatic != 0
        light = spectrum(wavelengths) if has_colours else spectrum(1)
        table, squeeze = self._table(camera, view, light), camera.lens.drawn_squeeze
        return RayBundle(
            pattern,
            (table.pupil_reach_m / squeeze, table.pupil_reach_m),
            table,
            light.rgb,
            camera.lens.transmittance,
            squeeze,
        )

    def _table(self, camera: Camera, view: PinholeView, light: Spectrum) -> LensTable:
        lens, last_slope = camera.lens, corner_slope(view)
        edges = edge_slopes(view) if lens.has_cylinders or lens.has_outlines else None
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
            camera.focus_distance_m if has_surfaces(camera) else None,  # errors of other lenses do not depend on it
            camera.horizontal_aperture_mm,
            camera.vertical_aperture_mm,
            last_slope,
            light.wavelengths_nm,
            edges and (edges, lens.squeeze),
        )
        if key not in self._tables:
            while len(self._tables) >= _KEPT:
                del self._tables[next(iter(self._tables))]
            disk_key = content_key(code_key(_CODE), self._device, key)
            table = _load_table(disk_key)
            if table is None:
                table = self._make_table(camera, last_slope, edges, light)
                self._store_table(disk_key, table)
            self._tables[key] = table
        return self._tables[key]

    def _store_table(self, disk_key: str, table: LensTable) -> None:
        if self._stored < _STORED:
            self._stored += 1
            store_arrays(_KIND, disk_key, table_arrays(table))

    def _make_table(
        self, camera: Camera, last_slope: float, edges: tuple[float, float] | None, light: Spectrum
    ) -> LensTable:
        """Make the table of the lens's own errors and of drawn power."""
        lens, focal_length_mm = camera.lens, camera.focal_length_mm
        if not _has_errors(camera):
            radius_m = pupil_radius_m(camera)
            return make_drawn_lens_table(
                lens, focal_length_mm=focal_length_mm, pupil_radius_m=radius_m, last_slope=last_slope
            )
        own = self._own_table(camera, last_slope, edges, light)
        if not is_drawn(lens):
            return own
        # real glass may be narrower than the f-number says
        radius_m = (
            mount_lens(camera).entrance_pupil_radius_mm / 1000 if has_surfaces(camera) else pupil_radius_m(camera)
        )
        return add_drawn_power(own, lens, focal_length_mm=focal_length_mm, pupil_radius_m=radius_m)

    def _own_table(
        self, camera: Camera, last_slope: float, edges: tuple[float, float] | None, light: Spectrum
    ) -> LensTable:
        lens = camera.lens
        scales = own_scales(lens)
        if edges is not None:
            glass, wavelengths_nm = mount_lens(camera), light.wavelengths_nm
            squeeze = lens.squeeze if lens.has_cylinders else 1.0
            return make_asymmetric_table(self._tracer, glass, squeeze, edges, focus_w(camera), wavelengths_nm, scales)
        if lens.model == "seidel" and lens.seidel is not None:
            return make_seidel_table(
                lens.seidel,
                scales,
                focal_length_mm=camera.focal_length_mm,
                pupil_radius_m=pupil_radius_m(camera),
                last_slope=last_slope,
                wavelengths_nm=light.wavelengths_nm,
            )
        if lens.model == "dataSheet" and lens.data_sheet is not None:
            return make_data_sheet_table(
                lens.data_sheet,
                scales,
                focal_length_mm=camera.focal_length_mm,
                pupil_radius_m=pupil_radius_m(camera),
                last_slope=last_slope,
                wavelengths_nm=light.wavelengths_nm,
            )
        if lens.model == "heightField" and lens.height_field is not None:
            return make_grid_table(
                self._tracer,
                mount_lens(camera),
                lens.height_field,
                last_slope,
                focus_w(camera),
                light.wavelengths_nm,
                scales,
            )
        return make_prescription_table(
            self._tracer, mount_lens(camera), last_slope, focus_w(camera), light.wavelengths_nm, scales
        )


def _load_table(disk_key: str) -> LensTable | None:
    arrays = load_arrays(_KIND, disk_key)
    if arrays is None:
        return None
    try:
        return table_from_arrays(arrays)
    except ValueError:  # an entry of something else
        return None


def _has_errors(camera: Camera) -> bool:
    """Whether the lens has errors of its own."""
    return has_surfaces(camera) or camera.lens.has_thin_errors


def corner_slope(view: PinholeView) -> float:
    """Field of the picture's farthest corner: slope in object space of an ideal lens."""
    return float(np.hypot(*edge_slopes(view)))


def edge_slopes(view: PinholeView) -> tuple[float, float]:
    """Fields of the picture's farthest edges, from side to side and up and down."""
    return max(view.cx, view.width - view.cx) / view.fx, max(view.cy, view.height - view.cy) / view.fy


def merge_wavelengths(bundle: RayBundle, f_px: float, w_span: float) -> RayBundle:
    """Merge all wavelengths into one ray where their rays differ invisibly.

    Args:
        bundle: ray bundle of any lens.
        f_px: focal length in layer pixels.
        w_span: largest difference between the inverse depth in focus and that of any surface in view, 1/m.
    """
    if not isinstance(bundle.table, PolynomialTable) or len(bundle.rgb) == 1:
        return bundle
    rows = bundle.table.rows
    middle = rows[len(rows) // 2]
    apart = np.abs(rows - middle)
    slopes = apart[..., SLOPE_T:PUPIL_T].sum(-1) + apart[..., ROW_LENGTH:].sum(-1)
    spread = slopes + apart[..., PUPIL_T:FRONT_RIM].sum(-1) * w_span
    if spread.max() * f_px > SHARED_WITHIN_PX:
        return bundle
    return replace(bundle, table=replace(bundle.table, rows=middle[None]), rgb=np.ones((1, 3)))
