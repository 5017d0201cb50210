"""FLAG: a blur of any convex shape in time linear in its radius (Moersch & Hamilton 2014, "Variable-Sized, Circular Bokeh Depth
of Field Effects").

Beyond the paper: fields in front of and behind the focus are blurred apart, which takes away the hard edges of its foregrounds
and the halos around its backgrounds; shapes need not be symmetric; rows are looked through by stretches whose largest radius is
known (its future work, by squares); and the picture is worked on in bands of rows, so that memory has a bound whatever its size.
"""

from __future__ import annotations

from dataclasses import dataclass

import moderngl
import numpy as np

from render.gl.held import Held, Making
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.blur_shape import AREA_STEPS, COLUMNS, BlurShape

BAND_BYTES = 96 << 20
"""Memory of the piles of a band, at most, unless a single row needs more."""
_TILE = 16
_LEAST_PX = 0.25  # what is sharper is a pixel


@dataclass(frozen=True)
class Field:
    """One side of the focus.

    Attributes:
        light: RGBA32F, premultiplied.
        radii: RG32F in pixels: in front of the focus, and behind it.
        channel: of the radii that are this field's.
    """

    light: moderngl.Texture
    radii: moderngl.Texture
    channel: int


def band_rows(width: int, most_px: int, *, two_sided: bool) -> int:
    """Rows of the picture that are finished at once; the piles of as many, and of those that reach them, are held.

    Args:
        width: of the picture in pixels.
        most_px: largest radius.
        two_sided: whether the shape is not symmetric, which takes two piles.
    """
    slices = (most_px + 2) * (2 if two_sided else 1)
    held = BAND_BYTES // (width * slices * 16)
    return int(max(8, held - 2 * (most_px + 1)))


class Flag:
    """Blurs fields, with the programs of one context."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs

    def widest(self, radii: moderngl.Texture) -> moderngl.Texture:
        """The largest radii of stretches of rows; to be given back."""
        width, height = radii.size
        made = self._ctx.texture((-(-width // _TILE), height), 2, dtype="f4")
        program = self._programs.compute("flag_widest.comp", {"TILE": _TILE})
        radii.use(0)
        set_uniforms(program, radii=0)
        made.bind_to_image(0, read=False, write=True)
        program.run(-(-made.width // 8), -(-height // 8))
        self._ctx.memory_barrier()
        return made

    def reduced(self, field: Field, shrink: int, split_px: float) -> Field:
        """A field's light that is spread wide, at less resolution; its textures are to be given back.

        Args:
            field: of the picture.
            shrink: pixels to one of the new field's, along each axis.
            split_px: the radius from which on all light is; none is from half of it down.
        """
        width, height = (-(-side // shrink) for side in field.light.size)
        with Making() as making:
            light = making.keep(self._ctx.texture((width, height), 4, dtype="f4"))
            radii = making.keep(self._ctx.texture((width, height), 2, dtype="f4"))
        program = self._programs.compute("flag_reduce.comp")
        field.light.use(0)
        field.radii.use(1)
        set_uniforms(program, light=0, radii=1, channel=field.channel, shrink=shrink, split_px=split_px)
        light.bind_to_image(0, read=False, write=True)
        radii.bind_to_image(1, read=False, write=True)
        program.run(-(-width // 8), -(-height // 8))
        self._ctx.memory_barrier()
        return Field(light, radii, 0)

    def blur(
        self, field: Field, shape: BlurShape, most_px: float, target: moderngl.Texture, *, split_px: float = 0.0
    ) -> None:
        """Blur a field: each of its points is spread evenly over its circle of confusion, and loses nothing.

        Args:
            field: what to blur.
            shape: of the blur.
            most_px: no radius of the field is larger.
            target: RGBA32F as large as the field: its light, and how much there is of it.
            split_px: leave out what `reduced` has; 0 for nothing.
        """
        width, height = field.light.size
        most = int(np.ceil(most_px)) + 1
        two_sided = not shape.is_symmetric
        band = min(band_rows(width, most, two_sided=two_sided), height)
        held_rows = min(band + 2 * most, height)
        slices = (most + 1) * (2 if two_sided else 1)
        with Held() as held:
            widest = held.keep(self.widest(field.radii))
            piles = held.keep(self._ctx.texture_array((width, held_rows, slices), 4, dtype="f4"))
            heights = held.keep(self._ctx.texture((width, held_rows), 1, dtype="f4"))
            outline, area = held.keep(self._table(shape.edges)), held.keep(self._table(shape.areas(most)[:, None]))
            rows, columns = self._made(most, two_sided)
            for unit, texture in enumerate((field.light, field.radii, widest, outline, area, heights)):
                texture.use(unit)
            piles.use(6)
            set_uniforms(rows, light=0, radii=1, widest=2, outline=3, area=4, channel=field.channel, most=most)
            set_uniforms(rows, split_px=split_px)
            set_uniforms(columns, piles=6, heights=5, most=most)
            for first in range(0, height, band):
                low, high = max(first - most, 0), min(first + band + most, height)
                set_uniforms(rows, first_row=low, rows=high - low)
                piles.bind_to_image(0, read=True, write=True)
                heights.bind_to_image(1, read=False, write=True)
                rows.run(-(-width // 32), -(-(high - low) // 2))
                self._ctx.memory_barrier()
                wanted = min(band, height - first)
                set_uniforms(columns, first_row=low, rows=high - low, first_wanted=first, wanted=wanted)
                target.bind_to_image(0, read=False, write=True)
                columns.run(-(-width // 32), -(-wanted // 2))
                self._ctx.memory_barrier()

    def _made(self, most: int, two_sided: bool) -> tuple[moderngl.ComputeShader, moderngl.ComputeShader]:
        sided: dict[str, int | float | str] = {"TWO_SIDED": 1} if two_sided else {}
        inset = (COLUMNS - 1) / COLUMNS
        defines: dict[str, int | float | str] = {
            "TILE": _TILE,
            "LEAST": _LEAST_PX,
            "AREA_STEPS": f"{AREA_STEPS}.0",
            "OUTLINE_INSET": f"{inset:.9f}",
            "OUTLINE_EDGE": f"{(1 - inset) / 2:.9f}",
        }
        return self._programs.compute("flag_rows.comp", defines | sided), self._programs.compute(
            "flag_columns.comp", sided
        )

    def _table(self, values: np.ndarray[tuple[int, ...], np.dtype[np.float32]]) -> moderngl.Texture:
        texture = self._ctx.texture(
            (len(values), 1), values.shape[1], np.ascontiguousarray(values).tobytes(), dtype="f4"
        )
        texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        texture.repeat_x = texture.repeat_y = False
        return texture
