"""The zoom positions of a CODE V file: quantities with a value at each.

ZOO 3                               three positions; the surfaces are those of the first
ZOO THI S4 1.2 5.5 9.0              thickness of surface 4 at each; THI S4 Z2 5.5 is one of them
ZOO FNO 2.8 3.2 4.0                 f-number; EPD: the entrance beam's diameter
ZOO TIT; TIT Z1 "wide"              name of a position
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from render.optics.lens_files.configurations import (
    DraftConfigurations,
    DraftVariation,
    Quantity,
)
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.drafts import FAR_AWAY_MM, Draft
from render.optics.lens_files.lens_text import LensText
from render.optics.prescription.validation import MAX_CONFIGURATIONS

_OF_SURFACES: dict[str, Quantity] = {
    "THI": "thickness",
    "RDY": "radius",
    "CUY": "radius",
    "CIR": "semi_diameter",
    "K": "conic",
}
_OF_SYSTEM: dict[str, Quantity] = {"FNO": "f_number", "EPD": "pupil_diameter"}
_APERTURES = ("REX", "REY", "ELX", "ELY", "ADX", "ADY", "ARO")
_NOT_READ = ("GLA", "STO", "NA", *"ABCDEFGHJ", "XDE", "YDE", "ZDE", "ADE", "BDE", "CDE", *_APERTURES)
_SURFACE = re.compile(r"S(\d{1,4}|O|I)", re.ASCII)
_POSITION = re.compile(r"Z(\d{1,4})", re.ASCII)


class CodeVZoom:
    """Takes the commands that are about zoom positions.

    Attributes:
        count: number of positions.
    """

    def __init__(self, text: LensText) -> None:
        self.count = 1
        self._text = text
        self._values: dict[tuple[str, str], list[float | None]] = {}
        self._names: dict[int, str] = {}
        self._not_read: list[str] = []

    def takes(self, line: int, command: str, words: Sequence[str]) -> bool:
        """Take a command if it is about zoom positions.

        Raises:
            InputError: the positions are not as they must be.
        """
        if command[:3] == "ZOO":
            self._zoom(line, words)
            return True
        places = [place for place, word in enumerate(words) if _POSITION.fullmatch(word.upper())]
        if not places or self.count < 2:
            return False
        place = places[0]
        at = self._position(words[place], line)
        value = words[place + 1] if place + 1 < len(words) else ""
        if command[:3] == "TIT":
            self._names[at] = value.strip("'\" ")
        else:
            surface = next((word.upper() for word in words[:place] if _SURFACE.fullmatch(word.upper())), "")
            self._set(line, command[:3], surface, [(at, value)])
        return True

    def finish(self, draft: Draft, surfaces: Sequence[DraftSurface]) -> None:
        """Set the surfaces to the first position, and keep all of them.

        Args:
            draft: that takes the positions.
            surfaces: of the file, with object and image.

        Raises:
            InputError: a command names a surface that is not there.
        """
        if self.count < 2:
            return
        names = tuple(self._names.get(index, "") for index in range(self.count)) if self._names else ()
        found = draft.configurations = DraftConfigurations(self.count, "zoom positions", names)
        for (command, label), values in self._values.items():
            if command in _OF_SYSTEM:
                found.variations.append(DraftVariation(None, _OF_SYSTEM[command], tuple(values)))
                continue
            number = {"SO": 0, "SI": len(surfaces) - 1}.get(label)
            number = int(label[1:]) if number is None else number
            if number >= len(surfaces):
                raise self._text.error(f"ZOO {command} is about surface {number}, which is not there")
            self._vary(draft, surfaces, number, command, values)
        if self._not_read:
            draft.notes.append(f"Its zoom positions differ in {', '.join(self._not_read)} too, which is not read.")

    def first(self, command: str) -> float | None:
        """Value of a system command at the first position, where it varies."""
        return self._values.get((command, ""), [None])[0]

    def _vary(
        self, draft: Draft, surfaces: Sequence[DraftSurface], number: int, command: str, values: Sequence[float | None]
    ) -> None:
        quantity, surface = _OF_SURFACES[command], surfaces[number]
        if command == "CUY":
            values = [None if value is None else _inverse(value) for value in values]
        if values[0] is not None:
            setattr(surface, quantity, values[0])
        if number > 0:
            draft.configurations.variations.append(DraftVariation(surface, quantity, tuple(values)))
        elif quantity == "thickness":
            far = FAR_AWAY_MM / draft.unit_mm
            distances = tuple(float("inf") if value is not None and value >= far else value for value in values)
            draft.configurations.variations.append(DraftVariation(None, "object_distance", distances))

    def _zoom(self, line: int, words: Sequence[str]) -> None:
        if not words:
            return
        if words[0].isdecimal():
            if not (len(words[0]) < 6 and 1 <= int(words[0]) <= MAX_CONFIGURATIONS):
                raise self._text.error(f"ZOO must be from 1 to {MAX_CONFIGURATIONS}, got {words[0][:40]}", line)
            if self._values and int(words[0]) != self.count:
                raise self._text.error(f"ZOO {words[0]} stands behind values of {self.count} positions", line)
            self.count = int(words[0])
            return
        command, rest = words[0].upper()[:3], list(words[1:])
        surface = rest.pop(0).upper() if rest and _SURFACE.fullmatch(rest[0].upper()) else ""
        if command in _NOT_READ:
            if len(set(rest)) > 1 and command not in self._not_read:
                self._not_read.append(command)
        elif rest and len(rest) != self.count and (command in _OF_SURFACES or command in _OF_SYSTEM):
            raise self._text.error(
                f"ZOO {command} has {len(rest)} values for {self.count} positions", line, surface[1:]
            )
        else:
            self._set(line, command, surface, list(enumerate(rest)))

    def _set(self, line: int, command: str, surface: str, values: Sequence[tuple[int, str]]) -> None:
        if command not in _OF_SYSTEM and (command not in _OF_SURFACES or not surface):
            return
        kept = self._values.setdefault((command, "" if command in _OF_SYSTEM else surface), [None] * self.count)
        for at, word in values:
            kept[at] = self._text.number(word, f"value of {command} at position {at + 1}", line, surface[1:])

    def _position(self, word: str, line: int) -> int:
        number = int(word[1:])
        if not 1 <= number <= self.count:
            raise self._text.error(f"the file has {self.count} zoom positions, got {word}", line)
        return number - 1


def _inverse(curvature: float) -> float:
    return 1 / curvature if abs(curvature) > 1e-12 else 0.0
