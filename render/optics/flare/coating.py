"""Reflectance of a lens surface: Fresnel's equations, bare or under a quarter-wave coating.

Light is unpolarised at each surface: the mean of both polarisations counts (as in Hullin et al. 2011, "Physically-Based Real-Time
Lens Flare Rendering", section 4.3), and glass and coating absorb nothing.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.lens import Surface
from render.optics.glass import D_LINE_NM, refractive_index

MGF2_INDEX = 1.38
"""Refractive index of magnesium fluoride, the material of single coatings (Macleod, "Thin-Film Optical Filters")."""


def reflectance(
    before: float | DoubleArray,
    behind: float | DoubleArray,
    cosine: float | DoubleArray,
    wavelength_nm: float | DoubleArray,
    coating_nm: float = 0.0,
) -> DoubleArray:
    """Share of the light that a surface reflects.

    Under a coating the light that its two faces reflect interferes (Born & Wolf, "Principles of Optics", section 1.6.4, for one
    layer). The layer is of magnesium fluoride, a quarter of a wavelength thick at normal incidence.

    Args:
        before: refractive index that the light comes from.
        behind: refractive index that it goes into.
        cosine: of the angle between ray and normal, 0 to 1.
        wavelength_nm: of the light, in vacuum.
        coating_nm: the wavelength that the coating is made for; 0 for a bare surface.

    Returns:
        From 0 to 1, in the shape of the arguments together; 1 where the light is totally reflected.
    """
    cosine = np.abs(np.asarray(cosine, np.float64))
    sine = np.asarray(before) * np.sqrt(np.maximum(1 - cosine**2, 0.0))
    cosine_behind, passes = _cosine(sine / behind)
    s, p = _amplitudes(before, behind, cosine, cosine_behind)
    if coating_nm > 0:
        cosine_within, reaches = _cosine(sine / MGF2_INDEX)
        passes = passes & reaches
        outer = _amplitudes(before, MGF2_INDEX, cosine, cosine_within)
        inner = _amplitudes(MGF2_INDEX, behind, cosine_within, cosine_behind)
        phase = np.cos(np.pi * coating_nm / np.asarray(wavelength_nm) * cosine_within)
        shares = [_interfere(a, b, phase) for a, b in zip(outer, inner, strict=True)]
    else:
        shares = [s**2, p**2]
    return np.asarray(np.where(passes, (shares[0] + shares[1]) / 2, 1.0))


def axial_transmittance(surfaces: Sequence[Surface], wavelength_nm: float = D_LINE_NM) -> float:
    """Share of the light along the axis that no surface reflects; glass absorbs nothing, and ghosts are left out.

    Args:
        surfaces: of a lens, from front to rear.
        wavelength_nm: of the light.
    """
    share, before = 1.0, 1.0
    for surface in surfaces:
        behind = float(refractive_index(surface.glass, wavelength_nm))
        if behind != before:
            share *= 1 - float(reflectance(before, behind, 1.0, wavelength_nm, surface.coating_nm))
        before = behind
    return share


def _cosine(sine: DoubleArray) -> tuple[DoubleArray, NDArray[np.bool_]]:
    """Cosine of the angle of a sine, and whether there is such an angle."""
    squared = 1 - sine**2
    return np.sqrt(np.maximum(squared, 0.0)), np.asarray(squared >= 0)


def _amplitudes(
    before: float | DoubleArray, behind: float | DoubleArray, cosine: DoubleArray, cosine_behind: DoubleArray
) -> tuple[DoubleArray, DoubleArray]:
    """Fresnel's coefficients across and along the plane of incidence (Born & Wolf, section 1.5.2)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (before * cosine - behind * cosine_behind) / (before * cosine + behind * cosine_behind)
        p = (behind * cosine - before * cosine_behind) / (behind * cosine + before * cosine_behind)
    return np.asarray(s), np.asarray(p)


def _interfere(outer: DoubleArray, inner: DoubleArray, phase: DoubleArray) -> DoubleArray:
    """Share that two faces reflect together, by the cosine of the phase that the way through the layer and back costs."""
    crossed = 2 * outer * inner * phase
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray((outer**2 + inner**2 + crossed) / (1 + (outer * inner) ** 2 + crossed))
