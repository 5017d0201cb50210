"""Values of a lens file in JSON, with errors that name the place in it."""

from __future__ import annotations

import json
import math
from typing import Any

from render.errors import InputError
from render.optics.lens_files.lens_text import LensText

_LONGEST_WORD = 200


class JsonPart:
    """A value in the file, and its place."""

    def __init__(self, text: LensText, value: Any, place: str = "") -> None:
        self._text, self._value, self._place = text, value, place

    def __bool__(self) -> bool:
        """Whether there is something other than null, zero or emptiness."""
        return bool(self._value)

    def error(self, what: str, surface: str = "") -> InputError:
        """Make an error with this place, or that of the surface.

        Args:
            what: the rest of the sentence.
            surface: as the file counts it.
        """
        place = self._place.replace(".attributes", "").rstrip(".")
        return self._text.error(f"{place}: {what}" if place and not surface else what, surface=surface)

    def part(self, *keys: str) -> JsonPart:
        """A part by the names on the way to it; null where one is missing."""
        value, place = self._value, self._place
        for key in keys:
            value = value.get(key) if isinstance(value, dict) else None
            place = f"{place}.{key}" if place else key
        return JsonPart(self._text, value, place)

    def entries(self, key: str, *, at_most: int) -> list[JsonPart]:
        """The entries of a list; none where it is missing.

        Raises:
            InputError: it is no list, or has more entries than that.
        """
        found = self.part(key)
        values = [] if found._value is None else found._value
        if not isinstance(values, list):
            raise found.error("expected a list")
        if len(values) > at_most:
            raise found.error(f"expected at most {at_most} entries, got {len(values)}")
        return [JsonPart(self._text, value, f"{found._place}[{i}]") for i, value in enumerate(values)]

    def number(self, key: str, default: float | None = None, *, infinite: bool = False) -> float:
        """A number.

        Args:
            key: its name.
            default: where it is missing or null; None makes that an error.
            infinite: whether it may be infinite.

        Raises:
            InputError: it is no such number.
        """
        found = self.part(key)
        value = default if found._value is None else found._value
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise found.error("expected a number")
        try:
            number = float(value)
        except OverflowError:
            number = math.nan
        if math.isnan(number) or (math.isinf(number) and not infinite):
            raise found.error(f"expected a {'' if infinite else 'finite '}number")
        return number

    def numbers(self, key: str, *, at_most: int) -> list[float]:
        """The numbers of a list, or of an array that is an object with them (`__ndarray__`); none where it is missing.

        Raises:
            InputError: it is no such list, or has more entries than that.
        """
        found = self.part(key)
        if found.part("__ndarray__"):
            return found.numbers("__ndarray__", at_most=at_most)
        parts = self.entries(key, at_most=at_most)
        return [JsonPart(self._text, {"": part._value}, part._place).number("") for part in parts]

    def rows(self, key: str, *, at_most: int) -> list[list[float]]:
        """The numbers of a list of lists that are equally long, or of an array that is an object with them (`__ndarray__`); none
        where it is missing.

        Raises:
            InputError: it is no such list, or has more rows or columns than that.
        """
        if self.part(key, "__ndarray__"):
            return self.part(key).rows("__ndarray__", at_most=at_most)
        parts = self.entries(key, at_most=at_most)
        found = [JsonPart(self._text, {"": part._value}, part._place).numbers("", at_most=at_most) for part in parts]
        if len({len(row) for row in found}) > 1:
            raise self.part(key).error("expected rows of the same length")
        return found

    def word(self, key: str) -> str:
        """A text; empty where it is missing."""
        value = self.part(key)._value
        return value[:_LONGEST_WORD] if isinstance(value, str) else ""

    def words(self, key: str) -> list[str]:
        """The texts of a list; none where it is missing."""
        value = self.part(key)._value
        return [word[:_LONGEST_WORD] for word in value if isinstance(word, str)] if isinstance(value, list) else []

    def flag(self, key: str) -> bool:
        """Whether something is set."""
        return self.part(key)._value is True


def read_json(text: LensText) -> JsonPart:
    """The whole file.

    Raises:
        InputError: it is no JSON.
    """
    try:
        return JsonPart(text, json.loads("\n".join(text.lines)))
    except json.JSONDecodeError as error:
        raise text.error(f"it is no JSON: {error.msg}", error.lineno) from error
    except (RecursionError, ValueError) as error:
        raise text.error("it is no JSON of a lens: too deep, or with numbers beyond all measure") from error
