"""Spread of each pixel's light over its circle of confusion: the first pass of the blurs that spread light evenly."""

from __future__ import annotations

from dataclasses import dataclass

import moderngl
import numpy as np

from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.model.arrays import FloatArray
from render.postblur.blur_shape import COLUMNS, BlurShape

LEAST_PX = 0.25
"""Radius below which a pixel is drawn sharp, pixels."""
OUTLINE_DEFINES = {"OUTLINE_INSET": f"{(COLUMNS - 1) / COLUMNS:.9f}", "OUTLINE_EDGE": f"{0.5 / COLUMNS:.9f}"}
"""Defines of ``layers/outline.glsl``: its columns lie between the middles of its first and its last texel."""


@dataclass(frozen=True)
class RadiusWindow:
    """Range of radii in pixels, with soft bounds: a smooth step between the two numbers of a pair.

    Attributes:
        rise: no light up to the first radius, all of it from the second on.
        fall: all light up to the first radius, none from the second on.
    """

    rise: tuple[float, float] = (-2.0, -1.0)
    fall: tuple[float, float] = (1e9, 2e9)

    def set_uniforms(self, program: moderngl.ComputeShader) -> None:
        """Set the uniforms of ``flag/radius_window.glsl``."""
        set_uniforms(program, rise=self.rise, fall=self.fall)


ALL_RADII = RadiusWindow()


@dataclass(frozen=True)
class Field:
    """Near or far field of a picture.

    Attributes:
        light: RGBA32F, premultiplied.
        radii: RG32F: radii of circles of confusion in pixels, of the near and of the far field.
        channel: channel of ``radii`` that belongs to this field.
    """

    light: moderngl.Texture
    radii: moderngl.Texture
    channel: int


@dataclass(frozen=True)
class PointSpread:
    """Light that each pixel spreads over its circle of confusion. The textures are valid until they are released.

    Attributes:
        intensity: RGBA32F, light that each covered pixel gets.
        radii: R32F, radius in pixels, 0 where a pixel has no light in the window.
        outline: extent of the blur shape up and down, over columns from its left to its right end.
    """

    intensity: moderngl.Texture
    radii: moderngl.Texture
    outline: moderngl.Texture


class PointSpreadPass:
    """Computes point spreads, with the programs of one context."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs

    def run(self, field: Field, shape: BlurShape, window: RadiusWindow, scope: Resources) -> PointSpread:
        """Divide each pixel's light by the area of its circle of confusion (Moersch & Hamilton 2014, section 3.2.2).

        Args:
            field: near or far field of the picture.
            shape: blur shape.
            window: range of radii that is included.
            scope: scope that owns the textures.
        """
        size = field.light.size
        intensity = scope.keep(self._ctx.texture(size, 4, dtype="f4"))
        radii = scope.keep(self._ctx.texture(size, 1, dtype="f4"))
        outline = scope.keep(self._table(shape.edges))
        program = self._programs.compute("flag/point_spread.comp", {"LEAST": LEAST_PX, **OUTLINE_DEFINES})
        for unit, texture in enumerate((field.light, field.radii, outline)):
            texture.use(unit)
        set_uniforms(program, light=0, radii=1, outline=2, channel=field.channel)
        shape.set_uniforms(program)
        window.set_uniforms(program)
        intensity.bind_to_image(0, read=False, write=True)
        radii.bind_to_image(1, read=False, write=True)
        program.run(-(-size[0] // 8), -(-size[1] // 8))
        self._ctx.memory_barrier()
        return PointSpread(intensity, radii, outline)

    def _table(self, values: FloatArray) -> moderngl.Texture:
        data = np.ascontiguousarray(values).tobytes()
        texture = self._ctx.texture((len(values), 1), values.shape[1], data, dtype="f4")
        texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        texture.repeat_x = texture.repeat_y = False
        return texture
