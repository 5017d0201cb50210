"""The linear post-filter of Potmesil & Chakravarty (1981, "A Lens and Aperture Camera Model for Synthetic Image Generation"):
each pixel's light is spread over its circle of confusion; a pixel is the sum of the weighted light that falls on it over the sum
of the weights. Time grows with the area of the circles.

It is the baseline of `render.postblur.importance`, which makes the same sums by what has changed in them. Both are exact, so that
they can be taken apart again: light is rounded to 29 bits of a scale above the brightest in the picture, weights to 20, and of
the sums of their products doubles lose nothing while weights add up to less than 16, which those of circles of up to 96 pixels
do.

Beyond the paper: fields in front of and behind the focus are spread apart and joined, as in every engine here; and what is
blurred much more than a pixel, and lies farther, does not shed on it (Fearing 1995, section 5), so that what is sharp stays so.
"""

from __future__ import annotations

import math

import moderngl
import numpy as np

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint, PieceSize
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.joined import Blurred, Joiner
from render.postblur.shed import Field
from render.postblur.sides import Sides
from render.postblur.spread_tables import STEP_PX, IrisImage, Spread, SpreadTables

CUTOFF_PX, CUTOFF_SHARE = 1.5, 2.0
"""Cut-off: a nearer pixel hides a farther one whose blur radius is above the first number (px) and above the second
times its own.

For a sharp pixel these are Fearing's 3 pixels of diameter; a blurred pixel hides only part of its surroundings.
"""
NO_CUTOFF = 1e9
"""Nothing is hidden: the method as Potmesil & Chakravarty have it."""
LIGHT_BITS = 29
TILE, LANES = 8, 64
Buffers = tuple[moderngl.Buffer, moderngl.Buffer, moderngl.Buffer]
"""Buffers that light is spread from: half tiles, their reach, and the list of tiles."""
_HEADROOM = 2  # powers of 2 above the brightest light, so that a brighter one can join
_LESS_LIGHT = 4  # by how many it must fall for a finer scale
_SPARE_STEPS = 8  # tables beyond those that a picture needs


class FieldSpreader:
    """Spreads a field of a picture, with the programs of one context. What it has made is valid until it is used again.

    Args:
        ctx: the context.
        programs: of it.
        step_px: of the radius; what it changes by less is no change.
        cutoff_px: how much something farther must be blurred for a sharp pixel to hide it; `NO_CUTOFF` for nothing.

    Attributes:
        light: the field's, as it was taken.
        state: number of the table of each pixel, and its radius.
        shedding: what half tiles shed light (`linear/linear_take.comp`).
        reaches: how far.
        filled: in which tiles any do.
        shown: the sum of weighted light, and that of weights.
    """

    light: moderngl.Texture
    state: moderngl.Texture
    shedding: moderngl.Buffer
    reaches: moderngl.Buffer
    filled: moderngl.Buffer
    shown: moderngl.Texture

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, *, step_px: float = STEP_PX, cutoff_px: float = CUTOFF_PX
    ) -> None:
        self._ctx, self._programs = ctx, programs
        self._step_px, self._cutoff_px = step_px, cutoff_px
        is_software = "llvmpipe" in ctx.info["GL_RENDERER"] or "softpipe" in ctx.info["GL_RENDERER"]
        self._rows = 8 if is_software else 2  # of pixels to a lane: few lanes with much to do each, or many
        self._piece = PieceSize(8)  # rows of tiles
        self._told = ctx.buffer(reserve=8)
        self._scale: int | None = None  # power of 2 that no light is above
        self._tables: SpreadTables | None = None
        self._held = Resources()
        self.size = (0, 0)

    @property
    def tiles(self) -> tuple[int, int]:
        """Columns and rows of tiles."""
        return -(-self.size[0] // TILE), -(-self.size[1] // TILE)

    @property
    def half_tiles(self) -> int:
        """Their number, each of four rows of a tile."""
        return 2 * self.tiles[0] * self.tiles[1]

    @property
    def has_cutoff(self) -> bool:
        """Whether what is nearer hides anything."""
        return self._cutoff_px < NO_CUTOFF

    @property
    def tables(self) -> SpreadTables:
        """Those that were made last."""
        if self._tables is None:
            raise ValueError("no tables were made")
        return self._tables

    def fit(self, size: tuple[int, int]) -> bool:
        """Make room for fields of a size; whether it was not there yet."""
        if size == self.size:
            return False
        self._held.close()
        self.size = (0, 0)
        texture, buffer, keep = self._ctx.texture, self._ctx.buffer, self._held.keep
        self.light, self.shown = (keep(texture(size, 4, dtype="f4")) for _ in range(2))
        self.state = keep(texture(size, 2, dtype="f4"))
        self.size = size
        self.shedding, self.reaches = (keep(buffer(reserve=size_ * self.half_tiles)) for size_ in (16, 4))
        self.filled = keep(self.bits_of_tiles())
        return True

    def bits_of_tiles(self) -> moderngl.Buffer:
        """Room for a bit for each tile, in rows."""
        return self._ctx.buffer(reserve=4 * self._filled_words * self.tiles[1])

    @property
    def _filled_words(self) -> int:
        return self.tiles[0] // 32 + 2  # one more than is needed, for what is read across

    def tabled(self, spread: Spread, most_px: float) -> bool:
        """Make tables for radii up to one; whether there were none that are like these."""
        old = self._tables
        if old is not None and old.serves(spread, most_px):
            return False
        alike = old is not None and old.spread == spread
        self._tables = SpreadTables(
            self._ctx,
            spread,
            most_px + _SPARE_STEPS * self._step_px,
            self._step_px,
            with_differences=not self.has_cutoff,
        )
        if old is not None:
            old.release()
        return not alike

    def take(self, field: Field, side: float) -> None:
        """Take a field into `light` and `state`, and find what sheds.

        Args:
            field: of the size that was fitted.
            side: 1 in front of the focus, -1 behind it; 1 where radii are signed, above 0 in front.
        """
        program = self._programs.compute("linear/linear_take.comp")
        buffers = self.shedding, self.reaches, self.filled
        if not self.run_take(program, field, side, buffers)[0]:
            self.run_take(program, field, side, buffers)  # at a scale that is its own

    def run_take(
        self,
        program: moderngl.ComputeShader,
        field: Field,
        side: float,
        buffers: Buffers,
        **last: moderngl.Texture,
    ) -> tuple[bool, int]:
        """Run a variant of linear_take.comp.

        Returns:
            Whether the field is of the scale that it was taken at, and how many of its pixels have changed. If it is not, the
            next one is taken at this one's.
        """
        tables = self.tables
        self._told.write(bytes(8))
        self.bound(program, light=field.light, radii=field.radii, steps=tables.steps, **last)
        set_uniforms(program, channel=field.channel, side=side, step_px=self._step_px, has_cutoff=self.has_cutoff)
        set_uniforms(program, quantum=2.0 ** ((self._scale or 0) - LIGHT_BITS), quantum_alpha=2.0**-LIGHT_BITS)
        set_uniforms(program, most_even=float(tables.steps.width - 1), beyond_px=tables.beyond_px)
        self.light.bind_to_image(0, read=False, write=True)
        self.state.bind_to_image(1, read=False, write=True)
        shedding, reaches, filled = buffers
        filled.clear()
        for unit, buffer in enumerate((shedding, reaches, self._told, filled), start=1):
            buffer.bind_to_storage_buffer(unit)
        self.run_half_tiles(program)
        told = self._told.read()
        needed = max(-60, math.frexp(float(np.frombuffer(told, np.float32, 1)[0]))[1])
        fits = self._scale is not None and needed <= self._scale <= needed + _HEADROOM + _LESS_LIGHT
        if not fits:
            self._scale = needed + _HEADROOM
        return fits, int(np.frombuffer(told, np.uint32)[1])

    def spread_all(
        self, sums: moderngl.Buffer | None = None, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        """Spread all that was taken, into `shown`.

        Args:
            sums: four doubles for each pixel, to keep them in with all their bits.
            cancellation: that beats between rows of tiles.

        Raises:
            Cancelled: the work is stale.
        """
        program = self.spreading(**({"KEEP": 1} if sums is not None else {}))
        first, (across, down) = 0, self.tiles
        while first < down:
            rows = min(self._piece.units if cancellation.is_cancellable else down, down - first)
            self.bound(program, weights=self.tables.weights, light_now=self.light, state_now=self.state)
            self.bind_spread(program, (self.shedding, self.reaches, self.filled))
            if sums is not None:
                sums.bind_to_storage_buffer(0)
            set_uniforms(program, first_tile=first)
            program.run(across, rows)
            self._ctx.memory_barrier()
            self._piece.learn(rows, cancellation.poll())
            first += rows

    def spreading(self, **defines: int) -> moderngl.ComputeShader:
        """A variant of linear_spread.comp."""
        return self._programs.compute("linear/linear_spread.comp", {"ROWS": self._rows, **defines})

    def bind_spread(self, program: moderngl.ComputeShader, buffers: Buffers) -> None:
        """Tell a variant of linear/linear_spread.comp of tiles and tables, and what it draws on."""
        half = self.tables.half
        set_uniforms(program, half_px=half, cutoff_px=self._cutoff_px, has_cutoff=self.has_cutoff, tiles=self.tiles)
        set_uniforms(program, tiles_around=-(-half // TILE), first_difference=self.tables.count)
        set_uniforms(program, filled_words=self._filled_words, own_share=CUTOFF_SHARE)
        self.shown.bind_to_image(0, read=False, write=True)
        for unit, buffer in zip((1, 2, 4), buffers, strict=True):
            buffer.bind_to_storage_buffer(unit)

    @staticmethod
    def bound(program: moderngl.ComputeShader, **textures: moderngl.Texture | moderngl.TextureArray) -> None:
        """Bind textures by the names that a program has for them."""
        for unit, (name, texture) in enumerate(textures.items()):
            texture.use(unit)
            set_uniforms(program, **{name: unit})

    def run_half_tiles(self, program: moderngl.ComputeShader) -> None:
        """Run a program with a lane for each half tile, and wait until others can see what it wrote."""
        set_uniforms(program, tiles=self.tiles, filled_words=self._filled_words)
        program.run(-(-self.half_tiles // LANES))
        self._ctx.memory_barrier()

    def release(self) -> None:
        """Give the memory back; it is made anew when it is needed."""
        self._held.close()
        self.size = (0, 0)
        if self._tables is not None:
            self._tables.release()
            self._tables = None


class LinearField:
    """Spreads a field whole, each time."""

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
            spread: how light is distributed over a circle of confusion.
            most_px: no radius is larger.
            cancellation: that beats between pieces of the work.

        Returns:
            RGBA32F: the sum of weighted light, and that of weights; valid until the next one.

        Raises:
            Cancelled: the work is stale.
        """
        made = self._spreader
        made.fit(field.light.size)
        made.tabled(spread, most_px)
        made.take(field, side)
        made.spread_all(cancellation=cancellation)
        return made.shown

    def release(self) -> None:
        """Give the memory back."""
        self._spreader.release()


class LinearBlur:
    """The engine ``linear``: both sides of the focus spread over the iris's image, and joined."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._cancellation, self._joiner = cancellation, Joiner(ctx, programs)
        self._fields = tuple(LinearField(FieldSpreader(ctx, programs)) for _ in range(2))

    def blurred(self, sides: Sides, held: Resources) -> moderngl.Texture:
        """As `render.postblur.sides.Blur` has it."""
        near, far = (
            made.spread(field, side, spread, sides.most_px, self._cancellation)
            for made, (field, side, spread) in zip(self._fields, fields_of(sides), strict=True)
        )
        return self._joiner.joined(sides, {"near": Blurred(near), "far": Blurred(far)}, held)

    def release(self) -> None:
        """Give the memory back."""
        for field in self._fields:
            field.release()


def fields_of(sides: Sides) -> tuple[tuple[Field, float, Spread], tuple[Field, float, Spread]]:
    """Near and far fields with their sign and their spread."""
    near, far = (IrisImage(sides.iris, is_behind=behind, squeeze=sides.squeeze) for behind in (False, True))
    return (Field(sides.near, sides.radii, 0), 1.0, near), (Field(sides.far, sides.radii, 1), -1.0, far)
