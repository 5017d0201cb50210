"""UDIM sets in networks of MaterialX: tiles side by side in one image, since the library's functions read single images."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pxr import UsdShade

from render.model.scene import Image
from render.model.udim import FIRST_TILE, TILES_A_ROW
from render.stage.materials.mtlx.documents import file_in
from render.stage.materials.mtlx.network import Input, Link, Network, Node
from render.stage.materials.mtlx.values import color_of
from render.stage.materials.textures import downsample

TOKEN = "<UDIM>"
MOST_SIDE_PX = 8192
MOST_PIXELS = 2**25
_COORDINATES = {"image": "texcoord", "UsdUVTexture": "st"}
"""Inputs for texture coordinates of the nodes that may read sets, by category."""


@dataclass(frozen=True, eq=False)
class TileGrid:
    """Tiles side by side.

    Attributes:
        image: the tiles; where there is none, the set's fallback.
        first: column and row of the tile at the lower left, from 0.
        size: number of columns and rows.
    """

    image: Image
    first: tuple[int, int]
    size: tuple[int, int]


def tile_files(given: Input) -> dict[int, str]:
    """Paths of the tiles of a set by their numbers: of the files that are there."""
    if given.tiles:
        return dict(given.tiles)
    found = UsdShade.UdimUtils.ResolveUdimTilePaths(file_in(given.folder, given.value or ""), None)
    return {int(number): str(path) for path, number in found}


def grid_of(tiles: Image, fallback: tuple[float, ...]) -> TileGrid:
    """Put the tiles of a set side by side, averaged down where the whole would be too large.

    Args:
        tiles: the set.
        fallback: colour where there is no tile; black where it is empty.
    """
    numbers = np.array(tiles.tiles) - FIRST_TILE
    columns, rows = numbers % TILES_A_ROW, numbers // TILES_A_ROW
    first = int(columns.min()), int(rows.min())
    size = int(np.ptp(columns)) + 1, int(np.ptp(rows)) + 1
    height, width = tiles.pixels.shape[1:3]
    step = max(1, -(-width * size[0] // MOST_SIDE_PX), -(-height * size[1] // MOST_SIDE_PX))
    step = max(step, int(np.ceil(np.sqrt(width * size[0] * height * size[1] / MOST_PIXELS))))
    height, width = -(-height // step), -(-width // step)
    whole = np.empty((height * size[1], width * size[0], 4), np.float16)
    whole[:] = np.array([*color_of(fallback), 1], np.float16)
    for pixels, column, row in zip(tiles.pixels, columns, rows, strict=True):
        left, top = (column - first[0]) * width, (size[1] - 1 - (row - first[1])) * height
        whole[top : top + height, left : left + width] = downsample(pixels.astype(np.float32), step)
    return TileGrid(Image(whole, tiles.name, tiles.channels), first, size)


def spread_coordinates(network: Network, grid: Callable[[Node, Input], TileGrid | None]) -> dict[int, Image]:
    """Make the nodes of a network that read sets read grids of tiles in their place.

    Args:
        network: it, which is changed.
        grid: the grid of a set, by the node and its input; None where it cannot be read.

    Returns:
        Images of the grids, by the identity of the inputs that name them.
    """
    images = {}
    for node in list(network.nodes()):
        given = node.inputs.get("file")
        key = _COORDINATES.get(node.category)
        found = grid(node, given) if given is not None and key and TOKEN in (given.value or "") else None
        if given is None or key is None or found is None:
            continue
        plain = Link(Node("texcoord", "vector2", name=f"{node.name} coordinates"))
        own = node.inputs.get(key, Input("vector2", source=plain))
        moved = Node("subtract", "vector2", {"in1": own, "in2": _pair(found.first)}, name=f"{node.name} place")
        scaled = Node("divide", "vector2", {"in1": Input("vector2", source=Link(moved)), "in2": _pair(found.size)})
        node.inputs |= {
            key: Input("vector2", source=Link(scaled)),
            "uaddressmode": Input("string", "clamp"),
            "vaddressmode": Input("string", "clamp"),
        }
        images[id(given)] = found.image
    return images


def _pair(values: tuple[int, int]) -> Input:
    return Input("vector2", f"{values[0]}, {values[1]}")
