"""Data sheet of a lens, as a test bench would measure it."""

from __future__ import annotations

import math

import numpy as np

from render.errors import SettingsError
from render.optics.lens_files import MeasuredLens
from render.optics.report import LensReport
from render.optics.report.lens_report import film_rays
from render.optics.report.measuring import measure_sheet
from render.shot.lens.lens_alone import LensAlone

_HEIGHTS = 10
_SMALLEST_STOP = 22.0
"""F-number to which a lens of unknown range is assumed to close."""


def measured_lens(lens: LensAlone, report: LensReport) -> MeasuredLens:
    """Measure the data sheet of a lens as it is set; a lens that is described by a sheet returns that sheet.

    Args:
        lens: the lens.
        report: of the lens; it is measured up to the corner of its gate.

    Raises:
        SettingsError: it is a pinhole, which has no aberrations, or has cylinders, openings or obscurations, which no data sheet
            describes.
    """
    camera = report.camera
    if not report.f_stop:
        raise SettingsError(f"{lens.title} is a pinhole: it has no errors to write down")
    if camera.lens.has_cylinders:
        raise SettingsError(f"{lens.title} has cylinders: a data sheet is round")
    if camera.lens.has_outlines:
        raise SettingsError(f"{lens.title} has openings or obscurations: a data sheet knows no shape of the pupil")
    sheet = camera.lens.data_sheet
    source = lens.description
    if sheet is None:
        sheet = measure_sheet(film_rays(camera), np.linspace(0.0, report.corner_mm, _HEIGHTS), report.f_stop)
        distance = camera.focus_distance_m
        focus = "infinity" if math.isinf(distance) else f"{distance:g} m"
        source = f"measured on the rays of {lens.title} at f/{report.f_stop:.3g}, focused at {focus}"
    return MeasuredLens(
        lens.title,
        camera.focal_length_mm,
        sheet,
        (lens.f_stop, max(_SMALLEST_STOP, lens.f_stop)),
        camera.lens.close_focus_m,
        (source,) if source else (),
    )
