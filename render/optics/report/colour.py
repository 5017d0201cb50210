"""Longitudinal aberration over the pupil, and lateral colour over the field, for each colour of the picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray
from render.optics.report.field import WAVELENGTHS_NM, radial
from render.optics.report.film_rays import FilmRays

_ZONES, _HEIGHTS = 25, 25
_NARROW = 0.02  # of the pupil: the innermost zone


@dataclass(frozen=True, eq=False)
class ColourCurves:
    """Errors of red, green and blue light (`render.optics.report.field.WAVELENGTHS_NM`); NaN where no ray passes.

    Attributes:
        pupil: ``(n,)`` heights of rays in the stop, over its radius.
        longitudinal_mm: ``(3, n)`` where these rays cross the axis, behind the film.
        heights_mm: ``(k,)`` of the image.
        lateral_um: ``(3, k)`` by which the chief ray lands farther from the axis than the green one.
    """

    pupil: DoubleArray
    longitudinal_mm: DoubleArray
    heights_mm: DoubleArray
    lateral_um: DoubleArray


def measure_colour(rays: FilmRays, corner_mm: float) -> ColourCurves:
    """Measure a lens's colour errors and the spherical aberration of each colour.

    Args:
        rays: of the lens.
        corner_mm: height of the gate's corner.
    """
    pupil, heights = np.linspace(_NARROW, 1.0, _ZONES), np.linspace(0.0, corner_mm, _HEIGHTS)
    fan = np.stack([0 * pupil, pupil], axis=1)
    longitudinal, chief = [], []
    for wavelength in WAVELENGTHS_NM:
        on_axis = rays.beams(np.zeros((1, 2)), fan, wavelength)
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = -on_axis.landing_mm[0, :, 1] / on_axis.slopes[0, :, 1]
        longitudinal.append(np.where(on_axis.open[0], crossing, np.nan))
        chief.append(rays.beams(radial(rays, heights), np.zeros((1, 2)), wavelength).landing_mm[:, 0, 1])
    green = chief[len(chief) // 2]
    lateral = 1000 * (np.array(chief) - green)
    lateral[:, heights > rays.last_height_mm] = np.nan
    return ColourCurves(pupil, np.array(longitudinal), heights, lateral)
