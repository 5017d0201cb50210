"""CODE V's apertures of surfaces.

    CIR 12.0                            half the clear diameter
    REX 18; REY 10                      a rectangle's half width and half height; ELX, ELY: an ellipse's half axes
    ADX 0.5; ADY -1                     its centre
    CIR OBS 4; ADX OBS 1                an obscuration; so REX OBS, ELX OBS, …
    CIR EDG 13                          edge of the glass, which stops no light
    REX S3 L'mask' 18                   of surface 3, with a name

A surface has a circle about the axis, one more opening and one obscuration. What goes beyond them, turned apertures (ARO), and
holes (HOL) are named in a note.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from render.errors import InputError
from render.model.lens import Outline
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.lens_text import LensText
from render.optics.prescription.outlines import is_circle, reach_mm

_SIZES = ("CIR", "REX", "REY", "ELX", "ELY")
_PLACES = ("ADX", "ADY", "ARO")
APERTURES = (*_SIZES, *_PLACES)
_EDGE, _HOLE, _OBSCURATION = "EDG", "HOL", "OBS"
_NAME = re.compile(r"L|L?['\"].*", re.IGNORECASE)
_FULL_TURN_DEG = 360.0


@dataclass
class _Aperture:
    surface: DraftSurface
    is_obscuration: bool
    name: str
    line: int
    numbers: dict[str, float] = field(default_factory=dict)

    @property
    def centre(self) -> tuple[float, float]:
        return self.numbers.get("ADX", 0.0), self.numbers.get("ADY", 0.0)


class CodeVApertures:
    """Apertures of the surfaces, as they are read."""

    def __init__(self, text: LensText) -> None:
        self._text = text
        self._read: dict[tuple[int, bool, str], _Aperture] = {}  # by the id of the surface, which lives as long
        self._notes: dict[str, None] = {}

    def take(self, command: str, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        """Take a command, one of `APERTURES`, without the surface that it names.

        Raises:
            InputError: its number is none, or negative.
        """
        rest = list(words)
        name, kinds = "", set()
        while rest and (_NAME.fullmatch(rest[0]) or rest[0].upper() in (_EDGE, _HOLE, _OBSCURATION)):
            word = rest.pop(0)
            if _NAME.fullmatch(word):
                name = word
            else:
                kinds.add(word.upper())
        if _EDGE in kinds:
            return
        if _HOLE in kinds:
            self._leave_out(surface, f"{command} {_HOLE}")
            return
        what = f"half width ({command})" if command in _SIZES else f"place of the aperture ({command})"
        what = "half of the clear diameter (CIR)" if command == "CIR" and not kinds else what
        least = 0.0 if command in _SIZES else -float("inf")
        number = self._text.number(rest[0] if rest else "", what, line, surface.label, at_least=least)
        self._find(surface, _OBSCURATION in kinds, name, line).numbers[command] = number

    def finish(self, surfaces: Sequence[DraftSurface]) -> list[str]:
        """Set clear diameters, openings and obscurations of the surfaces; notes on what is not read.

        Raises:
            InputError: there is no such aperture.
        """
        known = {id(surface) for surface in surfaces}
        for aperture in self._read.values():
            if id(aperture.surface) in known:
                self._set(aperture)
        return list(self._notes)

    def _find(self, surface: DraftSurface, is_obscuration: bool, name: str, line: int) -> _Aperture:
        key = id(surface), is_obscuration, name
        if key not in self._read:
            self._read[key] = _Aperture(surface, is_obscuration, name, line)
        return self._read[key]

    def _set(self, aperture: _Aperture) -> None:
        outlines, surface = [*self._outlines(aperture)], aperture.surface
        turn = aperture.numbers.get("ARO", 0.0)
        for what, outline in outlines:
            if turn % (_FULL_TURN_DEG / 2) and not is_circle(outline):
                self._leave_out(surface, f"{what}, turned by ARO")
            elif aperture.is_obscuration:
                if surface.obscuration is not None:
                    self._leave_out(surface, f"{what} OBS")
                    continue
                surface.obscuration = outline
            elif what == "CIR" and outline.centre_mm == (0.0, 0.0):
                surface.semi_diameter = outline.half_mm[0]
            elif surface.opening is not None:
                self._leave_out(surface, what)
            else:
                surface.opening = outline
                if not surface.is_stop and surface.semi_diameter == 0:
                    surface.semi_diameter = reach_mm(outline)

    def _outlines(self, aperture: _Aperture) -> list[tuple[str, Outline]]:
        found: list[tuple[str, Outline]] = []
        numbers, centre = aperture.numbers, aperture.centre
        if radius := numbers.get("CIR", 0.0):
            found.append(("CIR", Outline("ellipse", (radius, radius), centre)))
        for begin, kind in (("RE", "rectangle"), ("EL", "ellipse")):
            x, y = (numbers.get(f"{begin}{axis}", 0.0) for axis in "XY")
            if x and y:
                outline = Outline("rectangle" if kind == "rectangle" else "ellipse", (x, y), centre)
                found.append((f"{begin}X and {begin}Y", outline))
            elif x or y:
                raise self._error(aperture, f"{begin}X and {begin}Y must both be above 0, got {x:g} and {y:g}")
        return found

    def _leave_out(self, surface: DraftSurface, what: str) -> None:
        self._notes[f"The aperture of surface {surface.label} ({what}) is not read; light passes it."] = None

    def _error(self, aperture: _Aperture, what: str) -> InputError:
        return self._text.error(f"of its aperture {what}", aperture.line, aperture.surface.label)
