"""Smooth curves through points that do not overshoot them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray


@dataclass(frozen=True, eq=False)
class MonotoneCurve:
    """Piecewise cubic through points, monotone between each two, straight beyond the ends (Fritsch & Butland 1984).

    Attributes:
        x: ``(k,)`` increasing, at least one.
        y: ``(k, n)`` values.
        slopes: ``(k, n)`` at the points.
    """

    x: DoubleArray
    y: DoubleArray
    slopes: DoubleArray

    @classmethod
    def through(cls, x: DoubleArray, y: DoubleArray) -> MonotoneCurve:
        """Curve through points: a straight line for two, constant for one.

        Args:
            x: ``(k,)`` increasing.
            y: ``(k, n)``.
        """
        slopes = np.zeros_like(y)
        if len(x) > 1:
            widths = np.diff(x)[:, None]
            secants = np.diff(y, axis=0) / widths
            slopes[0], slopes[-1] = secants[0], secants[-1]
        if len(x) > 2:
            slopes[1:-1] = _inner_slopes(widths, secants)
            slopes[0] = _end_slope(widths[0], widths[1], secants[0], secants[1])
            slopes[-1] = _end_slope(widths[-1], widths[-2], secants[-1], secants[-2])
        return cls(x, y, slopes)

    def at(self, x: float) -> DoubleArray:
        """Values ``(n,)`` at a place."""
        if len(self.x) == 1 or x <= self.x[0]:
            return np.asarray(self.y[0] + (x - self.x[0]) * self.slopes[0])
        if x >= self.x[-1]:
            return np.asarray(self.y[-1] + (x - self.x[-1]) * self.slopes[-1])
        i = int(np.searchsorted(self.x, x, side="right")) - 1
        width = self.x[i + 1] - self.x[i]
        t = (x - self.x[i]) / width
        ends = (1 + 2 * t) * (1 - t) ** 2 * self.y[i] + t**2 * (3 - 2 * t) * self.y[i + 1]
        return np.asarray(
            ends + width * (t * (1 - t) ** 2 * self.slopes[i] - t**2 * (1 - t) * self.slopes[i + 1]), np.float64
        )


def _inner_slopes(widths: DoubleArray, secants: DoubleArray) -> DoubleArray:
    """Weighted harmonic mean of the two secants; 0 where they differ in sign."""
    before, behind = widths[:-1] + 2 * widths[1:], 2 * widths[:-1] + widths[1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        means = (before + behind) / (before / secants[:-1] + behind / secants[1:])
    return np.where(secants[:-1] * secants[1:] > 0, means, 0.0)


def _end_slope(
    width: DoubleArray, next_width: DoubleArray, secant: DoubleArray, next_secant: DoubleArray
) -> DoubleArray:
    """Slope of the parabola through three points, limited so that the curve stays monotone."""
    slope = ((2 * width + next_width) * secant - width * next_secant) / (width + next_width)
    slope = np.where(slope * secant <= 0, 0.0, slope)
    return np.where((secant * next_secant <= 0) & (np.abs(slope) > 3 * np.abs(secant)), 3 * secant, slope)
