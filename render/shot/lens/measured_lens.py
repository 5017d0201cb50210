"""The data sheet of a lens on its own."""

from __future__ import annotations

import math

import numpy as np

from render.errors import SettingsError
from render.optics.lens_files import MeasuredLens
from render.optics.report import LensReport
from render.optics.report.lens_report import film_rays
from render.optics.report.measuring import measured_sheet
from render.shot.lens.lens_alone import LensAlone

_HEIGHTS = 10
_CLOSED = 22.0
"""How far an iris closes whose lens does not say it."""


def measured_lens(lens: LensAlone, report: LensReport) -> MeasuredLens:
    """What a test bench would write down of a lens as it is set; the sheet itself of a lens that is known by one.

    Args:
        lens: which one.
        report: of it; up to its gate's corner it is measured.

    Raises:
        SettingsError: it is a pinhole, which has no errors.
    """
    camera = report.camera
    if not report.f_stop:
        raise SettingsError(f"{lens.title} is a pinhole: it has no errors to write down")
    sheet = camera.lens.data_sheet
    source = lens.description
    if sheet is None:
        sheet = measured_sheet(film_rays(camera), np.linspace(0.0, report.corner_mm, _HEIGHTS), report.f_stop)
        distance = camera.focus_distance_m
        focus = "infinity" if math.isinf(distance) else f"{distance:g} m"
        source = f"measured on the rays of {lens.title} at f/{report.f_stop:.3g}, focused at {focus}"
    return MeasuredLens(
        lens.title,
        camera.focal_length_mm,
        sheet,
        (lens.f_stop, max(_CLOSED, lens.f_stop)),
        camera.lens.close_focus_m,
        (source,) if source else (),
    )
