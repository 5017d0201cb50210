"""Axes of a contact sheet, such as ``stock=vision3_500t_5219,velvia_50`` or ``stop=1.4,2.8``, checked before any rendering."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from render.errors import NotFoundError, SettingsError
from render.film.settings import PUSHES
from render.film.stock import library_stock
from render.optics.photometry.exposure import MAX_COMPENSATION_STOPS
from render.shot.lens.lens_choice import LensChoice, choose_lens

MAX_PICTURES = 64
"""Most pictures of one sheet: more are too small to compare, and take too long."""

Value = str | float | LensChoice


@dataclass(frozen=True)
class Choice:
    """One value that is compared.

    Attributes:
        label: text under the picture.
        value: a stock's name, a number, or a lens.
    """

    label: str
    value: Value


@dataclass(frozen=True)
class Axis:
    """The values that differ from one column, or row, to the next.

    Attributes:
        name: one of `AXES`.
        choices: two or more, or one for a label alone.
    """

    name: str
    choices: tuple[Choice, ...]


def parse_axes(typed: list[str]) -> tuple[Axis, ...]:
    """Parse one axis, or columns and rows.

    Args:
        typed: such as ``stop=2,4,8``.

    Raises:
        SettingsError: an axis cannot be read or names an unknown value; there are too many axes, two equal ones, or too many
                pictures.
        InputError: a lens file holds no lens.
    """
    axes = tuple(_parse_axis(text) for text in typed)
    if not 1 <= len(axes) <= 2:
        raise SettingsError(f"a contact sheet compares one or two things, got {len(axes)}")
    if len({axis.name for axis in axes}) < len(axes):
        raise SettingsError(f"a contact sheet compares {axes[0].name} with another thing than itself")
    count = math.prod(len(axis.choices) for axis in axes)
    if count > MAX_PICTURES:
        raise SettingsError(f"a contact sheet has {MAX_PICTURES} pictures at most, {count} are asked for")
    return axes


def _parse_axis(text: str) -> Axis:
    name, equals, values = text.partition("=")
    name = name.strip()
    if name not in AXES or not equals:
        raise SettingsError(f"a contact sheet takes {', '.join(AXES)}, such as stop=2,4,8; got {text!r}")
    words = [word.strip() for word in values.split(",") if word.strip()]
    if not words:
        raise SettingsError(f"a contact sheet of {name} needs what to compare, such as {name}={EXAMPLES[name]}")
    choices = tuple(AXES[name](word) for word in words)
    same = [word if isinstance(own.value, LensChoice) else own.value for word, own in zip(words, choices, strict=True)]
    if len(set(same)) < len(same):
        raise SettingsError(f"a contact sheet shows each {name} once, got {values}")
    return Axis(name, choices)


def _parse_stock(word: str) -> Choice:
    entry = library_stock(word)
    if entry.kind != "camera":
        raise SettingsError(f"{entry.name} is a print stock, expected one for the camera", code="unknown_stock")
    return Choice(entry.title, entry.name)


def _parse_lens(word: str) -> Choice:
    try:
        lens = choose_lens(word)
        return Choice(lens.name or word, lens)
    except NotFoundError as error:
        raise SettingsError(error.detail, code=error.code, path=error.path) from error


def _parse_number(name: str, word: str, low: float, high: float) -> float:
    try:
        number = float(word)
    except ValueError:
        number = math.nan
    if not low <= number <= high:
        raise SettingsError(f"a contact sheet's {name} is a number from {low:g} to {high:g}, got {word!r}")
    return number


def _parse_stop(word: str) -> Choice:
    number = _parse_number("stop", word.lower().removeprefix("f/"), 0.1, 1000.0)
    return Choice(f"f/{number:g}", number)


def _parse_push(word: str) -> Choice:
    number = _parse_number("push", word, PUSHES.least, PUSHES.most)
    if number == 0:
        return Choice("developed as usual", number)
    return Choice(f"{'pushed' if number > 0 else 'pulled'} {_in_stops(abs(number))}", number)


def _parse_exposure(word: str) -> Choice:
    number = _parse_number("exposure", word, -MAX_COMPENSATION_STOPS, MAX_COMPENSATION_STOPS)
    if number == 0:
        return Choice("as it is exposed", number)
    return Choice(f"{_in_stops(abs(number))} {'over' if number > 0 else 'under'}", number)


def _in_stops(number: float) -> str:
    return f"{number:g} stop{'' if number == 1 else 's'}"


def _parse_frame(word: str) -> Choice:
    number = _parse_number("frame", word, -1e9, 1e9)
    return Choice(f"frame {number:g}", number)


AXES: dict[str, Callable[[str], Choice]] = {
    "stock": _parse_stock,
    "stop": _parse_stop,
    "lens": _parse_lens,
    "push": _parse_push,
    "exposure": _parse_exposure,
    "frame": _parse_frame,
}
EXAMPLES = {
    "stock": "vision3_500t_5219,velvia_50",
    "stop": "1.4,2.8,5.6",
    "lens": "planar_50,swirly_58",
    "push": "-1,0,1",
    "exposure": "-1,0,1",
    "frame": "1,24,48",
}
