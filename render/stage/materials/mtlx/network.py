"""Networks of MaterialX nodes that lead to one surface, whatever they were read from."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

MOST_NODES = 1_000
"""Nodes of one network."""
MOST_DEPTH = 200
"""Nodes from a surface to what feeds it, one behind the other."""
MOST_WEIGHT = 2_000
"""Weight of all nodes that a network stands for, as `node_weight` has it: they are compiled one by one."""
OWN = "mtlxdoc_"
"""Prefix of what definitions of a document declare, so that it meets no name of our shaders."""
_HEAVY = re.compile(r".*(noise|fractal|worley|hextiled|triplanar|blur|flake|heighttonormal|curve).*")
IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def node_weight(category: str) -> int:
    """Weight of a node of the library: of code that loops or looks up many times, twenty plain ones."""
    return 20 if _HEAVY.fullmatch(category) else 1


class NetworkError(ValueError):
    """Network that cannot be read; the message gives the reason."""


@dataclass(frozen=True, eq=False)
class Link:
    """Output of a node.

    Attributes:
        node: whose.
        output: its name, or an empty string for the only one.
    """

    node: Node
    output: str = ""


@dataclass(frozen=True, eq=False)
class Input:
    """Input of a node.

    Attributes:
        type: MaterialX's name of its type, such as ``color3``, or an empty string where it is not said.
        value: as MaterialX writes it, or None where a node feeds it.
        source: the output that feeds it, or None.
        color_space: that of a colour or of an image file, or an empty string.
        folder: for a file, the folder that its name counts from.
        tiles: numbers and paths of a UDIM set's tiles, where they are known.
    """

    type: str
    value: str | None = None
    source: Link | None = None
    color_space: str = ""
    folder: str = ""
    tiles: tuple[tuple[int, str], ...] = ()


@dataclass(eq=False)
class Node:
    """Node of a network.

    Attributes:
        category: kind of node, such as ``image``, or an empty string where ``definition`` tells it.
        type: type of its output, or an empty string where it is not said.
        inputs: by name.
        definition: name of its nodedef, or an empty string.
        namespace: of its definition, or an empty string.
        name: in its document, for messages.
    """

    category: str
    type: str
    inputs: dict[str, Input] = field(default_factory=dict)
    definition: str = ""
    namespace: str = ""
    name: str = ""


@dataclass(frozen=True, eq=False)
class Network:
    """Surface and what feeds it.

    Attributes:
        surface: the shader, such as a ``standard_surface``.
        definitions: MaterialX documents that define nodes of its own.
        version: of MaterialX that it was written for.
        folder: of the files that ``definitions`` name.
        weights: of the nodes that ``definitions`` define, by category. Their inputs and outputs have the prefix `OWN`.
        displacement: node of the material's displacement, or None.
        notes: what of it could not be read, for messages.
    """

    surface: Node
    definitions: tuple[str, ...] = ()
    version: str = "1.39"
    folder: str = ""
    weights: Mapping[str, float] = field(default_factory=dict)
    displacement: Node | None = None
    notes: tuple[str, ...] = ()

    def nodes(self) -> Iterator[Node]:
        """Nodes that feed the surface, each once, before those that it feeds; the surface is the last.

        Raises:
            NetworkError: there are too many, or they feed each other in a circle.
        """
        done: set[int] = set()
        waiting: list[tuple[Node, bool]] = [(self.surface, False)]
        above: set[int] = set()
        while waiting:
            node, is_left = waiting.pop()
            if is_left:
                above.discard(id(node))
                done.add(id(node))
                yield node
            elif id(node) not in done:
                if id(node) in above:
                    raise NetworkError("its nodes feed each other in a circle")
                above.add(id(node))
                if len(above) > MOST_DEPTH or len(done) > MOST_NODES:
                    raise NetworkError(f"it has more than {MOST_NODES:,} nodes, or {MOST_DEPTH} behind each other")
                waiting.append((node, True))
                waiting += [(each.source.node, False) for each in node.inputs.values() if each.source is not None]
