"""Zemax's surfaces with two curves: BICONICX and TOROIDAL.

TYPE BICONICX        CURV and CONI are the curve in y
  PARM 1 50.0        radius in x, 0 for none
  PARM 2 -1.0        conic constant in x
TYPE TOROIDAL        the curve in y, with CONI, turned about an axis that is parallel to y
  PARM 1 50.0        radius of that turn, 0 for none: a cylinder
  PARM 3 1.1E-6      PARM i: coefficient of y^(2i - 2) in the curve, i from 2 to 8
  XDAT 1 0           number of Zernike terms; with any it is refused
"""

from __future__ import annotations

from dataclasses import dataclass, field

from render.errors import InputError
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.lens_text import LensText

TYPES = ("BICONICX", "TOROIDAL")
_RADIUS, _CONIC = "1", "2"
_TERMS = {str(place): 2 * place - 2 for place in range(2, 9)}  # powers of y
_EXTRAPOLATE = "0"  # whether rays that miss go on


@dataclass
class _Read:
    surface: DraftSurface
    kind: str
    line: int
    parameters: dict[str, float] = field(default_factory=dict)


class TwoCurves:
    """Surfaces of these types, as they are read."""

    def __init__(self, text: LensText) -> None:
        self._text = text
        self._read: dict[int, _Read] = {}  # by the id of the surface, which lives as long

    def begin(self, surface: DraftSurface, kind: str, line: int) -> None:
        """Take a surface whose TYPE is one of `TYPES`."""
        self._read[id(surface)] = _Read(surface, kind, line)

    def holds(self, surface: DraftSurface) -> bool:
        """Whether a surface is one of these."""
        return id(surface) in self._read

    def take(self, surface: DraftSurface, number: str, value: float) -> None:
        """Take a parameter (PARM) of one of these."""
        self._read[id(surface)].parameters[number] = value

    def take_extra(self, surface: DraftSurface, number: str, value: float) -> None:
        """Take extra data (XDAT) of one of these.

        Raises:
            InputError: a torus has Zernike terms.
        """
        each = self._read[id(surface)]
        if each.kind == "TOROIDAL" and number == "1" and value:
            raise self._error(
                each, f"Zernike terms (XDAT 1) of a torus are not supported: their number must be 0, got {value:g}"
            )

    def finish(self) -> None:
        """Set the curves in x.

        Raises:
            InputError: a surface has parameters that its type has not.
        """
        for each in self._read.values():
            known = (_RADIUS, *_TERMS, _EXTRAPOLATE) if each.kind == "TOROIDAL" else (_RADIUS, _CONIC)
            left = [number for number, value in each.parameters.items() if value and number not in known]
            if left:
                raise self._error(each, f"PARM {left[0][:9]} of a surface of TYPE {each.kind} must be 0")
            surface, radius = each.surface, each.parameters.get(_RADIUS, 0.0)
            if each.kind == "TOROIDAL":
                surface.across, surface.torus = (radius, 0.0), "upright"
                surface.terms = {power: each.parameters.get(number, 0.0) for number, power in _TERMS.items()}
            else:
                surface.across = radius, each.parameters.get(_CONIC, 0.0)

    def _error(self, each: _Read, what: str) -> InputError:
        return self._text.error(what, each.line, each.surface.label)
