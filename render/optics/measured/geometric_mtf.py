"""Geometric MTF: contrast of sine gratings by where rays land on the film, without diffraction.

It is the modulus of the Fourier transform of the spot (Welford 1986, section 13.6; Born & Wolf 1999, section 9.5). Diffraction
lowers contrast further, to about ``1 − 1.27·ν/ν_c`` of it well below the cut-off ``ν_c = 1/(λN)``, which is 630 lp/mm at f/2.8.
"""

from __future__ import annotations

import numpy as np

from render.model.arrays import DoubleArray


def geometric_mtf(landing_mm: DoubleArray, weights: DoubleArray, frequencies_per_mm: DoubleArray) -> DoubleArray:
    """Contrast of gratings along each of the two axes of the landing points.

    Args:
        landing_mm: ``(h, n, 2)`` where rays of each spot land.
        weights: ``(h, n)`` light of each ray, 0 or more.
        frequencies_per_mm: ``(k,)`` line pairs per millimetre.

    Returns:
        ``(h, k, 2)`` from 0 to 1; NaN where a spot has no light. The first of the last axis is for gratings that vary along the
        first axis of the points: with points along and across the radius it is the tangential contrast, and then the sagittal.
    """
    light = weights.sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = weights / light[:, None]
    found = np.empty((len(landing_mm), len(frequencies_per_mm), 2))
    for k, frequency in enumerate(frequencies_per_mm):
        waves = np.exp(2j * np.pi * frequency * landing_mm)
        found[:, k] = np.abs((share[..., None] * waves).sum(axis=1))
    return np.where(light[:, None, None] > 0, found, np.nan)
