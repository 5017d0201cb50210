"""Blurs of a data sheet from an MTF chart.

The model is the lens engine's own: the geometric contrast (`render.optics.measured.geometric_mtf`) of the rays that a data
sheet with these blurs makes (`render.optics.data_sheet`), at one wavelength, through a round iris at the chart's f-number and
past the rims that the sheet's illumination says; times the contrast that diffraction leaves a perfect lens (Born & Wolf 1999,
section 8.5.2; the product is Hopkins's approximation of 1957), where it is to count. At each image height the sagittal and
the tangential blur are those that leave the least squares over the chart's frequencies. On the axis both are one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.data_sheet import DataSheet
from render.optics.data_sheet import at_heights, open_pupil, sheet_errors
from render.optics.measured.geometric_mtf import geometric_mtf
from render.optics.measured.mtf_chart import MtfChart
from render.optics.report.mtf import perfect_transfer

DIFFRACTION_NM = 550.0
_LEAST_MM, _MOST_MM, _CANDIDATES = 2e-4, 0.3, 48
_REFINEMENTS = 24
_GOLDEN = (np.sqrt(5) - 1) / 2


@dataclass(frozen=True, eq=False)
class FittedBlur:
    """Blurs that give a chart.

    Attributes:
        sheet: heights and both blurs, over heights from 0, with all else that was given.
        rms: root mean square of the contrast that is left.
        worst: the largest of it.
        worst_at: its height in mm and its line pairs per millimetre.
    """

    sheet: DataSheet
    rms: float
    worst: float
    worst_at: tuple[float, float]


def fit_blur(
    chart: MtfChart, focal_length_mm: float, f_stop: float, known: DataSheet | None = None, *, diffraction: bool = True
) -> FittedBlur:
    """Fit the blurs of a data sheet to a chart.

    Args:
        chart: the contrast.
        focal_length_mm: of the lens.
        f_stop: of the chart; above 0.
        known: other errors and the illumination of the lens, which count; its blurs do not.
        diffraction: whether the chart has diffraction in it, as measured ones have; geometric ones of lens design have none.
    """
    heights = chart.heights_mm if chart.heights_mm[0] == 0 else np.concatenate([[0.0], chart.heights_mm])
    rows = chart.rows + (len(heights) - len(chart.heights_mm))
    model = _Model(chart, heights, rows, focal_length_mm, f_stop, known, diffraction)
    line = np.geomspace(_LEAST_MM, _MOST_MM, _CANDIDATES)
    squares = np.array([model.squares(np.full((len(heights), 2), blur)) for blur in line])
    best = np.clip(squares.argmin(axis=0), 1, _CANDIDATES - 2)
    low, high = np.log(line[best - 1]), np.log(line[best + 1])
    for _ in range(_REFINEMENTS):
        inner, outer = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        is_low = model.squares(np.exp(inner)) < model.squares(np.exp(outer))
        low, high = np.where(is_low, low, inner), np.where(is_low, outer, high)
    blurs = np.exp((low + high) / 2)
    if chart.heights_mm[0] != 0:  # the axis is not in the chart
        blurs[0] = blurs[1].mean()
    sheet = model.sheet(blurs)
    misses = model.contrast(blurs)[rows, np.arange(len(rows))] - chart.contrast[:, ::-1]
    worst = int(np.abs(misses).max(axis=1).argmax())
    at = float(chart.heights_mm[int(chart.rows[worst])]), float(chart.per_mm[worst])
    return FittedBlur(sheet, float(np.sqrt((misses**2).mean())), float(np.abs(misses).max()), at)


class _Model:
    """Contrast of a data sheet at the chart's heights and frequencies."""

    def __init__(
        self,
        chart: MtfChart,
        heights: DoubleArray,
        rows: NDArray[np.int64],
        focal_length_mm: float,
        f_stop: float,
        known: DataSheet | None,
        diffraction: bool,
    ) -> None:
        self._chart, self._heights, self._rows = chart, heights, rows
        self._focal_length_mm, self._f_stop = focal_length_mm, f_stop
        others = {
            name: tuple(at_heights(known, name, heights).tolist())
            for name in ("light", "spherical", "coma_mm", "field_curvature_mm", "distortion")
            if known is not None and getattr(known, name)
        }
        self._known = DataSheet(tuple(heights.tolist()), f_stop=f_stop, **others)
        self._perfect = np.array(
            [perfect_transfer(float(n), DIFFRACTION_NM, f_stop) if diffraction else 1.0 for n in chart.per_mm]
        )

    def sheet(self, blurs: DoubleArray) -> DataSheet:
        """The data sheet with tangential and sagittal blurs ``(h, 2)``."""
        tangential, sagittal = (tuple(float(value) for value in column) for column in blurs.T)
        return replace(self._known, tangential_blur_mm=tangential, sagittal_blur_mm=sagittal)

    def contrast(self, blurs: DoubleArray) -> DoubleArray:
        """Contrast ``(h, n, 2)``, tangential and sagittal, at the frequencies of the chart's rows."""
        errors = sheet_errors(
            self.sheet(blurs), self._heights, focal_length_mm=self._focal_length_mm, f_stop=self._f_stop
        )
        points, weights = open_pupil(errors.edge, errors.rim_offset, errors.rim_radius)
        landing = errors.landing_mm(points / errors.edge)
        frequencies, back = np.unique(self._chart.per_mm, return_inverse=True)
        return np.asarray(geometric_mtf(landing, weights, frequencies)[:, back] * self._perfect[:, None])

    def squares(self, blurs: DoubleArray) -> DoubleArray:
        """Sums ``(h, 2)`` of squared differences from the chart; on the axis one for both."""
        found = self.contrast(blurs)[self._rows, np.arange(len(self._rows))]
        total = np.zeros((len(self._heights), 2))
        np.add.at(total, self._rows, (found - self._chart.contrast[:, ::-1]) ** 2)
        total[0] = total[0].sum()
        return total
