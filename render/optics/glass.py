"""Refractive index of optical media over wavelength: Sellmeier's equation, or the Abbe number, or a constant.

Light is named by its vacuum wavelength in nanometres; air is taken as vacuum, as lens catalogues do.
"""

from __future__ import annotations

from typing import overload

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import Glass

# Fraunhofer's lines of helium and hydrogen, for which catalogues give index and Abbe number (ISO 7944).
D_LINE_NM, F_LINE_NM, C_LINE_NM = 587.5618, 486.1327, 656.2725

# The coefficients of SF10 are those of today's lead-free melt (N-SF10), and so are the two numbers beside them.
CATALOGUE: dict[str, Glass] = {
    glass.name: glass
    for glass in (
        Glass(
            1.51680,
            64.17,
            sellmeier_b=(1.03961212, 0.231792344, 1.01046945),
            sellmeier_c=(0.00600069867, 0.0200179144, 103.560653),
            name="BK7",
        ),
        Glass(
            1.72828,
            28.53,
            sellmeier_b=(1.62153902, 0.256287842, 1.64447552),
            sellmeier_c=(0.0122241457, 0.0595736775, 147.468793),
            name="SF10",
        ),
    )
}


@overload
def refractive_index(glass: Glass, wavelength_nm: float) -> float: ...


@overload
def refractive_index(glass: Glass, wavelength_nm: DoubleArray) -> DoubleArray: ...


def refractive_index(glass: Glass, wavelength_nm: float | DoubleArray) -> float | DoubleArray:
    """Index of a medium by the best that is known of it.

    Sellmeier's equation (Sellmeier 1871; Lee, Eisemann & Seidel 2010, section 4) where the coefficients are given; else
    Cauchy's law ``A + B/λ²`` through n_d that spreads ``n_F − n_C = (n_d − 1)/V_d``; else the index at the d line.

    Args:
        glass: the medium.
        wavelength_nm: one wavelength or an array of them.

    Returns:
        A number for a number and an array of its shape for an array; NaN where Sellmeier's equation has no real root.
    """
    wavelengths_nm = np.asarray(wavelength_nm, np.float64)
    if glass.sellmeier_b is not None and glass.sellmeier_c is not None:
        index = _sellmeier(glass.sellmeier_b, glass.sellmeier_c, wavelengths_nm)
    elif glass.abbe != 0:
        index = _cauchy(glass.index, glass.abbe, wavelengths_nm)
    else:
        index = np.full(wavelengths_nm.shape, glass.index)
    return index if isinstance(wavelength_nm, np.ndarray) else float(index)


def _sellmeier(b: tuple[float, ...], c: tuple[float, ...], wavelengths_nm: DoubleArray) -> DoubleArray:
    squared_um = np.square(wavelengths_nm / 1000)
    with np.errstate(divide="ignore", invalid="ignore"):
        terms = [bi * squared_um / (squared_um - ci) for bi, ci in zip(b, c, strict=True)]
        return np.asarray(np.sqrt(1 + sum(terms)))


def _cauchy(index_d: float, abbe: float, wavelengths_nm: DoubleArray) -> DoubleArray:
    spread = (index_d - 1) / abbe
    b = spread / (F_LINE_NM**-2 - C_LINE_NM**-2)
    return np.asarray(index_d + b * (wavelengths_nm**-2 - D_LINE_NM**-2))
