"""Reduction of MaterialX's `mix`, `dot` and `convert` nodes of surfaces to surfaces that are drawn, and mixes of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from render.stage.materials.mtlx.arithmetic import component, constant, held
from render.stage.materials.mtlx.lobes import reduce_surface
from render.stage.materials.mtlx.network import Input, Link, Network, NetworkError, Node
from render.stage.materials.mtlx.surfaces import MIXED, SURFACES
from render.stage.materials.mtlx.values import WIDTHS

MOST_MIXED = 8
"""Surfaces that one material mixes: each is evaluated for each fragment."""


@dataclass(frozen=True)
class DrawnNetwork:
    """Network whose surface is drawn.

    Attributes:
        network: its surface is of `SURFACES`; a `MIXED` one has further ones in ``bg`` and ``fg``.
        left_out: what is not drawn, for messages.
    """

    network: Network
    left_out: tuple[str, ...]


def drawn_network(network: Network) -> DrawnNetwork:
    """Replace the surface of a network by one of those that are drawn, or by a mix of them.

    Raises:
        NetworkError: none of its surfaces is drawn, or it mixes too many.
    """
    list(network.nodes())  # refuses circles
    reader = _Reader(network)
    surface = reader.surface(network.surface)
    return DrawnNetwork(replace(network, surface=surface), tuple(dict.fromkeys(reader.left_out)))


def mixed_surfaces(surface: Node) -> Iterator[Node]:
    """Yield a surface that is drawn and all that it mixes, each once, the sides of a mix before it."""
    seen: dict[int, Node] = {}

    def visit(node: Node) -> None:
        if id(node) not in seen:
            for each in sides_of(node):
                visit(each)
            seen[id(node)] = node

    visit(surface)
    yield from seen.values()


def single_surfaces(surface: Node) -> list[Node]:
    """Those of `mixed_surfaces` that are no mixes themselves."""
    return [node for node in mixed_surfaces(surface) if node.category != MIXED]


def sides_of(mixed: Node) -> tuple[Node, ...]:
    """``bg`` and ``fg`` of a mix; none of another surface."""
    if mixed.category != MIXED:
        return ()
    return tuple(given.source.node for name in ("bg", "fg") if (given := mixed.inputs[name]).source is not None)


def share_of(mixed: Node) -> float | None:
    """Share of ``fg`` in a mix, 0 to 1; None where a node gives it."""
    numbers = held(mixed.inputs["share"])
    return None if numbers is None else min(max(numbers[0], 0.0), 1.0)


@dataclass(eq=False)
class _Reader:
    network: Network
    left_out: list[str] = field(default_factory=list)
    _read: dict[int, Node] = field(default_factory=dict)
    _singles: set[int] = field(default_factory=set)
    _mixes: int = 0

    def surface(self, node: Node) -> Node:
        """Surface that is drawn for a node."""
        while _makes_surface(node, "dot"):
            given = node.inputs.get("in")
            if given is None or given.source is None:
                raise NetworkError(f"{node.name or 'a dot'} has no surface")
            node = given.source.node
        if id(node) not in self._read:
            found = self._read[id(node)] = self._surface(node)
            if found.category != MIXED:
                self._singles.add(id(found))
            if len(self._singles) > MOST_MIXED:
                raise NetworkError(f"it mixes more than {MOST_MIXED} surfaces")
        return self._read[id(node)]

    def _surface(self, node: Node) -> Node:
        if _makes_surface(node, "mix"):
            return self._mix(node)
        if _makes_surface(node, "convert"):
            return self._glow(node)
        if node.category not in SURFACES or node.category == MIXED:
            names = ", ".join(name for name in SURFACES if name != MIXED)
            raise NetworkError(f"its surface is a {node.category[:60]}; {names} and mixes of them are drawn")
        if node.category != "surface":
            return node
        reduced = reduce_surface(replace(self.network, surface=node))
        self.left_out += reduced.left_out
        return reduced.network.surface

    def _mix(self, node: Node) -> Node:
        self._mixes += 1  # before it goes deeper
        if self._mixes > 2 * MOST_MIXED:
            raise NetworkError(f"it has more than {2 * MOST_MIXED} mixes of surfaces")
        given = {name: node.inputs[name].source for name in ("bg", "fg") if name in node.inputs}
        links = {name: source for name, source in given.items() if source is not None}
        share = node.inputs.get("mix", Input("float", "0"))
        if not links:
            raise NetworkError(f"{node.name or 'a mix'} mixes no surfaces")
        if len(links) == 1:
            ((name, link),) = links.items()
            self.left_out.append(f"the {'fg' if name == 'bg' else 'bg'} of {node.name or 'mix'}, which nothing feeds,")
            return self.surface(link.node)
        numbers = held(share)
        if numbers is not None and len(numbers) != 1:
            self.left_out.append(f"the share {(share.value or '')[:40]!r} of {node.name or 'mix'}, which is no number,")
            numbers = (0.0,)
        if numbers is not None and not 0 < numbers[0] < 1:
            return self.surface(links["fg" if numbers[0] >= 1 else "bg"].node)
        sides = {name: self.surface(link.node) for name, link in links.items()}
        if sides["bg"] is sides["fg"]:
            return sides["bg"]
        inputs = {name: Input("float", source=Link(side)) for name, side in sides.items()}
        return Node(MIXED, "float", inputs | {"share": share}, name=node.name)

    def _glow(self, node: Node) -> Node:
        """Surface that emits what a `convert` node is given; a fourth number is its opacity."""
        color, inputs = node.inputs.get("in", constant(0.0, 0.0, 0.0)), {}
        numbers = held(color)
        if numbers is not None and len(numbers) != WIDTHS.get(color.type):
            self.left_out.append(
                f"the light {(color.value or '')[:40]!r} of {node.name or 'convert'}, which is no {color.type},"
            )
            color = constant(0.0, 0.0, 0.0)
        if color.type in ("color4", "vector4"):
            inputs["opacity"] = component(color, 3)
        if color.type != "color3":
            color = Input("color3", source=Link(Node("convert", "color3", {"in": color}, name=node.name)))
        return Node("surface_unlit", "surfaceshader", inputs | {"emission_color": color}, name=node.name)


def _makes_surface(node: Node, category: str) -> bool:
    return node.type == "surfaceshader" and node.category == category
