"""Cache of spots and their tables."""

from __future__ import annotations

from dataclasses import dataclass, field

import moderngl

from render.gl.limits import check_texture_array
from render.postblur.blur_shape import iris_key
from render.postblur.focus_split import SPLIT_PX, FocusSplit
from render.postblur.scatter_axis import make_axis_spot
from render.postblur.scatter_spot import Spot, SpotTables, make_camera_spot, make_spot_tables

_MAX_SPOTS = 4
"""Spots kept, each with all its tables: two, or two for each resolution where the lens has errors, of 3 to 20 MB each."""


@dataclass(frozen=True, eq=False)
class TableTextures:
    """Tables of spots on the device.

    Attributes:
        weights: R32F array, a layer for each table.
        reach: R32I, a column for each table.
        steps: see `SpotTables`.
        middle: see `SpotTables`.
    """

    weights: moderngl.Texture | moderngl.TextureArray
    reach: moderngl.Texture
    steps: int
    middle: int

    @classmethod
    def upload(cls, ctx: moderngl.Context, tables: SpotTables) -> TableTextures:
        """Upload tables; the caller releases them."""
        count, side, _ = tables.weights.shape
        check_texture_array(ctx, (side, side, count), "the pictures of spots")
        weights = ctx.texture_array((side, side, count), 1, tables.weights.tobytes(), dtype="f4")
        weights.filter = moderngl.NEAREST, moderngl.NEAREST
        reach = ctx.texture((count, 1), 1, tables.reach.tobytes(), dtype="i4")
        reach.filter = moderngl.NEAREST, moderngl.NEAREST
        return cls(weights, reach, tables.steps, tables.middle)

    def release(self) -> None:
        """Release the textures."""
        self.weights.release()
        self.reach.release()


@dataclass(frozen=True, eq=False)
class _CachedSpot:
    """A spot, and its tables by shrink factor and by whether they are for the far field."""

    spot: Spot
    tables: dict[tuple[int, bool], TableTextures] = field(default_factory=dict)

    def release(self) -> None:
        while self.tables:
            self.tables.popitem()[1].release()


class SpotCache:
    """Spots of one context that were used last, with their tables."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._kept: dict[tuple[object, ...], _CachedSpot] = {}

    def spot(self, split: FocusSplit) -> Spot:
        """Spot of a picture's camera."""
        lens = None if split.errors is None else make_axis_spot(split.errors)
        key = (*iris_key(split.iris), split.squeeze, None if lens is None else lens.cache_key)
        kept = self._kept.pop(key, None)
        if kept is None:
            while len(self._kept) >= _MAX_SPOTS:
                self._kept.pop(next(iter(self._kept))).release()
            kept = _CachedSpot(make_camera_spot(split.iris, split.squeeze, lens))
        self._kept[key] = kept  # now the most recently used
        return kept.spot

    def tables(self, spot: Spot, shrink: int, *, behind: bool) -> TableTextures:
        """Tables of a spot, in pixels of a picture ``shrink`` times smaller.

        Args:
            spot: from `spot`, in pixels of the whole picture; one of the last few returned.
            shrink: factor by which the picture is smaller.
            behind: whether the tables are for the far field.
        """
        tables = next(kept.tables for kept in self._kept.values() if kept.spot is spot)
        key = shrink if spot.has_errors else 1, behind
        if key not in tables:
            tables[key] = TableTextures.upload(
                self._ctx, make_spot_tables(spot.reduce(shrink), SPLIT_PX, behind=behind)
            )
        return tables[key]

    def release(self) -> None:
        """Release the memory."""
        while self._kept:
            self._kept.popitem()[1].release()
