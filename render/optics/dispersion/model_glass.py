"""Dispersion of a glass known by index and Abbe number alone.

Relative partial dispersions of most glasses lie near a line over the Abbe number, the normal line; how far a glass is off it
depends on its kind. So that deviation is taken from the catalogue's glasses of about that index and Abbe number: the mean of all,
weighted by the inverse fourth power of their distance. A glass of the catalogue with these very numbers has nearly all of the
weight.

The index then runs as ``n = n_d + Σ c_i·(L^e_i − L_d^e_i)``, with exponents 2, −2, −4, −6 and −8, through its values at h, g,
F, C and r. Given the partial dispersions of a catalogue's glass, it stays within 3e-5 of n_F − n_C from 400 to 700 nm for nine
glasses in ten.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache, lru_cache

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import Dispersion, Glass
from render.optics.dispersion.catalogue import OPTICAL_GLASS, catalogue
from render.optics.dispersion.lines import C_LINE_NM, D_LINE_NM, F_LINE_NM, G_LINE_NM, H_LINE_NM, R_LINE_NM

_EXPONENTS = np.array([2.0, -2.0, -4.0, -6.0, -8.0])
_LINES_NM = np.array([H_LINE_NM, G_LINE_NM, F_LINE_NM, C_LINE_NM, R_LINE_NM])
# Distances that count as 1: differences between glasses of one type by several makers.
_INDEX_STEP, _ABBE_STEP = 1e-3, 0.1
_SCHOTTS_LINE = (0.6438, -0.001682)  # of P_gF over V_d, through K7 and F2 (Schott, TIE-29)
_FARTHEST = 1e6
_SAME = 0.001  # squared distance below which glasses are the same
_REFERENCE, _REFERENCE_WEIGHT = (
    "Schott",
    10.0,
)  # glasses of the same numbers with and without lead differ; most designs mean Schott's


def model_index(index: float, abbe: float, wavelengths_nm: DoubleArray) -> DoubleArray:
    """Refractive indices of a model glass.

    Args:
        index: at the d line.
        abbe: Abbe number V_d, not 0.
        wavelengths_nm: any shape.

    Returns:
        Indices of the same shape.
    """
    a, b, c, d, e = _shape(index, abbe)
    x = np.square(D_LINE_NM / wavelengths_nm)
    above_d = a / x + x * (b + x * (c + x * (d + x * e))) - (a + b + c + d + e)
    return np.asarray(index + (index - 1) / abbe * above_d)


def partial_dispersions(index: float, abbe: float) -> DoubleArray:
    """Relative partial dispersions ``(4,)`` of a model glass: P_hg, P_gF, P_Fd and P_Cr."""
    glasses, deviations, lines, weight = _partials()
    place = np.clip([index, abbe], -_FARTHEST, _FARTHEST)  # beyond, all glasses are equally far away
    squared = np.square((place - glasses) / (_INDEX_STEP, _ABBE_STEP)).sum(axis=1)
    weights = weight * (squared + _SAME) ** -2.0
    return np.asarray(np.array([1.0, abbe]) @ lines + weights @ deviations / weights.sum())


def deviating_glass(glass: Glass, deviation: float) -> Glass:
    """A model glass whose P_gF is off Schott's normal line by a given deviation, as Zemax has it.

    The other partial dispersions are off theirs in the proportion that the catalogue's glasses have.

    Args:
        glass: with index and Abbe number, which is not 0.
        deviation: of P_gF.
    """
    _, deviations, lines, _ = _partials()
    normal = np.array([1.0, glass.abbe]) @ lines
    proportions = deviations.T @ deviations[:, 1] / np.square(deviations[:, 1]).sum()
    schotts = _SCHOTTS_LINE[0] + _SCHOTTS_LINE[1] * glass.abbe
    factors = np.array(_factors(normal + proportions * (schotts + deviation - normal[1])))
    factors *= (glass.index - 1) / glass.abbe
    in_um = factors * (D_LINE_NM / 1000) ** -_EXPONENTS
    pairs = np.stack([in_um, _EXPONENTS], axis=1).ravel().tolist()
    return replace(glass, dispersion=Dispersion("cauchy", (glass.index - float(factors.sum()), 0.0, *pairs)))


@lru_cache(maxsize=1024)
def _shape(index: float, abbe: float) -> tuple[float, ...]:
    return _factors(partial_dispersions(index, abbe))


def _factors(partials: DoubleArray) -> tuple[float, ...]:
    """Factors of the five terms in L/L_d, for n_F − n_C = 1."""
    phg, pgf, pfd, pcr = partials
    above_d = np.array([phg + pgf + pfd, pgf + pfd, pfd, pfd - 1, pfd - 1 - pcr])
    terms = (_LINES_NM[:, None] / D_LINE_NM) ** _EXPONENTS - 1
    return tuple(np.linalg.solve(terms, above_d).tolist())


@cache
def _partials() -> tuple[DoubleArray, DoubleArray, DoubleArray, DoubleArray]:
    """Index and Abbe number ``(n, 2)``; deviations ``(n, 4)`` from the normal lines; these ``(2, 4)``, constants and slopes; and
    weights ``(n,)``.
    """
    made = [glass for glass in catalogue() if glass.maker in OPTICAL_GLASS]
    glasses, partials = np.array([(glass.index, glass.abbe) for glass in made]), np.array([g.partials for g in made])
    terms = np.stack([np.ones(len(made)), glasses[:, 1]], axis=1)
    lines = np.linalg.lstsq(terms, partials, rcond=None)[0]
    weight = np.array([_REFERENCE_WEIGHT if glass.maker == _REFERENCE else 1.0 for glass in made])
    return glasses, partials - terms @ lines, lines, weight
