"""Ranges of inverse depth over any rectangle of the layers, in four look-ups: N-buffers over 4x4 blocks.

Lee, Eisemann & Seidel 2010, section 3.1, "Computing Min/Max Values"; Decoret 2005.
"""

from __future__ import annotations

from dataclasses import dataclass

import moderngl
import numpy as np

from render.gl.shaders import ProgramCache
from render.layers.peel import Layers
from render.layers.targets import LAYERS_PER_PACK, texture_bytes

BLOCK_PX = 4
EMPTY_MIN = 3.0e38
"""Lower end of an empty range, above every inverse depth."""


@dataclass(frozen=True)
class NBuffers:
    """Ranges over the layers of one peeling.

    Attributes:
        ranges: RG32F array, ``levels`` slices at a quarter of the layers' resolution: (min, max) of w in 1/m.
        levels: how many; the first texel of the last one covers everything.
    """

    ranges: moderngl.TextureArray
    levels: int

    @property
    def bytes(self) -> int:
        """Memory of the device that they take."""
        return texture_bytes(self.ranges)


class NBufferBuilder:
    """Builds N-buffers, keeping the texture for the next layers of the same size."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx = ctx
        self._programs = programs
        self._ranges: moderngl.TextureArray | None = None

    def build(self, layers: Layers) -> NBuffers:
        """Build the ranges over all layers."""
        width, height = (-(-side // BLOCK_PX) for side in (layers.view.width, layers.view.height))
        levels = int(np.ceil(np.log2(max(width, height)))) + 1
        ranges = self._sized(width, height, levels)
        self._fill_blocks(layers, ranges)
        program = self._programs.compute("nbuffer.comp")
        ranges.bind_to_image(0, read=True, write=True)
        for level in range(1, levels):
            self._ctx.memory_barrier()
            program["level"] = level
            program.run(-(-width // 8), -(-height // 8))
        self._ctx.memory_barrier()
        return NBuffers(ranges, levels)

    def release(self) -> None:
        """Give the memory back."""
        if self._ranges is not None:
            self._ranges.release()

    def _fill_blocks(self, layers: Layers, ranges: moderngl.TextureArray) -> None:
        program = self._programs.compute("blocks.comp", {"EMPTY_MIN": EMPTY_MIN})
        packs = layers.targets.packed_w
        for unit, name in enumerate(("near_w", "far_w")):
            packs[min(unit, len(packs) - 1)].use(unit)
            program[name] = unit
        program["two_packs"] = layers.count > LAYERS_PER_PACK
        ranges.bind_to_image(0, read=False, write=True)
        program.run(-(-ranges.width // 8), -(-ranges.height // 8))

    def _sized(self, width: int, height: int, levels: int) -> moderngl.TextureArray:
        if self._ranges is None or self._ranges.size != (width, height, levels):
            self.release()
            self._ranges = None
            self._ranges = self._ctx.texture_array((width, height, levels), 2, dtype="f4")
            self._ranges.filter = (moderngl.NEAREST, moderngl.NEAREST)
        return self._ranges
