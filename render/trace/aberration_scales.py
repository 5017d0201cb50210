"""A lens's errors made smaller or larger one kind at a time, by the powers of the pupil that they grow with.

Over the pupil of one field height the slope error is a polynomial. What is constant is distortion; what grows in proportion to
the pupil is defocus, and its mean over the two planes less that on the axis is field curvature, half their difference
astigmatism; even powers are coma and its kin, odd ones from the third on spherical aberration, with the defocus on the axis that
balances it (Welford 1986, chapter 7).
"""

from __future__ import annotations

import numpy as np

from render.lens import AberrationScales
from render.scene import DoubleArray
from render.trace.lens_fit import even_basis, even_powers_of, odd_basis

_DEGREE = 7


def scaled_errors(
    slope: DoubleArray, on_stop: DoubleArray, axis_defocus: float, scales: AberrationScales
) -> DoubleArray:
    """Slope errors with each kind of aberration scaled.

    Args:
        slope: ``(n, 2)`` of one field height, tangential first.
        on_stop: ``(n, 2)`` where on the stop, in units of its radius.
        axis_defocus: `defocus` of the field height 0.
        scales: the factors; chromatic and vignetting are not looked at.

    Returns:
        ``(n, 2)``.
    """
    even, odd = even_basis(on_stop, _DEGREE), odd_basis(on_stop, _DEGREE)
    tangential, sagittal = _coefficients(slope, even, odd)
    change_t = tangential * (_factors(even_powers_of(_DEGREE), 0, scales) - 1)
    change_s = sagittal * (_factors(even_powers_of(_DEGREE - 1), 1, scales) - 1)
    defocus_t, defocus_s = tangential[1], sagittal[0]
    mean, half = (defocus_t + defocus_s) / 2 - axis_defocus, (defocus_t - defocus_s) / 2
    kept = scales.spherical * axis_defocus + scales.field_curvature * mean
    change_t[1] = kept + scales.astigmatism * half - defocus_t
    change_s[0] = kept - scales.astigmatism * half - defocus_s
    return np.asarray(slope + np.stack([even @ change_t, odd @ change_s], axis=1))


def defocus(slope: DoubleArray, on_stop: DoubleArray) -> float:
    """Slope error in proportion to the pupil, mean of both planes."""
    tangential, sagittal = _coefficients(slope, even_basis(on_stop, _DEGREE), odd_basis(on_stop, _DEGREE))
    return float(tangential[1] + sagittal[0]) / 2


def _coefficients(slope: DoubleArray, even: DoubleArray, odd: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    tangential = np.linalg.lstsq(even, slope[:, 0], rcond=None)[0]
    return np.asarray(tangential), np.asarray(np.linalg.lstsq(odd, slope[:, 1], rcond=None)[0])


def _factors(powers: list[tuple[int, int]], more: int, scales: AberrationScales) -> DoubleArray:
    """``(terms,)`` factor of each term; ``more`` is what its total degree exceeds that of the even basis by."""
    degrees = np.array([i + j + more for i, j in powers])
    factors = np.where(degrees % 2 == 0, scales.coma, scales.spherical)
    factors[degrees == 0] = scales.distortion
    return np.asarray(factors)
