"""CODE V's diffractive surfaces.

    DIF DOE                             by the phase that it adds
    HOR 1                               order of diffraction, 1 by default
    HWL 587.6                           wavelength of its coefficients, nm
    HCT R                               with rotational symmetry
    HCO C1 -0.0005; HCO C2 1e-8         coefficients of r², r⁴, ... in the path that it adds, a length

In radians the phase is 2π·HOR/HWL times the path. Gratings, holograms and coefficients of another type are refused.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from render.errors import InputError
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.lens_text import LensText

COMMANDS = ("DIF", "HOR", "HWL", "HCT", "HCO")
_PHASE, _ROUND = "DOE", "R"
_MOST_ORDERS = 1000
_WAVELENGTHS_NM = 1.0, 1e6


@dataclass
class _Read:
    surface: DraftSurface
    line: int
    kind: str = ""
    order: float = 1.0
    wavelength_nm: float = 0.0
    form: str = ""
    path: dict[int, float] = field(default_factory=dict)


class CodeVDiffraction:
    """Diffractive surfaces, as they are read."""

    def __init__(self, text: LensText) -> None:
        self._text = text
        self._read: dict[int, _Read] = {}  # by the id of the surface, which lives as long

    def take(self, surface: DraftSurface, name: str, words: Sequence[str], line: int) -> None:
        """Take a command, one of `COMMANDS`, without the surface that it names.

        Raises:
            InputError: its number is none, or the surface diffracts in another way.
        """
        each = self._read.setdefault(id(surface), _Read(surface, line))
        word, label = words[0].upper() if words else "", surface.label
        if name == "DIF":
            if word != _PHASE:
                what = f"DIF{' ' if word else ''}{word[:20]} is not supported: expected {_PHASE}, a phase"
                raise self._text.error(what, line, label)
            each.kind, each.line = word, line
        elif name == "HOR":
            each.order = self._text.number(word, "order of diffraction (HOR)", line, label)
        elif name == "HWL":
            each.wavelength_nm = self._text.number(word, "wavelength of the phase (HWL)", line, label)
        elif name == "HCT":
            each.form = word
        elif found := re.fullmatch(r"C(\d{1,2})", word, re.ASCII):
            value = self._text.number(words[1] if words[1:] else "", f"coefficient {word} (HCO)", line, label)
            each.path[2 * int(found[1])] = value
        else:
            raise self._text.error(
                f"HCO must be followed by C1, C2, ... and a value, got {word[:20] or 'nothing'}", line, label
            )

    def finish(self, unit_mm: float) -> None:
        """Set the phases of all surfaces.

        Args:
            unit_mm: the file's unit of length.

        Raises:
            InputError: a surface lacks what its phase needs.
        """
        for each in self._read.values():
            if each.kind and any(each.path.values()):
                each.surface.phase = self._phase(each, unit_mm)

    def _phase(self, each: _Read, unit_mm: float) -> dict[int, float]:
        if each.form != _ROUND:
            got = f"got {each.form[:20]}" if each.form else "got none"
            raise self._error(each, f"the phase must have rotational symmetry, as HCT {_ROUND} says, {got}")
        if not (each.order == int(each.order) and abs(each.order) <= _MOST_ORDERS):
            what = f"the order of diffraction (HOR) must be a whole number up to {_MOST_ORDERS}, got {each.order:g}"
            raise self._error(each, what)
        low, high = _WAVELENGTHS_NM
        if not low <= each.wavelength_nm <= high:
            what = (
                f"the wavelength of the phase (HWL) must be from {low:g} to {high:g} nm, got {each.wavelength_nm:g} nm"
            )
            raise self._error(each, what)
        if each.path.get(0):
            raise self._error(each, "coefficients of the phase (HCO) begin with C1, got C0")
        factor = 2 * math.pi * each.order * unit_mm / (each.wavelength_nm * 1e-6)
        return {power: factor * value for power, value in each.path.items()}

    def _error(self, each: _Read, what: str) -> InputError:
        return self._text.error(what, each.line, each.surface.label)
