"""Image of an iris at all levels of detail, as connections read it (``highlights/opening.glsl``)."""

from __future__ import annotations

import moderngl
import numpy as np

from render.gl.resources import Construction
from render.gl.shaders import ProgramCache, set_uniforms
from render.model.arrays import FloatArray
from render.trace.highlights.mipmaps import build_mipmaps
from render.trace.ray_buffers import Program


def iris_levels(ctx: moderngl.Context, programs: ProgramCache, image: FloatArray) -> moderngl.Texture:
    """Upload the image of an iris with mipmaps; the caller releases it.

    Args:
        ctx: context.
        programs: its programs.
        image: ``(side, side)`` transmission over the square around the disc; the texture has twice the side, dark around it.
    """
    side = len(image)
    padded = np.pad(np.asarray(image, np.float32), side // 2)
    with Construction() as making:
        texture = making.keep(ctx.texture(padded.shape, 1, padded.tobytes(), dtype="f4"))
        texture.repeat_x = texture.repeat_y = False
        build_mipmaps(ctx, programs, texture)
    return texture


def bind_iris(program: Program, levels: moderngl.Texture, image: FloatArray, unit: int) -> None:
    """Bind the texture of `iris_levels` to a program, and set the means over its light; x is right, y down."""
    side = len(image)
    line = (np.arange(side) + 0.5) / side * 2 - 1
    x, y = np.meshgrid(line, line)
    light = image / image.sum(dtype=np.float64)
    mean_x, mean_y, xx, xy, yy = (float((light * power).sum()) for power in (x, y, x * x, x * y, y * y))
    levels.use(unit)
    set_uniforms(program, iris_levels=unit, iris_mean=(mean_x, mean_y), iris_squares=(xx, xy, yy))
