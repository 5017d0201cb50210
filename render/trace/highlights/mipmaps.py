"""Mipmaps of textures of floats, by a compute shader.

The driver's own (``glGenerateMipmap``) are not used: where a side is odd, drivers average in different ways, and Mesa's
software rasteriser compiles its shader anew in each process, which takes 0.1 s.
"""

from __future__ import annotations

import moderngl

from render.gl.compat import GL
from render.gl.shaders import ProgramCache

_FINER, _COARSER = 0, 1  # as the shader binds them
_GROUP = 8
_TRILINEAR = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
_FORMATS = {1: ("GL_R32F", "GL_RED"), 2: ("GL_RG32F", "GL_RG")}


def build_mipmaps(ctx: moderngl.Context, programs: ProgramCache, texture: moderngl.Texture) -> None:
    """Fill the levels of a texture of one or two 32-bit floats with means of its pixels, and filter it trilinearly.

    Args:
        ctx: context.
        programs: its programs.
        texture: level 0 is filled, and a memory barrier has followed what images stored there.
    """
    sizes = _level_sizes(texture.width, texture.height)
    internal, layout = (getattr(GL, name) for name in _FORMATS[texture.components])
    texture.use(ctx.default_texture_unit)  # as moderngl does: other units keep their textures
    for level, (width, height) in enumerate(sizes[1:], 1):
        GL.glTexImage2D(GL.GL_TEXTURE_2D, level, internal, width, height, 0, layout, GL.GL_FLOAT, None)
    texture.filter = _TRILINEAR
    program = programs.compute("highlights/halve.comp", {"ONE_CHANNEL": 1} if texture.components == 1 else {})
    for level, (width, height) in enumerate(sizes[1:], 1):
        texture.bind_to_image(_FINER, read=True, write=False, level=level - 1)
        texture.bind_to_image(_COARSER, read=False, write=True, level=level)
        program.run(-(-width // _GROUP), -(-height // _GROUP))
        ctx.memory_barrier()


def _level_sizes(width: int, height: int) -> list[tuple[int, int]]:
    """Sizes of all levels, from the texture's own to one pixel."""
    sizes = [(width, height)]
    while sizes[-1] != (1, 1):
        width, height = sizes[-1]
        sizes.append((max(width // 2, 1), max(height // 2, 1)))
    return sizes
