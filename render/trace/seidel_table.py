"""The table of a thin lens with third-order wavefront errors: its polynomials are the derivatives of the wavefront.

In the picture's frame (upright, x toward the pixel) the slope error of the ray through pupil point X is ``-∂W/∂X``, with the
wavefront's coma and distortion counted from the image point's side of the film, which is the pixel's opposite (Welford 1986,
chapter 7; signs as in `render.model.lens.SeidelErrors`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import AberrationScales, SeidelErrors
from render.optics.glass import D_LINE_NM
from render.trace.lens_fit import even_powers
from render.trace.lens_table import (
    BOUND,
    FRONT_RIM,
    LIGHT,
    PUPIL_S,
    PUPIL_T,
    REAR_RIM,
    REGION,
    ROW_LENGTH,
    SLOPE_S,
    SLOPE_T,
    WEIGHT,
    PolynomialTable,
)

HEIGHTS = 48
_MIDDLE_NM, _SPAN_NM = 562.5, 175.0  # colour errors are stated between 475 and 650 nm and taken as linear between


def make_seidel_table(
    errors: SeidelErrors,
    scales: AberrationScales,
    *,
    focal_length_mm: float,
    pupil_radius_m: float,
    last_slope: float,
    wavelengths_nm: Sequence[float],
) -> PolynomialTable:
    """Make the table of a Seidel lens.

    Args:
        errors: its wavefront errors.
        scales: factors on them.
        focal_length_mm: focal length of the lens.
        pupil_radius_m: pupil radius at the f-number used; not 0.
        last_slope: field of the picture's farthest corner, slope in object space.
        wavelengths_nm: one part of the table for each.
    """
    slopes = np.linspace(0.0, last_slope, HEIGHTS)
    heights = slopes * focal_length_mm / errors.reference_height_mm
    reference_m = focal_length_mm / (2000 * errors.reference_f_stop)
    per_radius = D_LINE_NM * 1e-9 / reference_m  # slope for a wavelength of error per reference radius
    edge = pupil_radius_m / reference_m
    rows = np.zeros((len(wavelengths_nm), HEIGHTS, ROW_LENGTH))
    even, odd = even_powers(7), even_powers(6)

    def add(power_x: int, power_y: int, tangential: DoubleArray, sagittal: DoubleArray) -> None:
        """Add ``tangential·x^i·y^j`` to the tangential error, and ``y·sagittal·x^i·y^j`` to the sagittal one."""
        rows[:, :, SLOPE_T + even.index((power_x, power_y))] += tangential
        rows[:, :, SLOPE_S + odd.index((power_x, power_y))] += sagittal

    zero = np.zeros(HEIGHTS)
    spherical = 4 * errors.w040 * scales.spherical * per_radius * edge**3 + zero
    add(1, 2, -spherical, zero)
    add(3, 0, -spherical, zero)
    add(2, 0, zero, -spherical)
    add(0, 2, zero, -spherical)
    coma = errors.w131 * scales.coma * heights * per_radius * edge**2
    add(2, 0, 3 * coma, zero)
    add(0, 2, coma, zero)
    add(1, 0, zero, 2 * coma)
    curvature = 2 * errors.w220 * scales.field_curvature * heights**2 * per_radius * edge
    astigmatism = 2 * errors.w222 * scales.astigmatism * heights**2 * per_radius * edge
    add(1, 0, -(curvature + astigmatism), zero)
    add(0, 0, zero, -curvature)
    add(0, 0, errors.w311 * scales.distortion * heights**3 * per_radius, zero)
    for part, wavelength in enumerate(wavelengths_nm):
        blueness = (_MIDDLE_NM - wavelength) / _SPAN_NM * scales.chromatic
        defocus = pupil_radius_m * errors.axial_color_mm * blueness * 1000 / focal_length_mm**2
        rows[part, :, SLOPE_T + even.index((1, 0))] += defocus
        rows[part, :, SLOPE_S + odd.index((0, 0))] += defocus
        rows[part, :, SLOPE_T] -= errors.lateral_color_mm * blueness * heights / focal_length_mm
    return _finish(rows, pupil_radius_m, last_slope)


def _finish(rows: DoubleArray, pupil_radius_m: float, last_slope: float) -> PolynomialTable:
    """The rows with the pupil of a thin lens, open everywhere, and their bounds."""
    rows[..., PUPIL_T + 1] = pupil_radius_m
    rows[..., PUPIL_S] = pupil_radius_m
    rows[..., FRONT_RIM] = rows[..., REAR_RIM] = -1.0
    rows[..., WEIGHT] = rows[..., LIGHT] = 1.0
    rows[..., REGION + 1] = rows[..., REGION + 2] = 1.0
    # on the unit disc no term exceeds its coefficient
    tangential = np.abs(rows[..., SLOPE_T + 1 : SLOPE_S]).sum(-1)
    sagittal = np.abs(rows[..., SLOPE_S:PUPIL_T]).sum(-1)
    rows[..., BOUND] = rows[..., SLOPE_T]
    rows[..., BOUND + 1] = np.hypot(tangential, sagittal)
    rows[..., BOUND + 3] = pupil_radius_m
    reach = float((np.abs(rows[..., BOUND]) + rows[..., BOUND + 1]).max())
    return PolynomialTable(rows.astype(np.float32), last_slope, pupil_radius_m, reach)
