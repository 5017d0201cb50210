"""FLAG: a blur of any convex shape in time linear in its radius (Moersch & Hamilton 2014, "Variable-Sized, Circular Bokeh Depth
of Field Effects").

Beyond the paper: fields in front of and behind the focus are blurred apart, which takes away the hard edges of its foregrounds
and the halos around its backgrounds; shapes need not be symmetric; rows are looked through by stretches whose largest radius is
known (its future work, by squares); and no more rows are held than reach those that are finished next, so that memory has a bound
whatever the picture's size.
"""

from __future__ import annotations

from dataclasses import dataclass

import moderngl
import numpy as np

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint
from render.gl.resources import Construction, Resources
from render.gl.shaders import Defines, ProgramCache, set_uniforms
from render.postblur.blur_shape import BlurShape
from render.postblur.shed import EVERYTHING, OUTLINE_DEFINES, Field, Shedder, Window

BAND_BYTES = 64 << 20
"""Memory of the piles that are held, at most, unless fewest rows need more."""
PILE_BYTES = 16
"""Bytes of one texel of the FLAG array."""
CANCELLABLE_ROWS = 64
"""Rows blurred between two cancellation points."""
_TILE = 16
_HEIGHT_BYTES, _SHED_BYTES = 4, 20  # of a pile's height; of what a pixel sheds, and how far


@dataclass(frozen=True)
class Ring:
    """The rows whose piles are held: a picture is finished some rows at a time, each when the rows that reach it are there.

    Attributes:
        new: rows that are finished at once.
        ahead: rows that must be held on either side of those.
        slices: of a pile.
    """

    new: int
    ahead: int
    slices: int

    @classmethod
    def of(cls, size: tuple[int, int], most: int, *, two_sided: bool, is_cancellable: bool = False) -> Ring:
        """For a picture.

        Args:
            size: its width and height in pixels.
            most: rows that anything reaches up or down, at most.
            two_sided: whether the shape is not symmetric, which takes two piles.
            is_cancellable: whether somebody may call the work off.
        """
        slices = (most + 1) * (2 if two_sided else 1)
        ahead = _TILE * -(-most // _TILE)
        fitting = BAND_BYTES // (size[0] * slices * PILE_BYTES) - 2 * ahead
        wanted = min(size[1], CANCELLABLE_ROWS) if is_cancellable else size[1]
        return cls(_TILE * max(1, min(fitting, wanted + _TILE - 1) // _TILE), ahead, slices)

    @property
    def rows(self) -> int:
        """Rows held."""
        return self.new + 2 * self.ahead


def held_bytes(size: tuple[int, int], most_px: float, *, two_sided: bool) -> int:
    """Memory that a blur holds while it works: the piles of some rows, and what each pixel sheds.

    Args:
        size: width and height of the picture in pixels.
        most_px: largest radius.
        two_sided: whether the shape is not symmetric.
    """
    ring = Ring.of(size, int(np.ceil(most_px)) + 1, two_sided=two_sided)
    return size[0] * ring.rows * (ring.slices * PILE_BYTES + _HEIGHT_BYTES) + size[0] * size[1] * _SHED_BYTES


class Flag:
    """Blurs fields, with the programs of one context."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx, self._programs, self._cancellation = ctx, programs, cancellation
        self._shedder = Shedder(ctx, programs)

    def reduced(self, field: Field, shrink: int, window: Window) -> Field:
        """Some of a field's light at less resolution; its textures are to be given back.

        Args:
            field: of the picture.
            shrink: pixels to one of the new field's, along each axis.
            window: the light that is meant.
        """
        width, height = (-(-side // shrink) for side in field.light.size)
        with Construction() as making:
            light = making.keep(self._ctx.texture((width, height), 4, dtype="f4"))
            radii = making.keep(self._ctx.texture((width, height), 2, dtype="f4"))
        program = self._programs.compute("flag/flag_reduce.comp")
        field.light.use(0)
        field.radii.use(1)
        set_uniforms(program, light=0, radii=1, channel=field.channel, shrink=shrink)
        window.set_on(program)
        light.bind_to_image(0, read=False, write=True)
        radii.bind_to_image(1, read=False, write=True)
        program.run(-(-width // 8), -(-height // 8))
        self._ctx.memory_barrier()
        return Field(light, radii, 0)

    def blur(
        self, field: Field, shape: BlurShape, most_px: float, target: moderngl.Texture, window: Window = EVERYTHING
    ) -> None:
        """Blur a field: each of its points is spread evenly over its circle of confusion, and loses nothing.

        Args:
            field: what to blur.
            shape: of the blur.
            most_px: no radius in the window is larger.
            target: RGBA32F as large as the field: its light, and how much there is of it.
            window: the light that is meant.
        """
        width, height = field.light.size
        most = int(np.ceil(most_px)) + 1
        two_sided = not shape.is_symmetric
        ring = Ring.of((width, height), most, two_sided=two_sided, is_cancellable=self._cancellation.is_cancellable)
        rows, columns = self._made(two_sided)
        with Resources() as held:
            shed = self._shedder.shed(field, shape, most, window, held)
            widest = self._widest(shed.reach, (1, 0), held)
            piles = held.keep(self._ctx.texture_array((width, ring.rows, ring.slices), 4, dtype="f4"))
            heights = held.keep(self._ctx.texture((width, ring.rows), 1, dtype="f4"))
            there = 0
            for first in range(0, height, ring.new):
                wanted = first + ring.new + ring.ahead
                for unit, texture in enumerate((shed.light, shed.reach, widest, shed.outline)):
                    texture.use(unit)
                set_uniforms(rows, shed=0, reach=1, widest=2, outline=3, most=most, ring=ring.rows)
                set_uniforms(rows, first_row=there, rows=wanted - there)
                piles.bind_to_image(0, read=True, write=True)
                heights.bind_to_image(1, read=False, write=True)
                rows.run(-(-width // 32), -(-(wanted - there) // 2))
                self._ctx.memory_barrier()
                self._cancellation.poll()
                there = wanted
                with Resources() as passing:
                    tallest = self._widest(heights, (0, 1), passing)
                    for unit, table in enumerate((heights, tallest)):
                        table.use(unit)
                    piles.use(2)
                    set_uniforms(columns, heights=0, tallest=1, piles=2, most=most, ring=ring.rows)
                    set_uniforms(columns, first_row=first, rows=ring.new)
                    target.bind_to_image(0, read=False, write=True)
                    columns.run(-(-width // 32), -(-ring.new // 2))
                    self._ctx.memory_barrier()
                    self._cancellation.poll()

    def _widest(self, values: moderngl.Texture, along: tuple[int, int], held: Resources) -> moderngl.Texture:
        """The largest values of stretches of rows or of columns."""
        size = [-(-side // _TILE) if step else side for side, step in zip(values.size, along, strict=True)]
        made = held.keep(self._ctx.texture((size[0], size[1]), 1, dtype="f4"))
        program = self._programs.compute("flag/flag_widest.comp", {"TILE": _TILE})
        values.use(0)
        set_uniforms(program, values=0, along=along)
        made.bind_to_image(0, read=False, write=True)
        program.run(-(-size[0] // 8), -(-size[1] // 8))
        self._ctx.memory_barrier()
        return made

    def _made(self, two_sided: bool) -> tuple[moderngl.ComputeShader, moderngl.ComputeShader]:
        defines: Defines = {"TILE": _TILE} | OUTLINE_DEFINES | ({"TWO_SIDED": 1} if two_sided else {})
        return self._programs.compute("flag/flag_rows.comp", defines), self._programs.compute(
            "flag/flag_columns.comp", defines
        )
