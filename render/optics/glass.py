"""Refractive index of optical media over wavelength.

Light is named by its vacuum wavelength in nanometres; air is taken as vacuum, as lens catalogues do.
"""

from __future__ import annotations

from functools import lru_cache
from typing import overload

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import Glass
from render.optics.dispersion.formulas import index_at
from render.optics.dispersion.lines import C_LINE_NM, CHANNELS_NM, D_LINE_NM, F_LINE_NM
from render.optics.dispersion.model_glass import model_index


@overload
def refractive_index(glass: Glass, wavelength_nm: float) -> float: ...


@overload
def refractive_index(glass: Glass, wavelength_nm: DoubleArray) -> DoubleArray: ...


def refractive_index(glass: Glass, wavelength_nm: float | DoubleArray) -> float | DoubleArray:
    """Index of a medium by the best that is known of it.

    The indices of the three channels where they are given (Lee, Eisemann & Seidel 2010, section 5.3), linear between their
    wavelengths; else Sellmeier's equation (Sellmeier 1871; Lee, Eisemann & Seidel 2010, section 4) where the coefficients are
    given; else the formula of its catalogue; else that of a glass of its index and Abbe number; else the index at the d line.

    Args:
        glass: the medium.
        wavelength_nm: one wavelength or an array of them.

    Returns:
        A number for a number and an array of its shape for an array; NaN where Sellmeier's equation has no real root.
    """
    if isinstance(wavelength_nm, np.ndarray):
        return _indices(glass, np.asarray(wavelength_nm, np.float64))
    return _index(glass, float(wavelength_nm))


@lru_cache(maxsize=4096)
def _index(glass: Glass, wavelength_nm: float) -> float:
    return float(_indices(glass, np.asarray(wavelength_nm)))


def _indices(glass: Glass, wavelengths_nm: DoubleArray) -> DoubleArray:
    if glass.channels is not None:
        return np.asarray(np.interp(wavelengths_nm, CHANNELS_NM[::-1], glass.channels[::-1]))
    if glass.sellmeier_b is not None and glass.sellmeier_c is not None:
        return _sellmeier(glass.sellmeier_b, glass.sellmeier_c, wavelengths_nm)
    if glass.dispersion is not None:
        return index_at(glass.dispersion, wavelengths_nm)
    if glass.abbe != 0:
        return model_index(glass.index, glass.abbe, wavelengths_nm)
    return np.full(wavelengths_nm.shape, glass.index)


def _sellmeier(b: tuple[float, ...], c: tuple[float, ...], wavelengths_nm: DoubleArray) -> DoubleArray:
    squared_um = np.square(wavelengths_nm / 1000)
    with np.errstate(divide="ignore", invalid="ignore"):
        terms = [bi * squared_um / (squared_um - ci) for bi, ci in zip(b, c, strict=True)]
        return np.asarray(np.sqrt(1 + sum(terms)))


__all__ = ["CHANNELS_NM", "C_LINE_NM", "D_LINE_NM", "F_LINE_NM", "refractive_index"]
