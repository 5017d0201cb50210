"""Fits Sellmeier's equation of three terms to another dispersion: a shot carries glass of foreign catalogues in this form.

For given poles C the strengths B follow by linear least squares, so that three numbers alone are searched for (variable
projection: Golub & Pereyra 1973), by Levenberg and Marquardt's method.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import Dispersion, Glass
from render.optics.dispersion.formulas import index_at

_VISIBLE_NM = np.linspace(400.0, 700.0, 41)
_STARTS_UM2 = ((0.005, 0.02, 100.0), (0.01, 0.05, 100.0), (0.002, 0.03, 50.0))
_POLES_UM2 = ((1e-6, 0.12), (1e-6, 0.14), (0.8, 1e4))
"""Limits of the poles: they keep off the visible light."""
_GOOD_ENOUGH = 1e-7
_STEPS = 60
_STEP = 1e-4  # of the logarithm of a pole, for slopes


def as_sellmeier(glass: Glass) -> Glass:
    """The glass with Sellmeier coefficients in place of its formula.

    Over the visible light the index stays within 2e-6 for most glasses. Where the formula is a polynomial that bends as no
    Sellmeier equation does, it is off by up to 1e-4.
    """
    if glass.dispersion is None:
        return glass
    b, c = _fit(glass.dispersion)
    return replace(glass, sellmeier_b=b, sellmeier_c=c, dispersion=None)


@cache
def _fit(dispersion: Dispersion) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """B, and C in square micrometres."""
    squared_um, indices = np.square(_VISIBLE_NM / 1000), index_at(dispersion, _VISIBLE_NM)
    fits = []
    for start in _STARTS_UM2:
        fits.append(_search(squared_um, indices, np.log(start)))
        if fits[-1][0] < _GOOD_ENOUGH:
            break
    _, b, poles = min(fits, key=lambda fit: fit[0])
    (b1, b2, b3), (c1, c2, c3) = b.tolist(), np.exp(poles).tolist()
    return (b1, b2, b3), (c1, c2, c3)


def _search(
    squared_um: DoubleArray, indices: DoubleArray, start: DoubleArray
) -> tuple[float, DoubleArray, DoubleArray]:
    """Largest error of the index, B, and the logarithms of the poles."""
    low, high = np.log(np.array(_POLES_UM2)).T
    poles, damping = start, 1e-3
    b, errors = _strengths(squared_um, indices, poles)
    for _ in range(_STEPS):
        moved = [_strengths(squared_um, indices, poles + step)[1] for step in _STEP * np.eye(3)]
        slopes = (np.stack(moved, axis=1) - errors[:, None]) / _STEP
        normal = slopes.T @ slopes
        normal[np.diag_indices(3)] = normal.diagonal() * (1 + damping) + 1e-20
        tried = np.clip(poles - np.linalg.solve(normal, slopes.T @ errors), low, high)
        tried_b, tried_errors = _strengths(squared_um, indices, tried)
        if tried_errors @ tried_errors < errors @ errors:
            poles, b, errors, damping = tried, tried_b, tried_errors, damping / 4
        else:
            damping *= 4
        if np.abs(errors).max() < _GOOD_ENOUGH or damping > 1e9:
            break
    return float(np.abs(errors).max()), b, poles


def _strengths(squared_um: DoubleArray, indices: DoubleArray, poles: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """B for given poles, and the errors of the index."""
    terms = squared_um[:, None] / (squared_um[:, None] - np.exp(poles))
    b = np.asarray(np.linalg.lstsq(terms, indices**2 - 1, rcond=1e-13)[0], np.float64)
    return b, (terms @ b + 1 - indices**2) / (2 * indices)
