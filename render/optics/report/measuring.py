"""Measurement of a data sheet from a lens's rays, as on a maker's test bench."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray
from render.model.data_sheet import DataSheet
from render.model.lens import IrisShape
from render.optics.data_sheet import MIDDLE_NM
from render.optics.iris import fill_iris
from render.optics.report.field import radial, relative_light
from render.optics.report.film_rays import FilmRays
from render.optics.sampling import sample_points

_RAYS = 900
_RED_NM, _BLUE_NM = 650.0, 475.0
_NOTHING_LEFT = 0.3  # of the spread: where curvature and coma leave less, the rest has no shape to speak of
_DARK = 0.01  # of the light on the axis: darker fields are not measured


@dataclass(frozen=True)
class _Fitted:
    """Errors of one place and colour, as they grow over the pupil.

    Attributes:
        defocus_mm: landing at the pupil's edge in proportion to the pupil, mean of both planes.
        coma_mm: a third of the flare's length.
        spherical: share of the rest that is spherical aberration, as `render.model.lens.DataSheet` counts it.
        spread_mm: standard deviation of all, along the radius and across.
    """

    defocus_mm: float
    coma_mm: float
    spherical: float
    spread_mm: tuple[float, float]


def measure_sheet(rays: FilmRays, heights_mm: DoubleArray, f_stop: float) -> DataSheet:
    """Measure a lens.

    Args:
        rays: rays of the focused lens.
        heights_mm: ``(k,)`` image heights, from 0 outward; dark heights are left out.
        f_stop: of the rays.
    """
    light = np.clip(relative_light(rays, heights_mm), 0.0, 2.0)
    light[0] = 1.0
    lit = (light > _DARK) & (heights_mm <= rays.last_height_mm)
    heights = heights_mm[: int(np.argmin(lit)) if not lit.all() else len(lit)]
    light = light[: len(heights)]
    fits = [_fit(rays, heights, wavelength) for wavelength in (MIDDLE_NM, _RED_NM, _BLUE_NM)]
    chiefs = [rays.beams(radial(rays, heights), np.zeros((1, 2)), nm).landing_mm[:, 0, 1] for nm in (_RED_NM, _BLUE_NM)]
    main, red, blue = fits
    distortion = np.zeros(len(heights))
    distortion[1:] = heights[1:] / rays.paraxial_height_mm(heights)[1:] - 1

    def listed(values: object) -> tuple[float, ...]:
        return tuple(float(value) for value in np.round(np.asarray(values, np.float64), 6) + 0.0)

    return DataSheet(
        heights_mm=listed(heights),
        distortion=listed(distortion),
        light=listed(light),
        sagittal_blur_mm=listed([fit.spread_mm[1] for fit in main]),
        tangential_blur_mm=listed([fit.spread_mm[0] for fit in main]),
        spherical=listed([fit.spherical for fit in main]),
        coma_mm=listed([0.0, *(3 * fit.coma_mm for fit in main[1:])]),
        field_curvature_mm=listed([2 * f_stop * fit.defocus_mm for fit in main]),
        lateral_color_mm=listed([0.0, *(chiefs[0] - chiefs[1])[1:]]),
        axial_color_mm=listed([2 * f_stop * (b.defocus_mm - r.defocus_mm) for r, b in zip(red, blue, strict=True)]),
        f_stop=f_stop,
    )


def _fit(rays: FilmRays, heights: DoubleArray, wavelength_nm: float) -> list[_Fitted]:
    pupil = fill_iris(sample_points(_RAYS, 0)[0, :, :2], IrisShape())
    beams = rays.beams(radial(rays, heights), pupil, wavelength_nm)
    # the places are straight above the middle: up is along the radius
    return [
        _separate(pupil[is_open, ::-1], landing[is_open, ::-1])
        for landing, is_open in zip(beams.landing_mm, beams.open, strict=True)
    ]


def _separate(pupil: DoubleArray, landing: DoubleArray) -> _Fitted:
    """One error after the other, each as large as leaves the least spread, and none larger than the spread there is."""
    x, y = pupil.T
    off = landing - landing.mean(axis=0)
    spread = off.std(axis=0)
    linear = pupil - pupil.mean(axis=0)
    defocus = _clamp(_share(off, linear), linear, spread)
    off, left = off - defocus * linear, np.sqrt(np.maximum(spread**2 - (defocus * linear.std(axis=0)) ** 2, 0.0))
    coma = np.stack([3 * x**2 + y**2, 2 * x * y], axis=1)
    coma = coma - coma.mean(axis=0)
    length = _clamp(_share(off, coma), coma, left)
    off, left = off - length * coma, np.sqrt(np.maximum(left**2 - (length * coma.std(axis=0)) ** 2, 0.0))
    squared = (x**2 + y**2)[:, None]
    balanced, zonal = ((shape - shape.mean(axis=0)) for shape in _of_spheres(squared, pupil))
    columns = [balanced, zonal * [1, 0], zonal * [0, 1]]
    spherical = np.linalg.lstsq(np.stack([column.ravel() for column in columns], axis=1), off.ravel(), rcond=None)[0][0]
    if left.min() < _NOTHING_LEFT * spread.min():
        return _Fitted(defocus, length, 0.0, (float(spread[0]), float(spread[1])))
    whole = float((left / np.maximum(balanced.std(axis=0), 1e-12)).min())
    share = float(np.clip(-spherical / whole, -1.0, 1.0)) if whole > 0 else 0.0
    return _Fitted(defocus, length, share, (float(spread[0]), float(spread[1])))


def _of_spheres(squared: DoubleArray, pupil: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Spherical aberration of the third order, and what `render.optics.data_sheet` takes for higher ones."""
    return (squared - 2 / 3) * pupil, (1 - squared) * (1 - 2 * squared) * pupil


def _share(off: DoubleArray, shape: DoubleArray) -> float:
    """Least-squares coefficient of a shape of errors in these errors."""
    return float((off * shape).sum() / (shape**2).sum())


def _clamp(amount: float, shape: DoubleArray, spread: DoubleArray) -> float:
    most = float((spread / np.maximum(shape.std(axis=0), 1e-12)).min())
    return min(max(amount, -most), most)
