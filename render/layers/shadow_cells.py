"""Least, greatest and mean depths of shadow maps over squares of 2, 4, 8 ... texels, for the shadows of lights with a size.

Guennebaud, Barthe & Paulin 2006, "Real-time soft shadow mapping by backprojection", section 4.2.
"""

from __future__ import annotations

import moderngl

from render.gl.compat import GL
from render.gl.resources import Construction
from render.gl.shaders import ProgramCache, set_uniforms

DEPTHS_UNIT, CELLS_UNIT = 12, 13
"""Texture units as ``layers/soft_shadow.glsl`` binds them."""
_COARSER, _FINER = 0, 1  # image units
_GROUP = 8


class ShadowCells:
    """Cells of an array of maps, and the maps as plain depths.

    Args:
        ctx: context.
        programs: its programs.
        maps: OpenGL name of the array, in immutable storage.
        side_px: side of a map, a power of two.
        layers: number of maps.
    """

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache, maps: int, side_px: int, layers: int) -> None:
        self._ctx, self._programs = ctx, programs
        self._sides = [side_px >> level for level in range(1, side_px.bit_length())]
        with Construction() as making:
            self._depths = int(GL.glGenTextures(1))
            making.callback(GL.glDeleteTextures, [self._depths])
            GL.glTextureView(self._depths, GL.GL_TEXTURE_2D_ARRAY, maps, GL.GL_DEPTH_COMPONENT32F, 0, 1, 0, layers)
            GL.glBindTexture(GL.GL_TEXTURE_2D_ARRAY, self._depths)
            for parameter, value in (
                (GL.GL_TEXTURE_MIN_FILTER, GL.GL_NEAREST),
                (GL.GL_TEXTURE_MAG_FILTER, GL.GL_NEAREST),
                (GL.GL_TEXTURE_WRAP_S, GL.GL_CLAMP_TO_EDGE),
                (GL.GL_TEXTURE_WRAP_T, GL.GL_CLAMP_TO_EDGE),
            ):
                GL.glTexParameteri(GL.GL_TEXTURE_2D_ARRAY, parameter, value)
            GL.glBindTexture(GL.GL_TEXTURE_2D_ARRAY, 0)
            self._cells = making.keep(ctx.texture_array((self._sides[0], self._sides[0], layers), 4, dtype="f4"))
            self._cells.use(ctx.default_texture_unit)
            for level, side in enumerate(self._sides[1:], 1):
                size = (side, side, layers)
                GL.glTexImage3D(GL.GL_TEXTURE_2D_ARRAY, level, GL.GL_RGBA32F, *size, 0, GL.GL_RGBA, GL.GL_FLOAT, None)
            self._cells.filter = moderngl.NEAREST_MIPMAP_NEAREST, moderngl.NEAREST

    def bind(self) -> None:
        """Bind the plain depths and the cells to their texture units."""
        GL.glActiveTexture(GL.GL_TEXTURE0 + DEPTHS_UNIT)
        GL.glBindTexture(GL.GL_TEXTURE_2D_ARRAY, self._depths)
        self._cells.use(CELLS_UNIT)

    def build(self, layer: int) -> None:
        """Build the cells of one map."""
        GL.glActiveTexture(GL.GL_TEXTURE0)
        GL.glBindTexture(GL.GL_TEXTURE_2D_ARRAY, self._depths)
        for level, side in enumerate(self._sides):
            program = self._programs.compute("layers/shadow_cells.comp", {} if level else {"FIRST": 1})
            set_uniforms(program, map=layer)
            self._cells.bind_to_image(_COARSER, read=False, write=True, level=level)
            if level:
                self._cells.bind_to_image(_FINER, read=True, write=False, level=level - 1)
            groups = -(-side // _GROUP)
            program.run(groups, groups)
            self._ctx.memory_barrier()

    def release(self) -> None:
        """Release the memory on the device."""
        GL.glDeleteTextures([self._depths])
        self._cells.release()
