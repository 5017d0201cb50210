"""A lens's errors made smaller or larger one kind at a time, by the powers of the pupil that they grow with.

Over the pupil of one field height the slope error is a polynomial. What is constant is distortion; what grows in proportion to
the pupil is defocus, and its mean over the two planes less that on the axis is field curvature, half their difference
astigmatism; even powers are coma and its kin, odd ones from the third on spherical aberration, with the defocus on the axis that
balances it (Welford 1986, chapter 7).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import AberrationScales
from render.trace.lens_fit import even_basis, even_powers, odd_basis

_DEGREE = 7


@dataclass(frozen=True, eq=False)
class ErrorChange:
    """Addend that scales the slope errors of one field height.

    Attributes:
        tangential: coefficients in the even basis.
        sagittal: coefficients in the odd basis.
    """

    tangential: DoubleArray
    sagittal: DoubleArray

    def at(self, on_stop: DoubleArray) -> DoubleArray:
        """``(n, 2)`` slopes, tangential first, at points of the stop in units of its radius."""
        tangential, sagittal = (
            even_basis(on_stop, _DEGREE) @ self.tangential,
            odd_basis(on_stop, _DEGREE) @ self.sagittal,
        )
        return np.stack([tangential, sagittal], axis=1)


def error_change(
    slope: DoubleArray, on_stop: DoubleArray, axis_defocus: float, scales: AberrationScales
) -> ErrorChange:
    """Change of the slope errors when each kind of aberration is scaled by its factor.

    Args:
        slope: ``(n, 2)`` of one field height, tangential first.
        on_stop: ``(n, 2)`` points on the stop, in units of its radius.
        axis_defocus: `defocus` of the field height 0.
        scales: the factors; chromatic and vignetting are ignored.
    """
    tangential, sagittal = _coefficients(slope, on_stop)
    change_t = tangential * (_factors(even_powers(_DEGREE), 0, scales) - 1)
    change_s = sagittal * (_factors(even_powers(_DEGREE - 1), 1, scales) - 1)
    defocus_t, defocus_s = tangential[1], sagittal[0]
    mean, half = (defocus_t + defocus_s) / 2 - axis_defocus, (defocus_t - defocus_s) / 2
    kept = scales.spherical * axis_defocus + scales.field_curvature * mean
    change_t[1] = kept + scales.astigmatism * half - defocus_t
    change_s[0] = kept - scales.astigmatism * half - defocus_s
    return ErrorChange(change_t, change_s)


def changes_shape(scales: AberrationScales) -> bool:
    """Whether any factor is not 1 but those of colour errors and vignetting."""
    return scales != replace(AberrationScales(), chromatic=scales.chromatic, vignetting=scales.vignetting)


def defocus(slope: DoubleArray, on_stop: DoubleArray) -> float:
    """Slope error in proportion to the pupil, mean of both planes."""
    tangential, sagittal = _coefficients(slope, on_stop)
    return float(tangential[1] + sagittal[0]) / 2


def _coefficients(slope: DoubleArray, on_stop: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    tangential = np.linalg.lstsq(even_basis(on_stop, _DEGREE), slope[:, 0], rcond=None)[0]
    sagittal = np.linalg.lstsq(odd_basis(on_stop, _DEGREE), slope[:, 1], rcond=None)[0]
    return np.asarray(tangential), np.asarray(sagittal)


def _factors(powers: list[tuple[int, int]], more: int, scales: AberrationScales) -> DoubleArray:
    """``(terms,)`` factor of each term; ``more`` is what its total degree exceeds that of the even basis by."""
    degrees = np.array([i + j + more for i, j in powers])
    factors = np.where(degrees % 2 == 0, scales.coma, scales.spherical)
    factors[degrees == 0] = scales.distortion
    return np.asarray(factors)
