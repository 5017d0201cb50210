"""Picture errors: a data sheet's errors over the height in the picture, for image-space passes (Kyaw 2013).

`render.optics.data_sheet` turns the same sheet into rays. Here a sharp picture is bent, blurred, smeared by coma and
darkened, each by a table over the distance from the axis (Kyaw 2013, section 7.3). Kyaw's blur is a box along the
radius and then across it; this one is Gaussian with the same spread, and the part that both directions share is applied
along rows and columns, since on the axis a radius has no direction. Depth-dependent errors are not covered: field
curvature and axial colour appear as they blur objects in the plane of focus.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray
from render.model.data_sheet import DataSheet
from render.model.lens import AberrationScales
from render.optics.data_sheet import MIDDLE_NM, SPAN_NM, at_heights, seen_slopes, sheet_errors
from render.optics.spectrum import THREE_LINES
from render.optics.view import PinholeView

ROWS = 256
SIGMAS = 3.5
"""Reach of a Gaussian blur in standard deviations: 5e-4 of its light is left out. It is at most the picture's diagonal."""


@dataclass(frozen=True, eq=False)
class PictureErrors:
    """Errors at even steps of the height, from the axis to ``last``; lengths are slopes, film lengths over the focal length.

    Attributes:
        last: height of the last row.
        source: ``(n, 3)`` for red, green and blue: height in the error-free picture that is seen there, over the height.
        even: ``(n, 3)`` standard deviation of the blur that is the same along the radius and across it.
        along: ``(n, 3)`` standard deviation of the additional blur along the radius.
        across: ``(n, 3)`` standard deviation of the additional blur across it.
        coma: ``(n,)`` a third of the flare's length.
        light: ``(n,)`` light relative to the axis.
        squeeze: anamorphic squeeze, by which bending and blur are narrower from side to side.
    """

    last: float
    source: DoubleArray
    even: DoubleArray
    along: DoubleArray
    across: DoubleArray
    coma: DoubleArray
    light: DoubleArray
    squeeze: float = 1.0

    def at(self, heights: DoubleArray) -> DoubleArray:
        """Interpolate the rows at heights: ``(..., 14)`` source, even, along and across of three channels, coma, light.
        Clamped.
        """
        rows = self.rows
        place = np.clip(heights / self.last, 0.0, 1.0) * (len(rows) - 1)
        low = np.minimum(place.astype(np.int64), len(rows) - 2)
        part = (place - low)[..., None]
        return np.asarray((1 - part) * rows[low] + part * rows[low + 1])

    @property
    def rows(self) -> DoubleArray:
        """All columns ``(n, 14)``, in the order of `at`."""
        ends = [self.coma[:, None], self.light[:, None]]
        return np.concatenate([self.source, self.even, self.along, self.across, *ends], axis=1)

    def margin(self, view: PinholeView) -> tuple[int, int]:
        """Margin in pixels, left and right, top and bottom, from which the passes draw light into the picture. It is at most the
        picture's own size: of a wider blur or bend, the light from beyond is missing.
        """
        x = np.linspace(-view.cx, view.width - view.cx, 65) / view.fx
        y = np.linspace(-view.cy, view.height - view.cy, 65) / view.fy
        left, right = (np.stack([np.full(65, edge), y], axis=1) for edge in x[[0, -1]])
        top, bottom = (np.stack([x, np.full(65, edge)], axis=1) for edge in y[[0, -1]])
        margins = []
        for axis, focal, edges in ((0, view.fx / self.squeeze, (left, right)), (1, view.fy, (top, bottom))):
            rows = self.at(np.hypot(*np.concatenate(edges).T))
            bent = np.abs(np.concatenate(edges)[:, axis]) * np.maximum(rows[:, :3].max(axis=1) - 1, 0.0)
            blur = np.hypot(rows[:, 3:6], np.maximum(rows[:, 6:9], rows[:, 9:12])).max(axis=1)
            reach = SIGMAS * blur + 3 * np.abs(rows[:, 12])
            size = (view.width, view.height)[axis]
            margins.append(min(math.ceil(focal * float((bent + reach).max())) + 2, size))
        return margins[0], margins[1]


def make_picture_errors(
    sheet: DataSheet,
    scales: AberrationScales,
    *,
    focal_length_mm: float,
    f_stop: float,
    last_slope: float,
    squeeze: float = 1.0,
    colours: bool = True,
    axis_is_drawn: bool = False,
) -> PictureErrors:
    """Picture errors of a lens described by a data sheet.

    Args:
        sheet: the lens's measurements.
        scales: factors on its errors.
        focal_length_mm: focal length of the lens.
        f_stop: above 0.
        last_slope: field of the picture's farthest corner. No blur reaches farther than twice of it.
        squeeze: anamorphic squeeze.
        colours: whether colour errors are drawn.
        axis_is_drawn: whether the picture already has the axis's monochrome blur, as the engine `scatter` draws it. Only the
            additional blur away from the axis is returned then.
    """
    slopes = np.linspace(0.0, last_slope, ROWS)
    heights = slopes * focal_length_mm
    errors = sheet_errors(sheet, heights, focal_length_mm=focal_length_mm, f_stop=f_stop, scales=scales)
    channels = THREE_LINES.wavelengths_nm if colours else (MIDDLE_NM,) * 3
    blur = np.stack([errors.spread_mm(wavelength, coma=False) for wavelength in channels], axis=1) / focal_length_mm
    if axis_is_drawn:
        drawn = errors.spread_mm(coma=False)[0] / focal_length_mm
        blur = np.sqrt(np.maximum(blur**2 - drawn**2, 0.0))
    blur = np.minimum(blur, 2 * last_slope * min(squeeze, 1.0) / SIGMAS)  # the time of a pixel grows with the reach
    even, excess = blur.min(axis=-1), blur[..., 0] ** 2 - blur[..., 1] ** 2
    near = np.maximum(heights, 1e-3 * focal_length_mm * last_slope)  # on the axis all ratios have their limits
    bend = seen_slopes(sheet, near, focal_length_mm, scales.distortion) * focal_length_mm / near
    lateral = -at_heights(sheet, "lateral_color_mm", near) * scales.chromatic / near
    source = [bend - (MIDDLE_NM - wavelength) / SPAN_NM * lateral * errors.stretch[:, 0] for wavelength in channels]
    return PictureErrors(
        last_slope,
        np.stack(source, axis=1),
        even,
        np.sqrt(np.maximum(excess, 0.0)),
        np.sqrt(np.maximum(-excess, 0.0)),
        errors.coma_mm * errors.edge**2 / focal_length_mm,
        np.maximum(errors.light, 1e-6) ** scales.vignetting,
        squeeze,
    )
