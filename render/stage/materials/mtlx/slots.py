"""Places of the primvars of a network among the numbers of vertices.

A vertex has one pair of texture coordinates, one colour and one number of its own (the display colour's and its opacity's), and
`VALUES_WIDTH` further numbers, which hold what else a network reads. The place in the prim's own space stands where the colour
and the number are otherwise.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from render.model.scene import VALUES_WIDTH

_WIDTHS = {"uv": 2, "color": 3, "vector": 3, "number": 1}
_OWN = {"uv": "uv", "color": "color", "vector": "color", "number": "number"}
"""Kind of the place of its own that a vertex has for a kind."""
NOWHERE = -2
DISPLAY_COLOR, COORDINATES = "displayColor", "st"


@dataclass(frozen=True)
class GeometryUse:
    """Value of the geometry that a network reads.

    Attributes:
        kind: ``uv``, ``color``, ``vector``, ``number`` or ``place``.
        primvar: name of the primvar; empty for a place.
        fallback: where the geometry has none; empty for what the kind has by itself.
        at: first of its numbers among the further ones; -1 for the place of its own, `NOWHERE` where there is no more room.
    """

    kind: str
    primvar: str = ""
    fallback: tuple[float, ...] = ()
    at: int = -1

    @property
    def numbers(self) -> tuple[float, ...]:
        """Its fallback, as many numbers as it has."""
        width = _WIDTHS[self.kind]
        plain = 0.5 if self.primvar == DISPLAY_COLOR else 0.0
        if len(self.fallback) == 1:
            return self.fallback * width
        return (*self.fallback, *(plain,) * width)[:width]


def place_uses(uses: Iterable[GeometryUse]) -> list[GeometryUse]:
    """Give each use its place; equal primvars of one kind share theirs.

    Args:
        uses: in the order in which they are placed, but that display colours and plain texture coordinates come first.
    """
    given = list(uses)
    taken = {"color", "number"} if any(use.kind == "place" for use in given) else set()
    found: dict[tuple[str, str], int] = {}
    first = 0
    for use in sorted(given, key=lambda use: use.primvar not in (DISPLAY_COLOR, COORDINATES)):
        key = use.kind, use.primvar
        if use.kind == "place" or key in found:
            continue
        if _OWN[use.kind] not in taken:
            taken.add(_OWN[use.kind])
            found[key] = -1
        elif first + _WIDTHS[use.kind] <= VALUES_WIDTH:
            found[key] = first
            first += _WIDTHS[use.kind]
        else:
            found[key] = NOWHERE
    return [use if use.kind == "place" else replace(use, at=found[use.kind, use.primvar]) for use in given]


def expression_of(use: GeometryUse, glsl: str) -> str:
    """GLSL that gives the value of a placed use, of a type."""
    if use.at == NOWHERE:
        numbers = [f"{float(number):.9g}" for number in use.numbers]
        numbers = [number if set(number) & set(".e") else f"{number}.0" for number in numbers]
        value = numbers[0] if len(numbers) == 1 else f"vec{len(numbers)}({', '.join(numbers)})"
    elif use.at >= 0:
        reader = {"uv": "value_pair", "color": "graph_value_color", "vector": "value_color", "number": "value_at"}
        value = f"{reader[use.kind]}({use.at})"
    else:
        value = {"uv": "graph_uv", "number": "graph_color.a"}.get(use.kind, "graph_color.xyz")
        if glsl == "vec4" and value == "graph_color.xyz":
            return "graph_color"
    width, needed = _WIDTHS[use.kind], int(glsl[-1]) if glsl.startswith("vec") else 1
    if needed < width:
        value = f"{value}.{'xyzw'[:needed]}"
    elif needed > width:
        value = f"vec{needed}({value}{', 0.0' * (needed - width - (needed == 4))}{', 1.0' if needed == 4 else ''})"
    return value if glsl.startswith("vec") else f"{glsl}({value})"
