"""Brown-Conrady distortion with radial terms in a quotient, as calibrations state it.

With ``r² = x² + y²`` a point (x, y) is mapped to

    x' = x·R + 2·p1·x·y + p2·(r² + 2x²)
    y' = y·R + p1·(r² + 2y²) + 2·p2·x·y        R = (1 + a1·r² + a2·r⁴ + a3·r⁶) / (1 + b1·r² + b2·r⁴ + b3·r⁶)

- OpenCV (its documentation of calib3d): from undistorted to distorted, in slopes, x to the right and y down, with k1, k2, k3
  for a and k4, k5, k6 for b.
- OpenTrackIO, by OpenLensIO 1.0.1, section 4.1, equations 16 and 17: in millimetres on the film, x to the right and y down,
  with k1, k3, k5 for a and k2, k4, k6 for b. The model "Brown-Conrady D-U", the default, maps from distorted to undistorted
  points, and "Brown-Conrady U-D" the other way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray

MAX_COEFFICIENT = 1e12


@dataclass(frozen=True)
class BrownConrady:
    """A distortion.

    Attributes:
        over: a1, a2, a3.
        under: b1, b2, b3.
        tangential: p1, p2.
        distorts: whether it maps undistorted points to distorted ones; else the other way.
        unit_mm: length that 1 stands for; 0 where it is a slope.
    """

    over: tuple[float, float, float]
    under: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tangential: tuple[float, float] = (0.0, 0.0)
    distorts: bool = True
    unit_mm: float = 0.0

    @classmethod
    def from_opencv(cls, coefficients: Sequence[float]) -> BrownConrady:
        """The model of OpenCV's vector ``k1, k2, p1, p2[, k3[, k4, k5, k6]]``."""
        k1, k2, p1, p2, k3, k4, k5, k6 = (*coefficients, 0.0, 0.0, 0.0, 0.0)[:8]
        return cls((k1, k2, k3), (k4, k5, k6), (p1, p2))

    @classmethod
    def from_opentrackio(
        cls, radial: Sequence[float], tangential: Sequence[float], *, distorts: bool = False
    ) -> BrownConrady:
        """The model of OpenTrackIO's lists ``k1 to k6`` and ``p1, p2``."""
        k1, k2, k3, k4, k5, k6 = (*radial, 0.0, 0.0, 0.0, 0.0, 0.0)[:6]
        p1, p2 = (*tangential, 0.0, 0.0)[:2]
        return cls((k1, k3, k5), (k2, k4, k6), (p1, p2), distorts, 1.0)

    def apply(self, points: DoubleArray) -> DoubleArray:
        """Map points ``(..., 2)``; infinite or NaN where the quotient is."""
        x, y = points[..., 0], points[..., 1]
        squared = x**2 + y**2
        with np.errstate(all="ignore"):
            over = 1 + squared * (self.over[0] + squared * (self.over[1] + squared * self.over[2]))
            under = 1 + squared * (self.under[0] + squared * (self.under[1] + squared * self.under[2]))
            p1, p2 = self.tangential
            across = 2 * p1 * x * y + p2 * (squared + 2 * x**2)
            up = p1 * (squared + 2 * y**2) + 2 * p2 * x * y
            return np.asarray(points * (over / under)[..., None] + np.stack([across, up], axis=-1))
