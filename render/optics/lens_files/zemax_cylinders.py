"""Zemax's surfaces with two curves: BICONICX and TOROIDAL.

    TYPE BICONICX        CURV and CONI are the curve in y
      PARM 1 50.0        radius in x, 0 for none
      PARM 2 -1.0        conic constant in x
    TYPE TOROIDAL        the curve in y, turned about an axis that is parallel to y
      PARM 1 50.0        radius of that turn, 0 for none: a cylinder

A torus is read where it is a cylinder or a sphere, which a surface with two curves is exactly; any other torus is refused.
"""

from __future__ import annotations

from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.lens_text import LensText

TYPES = ("BICONICX", "TOROIDAL")
_RADIUS, _CONIC = "1", "2"


class TwoCurves:
    """Surfaces of these types, as they are read."""

    def __init__(self, text: LensText) -> None:
        self._text = text
        self._read: list[tuple[DraftSurface, str, dict[str, float], int]] = []

    def begin(self, surface: DraftSurface, kind: str, line: int) -> None:
        """Take a surface whose TYPE is one of `TYPES`."""
        self._read.append((surface, kind, {}, line))

    def holds(self, surface: DraftSurface) -> bool:
        """Whether a surface is one of these."""
        return any(own is surface for own, *_ in self._read)

    def take(self, surface: DraftSurface, number: str, value: float) -> None:
        """Take a parameter (PARM) of one of these."""
        for own, _, parameters, _ in self._read:
            if own is surface:
                parameters[number] = value

    def finish(self) -> None:
        """Set the curves in x.

        Raises:
            InputError: a surface has parameters that no surface with two curves has.
        """
        for surface, kind, parameters, line in self._read:
            left = [number for number, value in parameters.items() if value and number not in (_RADIUS, _CONIC)]
            radius, conic = parameters.get(_RADIUS, 0.0), parameters.get(_CONIC, 0.0)
            if kind == "TOROIDAL":
                if conic:
                    left.insert(0, _CONIC)
                conic = self._conic_of_torus(surface, radius, line)
            if left:
                what = f"PARM {left[0][:9]} of a surface of TYPE {kind} must be 0"
                raise self._text.error(what, line, surface.label)
            if (radius, conic) != (surface.radius, surface.conic):
                surface.across = radius, conic

    def _conic_of_torus(self, surface: DraftSurface, radius: float, line: int) -> float:
        """Conic constant in x of a torus that is a cylinder or a sphere."""
        is_sphere = radius == surface.radius and surface.conic == 0
        if radius and surface.radius and not is_sphere:
            what = f"a torus of the radii {surface.radius:g} and {radius:g} is not supported: expected a cylinder (one radius 0)"
            raise self._text.error(what, line, surface.label)
        return 0.0
