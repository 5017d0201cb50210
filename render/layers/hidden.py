"""Tiles of a picture that a peeled layer hides in the next: for each, an inverse depth from which nothing is drawn."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.targets import Slot
from render.model.arrays import DoubleArray, FloatArray

TILE_PX = 8
_UNIT, _REACH_UNIT, _BINDING = 8, 13, 0


class HiddenTiles:
    """Limits of inverse depth over a picture.

    Args:
        limits: ``(rows, columns)``: in a tile of `TILE_PX` pixels nothing of this inverse depth or more is drawn, 1/m.
    """

    def __init__(self, limits: FloatArray) -> None:
        self._levels = [limits]
        while max(self._levels[-1].shape) > 1:
            rows, columns = self._levels[-1].shape
            even = np.pad(self._levels[-1], ((0, rows % 2), (0, columns % 2)), mode="edge")
            self._levels.append(even.reshape(-(-rows // 2), 2, -(-columns // 2), 2).max((1, 3)))

    def hide(self, low_px: DoubleArray, high_px: DoubleArray, least_w: DoubleArray) -> NDArray[np.bool_]:
        """Whether nothing is drawn of what lies in rectangles at an inverse depth or a greater one.

        Four tiles of the level in which a rectangle is at most two wide cover it.

        Args:
            low_px: ``(n, 2)`` left and top of each rectangle; may lie outside the picture.
            high_px: ``(n, 2)`` right and bottom.
            least_w: ``(n,)`` 1/m.
        """
        last = np.array(self._levels[0].shape[::-1]) - 1
        low = np.clip(np.floor(low_px / TILE_PX), 0, last).astype(np.int64)
        high = np.clip(np.floor(high_px / TILE_PX), 0, last).astype(np.int64)
        levels = np.ceil(np.log2(np.maximum((high - low).max(1, initial=0), 1))).astype(np.int64)
        limits = np.zeros(len(least_w), np.float32)
        for level in sorted(set(levels.tolist())):
            here, tiles = np.flatnonzero(levels == level), self._levels[level]
            (left, top), (right, bottom) = (low[here] >> level).T, (high[here] >> level).T
            corners = tiles[top, left], tiles[top, right], tiles[bottom, left], tiles[bottom, right]
            limits[here] = np.max(corners, axis=0)
        return np.asarray(least_w >= limits)


class HiddenMeasurer:
    """Measures on the device what layers hide.

    Args:
        ctx: context of the device.
        programs: its programs.
    """

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs
        self._buffer: moderngl.Buffer | None = None

    def measure(self, slot: Slot, umbra: float, reach: moderngl.Texture | None) -> HiddenTiles:
        """Tiles that a drawn layer hides. Waits for the device.

        Args:
            slot: the layer.
            umbra: least reach of an opaque surface's umbra, 1/m: 0 where it may be cut short.
            reach: bound on what rays meet behind the layer (`render.layers.reach`); None without.
        """
        width, height = slot.w.size
        columns, rows = -(-width // TILE_PX), -(-height // TILE_PX)
        if self._buffer is None or self._buffer.size != 4 * rows * columns:
            self.release()
            self._buffer = self._ctx.buffer(reserve=4 * rows * columns)
        program = self._programs.compute(
            "layers/hidden.comp", {"TILE_PX": TILE_PX} | ({} if reach is None else {"REACH": 1})
        )
        if reach is not None:
            reach.use(_REACH_UNIT)
            set_uniforms(program, reach=_REACH_UNIT)
        slot.w.use(_UNIT)
        set_uniforms(program, w=_UNIT, channel=slot.channel, umbra=umbra, columns=columns)
        self._buffer.bind_to_storage_buffer(_BINDING)
        program.run(-(-columns // 8), -(-rows // 8))
        self._ctx.memory_barrier()
        return HiddenTiles(np.frombuffer(self._buffer.read(), np.float32).reshape(rows, columns))

    def release(self) -> None:
        """Release the memory on the device."""
        if self._buffer is not None:
            self._buffer.release()
            self._buffer = None
