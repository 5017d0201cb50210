"""Per-pixel scatter weights: the first step of every blur that spreads light evenly over the circle of confusion."""

from __future__ import annotations

from dataclasses import dataclass

import moderngl
import numpy as np

from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.model.arrays import FloatArray
from render.postblur.blur_shape import AREA_STEPS, COLUMNS, BlurShape

LEAST_PX = 0.25
"""Radius below which a pixel is drawn sharp, pixels."""
OUTLINE_DEFINES = {"OUTLINE_INSET": f"{(COLUMNS - 1) / COLUMNS:.9f}", "OUTLINE_EDGE": f"{0.5 / COLUMNS:.9f}"}
"""Defines of ``layers/outline.glsl``: columns from -1 to 1 lie between the middles of its first and its last texel."""


@dataclass(frozen=True)
class Window:
    """Which light is meant, by its radius in pixels: of what is between the bounds of a pair, a share.

    Attributes:
        rise: none is to the first, all is from the second on.
        fall: all is to the first, none is from the second on.
    """

    rise: tuple[float, float] = (-2.0, -1.0)
    fall: tuple[float, float] = (1e9, 2e9)

    def set_on(self, program: moderngl.ComputeShader) -> None:
        """Tell a program that has ``flag/flag_window.glsl``."""
        set_uniforms(program, rise=self.rise, fall=self.fall)


EVERYTHING = Window()


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


@dataclass(frozen=True)
class Shed:
    """Light that each pixel scatters. The textures are valid until they are released.

    Attributes:
        light: RGBA32F, light on each covered pixel.
        reach: R32F, radius in pixels, 0 where a pixel scatters nothing.
        outline: extent of the blur shape up and down, over columns from -1 to 1.
    """

    light: moderngl.Texture
    reach: moderngl.Texture
    outline: moderngl.Texture


class Shedder:
    """Finds what points shed, with the programs of one context."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs

    def shed(self, field: Field, shape: BlurShape, most_px: float, window: Window, held: Resources) -> Shed:
        """Compute the light that a field's pixels scatter.

        Args:
            field: near or far field of the picture.
            shape: blur shape.
            most_px: no radius in the window is larger.
            window: range of radii that is included.
            held: scope that owns the textures.
        """
        size = field.light.size
        light = held.keep(self._ctx.texture(size, 4, dtype="f4"))
        reach = held.keep(self._ctx.texture(size, 1, dtype="f4"))
        outline = held.keep(self._table(shape.edges))
        area = held.keep(self._table(shape.areas(most_px)[:, None]))
        program = self._programs.compute("flag/flag_shed.comp", {"LEAST": LEAST_PX, "AREA_STEPS": f"{AREA_STEPS}.0"})
        for unit, texture in enumerate((field.light, field.radii, area)):
            texture.use(unit)
        set_uniforms(program, light=0, radii=1, area=2, channel=field.channel)
        window.set_on(program)
        light.bind_to_image(0, read=False, write=True)
        reach.bind_to_image(1, read=False, write=True)
        program.run(-(-size[0] // 8), -(-size[1] // 8))
        self._ctx.memory_barrier()
        return Shed(light, reach, outline)

    def _table(self, values: FloatArray) -> moderngl.Texture:
        data = np.ascontiguousarray(values).tobytes()
        texture = self._ctx.texture((len(values), 1), values.shape[1], data, dtype="f4")
        texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        texture.repeat_x = texture.repeat_y = False
        return texture
