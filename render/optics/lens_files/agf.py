"""Reads Zemax's glass catalogues, `.agf`.

    NM N-BK7 2 517642 1.5168 64.17 0 1  name, number of the formula, code, n_d, V_d
    CD 1.03961212E+0 6.00069867E-3 …    coefficients
    LD 0.31 2.5                         shortest and longest wavelength, micrometres

Other lines say nothing about the refractive index.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from render.model.lens import Dispersion
from render.optics.dispersion.formulas import index_at
from render.optics.dispersion.lines import C_LINE_NM, D_LINE_NM, F_LINE_NM
from render.optics.lens_files.lens_text import LensText

MAX_AGF_BYTES = 8 << 20  # the longest catalogue of a maker has 2 MB, in UTF-16
_MAX_COEFFICIENTS = 12
_ANY_NM = (0.0, 1e9)

# Exponents of the wavelength, by the number of the formula.
_EXPONENTS = {
    1: (0, 2, -2, -4, -6, -8),  # Schott
    10: (0, 2, -2, -4, -6, -8, -10, -12),  # extended
    12: (0, 2, -2, -4, -6, -8, 4, 6),  # extended 2
    13: (0, 2, 4, -2, -4, -6, -8, -10, -12),  # extended 3
}
_PAIRS = {2: 3, 6: 4, 11: 5}  # Sellmeier 1, 3 and 5


@dataclass(frozen=True)
class AgfGlass:
    """A glass of a catalogue file.

    Attributes:
        dispersion: its formula.
        range_nm: shortest and longest wavelength that the catalogue vouches for.
    """

    dispersion: Dispersion
    range_nm: tuple[float, float]


def read_agf(text: LensText) -> dict[str, AgfGlass]:
    """The glasses of a catalogue by their names. Those that are not transparent for visible light are left out.

    Args:
        text: the file.

    Raises:
        InputError: a number is none, or a glass is not complete.
    """
    found: dict[str, AgfGlass] = {}
    name, number, line_of = "", 0, 0
    coefficients: Sequence[float] = ()
    range_nm = _ANY_NM

    def keep() -> None:
        dispersion = _dispersion(text, name, number, coefficients, line_of) if name else None
        if dispersion is not None and _is_glass(dispersion, range_nm):
            found[name] = AgfGlass(dispersion, range_nm)

    for line, raw in enumerate(text.lines, 1):
        command, *words = raw.split() or [""]
        if command == "NM" and len(words) > 1:
            keep()
            name, number, line_of = words[0], int(text.number(words[1], "formula's number", line)), line
            coefficients, range_nm = (), _ANY_NM
        elif command == "CD":
            coefficients = [text.number(word, "coefficient (CD)", line) for word in words[:_MAX_COEFFICIENTS]]
        elif command == "LD" and len(words) > 1:
            low, high = (1000 * text.number(word, "wavelength (LD)", line, at_least=0) for word in words[:2])
            range_nm = (low, high)
    keep()
    return found


def _dispersion(text: LensText, name: str, number: int, given: Sequence[float], line: int) -> Dispersion | None:
    """The dispersion by the formula's number; None where there is no such formula."""
    c = [*given, *[0.0] * (_MAX_COEFFICIENTS - len(given))]
    if not any(c):
        raise text.error(f"glass {name} has no coefficients (CD)", line)
    formula, coefficients = "sellmeier", list[float]()
    if number in _EXPONENTS:
        pairs = zip(c, _EXPONENTS[number], strict=False)
        formula, coefficients = "powers", [number for factor, e in pairs if factor for number in (factor, float(e))]
    elif number in _PAIRS:
        coefficients = [1.0, 0.0, *c[: 2 * _PAIRS[number]]]
    elif number == 3:
        formula, coefficients = "herzberger", c[:6]
    elif number == 4:  # Sellmeier 2: n² = 1 + A + B1·L²/(L² − l1²) + B2/(L² − l2²)
        pole = c[4] ** 2
        strength = c[3] / pole if pole else 0.0
        coefficients = [1 + c[0] - strength, 0.0, c[1], c[2] ** 2, strength, pole]
    elif number == 5:
        formula, coefficients = "cauchy", [c[0], 0.0, c[1], -1.0, c[2], -3.5]
    elif number == 7:  # Handbook of Optics 1: n² = A + B/(L² − C) − D·L²
        strength = c[1] / c[2] if c[2] else 0.0
        coefficients = [c[0] - strength, -c[3], strength, c[2]]
    elif number == 8:  # Handbook of Optics 2: n² = A + B·L²/(L² − C) − D·L²
        coefficients = [c[0], -c[3], c[1], c[2]]
    elif number == 9:  # Sellmeier 4: n² = A + B·L²/(L² − C) + D·L²/(L² − E)
        coefficients = [c[0], 0.0, *c[1:5]]
    else:
        return None
    return Dispersion(formula, tuple(coefficients))


def _is_glass(dispersion: Dispersion, range_nm: tuple[float, float]) -> bool:
    """Whether it is a medium for visible light: its index is real, above 1, and falls from blue to red."""
    if range_nm[0] > F_LINE_NM or range_nm[1] < C_LINE_NM:
        return False
    n_f, n_d, n_c = index_at(dispersion, np.array([F_LINE_NM, D_LINE_NM, C_LINE_NM])).tolist()
    return bool(1 < n_c < n_d < n_f < 5)
