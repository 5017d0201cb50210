"""The linear post-filter of Potmesil & Chakravarty (1981, "A Lens and Aperture Camera Model for Synthetic Image Generation"):
each pixel's light is spread over its circle of confusion; a pixel is the sum of the weighted light that falls on it over the sum
of the weights. Time grows with the area of the circles.

It is the baseline of `render.postblur.importance`, which makes the same sums by what has changed in them. Both are exact, so that
they can be taken apart again: light is rounded to 29 bits of a scale above the brightest in the picture, weights to 20, and of
the sums of their products doubles lose nothing while weights add up to less than 16, which those of circles of up to 96 pixels
do.

Beyond the paper: fields in front of and behind the focus are spread apart and joined, as in every engine here; and what is
blurred more than a pixel, and lies farther, does not shed on it (Fearing 1995, section 5), so that what is sharp stays so.
"""

from __future__ import annotations

import math

import moderngl
import numpy as np

from render.gl.held import Held
from render.gl.pulse import UNWATCHED, PieceSize, Pulse
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.shed import Field
from render.postblur.sides import Sides
from render.postblur.spread_tables import EVEN_STEPS, STEP_PX, IrisImage, Spread, SpreadTables

CUTOFF_PX = 1.5
"""How much more than a pixel something farther must be blurred for that to hide it: Fearing's 3 pixels of diameter."""
NO_CUTOFF = 1e9
"""Nothing is hidden: the method as Potmesil & Chakravarty have it."""
LIGHT_BITS = 29
TILE = 8
HEADROOM = 2
"""Powers of 2 between the brightest light and the scale that sums are made in, so that a brighter one can join."""
_SPARE_STEPS = 8  # tables beyond those that a picture needs


class FieldSpreader:
    """Spreads a field of a picture, with the programs of one context. What it has made is valid until it is used again.

    Args:
        ctx: the context.
        programs: of it.
        step_px: of the radius; what it changes by less is no change.
        cutoff_px: how much more blurred than a pixel something farther must be for that to hide it; `NO_CUTOFF` for nothing.
    """

    def __init__(
        self,
        ctx: moderngl.Context,
        programs: ProgramCache,
        *,
        step_px: float = STEP_PX,
        cutoff_px: float = CUTOFF_PX,
    ) -> None:
        self._ctx, self._programs = ctx, programs
        self._step_px, self.cutoff_px = step_px, cutoff_px
        is_software = "llvmpipe" in ctx.info["GL_RENDERER"] or "softpipe" in ctx.info["GL_RENDERER"]
        self.rows = 8 if is_software else 2  # of pixels to a lane: few lanes with much to do each, or many
        self._piece = PieceSize(8)  # rows of tiles
        self._brightest = ctx.buffer(reserve=4)
        self.size = (0, 0)
        self.tables: SpreadTables | None = None
        self._held = Held()

    @property
    def tiles(self) -> tuple[int, int]:
        """Columns and rows of tiles."""
        return -(-self.size[0] // TILE), -(-self.size[1] // TILE)

    def fit(self, size: tuple[int, int]) -> bool:
        """Make room for fields of a size; whether it was not there yet."""
        if size == self.size:
            return False
        self._held.close()
        self.size = (0, 0)
        texture, keep = self._ctx.texture, self._held.keep
        self.light, self.shown = (keep(texture(size, 4, dtype="f4")) for _ in range(2))
        self.state = keep(texture(size, 2, dtype="f4"))
        self.size = size
        count = self.tiles[0] * self.tiles[1]
        self.masks, self.reaches = keep(self._ctx.buffer(reserve=8 * count)), keep(self._ctx.buffer(reserve=4 * count))
        return True

    def tabled(self, spread: Spread, most_px: float) -> bool:
        """Make tables for radii up to one; whether there were none that are like these."""
        old = self.tables
        if old is not None and old.serves(spread, most_px):
            return False
        alike = old is not None and old.spread == spread
        self.tables = SpreadTables(self._ctx, spread, most_px + _SPARE_STEPS * self._step_px, self._step_px)
        if old is not None:
            old.release()
        return not alike

    def scale(self, field: Field) -> int:
        """A power of 2 that no light of a field is above, with room for some that is brighter."""
        self._brightest.write(b"\0\0\0\0")
        program = self._programs.compute("linear_brightest.comp")
        self._brightest.bind_to_storage_buffer(0)
        self.bound(program, light=field.light)
        self.run(program, field.light.size)
        (most,) = np.frombuffer(self._brightest.read(), np.float32)
        return max(-60, math.frexp(float(most))[1]) + HEADROOM

    def take(self, field: Field, side: float, scale: int) -> None:
        """Take a field into `light` and `state`.

        Args:
            field: of the size that was fitted.
            side: 1 in front of the focus, -1 behind it; 1 where radii are signed, above 0 in front.
            scale: as `scale` finds it.
        """
        program = self._programs.compute("linear_take.comp")
        self.bound(program, light=field.light, radii=field.radii)
        set_uniforms(program, channel=field.channel, side=side, step_px=self._step_px, even_steps=float(EVEN_STEPS))
        set_uniforms(program, quantum=2.0 ** (scale - LIGHT_BITS), quantum_alpha=2.0**-LIGHT_BITS)
        set_uniforms(program, most_step=float(self.made_tables.count - 1))
        self.light.bind_to_image(0, read=False, write=True)
        self.state.bind_to_image(1, read=False, write=True)
        self.run(program, self.size)

    def spread_all(self, sums: moderngl.Buffer | None = None, pulse: Pulse = UNWATCHED) -> None:
        """Spread all that was taken, into `shown`: light and weights.

        Args:
            sums: four doubles for each pixel, to keep them in with all their bits.
            pulse: that beats between rows of tiles.

        Raises:
            Interrupted: the work is stale.
        """
        reach = self._programs.compute("linear_reach.comp")
        self.bound(reach, light_now=self.light, state_now=self.state, table_reaches=self.made_tables.reaches)
        self.bind_tiles(reach, self.masks, self.reaches)
        self.run(reach, self.tiles)
        program = self._programs.compute(
            "linear_spread.comp", {"ROWS": self.rows} | ({"KEEP": 1} if sums is not None else {})
        )
        first, (across, down) = 0, self.tiles
        while first < down:
            rows = min(self._piece.units if pulse.is_watched else down, down - first)
            self.bind_spread(program, sums)
            set_uniforms(program, first_tile=first)
            program.run(across, rows)
            self._ctx.memory_barrier()
            self._piece.learn(rows, pulse.beat())
            first += rows

    def bind_spread(self, program: moderngl.ComputeShader, sums: moderngl.Buffer | None) -> None:
        """Bind all that spreading all of it takes."""
        self.bound(program, weights=self.made_tables.weights, light_now=self.light, state_now=self.state)
        self.bind_tiles(program, self.masks, self.reaches)
        self.bind_tables(program)
        if sums is not None:
            sums.bind_to_storage_buffer(0)

    def bind_tables(self, program: moderngl.ComputeShader) -> None:
        """Tell a program of the tables, and what it draws on."""
        half = self.made_tables.half
        set_uniforms(program, half_px=half, cutoff_px=self.cutoff_px, tiles_around=-(-half // TILE))
        self.shown.bind_to_image(0, read=False, write=True)

    def bind_tiles(self, program: moderngl.ComputeShader, masks: moderngl.Buffer, reaches: moderngl.Buffer) -> None:
        """Bind what is known of tiles: which of their pixels shed light, and how far."""
        set_uniforms(program, tiles=self.tiles)
        masks.bind_to_storage_buffer(1)
        reaches.bind_to_storage_buffer(2)

    @staticmethod
    def bound(program: moderngl.ComputeShader, **textures: moderngl.Texture | moderngl.TextureArray) -> None:
        """Bind textures by the names that a program has for them."""
        for unit, (name, texture) in enumerate(textures.items()):
            texture.use(unit)
            set_uniforms(program, **{name: unit})

    def run(self, program: moderngl.ComputeShader, size: tuple[int, int]) -> None:
        """Run a program of 8 by 8 lanes over a size, and wait until others can see what it wrote."""
        program.run(-(-size[0] // 8), -(-size[1] // 8))
        self._ctx.memory_barrier()

    @property
    def made_tables(self) -> SpreadTables:
        """The tables that were made."""
        if self.tables is None:
            raise ValueError("no tables were made")
        return self.tables

    def release(self) -> None:
        """Give the memory back; it is made anew when it is needed."""
        self._held.close()
        self.size = (0, 0)
        if self.tables is not None:
            self.tables.release()
            self.tables = None


class LinearField:
    """Spreads a field whole, each time."""

    def __init__(self, spreader: FieldSpreader) -> None:
        self._spreader = spreader

    def spread(
        self, field: Field, side: float, spread: Spread, most_px: float, pulse: Pulse = UNWATCHED
    ) -> moderngl.Texture:
        """Spread a field.

        Args:
            field: what to spread.
            side: 1 in front of the focus, -1 behind it; 1 where radii are signed, above 0 in front.
            spread: how light is distributed over a circle of confusion.
            most_px: no radius is larger.
            pulse: that beats between pieces of the work.

        Returns:
            RGBA32F: the sum of weighted light, and that of weights; valid until the next one.

        Raises:
            Interrupted: the work is stale.
        """
        made = self._spreader
        made.fit(field.light.size)
        made.tabled(spread, most_px)
        made.take(field, side, made.scale(field))
        made.spread_all(pulse=pulse)
        return made.shown

    def release(self) -> None:
        """Give the memory back."""
        self._spreader.release()


class LinearBlur:
    """The engine ``linear``: both sides of the focus spread over the iris's image, and joined."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache, pulse: Pulse = UNWATCHED) -> None:
        self._ctx, self._programs, self._pulse = ctx, programs, pulse
        self._fields = tuple(LinearField(FieldSpreader(ctx, programs)) for _ in range(2))

    def blurred(self, sides: Sides, held: Held) -> moderngl.Texture:
        """As `render.postblur.sides.Blur` has it."""
        near, far = (
            made.spread(field, side, spread, sides.most_px, self._pulse)
            for made, (field, side, spread) in zip(self._fields, fields_of(sides), strict=True)
        )
        return joined(self._ctx, self._programs, sides, near, far, held)

    def release(self) -> None:
        """Give the memory back."""
        for field in self._fields:
            field.release()


def fields_of(sides: Sides) -> tuple[tuple[Field, float, Spread], tuple[Field, float, Spread]]:
    """What is in front of the focus and what is behind it, as fields, their side, and how they are spread."""
    near, far = (IrisImage(sides.iris, is_behind=behind, squeeze=sides.squeeze) for behind in (False, True))
    return (Field(sides.near, sides.radii, 0), 1.0, near), (Field(sides.far, sides.radii, 1), -1.0, far)


def joined(
    ctx: moderngl.Context,
    programs: ProgramCache,
    sides: Sides,
    near: moderngl.Texture,
    far: moderngl.Texture,
    held: Held,
) -> moderngl.Texture:
    """The picture of both sides spread."""
    program = programs.compute("postblur_join.comp")
    FieldSpreader.bound(
        program, near=near, far=far, near_wide=near, far_wide=far, far_sharp=sides.far, radii=sides.radii
    )
    set_uniforms(program, is_split=False)
    picture = held.keep(ctx.texture(sides.size, 4, dtype="f4"))
    picture.bind_to_image(0, read=False, write=True)
    program.run(-(-picture.width // 8), -(-picture.height // 8))
    ctx.memory_barrier()
    return picture
