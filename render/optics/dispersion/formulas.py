"""Dispersion formulas, with the wavelength L in micrometres.

| name | index | coefficients |
|---|---|---|
| sellmeier | n² = A + D·L² + Σ B_i·L² / (L² − C_i) | A, D, B_1, C_1, B_2, C_2, ... |
| powers | n² = Σ c_i·L^e_i | c_1, e_1, c_2, e_2, ... |
| cauchy | n = Σ c_i·L^e_i | c_1, e_1, c_2, e_2, ... |
| herzberger | n = A + B·H + C·H² + D·L² + E·L⁴ + F·L⁶, H = 1 / (L² − 0.028) | A, B, C, D, E, F |
| buchdahl | n = N + ν_1·w + ν_2·w², w = (L − 0.574) / (1 + 2.5·(L − 0.574)) | N, ν_1, ν_2 |

Every formula of the makers is one of these: Schott's polynomial and its extensions are powers, Conrady's is Cauchy's.
Buchdahl's is that of Robb & Mercado 1983, "Calculation of refractive indices using Buchdahl's chromatic coordinate".
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import Dispersion
from render.optics.dispersion.lines import C_LINE_NM, D_LINE_NM, F_LINE_NM

_HERZBERGER_UM2 = 0.028
_BUCHDAHL_UM, _BUCHDAHL_PER_UM = 0.574, 2.5

Formula = Callable[[DoubleArray, tuple[float, ...]], DoubleArray]


def index_at(dispersion: Dispersion, wavelengths_nm: DoubleArray) -> DoubleArray:
    """Refractive indices at an array of wavelengths; NaN or infinite where the formula has no value."""
    with np.errstate(all="ignore"):
        return _FORMULAS[dispersion.formula](wavelengths_nm / 1000, dispersion.coefficients)


def index_and_abbe(dispersion: Dispersion) -> tuple[float, float]:
    """Index at the d line and Abbe number V_d; 0 for a medium that does not part F from C."""
    n_d, n_f, n_c = index_at(dispersion, np.array([D_LINE_NM, F_LINE_NM, C_LINE_NM])).tolist()
    spread = n_f - n_c
    return n_d, (n_d - 1) / spread if abs(spread) > 1e-9 else 0.0


def _sellmeier(um: DoubleArray, c: tuple[float, ...]) -> DoubleArray:
    squared = um**2
    terms = [b * squared / (squared - pole) for b, pole in zip(c[2::2], c[3::2], strict=True)]
    return np.asarray(np.sqrt(c[0] + c[1] * squared + sum(terms)))


def _powers(um: DoubleArray, c: tuple[float, ...]) -> DoubleArray:
    return np.asarray(np.sqrt(_cauchy(um, c)))


def _cauchy(um: DoubleArray, c: tuple[float, ...]) -> DoubleArray:
    return np.asarray(sum(factor * um**power for factor, power in zip(c[::2], c[1::2], strict=True)))


def _herzberger(um: DoubleArray, c: tuple[float, ...]) -> DoubleArray:
    h = 1 / (um**2 - _HERZBERGER_UM2)
    return np.asarray(c[0] + c[1] * h + c[2] * h**2 + c[3] * um**2 + c[4] * um**4 + c[5] * um**6)


def _buchdahl(um: DoubleArray, c: tuple[float, ...]) -> DoubleArray:
    off = um - _BUCHDAHL_UM
    w = off / (1 + _BUCHDAHL_PER_UM * off)
    return np.asarray(c[0] + c[1] * w + c[2] * w**2)


_FORMULAS: dict[str, Formula] = {
    "sellmeier": _sellmeier,
    "powers": _powers,
    "cauchy": _cauchy,
    "herzberger": _herzberger,
    "buchdahl": _buchdahl,
}
