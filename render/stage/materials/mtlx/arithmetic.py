"""Arithmetic with inputs of nodes: of constants at once, of all else by further nodes of a network.

Numbers are of type ``float`` or ``color3``. None stands for nothing, black or zero.
"""

from __future__ import annotations

from collections.abc import Callable

from render.stage.materials.mtlx.network import Input, Link, Node
from render.stage.materials.mtlx.values import WIDTHS, numbers_of

_LINEAR = ("", "lin_rec709")


def constant(*numbers: float) -> Input:
    """Input of a number, or of the three of a colour."""
    return Input("color3" if len(numbers) == 3 else "float", ", ".join(f"{number:.9g}" for number in numbers))


def held(given: Input | None) -> tuple[float, ...] | None:
    """Numbers of a constant; None for what a node gives."""
    return None if given is None or given.source is not None else numbers_of(given)


def as_operand(given: Input) -> Input:
    """Input that can be computed with: a colour of another space than linear Rec. 709 becomes a node, which converts it."""
    if given.source is not None or given.color_space in _LINEAR or given.type not in ("color3", "color4"):
        return given
    return _of(Node("constant", given.type, {"value": given}))


def same(a: Input | None, b: Input | None) -> bool:
    """Whether two inputs are fed by the same output, or are the same constant."""
    if a is None or b is None:
        return a is b
    if a.source is not None and b.source is not None:
        return a.source.node is b.source.node and a.source.output == b.source.output
    return a.source is b.source and a.type == b.type and numbers_of(a) == numbers_of(b)


def add(a: Input | None, b: Input | None) -> Input | None:
    """Sum."""
    if a is None or b is None:
        return a if b is None else b
    return _combine("add", a, b, lambda x, y: x + y)


def multiply(a: Input | None, b: Input | None) -> Input | None:
    """Product."""
    if a is None or b is None:
        return None
    for one, other in ((a, b), (b, a)):
        numbers = held(one)
        if numbers is not None and not any(numbers):
            return None
        if numbers is not None and all(number == 1 for number in numbers) and _is_as_wide(other, one):
            return other
    return _combine("multiply", a, b, lambda x, y: x * y)


def divide(a: Input, b: Input) -> Input:
    """Quotient; ``b`` is no wider than ``a``, and not 0."""
    return _combine("divide", a, b, lambda x, y: x / y if y else 0.0)


def complement(a: Input | None) -> Input | None:
    """1 - a."""
    return constant(1.0) if a is None else add(multiply(a, constant(-1.0)) or constant(0.0), constant(1.0))


def at_most_one(a: Input | None) -> Input | None:
    """The lesser of a number and 1."""
    return None if a is None else _combine("min", a, constant(1.0), min)


def power(a: Input, exponent: float) -> Input:
    """Power of what is not negative."""
    return _combine("power", a, constant(exponent), lambda x, y: max(x, 0.0) ** y)


def component(a: Input, index: int) -> Input:
    """Number of a vector or colour."""
    numbers = held(a)
    if numbers is not None:
        return constant(numbers[index])
    return _of(Node("extract", "float", {"in": a, "index": Input("integer", str(index))}))


def mean(a: Input | None) -> Input | None:
    """Mean of a colour's numbers; a number as it is."""
    if a is None or a.type == "float":
        return a
    total = add(add(component(a, 0), component(a, 1)), component(a, 2))
    return multiply(total, constant(1 / 3))


def reflectance(ior: Input, extinction: Input | None = None) -> Input:
    """Reflectance at normal incidence of a refractive index, and of an extinction where it is a metal."""
    absorbed = multiply(extinction, extinction)
    less, more = add(ior, constant(-1.0)), add(ior, constant(1.0))
    assert less is not None
    assert more is not None
    above = add(multiply(less, less), absorbed) or constant(0.0)
    below = add(multiply(more, more), absorbed) or constant(1.0)
    return divide(above, below)


def _combine(category: str, a: Input, b: Input, compute: Callable[[float, float], float]) -> Input:
    a, b = as_operand(a), as_operand(b)
    if WIDTHS[b.type] > WIDTHS[a.type] and category in ("add", "multiply"):
        a, b = b, a
    x, y = held(a), held(b)
    if x is not None and y is not None:
        width = max(len(x), len(y))
        pairs = zip(x * (width // len(x)), y * (width // len(y)), strict=True)
        return constant(*(min(max(compute(*pair), -1e15), 1e15) for pair in pairs))
    return _of(Node(category, a.type, {"in1": a, "in2": b}))


def _is_as_wide(a: Input, b: Input) -> bool:
    return WIDTHS[a.type] >= WIDTHS[b.type]


def _of(node: Node) -> Input:
    return Input(node.type, source=Link(node))
