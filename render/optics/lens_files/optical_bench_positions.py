"""The variable distances of an Optical Bench file: a column for each position of zoom and focus."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from render.optics.lens_files.configurations import (
    DraftConfigurations,
    DraftVariation,
    Quantity,
)
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.drafts import FAR_AWAY_MM
from render.optics.lens_files.lens_text import LensText
from render.optics.prescription.validation import MAX_CONFIGURATIONS

_SAME_MM = 0.005  # patents round their distances to a hundredth
_OF_LENS: dict[str, Quantity] = {
    "d0": "object_distance",
    "focal length": "focal_length",
    "f-number": "f_number",
    "magnification": "magnification",
}
_NOTHING = ("", "undefined", "?")


class Positions:
    """Section [variable distances] of a file.

    Args:
        text: text of the file.
        rows: line and words of each row, by its name in small letters.
    """

    def __init__(self, text: LensText, rows: Mapping[str, tuple[int, Sequence[str]]]) -> None:
        self._text = text
        self._rows = rows
        distances = [words for name, (_, words) in rows.items() if name.startswith("d") or name == "bf"]
        self.count = max((len(words) for words in distances), default=1)

    def configurations(self, surfaces: Sequence[DraftSurface], thickness_names: Sequence[str]) -> DraftConfigurations:
        """All positions.

        Args:
            surfaces: of the lens.
            thickness_names: of each, as it stands in the lens data, in small letters.

        Raises:
            InputError: there are more than a file can have.
        """
        if self.count > MAX_CONFIGURATIONS:
            raise self._text.error(f"it has {self.count} positions, expected at most {MAX_CONFIGURATIONS}")
        found = DraftConfigurations(self.count, "positions of zoom and focus")
        for name, quantity in _OF_LENS.items():
            if name in self._rows:
                found.variations.append(DraftVariation(None, quantity, self._values(name)))
        for surface, name in zip(surfaces, thickness_names, strict=True):
            if name in self._rows:
                found.variations.append(DraftVariation(surface, "thickness", self._values(name)))
        return found

    def _values(self, name: str) -> tuple[float | None, ...]:
        _, words = self._rows[name]
        return tuple(_value(words, column) for column in range(self.count))

    def first(self, name: str) -> float | None:
        """A quantity at the first position, or None where the file does not give it.

        Raises:
            InputError: it is not a number of 0 or more.
        """
        line, words = self._rows.get(name, (0, ()))
        if not words or words[0].lower() in _NOTHING:
            return None
        return self._text.number(words[0], name, line, at_least=0)

    def length(self, word: str, what: str, line: int, surface: str) -> float:
        """A length as it stands in the lens data: a number, or the name of a variable distance at the first position.

        Raises:
            InputError: it is neither.
        """
        if word.lower() not in self._rows:
            return self._text.number(word, what, line, surface)
        line, words = self._rows[word.lower()]
        if word.lower() == "bf" and (not words or words[0].lower() in _NOTHING):
            return 0.0  # to be solved for
        return self._text.number(words[0] if words else "", f"{what} {word}", line, surface)

    def object_is_near(self) -> bool:
        """Whether the object is not at infinity at the first position."""
        _, words = self._rows.get("d0", (0, ()))
        distance = _value(words, 0)
        return distance is not None and distance < FAR_AWAY_MM

    def focus_group(self, thickness_names: Sequence[str]) -> tuple[int, int] | None:
        """First and last index of the surfaces that move to focus; None where the whole lens moves, or none says what.

        Args:
            thickness_names: of each surface, as it stands in the lens data, in small letters.
        """
        near = self._nearer_column()
        if near is None:
            return None
        moves = [(place, shift) for place, name in enumerate(thickness_names) if (shift := self._shift(name, near))]
        if len(moves) != 2 or abs(moves[0][1] + moves[1][1]) > 2 * _SAME_MM:
            return None  # one space: the whole lens, or all behind it; more: several groups
        return moves[0][0] + 1, moves[1][0]

    def _nearer_column(self) -> int | None:
        """A column of the first zoom position at a nearer focus."""
        focal_lengths, magnifications = (self._rows.get(name, (0, ()))[1] for name in ("focal length", "magnification"))
        for column in range(1, len(magnifications)):
            magnification, focal_length = _value(magnifications, column), _value(focal_lengths, column)
            same_zoom = focal_length is None or focal_length == _value(focal_lengths, 0)
            if magnification and same_zoom and (focal_length is not None or self.count == 2):
                return column
        return None

    def _shift(self, name: str, column: int) -> float:
        """Change of a distance from the first position to another; 0 where it is constant."""
        words = self._rows.get(name, (0, ()))[1]
        begin, end = _value(words, 0), _value(words, column)
        if begin is None or end is None or abs(end - begin) < _SAME_MM:
            return 0.0
        return end - begin


def _value(words: Sequence[str], column: int) -> float | None:
    try:
        value = float(words[column]) if column < len(words) and words[column].lower() not in _NOTHING else None
    except ValueError:
        return None
    return None if value is None or math.isnan(value) else value
