"""Zemax's apertures of surfaces.

    CLAP 2 12.5 0        light passes between these radii; OBSC: everywhere else
    SQAP 18 10 0         within these half widths in x and y; SQOB: outside of them
    ELAP 18 10 0         within the ellipse of these half axes; ELOB: outside of it
    SPID 1.5 4           arms of this width, so many of them, evenly from +x
    OBDC 0.5 -1          centre of the aperture, in x and y

A circle about the axis is the clear diameter, in place of DIAM, which in a drawing is often wider. Notes name a spider (SPID) on
a surface without a clear diameter, an aperture by points (USAP), and an obscuration (OBSC) that is a ring within its lens.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from render.errors import InputError
from render.model.lens import Outline
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.lens_text import LensText
from render.optics.prescription.outlines import is_circle, reach_mm, spider

_RADII = ("CLAP", "OBSC")
_HALF_WIDTHS = ("SQAP", "SQOB", "ELAP", "ELOB")
_NOT_READ = ("USAP", "UDAD")
_SPIDER, _MOST_ARMS = "SPID", 16
_BEYOND = 1.05  # clear semi-diameters to which an arm goes
_CENTRE = "OBDC"
APERTURES = (*_RADII, *_HALF_WIDTHS, *_NOT_READ, _SPIDER, _CENTRE)


@dataclass
class _Aperture:
    surface: DraftSurface
    kind: str = ""
    size: tuple[float, float] = (0.0, 0.0)
    centre: tuple[float, float] = (0.0, 0.0)
    line: int = 0


class ZemaxApertures:
    """Apertures of the surfaces, as they are read."""

    def __init__(self, text: LensText) -> None:
        self._text = text
        self._read: list[_Aperture] = []
        self._left_out: list[tuple[DraftSurface, str]] = []

    def take(self, command: str, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        """Take a line whose command is one of `APERTURES`.

        Raises:
            InputError: its numbers are none, or negative.
        """
        least = -float("inf") if command == _CENTRE else 0.0
        what = f"centre of the aperture ({command})"
        what = f"radius ({command})" if command in _RADII else f"half width ({command})" if least == 0 else what
        if command in _NOT_READ:
            self._left_out.append((surface, command))
            return
        what = "width, or number of arms, of the spider (SPID)" if command == _SPIDER else what
        first, second = (
            self._text.number(word, what, line, surface.label, at_least=least) for word in (*words, "0", "0")[:2]
        )
        if not self._read or self._read[-1].surface is not surface:
            self._read.append(_Aperture(surface))
        aperture = self._read[-1]
        if command == _CENTRE:
            aperture.centre = first, second
        elif first or second:  # of zeros it is none
            aperture.kind, aperture.size, aperture.line = command, (first, second), line

    def finish(self, surfaces: Sequence[DraftSurface]) -> list[str]:
        """Set clear diameters, openings and obscurations of the surfaces; notes on what is not read.

        Raises:
            InputError: there is no such aperture.
        """
        for aperture in self._read:
            if any(aperture.surface is each for each in surfaces):
                self._set(aperture)
        named: dict[tuple[str, str], None] = {}
        for surface, command in self._left_out:
            if any(surface is each for each in surfaces):
                named[surface.label, command] = None
        return [
            f"The aperture of surface {label} ({command}) is not read; light passes it." for label, command in named
        ]

    def _set(self, aperture: _Aperture) -> None:
        surface, (first, second), kind = aperture.surface, aperture.size, aperture.kind
        if kind == _SPIDER:
            self._set_spider(aperture)
        if kind in _RADII:
            if second <= first:
                raise self._error(aperture, f"the radii must grow, got {first:g} and {second:g}")
            inner, outer = (
                Outline("ellipse", (radius, radius), aperture.centre) if radius else None for radius in (first, second)
            )
            if kind == "CLAP":
                self._open(surface, outer)
                surface.obscuration = inner
            elif inner is None:
                surface.obscuration = outer
            elif aperture.centre == (0.0, 0.0) and 0 < surface.semi_diameter <= second:
                self._open(surface, inner)
            else:
                self._left_out.append((surface, kind))
        elif kind in _HALF_WIDTHS:
            if not (first and second):
                raise self._error(aperture, f"both half widths must be above 0, got {first:g} and {second:g}")
            outline = Outline("rectangle" if kind.startswith("SQ") else "ellipse", (first, second), aperture.centre)
            if kind.endswith("OB"):
                surface.obscuration = outline
            else:
                self._open(surface, outline)

    def _set_spider(self, aperture: _Aperture) -> None:
        surface, (width, arms) = aperture.surface, aperture.size
        if not width or not arms:  # without width, or arms, it is none
            return
        if not (arms == int(arms) and arms <= _MOST_ARMS):
            raise self._error(aperture, f"the number of arms must be a whole one up to {_MOST_ARMS}, got {arms:g}")
        if not surface.semi_diameter:
            self._left_out.append((surface, _SPIDER))
            return
        length = _BEYOND * (surface.semi_diameter + float(np.hypot(*aperture.centre)))
        if width >= 2 * length * np.sin(np.pi / max(arms, 2)):
            raise self._error(aperture, f"{arms:g} arms of the width {width:g} leave nothing open")
        surface.obscuration = spider(width, int(arms), length, aperture.centre)

    def _open(self, surface: DraftSurface, outline: Outline | None) -> None:
        if outline is None:
            return
        if is_circle(outline) and outline.centre_mm == (0.0, 0.0):
            surface.semi_diameter = outline.half_mm[0]
            return
        surface.opening = outline
        if not surface.is_stop:  # an iris stays as wide as it is
            surface.semi_diameter = reach_mm(outline)

    def _error(self, aperture: _Aperture, what: str) -> InputError:
        return self._text.error(f"of its aperture ({aperture.kind}) {what}", aperture.line, aperture.surface.label)
