"""Linear post-filter (Potmesil & Chakravarty 1981): each pixel's light is spread over its circle of confusion.

"A Lens and Aperture Camera Model for Synthetic Image Generation". A pixel is the sum of the weighted light that falls
on it over the sum of the weights. Time grows with the area of the circles.

It is the baseline of `render.postblur.importance`, which updates the same sums where pixels have changed. Both are
exact, so that the effect of a pixel can be subtracted again: weights are rounded to 20 bits, light to 29 bits of a scale
above the brightest light in the picture. Sums of their products are exact in doubles, since the weights on a pixel add up
to less than 16 at radii of up to 96 pixels. Through a mask or radial weights they add up to less than 256, and light is
rounded to 25 bits.

Beyond the paper: the near and the far field are spread apart and composited, as in every engine here; and a pixel that
is farther and blurred much more than another does not spread onto it (Fearing 1995, section 5), so that sharp pixels
stay sharp.
"""

from __future__ import annotations

import math

import moderngl
import numpy as np

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint, PieceSize
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.composite import BlurredPart, Compositor
from render.postblur.focus_split import FocusSplit
from render.postblur.point_spread import Field
from render.postblur.spread_tables import STEP_PX, WEIGHT_BITS, IrisImage, Spread, SpreadTables

CUTOFF_PX, CUTOFF_SHARE = 1.5, 2.0
"""Cut-off: a nearer pixel hides a farther one whose blur radius is above the first number (px) and above the second
times its own.

For a sharp pixel these are Fearing's 3 pixels of diameter; a blurred pixel hides only part of its surroundings.
"""
NO_CUTOFF = 1e9
"""No cut-off: the method as in Potmesil & Chakravarty."""
DOUBLE_BITS = 53
"""Bits of a double's whole numbers: those of light, of weights, and of the sum of weights."""
TILE, LANES = 8, 64
"""Side of a tile in pixels, and invocations of a work group."""
Buffers = tuple[moderngl.Buffer, moderngl.Buffer, moderngl.Buffer]
"""Emitters, reaches and tile bits, as the attributes of `FieldSpreader` of these names."""
_HEADROOM = 2  # powers of 2 above the brightest light, so that a brighter one can join
_LESS_LIGHT = 4  # powers of 2 by which light must fall for a finer scale
_SPARE_STEPS = 8  # tables beyond those that a picture needs


class FieldSpreader:
    """Spreads a field of a picture, with the programs of one context. Its results are valid until it is used again.

    Args:
        ctx: the context.
        programs: programs of the context.
        step_px: step that radii are rounded to.
        cutoff_px: blur radius from which a sharp pixel hides a farther one; `NO_CUTOFF` for never.

    Attributes:
        light: light of the field, rounded.
        state: table number and radius of each pixel.
        emitters: bits of the pixels of each half tile that have light (`linear/linear_load.comp`).
        reaches: greatest distance to which each half tile spreads light, px.
        tile_bits: a bit for each tile with light.
        result: the sum of weighted light, and the sum of weights.
    """

    light: moderngl.Texture
    state: moderngl.Texture
    emitters: moderngl.Buffer
    reaches: moderngl.Buffer
    tile_bits: moderngl.Buffer
    result: moderngl.Texture

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, *, step_px: float = STEP_PX, cutoff_px: float = CUTOFF_PX
    ) -> None:
        self._ctx, self._programs = ctx, programs
        self._step_px, self._cutoff_px = step_px, cutoff_px
        is_software = "llvmpipe" in ctx.info["GL_RENDERER"] or "softpipe" in ctx.info["GL_RENDERER"]
        self._rows = 8 if is_software else 2  # pixel rows per invocation: software renderers prefer fewer, longer ones
        self._piece = PieceSize(8)  # rows of tiles
        self._summary = ctx.buffer(reserve=8)
        self._scale: int | None = None  # exponent of the power of 2 that no light exceeds
        self._tables: SpreadTables | None = None
        self._resources = Resources()
        self.size = (0, 0)

    @property
    def tiles(self) -> tuple[int, int]:
        """Columns and rows of tiles."""
        return -(-self.size[0] // TILE), -(-self.size[1] // TILE)

    @property
    def half_tiles(self) -> int:
        """Number of half tiles, each of four rows of a tile."""
        return 2 * self.tiles[0] * self.tiles[1]

    @property
    def has_cutoff(self) -> bool:
        """Whether nearer pixels hide farther ones."""
        return self._cutoff_px < NO_CUTOFF

    @property
    def light_bits(self) -> int:
        """Number of bits that light is rounded to."""
        return DOUBLE_BITS - WEIGHT_BITS - (self.tables.spread.most_weight.bit_length() - 1)

    @property
    def tables(self) -> SpreadTables:
        """Tables made by `update_tables`."""
        if self._tables is None:
            raise ValueError("no tables were made")
        return self._tables

    def resize(self, size: tuple[int, int]) -> bool:
        """Allocate for fields of a size; return True if the size is new."""
        if size == self.size:
            return False
        self._resources.close()
        self.size = (0, 0)
        texture, buffer, keep = self._ctx.texture, self._ctx.buffer, self._resources.keep
        self.light, self.result = (keep(texture(size, 4, dtype="f4")) for _ in range(2))
        self.state = keep(texture(size, 2, dtype="f4"))
        self.size = size
        self.emitters, self.reaches = (keep(buffer(reserve=entry_bytes * self.half_tiles)) for entry_bytes in (16, 4))
        self.tile_bits = keep(self.make_tile_bits())
        return True

    def make_tile_bits(self) -> moderngl.Buffer:
        """Allocate a bit for each tile, in rows."""
        return self._ctx.buffer(reserve=4 * self._tile_bit_words * self.tiles[1])

    @property
    def _tile_bit_words(self) -> int:
        return self.tiles[0] // 32 + 2  # one spare word, for reads across its end

    def update_tables(self, spread: Spread, most_px: float) -> bool:
        """Make tables for radii up to ``most_px``; return True if the spread differs from that of the last tables."""
        old = self._tables
        if old is not None and old.cover(spread, most_px):
            return False
        is_same_spread = old is not None and old.spread == spread
        self._tables = SpreadTables(
            self._ctx,
            spread,
            most_px + _SPARE_STEPS * self._step_px,
            self._step_px,
            with_differences=not self.has_cutoff,
        )
        if old is not None:
            old.release()
        return not is_same_spread

    def load(self, field: Field, side: float) -> None:
        """Load a field into `light` and `state`, and find the pixels that have light.

        Args:
            field: field of the size given to `resize`.
            side: 1 in front of the focus, -1 behind it; 1 where radii are signed, above 0 in front.
        """
        program = self._programs.compute("linear/linear_load.comp")
        buffers = self.emitters, self.reaches, self.tile_bits
        if not self.run_load(program, field, side, buffers)[0]:
            self.run_load(program, field, side, buffers)  # once more, rounded by this field's own scale

    def run_load(
        self,
        program: moderngl.ComputeShader,
        field: Field,
        side: float,
        buffers: Buffers,
        **last: moderngl.Texture,
    ) -> tuple[bool, int]:
        """Run a variant of linear_load.comp.

        Returns:
            Whether the field fits the scale that it was rounded by, and the number of its pixels that have changed. If it does
            not fit, the scale is set to this field's own for the next load.
        """
        tables = self.tables
        self._summary.write(bytes(8))
        self.bind_textures(program, light=field.light, radii=field.radii, steps=tables.steps, **last)
        set_uniforms(program, channel=field.channel, side=side, step_px=self._step_px, has_cutoff=self.has_cutoff)
        bits = self.light_bits
        set_uniforms(program, quantum=2.0 ** ((self._scale or 0) - bits), quantum_alpha=2.0**-bits)
        set_uniforms(program, most_even=float(tables.steps.width - 1), wide=tables.wide, beyond_px=tables.beyond_px)
        self.light.bind_to_image(0, read=False, write=True)
        self.state.bind_to_image(1, read=False, write=True)
        emitters, reaches, tile_bits = buffers
        tile_bits.clear()
        for unit, buffer in enumerate((emitters, reaches, self._summary, tile_bits), start=1):
            buffer.bind_to_storage_buffer(unit)
        self.run_half_tiles(program)
        summary = self._summary.read()
        needed = max(-60, math.frexp(float(np.frombuffer(summary, np.float32, 1)[0]))[1])
        fits = self._scale is not None and needed <= self._scale <= needed + _HEADROOM + _LESS_LIGHT
        if not fits:
            self._scale = needed + _HEADROOM
        return fits, int(np.frombuffer(summary, np.uint32)[1])

    def spread_all(
        self, sums: moderngl.Buffer | None = None, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        """Spread the loaded field into `result`.

        Args:
            sums: four doubles for each pixel, which receive the exact sums.
            cancellation: polled between rows of tiles.

        Raises:
            Cancelled: the work is stale.
        """
        program = self.spread_program(**({"KEEP": 1} if sums is not None else {}))
        across, down = self.tiles
        for first, end in self._piece.cut(down, cancellation):
            self.bind_textures(program, weights=self.tables.weights, light_now=self.light, state_now=self.state)
            self.bind_spread(program, (self.emitters, self.reaches, self.tile_bits))
            if sums is not None:
                sums.bind_to_storage_buffer(0)
            set_uniforms(program, first_tile=first)
            program.run(across, end - first)
            self._ctx.memory_barrier()

    def spread_program(self, **defines: int) -> moderngl.ComputeShader:
        """Return the variant of linear_spread.comp with these defines."""
        return self._programs.compute("linear/linear_spread.comp", {"ROWS": self._rows, **defines})

    def bind_spread(self, program: moderngl.ComputeShader, buffers: Buffers) -> None:
        """Set the uniforms and bind the buffers of a variant of linear/linear_spread.comp."""
        half = self.tables.half
        set_uniforms(program, half_px=half, cutoff_px=self._cutoff_px, has_cutoff=self.has_cutoff, tiles=self.tiles)
        set_uniforms(program, tiles_around=-(-half // TILE), first_difference=self.tables.count)
        set_uniforms(program, tile_bit_words=self._tile_bit_words, own_share=CUTOFF_SHARE)
        self.result.bind_to_image(0, read=False, write=True)
        for unit, buffer in zip((1, 2, 4), buffers, strict=True):
            buffer.bind_to_storage_buffer(unit)

    @staticmethod
    def bind_textures(program: moderngl.ComputeShader, **textures: moderngl.Texture | moderngl.TextureArray) -> None:
        """Bind textures to the sampler uniforms of these names."""
        for unit, (name, texture) in enumerate(textures.items()):
            texture.use(unit)
            set_uniforms(program, **{name: unit})

    def run_half_tiles(self, program: moderngl.ComputeShader) -> None:
        """Run a program with one invocation for each half tile, and make its writes visible."""
        set_uniforms(program, tiles=self.tiles, tile_bit_words=self._tile_bit_words)
        program.run(-(-self.half_tiles // LANES))
        self._ctx.memory_barrier()

    def release(self) -> None:
        """Release the memory; it is allocated again when needed."""
        self._resources.close()
        self.size = (0, 0)
        if self._tables is not None:
            self._tables.release()
            self._tables = None


class LinearField:
    """Spreads all of a field each time, in contrast to `render.postblur.importance_field`."""

    def __init__(self, spreader: FieldSpreader) -> None:
        self._spreader = spreader

    def spread(
        self,
        field: Field,
        side: float,
        spread: Spread,
        most_px: float,
        cancellation: CancellationPoint = NEVER_CANCELLED,
    ) -> moderngl.Texture:
        """Spread a field.

        Args:
            field: what to spread.
            side: 1 in front of the focus, -1 behind it; 1 where radii are signed, above 0 in front.
            spread: distribution of light over a circle of confusion.
            most_px: upper bound on the radii.
            cancellation: polled between pieces of the work.

        Returns:
            RGBA32F: the sum of weighted light, and the sum of weights; valid until the next call.

        Raises:
            Cancelled: the work is stale.
        """
        spreader = self._spreader
        spreader.resize(field.light.size)
        spreader.update_tables(spread, most_px)
        spreader.load(field, side)
        spreader.spread_all(cancellation=cancellation)
        return spreader.result

    def release(self) -> None:
        """Release the memory."""
        self._spreader.release()


class LinearBlur:
    """Blur of the engine ``linear``: near and far field are spread over the iris's image and composited."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._cancellation, self._compositor = cancellation, Compositor(ctx, programs)
        self._fields = tuple(LinearField(FieldSpreader(ctx, programs)) for _ in range(2))

    def blur(self, split: FocusSplit, scope: Resources) -> moderngl.Texture:
        """See `render.postblur.focus_split.Blur`."""
        near, far = (
            target.spread(field, side, spread, split.most_px, self._cancellation)
            for target, (field, side, spread) in zip(self._fields, split_fields(split), strict=True)
        )
        return self._compositor.composite(split, {"near": BlurredPart(near), "far": BlurredPart(far)}, scope)

    def release(self) -> None:
        """Release the memory."""
        for field in self._fields:
            field.release()


def split_fields(split: FocusSplit) -> tuple[tuple[Field, float, Spread], tuple[Field, float, Spread]]:
    """Return the near and the far field, each with its side (1 in front of the focus, -1 behind) and its spread."""
    near, far = (IrisImage(split.iris, is_behind=behind, squeeze=split.squeeze) for behind in (False, True))
    return (Field(split.near, split.radii, 0), 1.0, near), (Field(split.far, split.radii, 1), -1.0, far)
