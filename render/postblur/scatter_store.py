"""Spots and their tables, kept for the pictures to come."""

from __future__ import annotations

from dataclasses import dataclass

import moderngl

from render.lens import IrisShape
from render.postblur.scatter_spot import Spot, SpotTables, spot_of, spot_tables
from render.postblur.sides import Sides

SPLIT_PX = 24.0
"""Circles of confusion from this radius on are drawn at half the resolution, from twice of it on at a quarter, and so on."""
_KEPT = 8


@dataclass(frozen=True, eq=False)
class TableTextures:
    """Tables of spots on the device.

    Attributes:
        weights: R32F array, a layer for each table.
        reach: R32I, a column for each.
        steps: as `SpotTables` has it.
        middle: likewise.
    """

    weights: moderngl.Texture | moderngl.TextureArray
    reach: moderngl.Texture
    steps: int
    middle: int

    @classmethod
    def of(cls, ctx: moderngl.Context, tables: SpotTables) -> TableTextures:
        """Of tables; to be given back."""
        count, side, _ = tables.weights.shape
        weights = ctx.texture_array((side, side, count), 1, tables.weights.tobytes(), dtype="f4")
        weights.filter = moderngl.NEAREST, moderngl.NEAREST
        reach = ctx.texture((count, 1), 1, tables.reach.tobytes(), dtype="i4")
        reach.filter = moderngl.NEAREST, moderngl.NEAREST
        return cls(weights, reach, tables.steps, tables.middle)

    def release(self) -> None:
        """Give their memory back."""
        self.weights.release()
        self.reach.release()


class SpotStore:
    """The last few spots and tables of one context."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._spots: dict[tuple[object, ...], Spot] = {}
        self._tables: dict[tuple[object, ...], TableTextures] = {}

    def spot(self, sides: Sides) -> Spot:
        """Of a picture's camera."""
        errors = sides.errors
        lens = () if errors is None else (errors.table, errors.pupil_m, errors.focal_px)
        key = (*_content(sides.iris), sides.squeeze, *lens)
        if key not in self._spots:
            while len(self._spots) >= _KEPT:
                del self._spots[next(iter(self._spots))]
            self._spots[key] = spot_of(sides.iris, sides.squeeze, errors)
        return self._spots[key]

    def tables(self, spot: Spot, shrink: int, *, behind: bool) -> TableTextures:
        """Of a spot of `spot`, in pixels of a picture ``shrink`` times smaller.

        Args:
            spot: in pixels of the whole picture.
            shrink: likewise.
            behind: for what is behind the focus.
        """
        key = spot, shrink if spot.has_errors else 1, behind
        if key not in self._tables:
            while len(self._tables) >= _KEPT:
                self._tables.pop(next(iter(self._tables))).release()
            made = spot_tables(spot.reduced(shrink), SPLIT_PX, behind=behind)
            self._tables[key] = TableTextures.of(self._ctx, made)
        return self._tables[key]

    def release(self) -> None:
        """Give the memory back."""
        for tables in self._tables.values():
            tables.release()
        self._tables.clear()
        self._spots.clear()


def _content(iris: IrisShape) -> tuple[object, ...]:
    """What makes two irises equal."""
    mask = None if iris.mask is None else (iris.mask.shape, iris.mask.tobytes())
    return iris.blades, iris.roundness, iris.rotation_rad, mask, iris.radial_weights
