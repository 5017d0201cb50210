"""Zemax's aspheres beyond EVENASPH: odd powers, many powers, Forbes's polynomials, and diffractive surfaces.

    TYPE ODDASPHE        PARM i: coefficient of r^i, i from 1 to 8
    TYPE XASPHERE        extended asphere: coefficients of ρ², ρ⁴, ... with ρ = r/R
    TYPE XOSPHERE        extended odd asphere, also XODDASPH: coefficients of ρ, ρ², ρ³, ...
    TYPE QED...          Q-type asphere, also QTYP...: PARM 1 0 is Qbfs, 1 is Qcon; coefficients a_0, a_1, ...
    TYPE BINARY_2        PARM 0: order of diffraction; PARM i: coefficient of r^(2i); XDAT: of ρ², ρ⁴, ... in the phase, radians
      XDAT 1 4.0         number of coefficients
      XDAT 2 1.0         normalisation radius R
      XDAT 3 ...         the first coefficient

Lengths and coefficients are in the file's unit. Coefficients beyond the number are left over, and have no say.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from render.errors import InputError
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.forbes import MOST_TERMS, ForbesTerms
from render.optics.lens_files.lens_text import LensText

_STEPS = {"XASPHERE": 2, "XOSPHERE": 1, "XODDASPH": 1}  # of the powers
_FORBES = ("QED", "QTYP")
_BINARY = "BINARY_2"
_LAST_ODD = _LAST_EVEN = 8
_MOST_ORDERS = 1000
_MOST_EXTRA = 242  # XDAT: OpticStudio's extended surfaces have up to 240 coefficients
_COUNT, _RADIUS, _FIRST = 1, 2, 3

TYPES = ("ODDASPHE", *_STEPS, _BINARY)


def is_asphere(kind: str) -> bool:
    """Whether a TYPE is one of these."""
    return kind in TYPES or kind.startswith(_FORBES)


@dataclass
class _Read:
    surface: DraftSurface
    kind: str
    line: int
    parameters: dict[int, float] = field(default_factory=dict)
    extra: dict[int, float] = field(default_factory=dict)


class ZemaxAspheres:
    """Surfaces of these types, as they are read."""

    def __init__(self, text: LensText) -> None:
        self._text = text
        self._read: dict[int, _Read] = {}  # by the id of the surface, which lives as long

    def begin(self, surface: DraftSurface, kind: str, line: int) -> None:
        """Take a surface for whose TYPE `is_asphere` holds."""
        self._read[id(surface)] = _Read(surface, kind, line)

    def holds(self, surface: DraftSurface) -> bool:
        """Whether a surface is one of these."""
        return id(surface) in self._read

    def take(self, surface: DraftSurface, command: str, words: list[str], line: int) -> None:
        """Take PARM or XDAT, followed by its number and its value.

        Raises:
            InputError: one of them is missing, or no number.
        """
        number, value = (*words, "", "")[:2]
        if not (number.isdecimal() and number.isascii() and len(number) <= 4):
            what = f"{command} must be followed by its number and by its value"
            raise self._text.error(what, line, surface.label)
        most = _MOST_EXTRA if command == "XDAT" else 1000
        if int(number) > most:
            raise self._text.error(f"{command} has numbers up to {most}, got {number}", line, surface.label)
        term = self._text.number(value, f"value of {command} {number}", line, surface.label)
        each = self._read.get(id(surface))
        if each is not None:
            (each.extra if command == "XDAT" else each.parameters)[int(number)] = term

    def finish(self) -> None:
        """Set the terms of all surfaces.

        Raises:
            InputError: a surface has values that its type has not, or lacks its normalisation radius.
        """
        for each in self._read.values():
            if each.kind == "ODDASPHE":
                self._refuse_others(each, range(_LAST_ODD + 1))
                each.surface.terms = {power: value for power, value in each.parameters.items() if power}
                continue
            if each.kind == _BINARY:
                self._refuse_others(each, range(_LAST_EVEN + 1))
                each.surface.terms = {2 * place: value for place, value in each.parameters.items() if place}
            coefficients = self._coefficients(each)
            radius = each.extra.get(_RADIUS, 0.0)
            if not any(coefficients):
                continue
            if not radius > 0:
                raise self._error(each, f"the normalisation radius (XDAT 2) must be above 0, got {radius:g}")
            if each.kind == _BINARY:
                order = self._order(each)
                powers = {2 * (i + 1): value for i, value in enumerate(coefficients) if value}
                each.surface.phase = {
                    power: order * self._normalised(each, value, radius, power) for power, value in powers.items()
                }
            elif each.kind in _STEPS:
                step = _STEPS[each.kind]
                self._refuse_others(each, range(1))
                powers = {step * (i + 1): value for i, value in enumerate(coefficients)}
                each.surface.terms = {
                    power: self._normalised(each, value, radius, power) for power, value in powers.items()
                }
            else:
                self._set_forbes(each, coefficients, radius)

    def _order(self, each: _Read) -> float:
        if 0 not in each.parameters:
            raise self._error(each, f"a surface of TYPE {_BINARY} needs its order of diffraction (PARM 0)")
        order = each.parameters[0]
        if not (order == int(order) and abs(order) <= _MOST_ORDERS):
            what = f"the order of diffraction (PARM 0) must be a whole number up to {_MOST_ORDERS}, got {order:g}"
            raise self._error(each, what)
        return order

    def _coefficients(self, each: _Read) -> tuple[float, ...]:
        count = each.extra.get(_COUNT, 0.0)
        if not (count == int(count) and 0 <= count <= _MOST_EXTRA - 2):
            what = f"the number of coefficients (XDAT 1) must be from 0 to {_MOST_EXTRA - 2}, got {count:g}"
            raise self._error(each, what)
        return tuple(each.extra.get(_FIRST + i, 0.0) for i in range(int(count)))

    def _normalised(self, each: _Read, value: float, radius: float, power: int) -> float:
        """Coefficient of r^p from that of ρ^p."""
        try:
            return value / radius**power
        except (OverflowError, ZeroDivisionError):
            raise self._error(each, f"the normalisation radius (XDAT 2) of {radius:g} is out of reach") from None

    def _set_forbes(self, each: _Read, coefficients: tuple[float, ...], radius: float) -> None:
        self._refuse_others(each, range(2))
        kind = each.parameters.get(1, 0.0)
        if kind not in (0, 1):
            raise self._error(each, f"PARM 1 of a Q-type asphere must be 0 (Qbfs) or 1 (Qcon), got {kind:g}")
        while coefficients[-1] == 0:
            coefficients = coefficients[:-1]
        if len(coefficients) > MOST_TERMS:
            raise self._error(each, f"at most {MOST_TERMS} Forbes terms are supported, got {len(coefficients)}")
        each.surface.forbes = ForbesTerms("Qcon" if kind else "Qbfs", coefficients, radius)

    def _refuse_others(self, each: _Read, known: range) -> None:
        left = [number for number, value in each.parameters.items() if value and number not in known]
        if left:
            raise self._error(each, f"PARM {left[0]} of a surface of TYPE {each.kind[:20]} must be 0")

    def _error(self, each: _Read, what: str) -> InputError:
        return self._text.error(what, each.line, each.surface.label)
