"""Two lenses side by side, at the same setting and gate."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from render.errors import InputError, SettingsError
from render.model.camera import Camera
from render.optics.prescription.mounting import breathing_ratio, has_surfaces
from render.optics.report import LensReport
from render.shot.lens.lens_alone import LensAlone

BREATHING_M = (5.0, 2.0, 1.0, 0.5)
"""Focus distances from the entrance pupil."""


@dataclass(frozen=True, eq=False)
class ComparedLens:
    """One lens of a comparison.

    Attributes:
        lens: the lens.
        report: of it as it is set.
        picture_error_mm: error on the film of the rays of pictures; None where it is not known.
        breathing: growth of the picture from focus at infinity, as a share, at `BREATHING_M`; NaN where it does not focus.
    """

    lens: LensAlone
    report: LensReport
    picture_error_mm: float | None
    breathing: tuple[float, ...]


def compared_lens(lens: LensAlone, report: LensReport, picture_error_mm: float | None) -> ComparedLens:
    """Measure what a comparison shows beside a lens's report.

    Args:
        lens: the lens.
        report: of it as it is set.
        picture_error_mm: error on the film of the rays of pictures; None where it is not known.
    """
    return ComparedLens(
        lens, report, picture_error_mm, tuple(_growth(report.camera, distance) for distance in BREATHING_M)
    )


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
