"""Phases of diffractive surfaces."""

from __future__ import annotations

import numpy as np


def ideal_phase(focal_mm: float, terms: int = 8, nm: float = 550.0) -> tuple[float, ...]:
    """Series of −(2π/λ)·(√(f² + r²) − f): parallel light of the design wavelength meets in one point, without aberration."""
    found, binomial = [], 1.0
    for i in range(1, terms + 1):
        binomial *= (1.5 - i) / i
        found.append(-2 * np.pi / (nm * 1e-6) * binomial * focal_mm ** (1 - 2 * i))
    return tuple(found)
