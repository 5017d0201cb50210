"""Plan of a picture that is traced tile by tile, so that the memory of its layers is bounded.

The layers of a whole picture are cut across their longer side into strips. Each strip is peeled once, by itself, whatever the
memory. A tile of the picture is traced through a window of the layers: the strips that its rays reach. Windows follow each other
along the picture, and what two of them share is kept. So the pixels do not depend on the windows: a window of all strips gives
the same picture, to the bit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.layers.limits import BLOCK_PX
from render.layers.nbuffers import BINS_ABOVE_NEAREST, nbuffer_bytes
from render.layers.targets import MAX_LAYER_PIXELS, REFLECTOR_BYTES_PER_PX, layer_bytes_per_px
from render.optics.view import PinholeView
from render.trace.lens_table import BOUND, PolynomialTable
from render.trace.picture_focus import PictureFocus
from render.trace.rays import RayBundle

_GROUP = 8  # px of the picture, the side of the tracer's work groups: tiles are multiples of it
_GUARD = 4.0  # layer pixels: rounding of positions, and the pixels that a footprint touches
_BETWEEN_GRID_POINTS = 1.1
"""Allowance for a bent focal surface, whose extremes are taken on a grid over the picture (`PictureFocus.over_picture`)."""


@dataclass(frozen=True)
class LayerBudget:
    """Memory of the layers of a picture.

    Attributes:
        bytes: memory of layers and N-buffers above which a picture is traced in tiles, and limit on that of a window and a strip
            together; exceeded where the rays of one tile reach farther.
        strip_bytes: memory of a strip.
    """

    bytes: int = 1 << 30
    strip_bytes: int = 1 << 27

    @classmethod
    def of_device(cls, memory_bytes: int) -> LayerBudget:
        """Give the budget on a device: an eighth of its memory, and no less than where that is not known.

        Args:
            memory_bytes: memory of the GPU; 0 where it is not known, and for a CPU rasteriser.
        """
        most = max(cls.bytes, memory_bytes // 8)
        return cls(most, most // 8)


@dataclass(frozen=True)
class Tile:
    """One part of the picture.

    Attributes:
        first: its first column (or row) in the picture.
        stop: one past its last.
        window: first column (or row) of its window in the whole picture's layers.
    """

    first: int
    stop: int
    window: int


@dataclass(frozen=True)
class TilePlan:
    """Tiles of a picture.

    Attributes:
        whole: view of the whole picture's layers.
        axis: axis along which they follow each other: 0 for columns, 1 for rows.
        strip: length of the strips along that axis, layer pixels; the last one may extend beyond the layers.
        window: length of the windows along that axis, layer pixels; the last one may extend beyond the layers.
        tiles: the tiles in order.
    """

    whole: PinholeView
    axis: int
    strip: int
    window: int
    tiles: tuple[Tile, ...]

    @property
    def window_size(self) -> tuple[int, int]:
        """Width and height of the windows, layer pixels."""
        return (self.window, self.whole.height) if self.axis == 0 else (self.whole.width, self.window)

    def area(self, tile: Tile, picture: PinholeView) -> tuple[int, int, int, int]:
        """Left, top, width and height of a tile in the picture."""
        length = tile.stop - tile.first
        if self.axis == 0:
            return tile.first, 0, length, picture.height
        return 0, tile.first, picture.width, length


def plan_tiles(
    picture: PinholeView,
    whole: PinholeView,
    reach_px: float,
    layers: int,
    budget: LayerBudget,
    most_side_px: int,
    *,
    lit: bool = False,
    ids: bool = False,
) -> TilePlan | None:
    """Plan the tiles of a picture; None where its layers fit the budget and the limits on layers.

    Args:
        picture: view of the picture.
        whole: view of the whole picture's layers.
        reach_px: `ray_reach_px`.
        layers: number of layers.
        budget: memory.
        most_side_px: limit of the device on the sides of textures.
        lit: whether surfaces are lit, for which strips hold `render.layers.targets.Reflectors` too.
        ids: whether layers hold ids.
    """
    axis = 0 if whole.width >= whole.height else 1
    length, across = whole.size[axis], whole.size[1 - axis]
    most_side_px = min(most_side_px, MAX_LAYER_PIXELS // across)
    if layers_bytes(*whole.size, layers, lit=lit, ids=ids) <= budget.bytes and length <= most_side_px:
        return None
    per_line = layers_bytes(1 << 14, across, layers, ids=ids) >> 14
    strip_line = per_line + across * REFLECTOR_BYTES_PER_PX * lit
    strip = min(length, max(BLOCK_PX, min(budget.strip_bytes // strip_line, most_side_px // 8) // BLOCK_PX * BLOCK_PX))
    unit = strip if strip < length else BLOCK_PX
    scale = whole.fx / picture.fx
    least = _multiple(int(np.ceil(2 * reach_px + _GROUP * scale + 2 * _GUARD)) + unit, unit)
    room = max(0, budget.bytes - strip * strip_line) // per_line // unit * unit
    window = min(_multiple(length, unit), max(least, min(room, most_side_px // unit * unit)))
    axis_px = (whole.cx - scale * picture.cx, whole.cy - scale * picture.cy)[axis]
    tiles: list[Tile] = []
    first, end = 0, picture.size[axis]
    while first < end:
        begin = max(0, int(np.floor(axis_px + scale * first - reach_px))) // unit * unit
        begin = min(begin, _multiple(length, unit) - window)
        seen = begin + window
        stop = end if seen >= length else int((seen - reach_px - axis_px) / scale) // _GROUP * _GROUP
        tiles.append(Tile(first, min(stop, end), begin))
        first = stop
    return TilePlan(whole, axis, strip, window, tuple(tiles))


def layers_bytes(width: int, height: int, layers: int, *, lit: bool = False, ids: bool = False) -> int:
    """Memory of layers of this size, lit or not, with ids or not, and of their N-buffers, bytes."""
    return width * height * layer_bytes_per_px(layers, lit=lit, ids=ids) + nbuffer_bytes(width, height)


def ray_reach_px(bundle: RayBundle, focus: PictureFocus, whole: PinholeView, scale: float, nearest_w: float) -> float:
    """Bound on the distance, in layer pixels along either axis, from a pixel to what the tracer reads for it.

    Args:
        bundle: the lens.
        focus: focal surface.
        whole: view of the layers.
        scale: layer pixels per picture pixel.
        nearest_w: inverse depth of the nearest surface in view, 1/m.
    """
    w_f, pupil = focus.over_picture()
    off_focus = float((pupil * np.maximum(np.abs(w_f), np.abs(BINS_ABOVE_NEAREST * nearest_w - w_f))).max())
    if focus.affine is None:
        off_focus *= _BETWEEN_GRID_POINTS
    slope = bundle.slope_reach + bundle.reach_m * off_focus
    if isinstance(bundle.table, PolynomialTable):
        bound = np.abs(bundle.table.rows[..., BOUND : BOUND + 4].astype(np.float64))
        footprint = bound[..., 0] + bound[..., 1] + (bound[..., 2] + bound[..., 3]) * off_focus
        slope = max(slope, float(footprint.max()))
    return max(whole.fx, whole.fy) * slope + 0.5 * scale + 1.0 + _GUARD


def _multiple(length: int, unit: int) -> int:
    """Least multiple of the unit that is no shorter."""
    return -(-length // unit) * unit
