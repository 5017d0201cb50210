"""Two lenses side by side, at the same setting and gate."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from render.errors import InputError, SettingsError
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.lens import DataSheet, IrisShape
from render.optics.data_sheet import at_heights
from render.optics.iris import fill_iris
from render.optics.measured.geometric_mtf import geometric_mtf
from render.optics.prescription.mounting import breathing_ratio, has_surfaces
from render.optics.report import LensReport
from render.optics.report.field import WAVELENGTHS_NM, radial
from render.optics.report.lens_report import film_rays
from render.optics.sampling import sample_points
from render.shot.lens.lens_alone import LensAlone
from render.shot.lens.measured_lens import measured_lens

MTF_PER_MM = (10.0, 20.0, 40.0)
"""Line pairs per millimetre on the film."""
BREATHING_M = (5.0, 2.0, 1.0, 0.5)
"""Focus distances from the entrance pupil."""
_MTF_HEIGHTS = 13
_RAYS = 600


@dataclass(frozen=True, eq=False)
class ComparedLens:
    """One lens of a comparison.

    Attributes:
        lens: the lens.
        report: of it as it is set.
        heights_mm: ``(n,)`` from the axis to the gate's corner, of the curves below.
        mtf: ``(n, 3, 2)`` geometric contrast of white light at `MTF_PER_MM`, tangential and sagittal; NaN where it is dark, and
            of a pinhole.
        lateral_colour_mm: ``(n,)`` image height at 650 nm less that at 475 nm.
        axial_colour_mm: focus at 650 nm less focus at 475 nm on the axis; 0 of a pinhole.
        breathing: growth of the picture from focus at infinity, as a share, at `BREATHING_M`; NaN where it does not focus.
    """

    lens: LensAlone
    report: LensReport
    heights_mm: DoubleArray
    mtf: DoubleArray
    lateral_colour_mm: DoubleArray
    axial_colour_mm: float
    breathing: tuple[float, ...]


def compared_lens(lens: LensAlone, report: LensReport) -> ComparedLens:
    """Measure what a comparison shows beside a lens's report.

    Args:
        lens: the lens.
        report: of it as it is set.
    """
    heights = np.linspace(0.0, report.corner_mm, _MTF_HEIGHTS)
    sheet = measured_lens(lens, report).sheet if report.f_stop else DataSheet((0.0,))
    return ComparedLens(
        lens,
        report,
        heights,
        _mtf(report, heights),
        np.where(heights <= sheet.heights_mm[-1] + 1e-9, at_heights(sheet, "lateral_color_mm", heights), np.nan),
        float(at_heights(sheet, "axial_color_mm", np.zeros(1))[0]),
        tuple(_growth(report.camera, distance) for distance in BREATHING_M),
    )


def _mtf(report: LensReport, heights: DoubleArray) -> DoubleArray:
    frequencies = np.array(MTF_PER_MM)
    if not report.f_stop:
        return np.full((len(heights), len(frequencies), 2), np.nan)
    rays = film_rays(report.camera)
    pupil = fill_iris(sample_points(_RAYS, 0)[0, :, :2], report.camera.iris or IrisShape())
    beams = [rays.beams(radial(heights), pupil, wavelength) for wavelength in WAVELENGTHS_NM]
    landing = np.concatenate([beam.landing_mm for beam in beams], axis=1)
    light = np.concatenate([np.where(beam.open, beam.light, 0.0) for beam in beams], axis=1)
    light *= (heights <= rays.last_height_mm)[:, None]
    # the places are straight above the middle: up is along the radius
    return geometric_mtf(np.where(np.isfinite(landing), landing, 0.0)[..., ::-1], light, frequencies)


def _growth(camera: Camera, distance_m: float) -> float:
    """Growth of the picture from focus at infinity to a distance."""
    if not has_surfaces(camera):
        focal_m = camera.focal_length_mm / 1000
        return focal_m / (distance_m - focal_m) if distance_m > focal_m else math.nan
    try:
        near, far = (breathing_ratio(replace(camera, focus_distance_m=d)) for d in (distance_m, math.inf))
    except (InputError, SettingsError):
        return math.nan
    return near / far - 1
