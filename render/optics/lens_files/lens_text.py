"""Text of a lens file, and errors that name file, line and surface."""

from __future__ import annotations

import codecs
import math
import re
from dataclasses import dataclass

from render.errors import InputError

UNKNOWN_GLASS = "unknown_glass"
"""Code of the error of a glass that no catalogue has."""
MAX_BYTES = 2**20  # a zoom of fifty surfaces with all its coatings takes some tens of kilobytes

_NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eEdD][+-]?\d+)?", re.ASCII)  # d: of Fortran
_INFINITY = re.compile(r"([+-]?)inf(inity)?", re.IGNORECASE)
_SAMPLE = 512  # bytes that tell the encoding
_LONGEST_NUMBER = 40  # characters
_CONTROL = re.compile(r"[\x00-\x08\x0b\x0e-\x19\x1b-\x1f\x7f]")  # ^Z (1a) ends old files, form feeds part their pages


@dataclass(frozen=True)
class LensText:
    """A lens file as text.

    Attributes:
        name: of the file, for messages.
        lines: without their ends.
    """

    name: str
    lines: tuple[str, ...]

    def error(self, what: str, line: int | None = None, surface: str = "") -> InputError:
        """Make an error with its location.

        Args:
            what: the rest of the sentence.
            line: counted from 1; 0 and None where there is none.
            surface: as the file counts it.
        """
        places = [self.name]
        places += [f"line {line}"] if line else []
        places += [f"surface {surface}"] if surface else []
        return InputError(f"{', '.join(places)}: {what}", code="bad_lens_file", path=self.name)

    def number(self, text: str, what: str, line: int, surface: str = "", *, at_least: float = -math.inf) -> float:
        """A finite number.

        Args:
            text: as it stands in the file.
            what: which number it is, for the message.
            line: counted from 1.
            surface: as the file counts it.
            at_least: the least that makes sense.

        Raises:
            InputError: the word is not a number, or too small.
        """
        is_number = len(text) <= _LONGEST_NUMBER and _NUMBER.fullmatch(text)
        value = float(text.lower().replace("d", "e")) if is_number else math.nan
        if not math.isfinite(value):
            raise self.error(f"the {what} must be a number, got {_quote(text)}", line, surface)
        if value < at_least:
            raise self.error(f"the {what} must be {at_least:g} or more, got {text}", line, surface)
        return value

    def radius(self, text: str, what: str, line: int, surface: str = "") -> float:
        """A radius of curvature, 0 for a plane, which may be written as infinity.

        Args:
            text: as it stands in the file.
            what: which number it is, for the message.
            line: counted from 1.
            surface: as the file counts it.

        Raises:
            InputError: the word is neither a number nor infinity.
        """
        return 0.0 if _INFINITY.fullmatch(text) else self.number(text, what, line, surface)

    def distance(self, text: str, what: str, line: int, surface: str = "") -> float:
        """A distance along the axis, which may be infinite.

        Args:
            text: as it stands in the file.
            what: which number it is, for the message.
            line: counted from 1.
            surface: as the file counts it.

        Raises:
            InputError: the word is neither a number nor infinity.
        """
        return math.inf if _INFINITY.fullmatch(text) else self.number(text, what, line, surface)


def decode(data: bytes, name: str, at_most: int = MAX_BYTES) -> LensText:
    """The text of a lens file: UTF-16 (as Zemax writes it, with or without its mark), UTF-8 or any 8-bit encoding.

    Args:
        data: all of the file.
        name: of the file, for messages.
        at_most: bytes that such a file may have.

    Raises:
        InputError: it is too long for a lens file, or no text.
    """
    if len(data) > at_most:
        raise InputError(
            f"{name} is too long for a lens file: {len(data)} bytes, expected at most {at_most}",
            code="bad_lens_file",
            path=name,
        )
    text = _decode(data)
    if text is None or _CONTROL.search(text):
        raise InputError(f"{name} is no lens file: expected text, got binary data", code="bad_lens_file", path=name)
    return LensText(name, tuple(re.split(r"\r\n|\r|\n", text)))


def _decode(data: bytes) -> str | None:
    marked = data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    utf16 = "utf-16" if marked else _unmarked_utf16(data[:_SAMPLE])
    if utf16 and len(data) > 4:
        data = data[: len(data) // 2 * 2]  # a byte that is left over is half a character
    for encoding in [utf16] if utf16 else ["utf-8-sig", "latin-1"]:
        try:
            return data.decode(encoding)
        except UnicodeDecodeError:
            continue
    return None


def _unmarked_utf16(sample: bytes) -> str:
    """Encoding of UTF-16 that lost its mark: its text is Latin for the most part, so that every second byte is 0."""
    share = 0.8 * (len(sample) // 2)
    if len(sample) < 4:
        return ""
    return "utf-16-le" if sample[1::2].count(0) >= share else "utf-16-be" if sample[::2].count(0) >= share else ""


def _quote(text: str) -> str:
    return repr(text if len(text) <= 40 else text[:40] + "…")
