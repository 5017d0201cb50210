"""N-buffers over blocks of 4x4 layer pixels: the range of inverse depth in any rectangle, in four look-ups.

Beside the range of inverse depth (Lee, Eisemann & Seidel 2010, section 3.1, "Computing Min/Max Values"; Decoret 2005) they hold
which of 64 even bins between infinity and the nearest surface are occupied: a lamp in the foreground widens the range over the
empty space between it and the wall behind, where rays need not search. The bins' range is known before the layers are peeled, so
that layers of a part of the picture have the same bins as those of the whole.
"""

from __future__ import annotations

from dataclasses import dataclass

import moderngl
import numpy as np

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint
from render.gl.compat import read_first_texel
from render.gl.resources import Construction
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.limits import BLOCK_PX, EMPTY_MIN
from render.layers.movers import Movers, block_counts
from render.layers.peeled import Layers
from render.layers.targets import LAYERS_PER_PACK, texture_bytes

BINS_ABOVE_NEAREST = 1.06
"""Nearest end of the bins relative to the nearest surface's w: a pixel's plane reaches 5 % beyond it (``trace/slopes.glsl``)."""


@dataclass(frozen=True)
class NBuffers:
    """Ranges over the layers of one peeling.

    Attributes:
        ranges: RG32F array, ``levels`` slices at a quarter of the layers' resolution: (min, max) of w in 1/m.
        bins: RG32UI array of the same size: 64 bits, the lowest for the farthest bin of the whole range.
        w_range: range of inverse depth of the bins, 1/m; every surface is within it.
        levels: number of levels; the first texel of the last one covers the whole picture.
        nearest_w: greatest inverse depth of a surface, 1/m; 0 where there is none.
    """

    ranges: moderngl.TextureArray
    bins: moderngl.TextureArray
    w_range: tuple[float, float]
    levels: int
    nearest_w: float

    @property
    def bytes(self) -> int:
        """Memory on the device, bytes."""
        return texture_bytes(self.ranges) + texture_bytes(self.bins)


def nbuffer_bytes(width: int, height: int) -> int:
    """Memory of the N-buffers of layers of this size, bytes: that of `NBuffers.bytes`."""
    columns, rows = -(-width // BLOCK_PX), -(-height // BLOCK_PX)
    return 16 * columns * rows * _levels(columns, rows)


def _levels(width: int, height: int) -> int:
    """Number of levels over so many blocks."""
    return int(np.ceil(np.log2(max(width, height)))) + 1


def bind_layers(
    program: moderngl.ComputeShader | moderngl.Program, layers: Layers, nbuffers: NBuffers | None, first_unit: int
) -> int:
    """Bind layers and their N-buffers as ``trace/march.glsl`` reads them, and return the first texture unit left free.

    Programs that read no N-buffers need none.
    """
    targets = layers.targets
    textures: dict[str, moderngl.Texture | moderngl.TextureArray] = {
        "packed_w": targets.packed_w[0],
        "slopes": targets.packed_slopes[0],
        "radiance": targets.radiance,
        "background": targets.background,
    }
    if layers.count > LAYERS_PER_PACK:
        textures |= {"packed_w_far": targets.packed_w[1], "slopes_far": targets.packed_slopes[1]}
    if nbuffers is not None:
        textures |= {"ranges": nbuffers.ranges, "bins": nbuffers.bins}
        set_uniforms(program, last_level=nbuffers.levels - 1, w_range=nbuffers.w_range)
    for unit, (name, texture) in enumerate(textures.items(), start=first_unit):
        if name in program:
            texture.use(unit)
            program[name] = unit
    return first_unit + len(textures)


class NBufferBuilder:
    """Builds N-buffers, keeping the textures for layers of the same size."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx, self._cancellation = ctx, cancellation
        self._programs = programs
        self._textures: tuple[moderngl.TextureArray, moderngl.TextureArray] | None = None
        self._built: tuple[Layers, NBuffers] | None = None

    def build(self, layers: Layers, nearest_w: float, movers: Movers | None = None) -> NBuffers:
        """Build the ranges and bins over all layers and over all that the movers sweep. Those of the last layers are reused.

        Args:
            layers: peeled layers.
            nearest_w: inverse depth that no surface of the layers and no mover exceeds, 1/m (`Peeler.nearest_w`).
            movers: moving surfaces of the layers.
        """
        w_range = 0.0, BINS_ABOVE_NEAREST * nearest_w
        if (
            self._built is not None
            and self._built[0] is layers
            and self._built[1].w_range == w_range
            and movers is None
        ):
            return self._built[1]
        self._built = None
        width, height = block_counts(layers.view)
        levels = _levels(width, height)
        ranges, bins = self._allocate(width, height, levels)
        moving: dict[str, int | float | str] = {}
        if movers is not None:
            moving = {"MOVERS": 1}
            movers.bind_swept()
        self._fill(self._programs.compute("layers/blocks.comp", {"EMPTY_MIN": EMPTY_MIN, **moving}), layers, ranges)
        self._build_levels("layers/nbuffer.comp", ranges)
        program = self._programs.compute("layers/bins.comp", moving)
        set_uniforms(program, w_range=w_range)
        self._fill(program, layers, bins)
        self._build_levels("layers/bins_level.comp", bins)
        built = NBuffers(ranges, bins, w_range, levels, read_first_texel(ranges.glo, levels - 1)[1])
        if movers is None:
            self._built = layers, built
        return built

    def release(self) -> None:
        """Release the memory."""
        for texture in self._textures or ():
            texture.release()
        self._textures = self._built = None

    def _fill(self, program: moderngl.ComputeShader, layers: Layers, texture: moderngl.TextureArray) -> None:
        """Fill the texture's first slice with the contents of each block."""
        packs, slopes = layers.targets.packed_w, layers.targets.packed_slopes
        for pack, name in enumerate(("near", "far")):
            for unit, textures, of in ((2 * pack, packs, "w"), (2 * pack + 1, slopes, "slopes")):
                textures[min(pack, len(textures) - 1)].use(unit)
                program[f"{name}_{of}"] = unit
        program["two_packs"] = layers.count > LAYERS_PER_PACK
        texture.bind_to_image(0, read=False, write=True)
        program.run(-(-texture.width // 8), -(-texture.height // 8))
        self._ctx.memory_barrier()
        self._cancellation.poll()

    def _build_levels(self, shader: str, texture: moderngl.TextureArray) -> None:
        """Build the other levels from the first."""
        program = self._programs.compute(shader)
        texture.bind_to_image(0, read=True, write=True)
        for level in range(1, texture.layers):
            program["level"] = level
            program.run(-(-texture.width // 8), -(-texture.height // 8))
            self._ctx.memory_barrier()
            self._cancellation.poll()

    def _allocate(self, width: int, height: int, levels: int) -> tuple[moderngl.TextureArray, moderngl.TextureArray]:
        if self._textures is None or self._textures[0].size != (width, height, levels):
            self.release()
            with Construction() as making:
                ranges = making.keep(self._ctx.texture_array((width, height, levels), 2, dtype="f4"))
                bins = making.keep(self._ctx.texture_array((width, height, levels), 2, dtype="u4"))
            self._textures = ranges, bins
            for texture in self._textures:
                texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        return self._textures
