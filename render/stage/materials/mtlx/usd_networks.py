"""Networks of MaterialX nodes that are written as shaders of USD (``info:id`` ``ND_image_color3`` and the like)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pxr import Sdf, Usd, UsdShade

from render.stage.geometry.primvars import as_rows
from render.stage.materials.mtlx.library import library
from render.stage.materials.mtlx.network import MOST_DEPTH, MOST_NODES, Input, Link, Network, NetworkError, Node
from render.stage.materials.mtlx.surfaces import SURFACES


@dataclass(frozen=True, eq=False)
class FoundNetwork:
    """Network, and whether any of its values may change over time."""

    network: Network
    varies: bool


def surface_network(shader: UsdShade.Shader, time: Usd.TimeCode) -> FoundNetwork | None:
    """The network of a surface shader at a time; None where the library has no such node.

    Raises:
        NetworkError: its nodes have no end, or there are too many.
    """
    identifier = str(shader.GetIdAttr().Get() or "")
    if library().document.getNodeDef(identifier) is None:
        return None
    reader = _Reader(time)
    surface = reader.node(shader)
    return FoundNetwork(Network(surface), reader.varies)


def displacement_node(shader: UsdShade.Shader, time: Usd.TimeCode) -> tuple[Node, bool]:
    """Node of a displacement shader at a time, and whether any of its values may change.

    Raises:
        NetworkError: its nodes have no end, or there are too many.
    """
    reader = _Reader(time)
    return reader.node(shader), reader.varies


class _Reader:
    def __init__(self, time: Usd.TimeCode) -> None:
        self._time = time
        self._nodes: dict[str, Node] = {}
        self._depth = 0
        self.varies = False

    def node(self, shader: UsdShade.Shader) -> Node:
        path = str(shader.GetPath())
        if path in self._nodes:
            return self._nodes[path]
        if len(self._nodes) > MOST_NODES or self._depth > MOST_DEPTH:
            raise NetworkError(
                f"it has more than {MOST_NODES:,} nodes, or {MOST_DEPTH} behind each other, or a circle of them"
            )
        identifier = str(shader.GetIdAttr().Get() or "")
        definition = library().document.getNodeDef(identifier)
        category = definition.getNodeString() if definition is not None else ""
        kind = definition.getType() if definition is not None else ""
        is_surface = category in SURFACES
        node = Node(
            category or identifier, kind, definition="" if is_surface else identifier, name=shader.GetPath().name
        )
        self._depth += 1
        for each in shader.GetInputs():
            theirs = definition.getActiveInput(each.GetBaseName()) if definition is not None else None
            found = self._input(each, theirs.getType() if theirs is not None else "")
            if found is not None:
                node.inputs[each.GetBaseName()] = found
        self._depth -= 1
        self._nodes[path] = node
        return node

    def _input(self, given: UsdShade.Input, kind: str) -> Input | None:
        for attribute in given.GetValueProducingAttributes():
            if UsdShade.Output.IsOutput(attribute):
                shader = UsdShade.Shader(attribute.GetPrim())
                output = UsdShade.Output(attribute).GetBaseName()
                return (
                    Input(kind, source=Link(self.node(shader), "" if output == "out" else output)) if shader else None
                )
            if attribute.HasAuthoredValue():
                self.varies = self.varies or attribute.ValueMightBeTimeVarying()
                value = attribute.Get(self._time)
                space = str(attribute.GetColorSpace()) if attribute.HasColorSpace() else ""
                if isinstance(value, Sdf.AssetPath):
                    name, tiles = str(value.resolvedPath or value.path), _tiles(attribute, value.path)
                    return Input("filename", name, color_space=space, tiles=tiles)
                text = _text(value)
                return Input(kind, text, color_space=space) if text is not None else None
        return None


def _tiles(attribute: Usd.Attribute, name: str) -> tuple[tuple[int, str], ...]:
    """Numbers and paths of the tiles of a UDIM set, beside the layer that names it; none for a single image."""
    if not UsdShade.UdimUtils.IsUdimIdentifier(name):
        return ()
    for spec in attribute.GetPropertyStack(Usd.TimeCode.EarliestTime()):
        tiles = UsdShade.UdimUtils.ResolveUdimTilePaths(name, spec.layer)
        if tiles:
            return tuple((int(number), str(path)) for path, number in tiles)
    return ()


def _text(value: object) -> str | None:
    """Value as MaterialX writes it, or None for one that it has no type for."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    if hasattr(value, "GetRow"):  # a matrix
        return ", ".join(f"{number:.9g}" for number in np.array(value).ravel())
    width = 1 if isinstance(value, int | float) else _width(value)
    rows = as_rows([value] if isinstance(value, int | float) else value, width)
    return ", ".join(f"{number:.9g}" for number in rows[0]) if rows is not None and len(rows) == 1 else None


def _width(value: object) -> int:
    try:
        return len(value)  # type: ignore[arg-type]
    except TypeError:
        return 1
