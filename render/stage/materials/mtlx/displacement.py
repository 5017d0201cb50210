"""Displacement by MaterialX: of a constant, a primvar, or a channel of an image, times and plus constants."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from render.model.scene import Image, TextureLookup, Wrap
from render.stage.geometry.displacement import Displacement
from render.stage.materials.mtlx.network import Input, NetworkError, Node
from render.stage.materials.mtlx.opacity import is_used
from render.stage.materials.mtlx.values import numbers_of

WRAPS: dict[str, Wrap] = {"constant": "black", "clamp": "clamp", "periodic": "repeat", "mirror": "mirror"}
"""Wraps of images, by MaterialX's names."""
_CHANNELS = {"outr": 0, "outx": 0, "outg": 1, "outy": 1, "outb": 2, "outz": 2, "outa": 3, "outw": 3}
_MOST_STEPS = 200
"""Inputs that are followed to a height."""


_Numbers = tuple[float, ...]
"""A number for each channel, or one for all of them."""


@dataclass(frozen=True)
class _Height:
    """Factor times what a node gives, plus an offset; the offset alone where there is no node.

    The channel is the node's, None while its numbers are those of all channels.
    """

    factor: _Numbers
    offset: _Numbers
    node: Node | None = None
    channel: int | None = None

    def of_channel(self, index: int) -> _Height:
        """The height of a channel."""
        if not 0 <= index <= 3 or any(1 < len(part) <= index for part in (self.factor, self.offset)):
            raise NetworkError("its height is of a channel that there is not")
        factor, offset = (part[index : index + 1] if len(part) > 1 else part for part in (self.factor, self.offset))
        return _Height(factor, offset, self.node, index if self.channel is None else self.channel)

    def scaled(self, factor: _Numbers, offset: _Numbers) -> _Height:
        """The height times a factor plus an offset."""
        own = _each(lambda one, by, more: one * by + more, self.offset, factor, offset)
        return replace(self, factor=_each(lambda one, by: one * by, self.factor, factor), offset=own)


def _each(function: Callable[..., float], *parts: _Numbers) -> _Numbers:
    """Results of a function of numbers, channel by channel."""
    width = max(map(len, parts))
    if any(len(part) not in (1, width) for part in parts):
        raise NetworkError("its height joins values with different numbers of channels")
    return tuple(function(*values) for values in zip(*(part * (width // len(part)) for part in parts), strict=True))


def read_displacement(node: Node, image_of: Callable[[Node, Input], Image | None], *, varies: bool) -> Displacement:
    """Read a ``displacement`` node.

    Args:
        node: it.
        image_of: the image that a node reads, by the node and its input; None where it cannot be read.
        varies: whether any of its values may change over time.

    Raises:
        NetworkError: its height is no such one.
    """
    height = node.inputs.get("displacement")
    if node.category != "displacement" or (height is not None and height.type == "vector3"):
        raise NetworkError(f"it is by a {(node.category or 'node that does not exist')[:60]} that is no height")
    scale = _value(node, "scale", 1.0)
    found = _height(height, _Steps()).scaled((scale,), (0.0,))
    if any(len(set(part)) > 1 for part in (found.factor, found.offset)):
        raise NetworkError("the channels of its height differ, and none of them is chosen")
    found = found.of_channel(0)
    (factor,), (offset,) = found.factor, found.offset
    if found.node is None or not factor:
        return Displacement(offset, varies=varies)
    if found.node.category == "geompropvalue":
        name = found.node.inputs.get("geomprop")
        if (factor, offset) != (1.0, 0.0) or name is None or not name.value:
            raise NetworkError("its primvar is scaled")
        return Displacement(_value(found.node, "default", 0.0), name.value, varies=varies)
    fallback = numbers_of(found.node.inputs.get("default")) or (0.0,)
    channel = found.channel or 0
    amount = factor * fallback[min(channel, len(fallback) - 1)] + offset
    lookup, coordinates = _lookup(found.node, channel, factor, offset, amount, image_of)
    return Displacement(amount, coordinates if lookup is not None else None, lookup, varies)


@dataclass
class _Steps:
    count: int = 0

    def take(self) -> None:
        self.count += 1
        if self.count > _MOST_STEPS:
            raise NetworkError("its height is computed by too many nodes")


def _height(given: Input | None, steps: _Steps, default: float = 0.0) -> _Height:
    steps.take()
    if given is None or given.source is None:
        return _Height((0.0,), numbers_of(given) or (default,))
    node, output = given.source.node, given.source.output
    inputs = node.inputs
    if node.category in ("image", "tiledimage"):
        return _Height((1.0,), (0.0,), node, 0 if node.type == "float" else _CHANNELS.get(output))
    if node.category == "geompropvalue" and given.type in ("float", ""):
        return _Height((1.0,), (0.0,), node)
    if node.category in ("constant", "dot"):
        return _height(inputs.get("value" if node.category == "constant" else "in"), steps)
    if node.category.startswith("separate"):
        return _height(inputs.get("in"), steps).of_channel(_CHANNELS.get(output, 0))
    if node.category == "extract":
        return _height(inputs.get("in"), steps).of_channel(int(_value(node, "index", 0.0)))
    if node.category in ("multiply", "divide", "add", "subtract"):
        second = 1.0 if node.category in ("multiply", "divide") else 0.0
        sides = _height(inputs.get("in1"), steps), _height(inputs.get("in2"), steps, second)
        return _combined(node.category, *sides)
    if node.category == "remap":
        low, high = _values(node, "inlow", 0.0), _values(node, "inhigh", 1.0)
        first, last = _values(node, "outlow", 0.0), _values(node, "outhigh", 1.0)
        slope = _each(lambda a, b, y, z: (z - y) / (b - a) if b != a else 0.0, low, high, first, last)
        begin = _each(lambda y, by, a: y - by * a, first, slope, low)
        return _height(inputs.get("in"), steps).scaled(slope, begin)
    raise NetworkError(f"its height is computed by {(node.name or 'a node')[:60]}, a {node.category[:60]}")


def _combined(category: str, a: _Height, b: _Height) -> _Height:
    """Sum, product and the like, of which one side is a constant."""
    if category in ("add", "subtract"):
        b = b.scaled((-1.0,), (0.0,)) if category == "subtract" else b
        one, other = (a, b) if b.node is None else (b, a)
        if other.node is None:
            return one.scaled((1.0,), other.offset)
    elif b.node is None:
        by = b.offset if category == "multiply" else tuple(1 / part if part else 0.0 for part in b.offset)
        return a.scaled(by, (0.0,))
    elif a.node is None and category == "multiply":
        return b.scaled(a.offset, (0.0,))
    raise NetworkError("its height joins several that are no constants")


def _lookup(
    node: Node,
    channel: int,
    factor: float,
    offset: float,
    fallback: float,
    image_of: Callable[[Node, Input], Image | None],
) -> tuple[TextureLookup | None, str]:
    """Look-up of an image, and the primvar of its coordinates."""
    file = node.inputs.get("file")
    if file is None:
        raise NetworkError("its image is not named")
    tiling, shift = (1.0, 1.0), (0.0, 0.0)
    if node.category == "tiledimage":
        tiling, shift = _pair(node, "uvtiling", 1.0), _pair(node, "uvoffset", 0.0)
        if any(is_used(node.inputs.get(name), 1.0) for name in ("realworldimagesize", "realworldtilesize")):
            raise NetworkError("its image has a size in the world")
    coordinates = _coordinates(node)
    image = image_of(node, file)
    if image is None:
        return None, coordinates
    wraps = [
        WRAPS.get((node.inputs[name].value or "") if name in node.inputs else "", "repeat")
        for name in ("uaddressmode", "vaddressmode")
    ]
    lookup = TextureLookup(
        image=image,
        uv_transform=np.array([[tiling[0], 0, -shift[0]], [0, tiling[1], -shift[1]]], np.float32),
        scale=np.full(4, factor, np.float32),
        bias=np.full(4, offset, np.float32),
        wrap_s=wraps[0],
        wrap_t=wraps[1],
        channel=channel,
        fallback=np.full(4, fallback, np.float32),
    )
    return lookup, coordinates


def _coordinates(node: Node) -> str:
    given = node.inputs.get("texcoord")
    source = given.source.node if given is not None and given.source is not None else None
    if given is None or (
        source is not None and source.category == "texcoord" and not is_used(source.inputs.get("index"))
    ):
        return "st"
    name = source.inputs.get("geomprop") if source is not None and source.category == "geompropvalue" else None
    if name is None or not name.value:
        raise NetworkError("the texture coordinates of its image are computed")
    return name.value


def _value(node: Node, name: str, default: float) -> float:
    """A constant.

    Raises:
        NetworkError: it is none.
    """
    return _values(node, name, default)[0]


def _values(node: Node, name: str, default: float) -> _Numbers:
    """A constant, of one channel or several.

    Raises:
        NetworkError: it is none.
    """
    given = node.inputs.get(name)
    if given is not None and given.source is not None:
        raise NetworkError(f"{name} of {(node.name or node.category)[:60]} is no constant")
    return numbers_of(given) or (default,)


def _pair(node: Node, name: str, default: float) -> tuple[float, float]:
    first = _value(node, name, default)
    numbers = numbers_of(node.inputs.get(name))
    return (first, numbers[1]) if len(numbers) == 2 else (first, first)
