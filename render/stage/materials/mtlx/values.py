"""Values of MaterialX, as the documents write them."""

from __future__ import annotations

import math
import re

from render.stage.materials.mtlx.network import Input

_MOST = 1e15
"""Numbers beyond it are no colours or weights; products of two of them are kept in single precision."""
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")

WIDTHS = {
    "float": 1,
    "integer": 1,
    "boolean": 1,
    "vector2": 2,
    "vector3": 3,
    "color3": 3,
    "vector4": 4,
    "color4": 4,
    "matrix33": 9,
    "matrix44": 16,
}
"""Numbers of a value, by its type."""


def parse_numbers(text: str) -> tuple[float, ...]:
    """Numbers of a value; none where some are too large or there are other words."""
    if text in ("true", "false"):
        return (float(text == "true"),)
    parts = [part for part in re.split(r"[\s,]+", text.strip()) if part] if len(text) <= 1_000 else [""]
    if not all(_NUMBER.fullmatch(part) for part in parts):
        return ()
    values = tuple(float(part) for part in parts)
    return values if all(math.isfinite(value) and abs(value) <= _MOST for value in values) else ()


def numbers_of(given: Input | None) -> tuple[float, ...]:
    """Numbers of an input's value; none where it has none, or no finite ones."""
    return parse_numbers(given.value) if given is not None and given.value is not None else ()


def color_of(numbers: tuple[float, ...]) -> tuple[float, float, float]:
    """Colour of a fallback's numbers: one of them is grey, and black stands for what is lacking."""
    red, green, blue = (numbers * 3 if len(numbers) == 1 else (*numbers, 0.0, 0.0, 0.0))[:3]
    return red, green, blue
