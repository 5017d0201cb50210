"""The multi-configuration editor of a Zemax file: operands with a value for each configuration.

MNUM 3 1                            three configurations; the surfaces are those of the first
LTTL 0 1 "far" 0 …                  the title of a configuration
THIC 4 1 5.2 0 …                    thickness, of surface 4, at configuration 1
CRVT, CONN, SDIA                    curvature, conic constant, semi-diameter of a surface
APER 0 1 2.8 0 …                    value of the system aperture

Solves make a thickness depend on others, so that it varies too: TCOM i L keeps the sum with that of surface i, TOLE i L the
length from surface i on, and MAZH puts the film where light meets.
"""

from __future__ import annotations

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
    "THIC": "thickness",
    "CRVT": "radius",
    "CONN": "conic",
    "SDIA": "semi_diameter",
}
_APERTURES = ("APTP", "APMN", "APMX", "APDX", "APDY")
_NOT_READ = (
    *_APERTURES,
    "GLSS",
    "PRAM",
    *(f"PAR{number}" for number in range(13)),
    "IGNR",
    "STPS",
    "MIND",
    "MABB",
    "MDPG",
)
OPERANDS = frozenset((*_OF_SURFACES, *_NOT_READ, "APER", "LTTL"))
SOLVES = frozenset(("TCOM", "TOLE", "MAZH"))


class ZemaxConfigurations:
    """Takes the lines of the editor, and the solves of the surfaces.

    Attributes:
        count: number of configurations.
    """

    def __init__(self, text: LensText) -> None:
        self.count = 1
        self._text = text
        self._active = 0
        self._begun = False
        self._values: dict[tuple[str, int], dict[int, float]] = {}
        self._names: dict[int, str] = {}
        self._changed: list[str] = []  # operands that are not read
        self._words: dict[tuple[str, int], str] = {}
        self._sums: dict[int, tuple[int, float, bool]] = {}
        self._film_follows = -1

    def begin(self, words: Sequence[str], line: int) -> None:
        """MNUM: number of configurations, and which one the surfaces are of."""
        self._begun = True
        self.count = self._index(words, 0, MAX_CONFIGURATIONS, "number of configurations (MNUM)", line) if words else 1
        if len(words) > 1:
            self._active = self._index(words, 1, self.count, "configuration (MNUM)", line) - 1

    def take(self, operand: str, words: Sequence[str], line: int) -> None:
        """Take an operand's value at a configuration; before MNUM the word means something else."""
        if not self._begun or len(words) < 3:
            return
        at = self._index(words, 1, self.count, f"configuration of {operand}", line) - 1
        if operand == "LTTL":
            self._names[at] = words[2].strip('"')
        elif operand in _NOT_READ:
            key = operand, self._index(words, 0, 9999, f"surface of {operand}", line, least=0)
            if self._words.setdefault(key, words[2]) != words[2] and operand not in self._changed:
                self._changed.append(operand)
        else:
            surface = 0 if operand == "APER" else self._index(words, 0, 9999, f"surface of {operand}", line, least=0)
            value = self._text.number(words[2], f"value of {operand}", line, str(surface))
            self._values.setdefault((operand, surface), {})[at] = value

    def solve(self, kind: str, surface: int, words: Sequence[str], line: int) -> None:
        """Take a solve of a surface's thickness."""
        if kind == "MAZH":
            self._film_follows = surface
        elif len(words) > 1:
            begin = self._index(words, 0, 9999, f"surface of {kind}", line, least=0)
            length = self._text.number(words[1], f"length of {kind}", line, str(surface))
            self._sums[surface] = begin, length, kind == "TOLE"

    def finish(self, draft: Draft, surfaces: Sequence[DraftSurface], aperture: Quantity | None) -> float | None:
        """Set the surfaces to the first configuration, and keep all of them.

        Args:
            draft: that takes the configurations.
            surfaces: of the file, with object and image, numbered from 0.
            aperture: kind of number that the system aperture is; None where the stop is the aperture.

        Returns:
            The system aperture's value at the first configuration, where the editor has one.

        Raises:
            InputError: an operand names a surface that is not there.
        """
        if self.count < 2:
            return None
        found = draft.configurations = DraftConfigurations(self.count, names=self._titles())
        apertures: tuple[float | None, ...] = ()
        for (operand, number), by_index in self._values.items():
            if number >= len(surfaces):
                raise self._text.error(f"{operand} is about surface {number}, which is not there")
            values = tuple(by_index.get(index) for index in range(self.count))
            if operand == "APER":
                apertures = values
                if aperture is not None:
                    found.variations.append(DraftVariation(None, aperture, values))
            elif number > 0:
                self._vary(found, surfaces[number], _OF_SURFACES[operand], values)
            elif operand == "THIC":
                found.variations.append(DraftVariation(None, "object_distance", self._object(values, draft.unit_mm)))
        self._follow_sums(found, surfaces)
        self._follow_film(found, surfaces, draft)
        if self._changed:
            draft.notes.append(f"Its configurations differ in {', '.join(self._changed)} too, which is not read.")
        return apertures[0] if apertures else None

    def _titles(self) -> tuple[str, ...]:
        return tuple(self._names.get(index, "") for index in range(self.count)) if self._names else ()

    def _vary(
        self,
        found: DraftConfigurations,
        surface: DraftSurface,
        quantity: Quantity,
        values: tuple[float | None, ...],
    ) -> None:
        if quantity == "radius":
            values = tuple(None if value is None else _inverse(value) for value in values)
        if values[0] is not None:
            setattr(surface, quantity, values[0])
        found.variations.append(DraftVariation(surface, quantity, values))

    def _object(self, values: tuple[float | None, ...], unit_mm: float) -> tuple[float | None, ...]:
        far = FAR_AWAY_MM / unit_mm
        return tuple(float("inf") if value is not None and value >= far else value for value in values)

    def _follow_sums(self, found: DraftConfigurations, surfaces: Sequence[DraftSurface]) -> None:
        """Thicknesses that solves make of others."""
        for number, (begin, length, is_whole) in sorted(self._sums.items()):
            if not 0 < begin < number < len(surfaces) - 1:
                continue
            others = surfaces[begin:number] if is_whole else [surfaces[begin]]
            parts = [_own_where_unknown(found, surface) for surface in others]
            if any(len(set(part)) > 1 for part in parts):
                values = tuple(length - sum(at) for at in zip(*parts, strict=True))
                surfaces[number].thickness = values[0]
                found.set_thicknesses(surfaces[number], values)

    def _follow_film(self, found: DraftConfigurations, surfaces: Sequence[DraftSurface], draft: Draft) -> None:
        """The distance to the film, where it is solved for: the file has that of its active configuration alone."""
        if self._film_follows != len(surfaces) - 2:
            return
        surface = surfaces[self._film_follows]
        values = tuple(surface.thickness if index == self._active else None for index in range(self.count))
        found.set_thicknesses(surface, values)
        draft.film_is_solved = draft.film_is_solved or self._active > 0

    def _index(self, words: Sequence[str], place: int, most: int, what: str, line: int, *, least: int = 1) -> int:
        word = words[place]
        if not (word.isdecimal() and len(word) < 6 and least <= int(word) <= most):
            raise self._text.error(f"the {what} must be from {least} to {most}, got {word[:40]}", line)
        return int(word)


def object_distance(found: DraftConfigurations) -> float | None:
    """Distance of the object at the first configuration, where it varies."""
    return next((each.values[0] for each in found.variations if each.quantity == "object_distance"), None)


def _own_where_unknown(found: DraftConfigurations, surface: DraftSurface) -> tuple[float, ...]:
    return tuple(surface.thickness if value is None else value for value in found.thicknesses(surface))


def _inverse(curvature: float) -> float:
    return 1 / curvature if abs(curvature) > 1e-12 else 0.0
