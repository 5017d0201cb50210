"""Aspheres in Forbes's polynomials (Forbes 2007, Optics Express 15, 5218).

With u = r/R, R the normalisation radius, the surface departs along the axis from its conic or sphere of curvature c by

    Qcon    u⁴·Σ a_m·Qcon_m(u²)
    Qbfs    u²·(1 − u²)/√(1 − c²·r²)·Σ a_m·Qbfs_m(u²)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from render.model.arrays import DoubleArray

MOST_TERMS = 20
"""Terms that are read; designs have about eight, and the slopes of many more cannot be made."""


@dataclass(frozen=True)
class ForbesTerms:
    """Departure of a surface.

    Attributes:
        kind: which polynomials.
        coefficients: a_0, a_1, ..., lengths.
        radius: normalisation radius, above 0.
    """

    kind: Literal["Qcon", "Qbfs"]
    coefficients: tuple[float, ...]
    radius: float

    def scaled(self, unit_mm: float) -> ForbesTerms:
        """The same in millimetres, from a file's unit."""
        return ForbesTerms(self.kind, tuple(a * unit_mm for a in self.coefficients), self.radius * unit_mm)

    def departure(self, r2: DoubleArray, curvature: float) -> DoubleArray:
        """Departure at squares of the distance from the axis.

        Args:
            r2: ``(n,)``.
            curvature: of the sphere that Qbfs departs from.
        """
        x = r2 / self.radius**2
        if self.kind == "Qcon":
            return np.asarray(x * x * _qcon_sum(self.coefficients, x))
        return np.asarray(x * (1 - x) * _qbfs_sum(self.coefficients, x) / np.sqrt(1 - curvature**2 * r2))

    def added_curvature(self) -> float:
        """Curvature at the vertex beyond the conic's."""
        if self.kind == "Qcon":
            return 0.0
        return 2 * float(_qbfs_sum(self.coefficients, np.zeros(1))[0]) / self.radius**2


def qcon_terms(terms: ForbesTerms) -> dict[int, float]:
    """Coefficients of r⁴, r⁶, ... that are the same polynomial as Qcon terms, by their power.

    Qcon_m(x) = (−1)^m·Σ_k (−x)^k·C(m, k)·C(m + k + 4, m): the Jacobi polynomial P_m^(0, 4)(2x − 1).
    """
    found: dict[int, float] = {}
    for m, coefficient in enumerate(terms.coefficients):
        for k in range(m + 1):
            whole = (-1) ** (m + k) * math.comb(m, k) * math.comb(m + k + 4, m)
            power = 4 + 2 * k
            found[power] = found.get(power, 0.0) + coefficient * whole / terms.radius**power
    return found


def _qcon_sum(coefficients: tuple[float, ...], x: DoubleArray) -> DoubleArray:
    """Σ a_m·Qcon_m(x) by the recurrence of Jacobi polynomials (Abramowitz and Stegun 1964, 22.7.1)."""
    before, now, total = np.zeros_like(x), np.ones_like(x), np.zeros_like(x)
    for m, coefficient in enumerate(coefficients):
        total = total + coefficient * now
        n = m + 1
        first = (2 * n + 3) * ((2 * n + 4) * (2 * n + 2) * (2 * x - 1) - 16) * now
        second = 2 * (n - 1) * (n + 3) * (2 * n + 4) * before
        before, now = now, (first - second) / (2 * n * (n + 4) * (2 * n + 2))
    return total


def _qbfs_sum(coefficients: tuple[float, ...], x: DoubleArray) -> DoubleArray:
    """Σ a_m·Qbfs_m(x) by Forbes's recurrence (Forbes 2010, Optics Express 18, 19700, appendix A)."""
    f, g = [2.0, math.sqrt(19) / 2], [-0.5]
    h: list[float] = []
    plain = [2 * np.ones_like(x), 6 - 8 * x]
    polynomials = [np.ones_like(x), (13 - 16 * x) / math.sqrt(19)]
    for m in range(2, len(coefficients)):
        h.append(-m * (m - 1) / (2 * f[m - 2]))
        g.append(-(1 + g[m - 2] * h[m - 2]) / f[m - 1])
        f.append(math.sqrt(m * (m + 1) + 3 - g[m - 1] ** 2 - h[m - 2] ** 2))
        plain.append((2 - 4 * x) * plain[m - 1] - plain[m - 2])
        polynomials.append((plain[m] - g[m - 1] * polynomials[m - 1] - h[m - 2] * polynomials[m - 2]) / f[m])
    parts = [a * polynomial for a, polynomial in zip(coefficients, polynomials, strict=False)]
    return np.asarray(sum(parts, start=np.zeros_like(x)))
