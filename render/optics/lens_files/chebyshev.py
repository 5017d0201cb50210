"""Surfaces of Chebyshev polynomials in x and y, where they have rotational symmetry.

Their departure from the conic is Σ c_ij·T_i(x/X)·T_j(y/Y). As a polynomial in x and y it is one in r² where each of its
homogeneous parts is: the share of every part that does not change around the axis is taken, and what is left over is measured
over the clear aperture.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.chebyshev import cheb2poly

from render.model.arrays import DoubleArray

MOST_ORDERS = 21
"""Coefficients along x and along y that are read; OpticStudio has up to the order 14."""
SAME_MM = 1e-9
"""Departure from rotational symmetry that no ray sees."""
_ROUNDED_MM = 1e-13  # of a term at the edge: what binary rounding leaves
_RADII, _ANGLES = 41, 48


@dataclass(frozen=True)
class RoundPart:
    """Part of a surface of Chebyshev polynomials that has rotational symmetry.

    Attributes:
        terms: coefficients of r², r⁴, ... by the power of r.
        vertex: sag on the axis, by which the surface stands behind its place.
        left_over: largest departure from it within the aperture.
    """

    terms: dict[int, float]
    vertex: float
    left_over: float


def round_part(coefficients: DoubleArray, lengths: Sequence[float], aperture: float) -> RoundPart:
    """The part of Chebyshev polynomials that has rotational symmetry.

    Args:
        coefficients: ``(n, m)`` c_ij, of T_i(x/X)·T_j(y/Y).
        lengths: X and Y, above 0.
        aperture: radius out to which it is compared, at most the smaller of these.

    Returns:
        The part, in the unit of the lengths.
    """
    whole = _monomials(coefficients, lengths)
    rows, columns = whole.shape
    terms: dict[int, float] = {}
    for power in range(2, rows + columns - 1, 2):
        parts = ((2 * i, power - 2 * i) for i in range(power // 2 + 1))
        term = float(sum(whole[i, j] * _mean(i, j) for i, j in parts if i < rows and j < columns))
        if not abs(term) * aperture**power <= _ROUNDED_MM:
            terms[power] = term
    angle = np.linspace(0, 2 * np.pi, _ANGLES, endpoint=False)
    r = np.linspace(0, aperture, _RADII)[:, None]
    freeform = np.polynomial.polynomial.polyval2d(r * np.cos(angle), r * np.sin(angle), whole)
    symmetric = whole[0, 0] + sum(value * r**power for power, value in terms.items())
    return RoundPart(terms, float(whole[0, 0]), float(np.abs(freeform - symmetric).max()))


def _monomials(coefficients: DoubleArray, lengths: Sequence[float]) -> DoubleArray:
    """Coefficients ``(n, m)`` of x^i·y^j."""
    whole = np.asarray(coefficients, np.float64)
    for axis, length in enumerate(lengths):
        count = whole.shape[axis]
        rows = np.zeros((count, count))
        for order in range(count):
            row = cheb2poly(np.eye(count)[order])
            rows[order, : len(row)] = row
        rows = rows / float(length) ** np.arange(count)
        whole = np.moveaxis(np.tensordot(whole, rows, axes=(axis, 0)), -1, axis)
    return whole


def _mean(i: int, j: int) -> float:
    """Mean of cosⁱ·sinʲ over the circle, for even i and j."""
    half = math.factorial((i + j) // 2) * math.factorial(i // 2) * math.factorial(j // 2)
    return math.factorial(i) * math.factorial(j) / float(half << (i + j))
