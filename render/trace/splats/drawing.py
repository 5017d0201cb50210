"""Draws splats far to near: one quad for each, blended over what is behind it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import moderngl
import numpy as np

from render.errors import GraphicsError
from render.gl.compat import GL
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.splats import ProjectedSplats

_RECORDS = 0  # as the shader binds them
_SPLATS_AT_ONCE = 1 << 19
"""Splats of one buffer: 24 MiB, which every device takes."""


class SplatQuads:
    """Draws ranges of projected splats into what is bound. The splats that were drawn last stay on the device.

    Args:
        ctx: context of the device.
        programs: its programs.
        fragment: fragment shader behind ``splats/splat.vert``.
        defines: of both.
    """

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, fragment: str, defines: dict[str, int | float | str]
    ) -> None:
        self._ctx = ctx
        self._program = programs.drawing("splats/splat.vert", fragment, defines)
        self._quad = ctx.vertex_array(self._program, [])
        self._uploaded: tuple[ProjectedSplats, int, moderngl.Buffer] | None = None

    def draw(
        self,
        splats: ProjectedSplats,
        rows: tuple[int, int],
        size: tuple[int, int],
        textures: dict[str, moderngl.Texture],
        **uniforms: object,
    ) -> None:
        """Draw some splats.

        Args:
            splats: splats in a view.
            rows: first of them that is drawn, and one past the last.
            size: of what they are drawn into, pixels.
            textures: textures that the shader reads, by name.
            uniforms: other uniforms of the shader.
        """
        for unit, (name, texture) in enumerate(textures.items()):
            texture.use(unit)
            set_uniforms(self._program, **{name: unit})
        set_uniforms(self._program, target_px=tuple(map(float, size)), last_row=len(splats.w) - 1, **uniforms)
        first, last = rows
        while first < last:
            begin = first - first % _SPLATS_AT_ONCE
            stop = min(last, begin + _SPLATS_AT_ONCE)
            self._upload(splats, begin).bind_to_storage_buffer(_RECORDS)
            set_uniforms(self._program, first=first - begin, begin=begin)
            self._quad.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=stop - first)
            first = stop

    def release(self) -> None:
        """Release the memory."""
        if self._uploaded is not None:
            self._uploaded[2].release()
            self._uploaded = None
        self._quad.release()

    def _upload(self, splats: ProjectedSplats, begin: int) -> moderngl.Buffer:
        """Buffer of the splats from ``begin`` on."""
        if self._uploaded is not None:
            if self._uploaded[0] is splats and self._uploaded[1] == begin:
                return self._uploaded[2]
            self._uploaded[2].release()
            self._uploaded = None
        buffer = self._ctx.buffer(np.ascontiguousarray(splats.records[begin : begin + _SPLATS_AT_ONCE]).tobytes())
        self._uploaded = splats, begin, buffer
        return buffer


class SplatDrawer:
    """Draws ranges of projected splats into slices of texture arrays.

    Args:
        ctx: context of the device.
        programs: its programs.
        defines: of ``splats/splat.frag``.
    """

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache, defines: dict[str, int | float | str]) -> None:
        self._ctx, self._framebuffer = ctx, int(GL.glGenFramebuffers(1))
        self._quads = SplatQuads(ctx, programs, "splats/splat.frag", defines)

    @contextmanager
    def drawing(self) -> Iterator[None]:
        """Set the device up for `draw`."""
        try:
            GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._framebuffer)
            GL.glColorMask(True, True, True, True)
            self._ctx.enable_only(moderngl.BLEND)
            self._ctx.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
            yield
        finally:
            GL.glFramebufferTextureLayer(GL.GL_FRAMEBUFFER, GL.GL_COLOR_ATTACHMENT0, 0, 0, 0)
            self._ctx.enable_only(moderngl.NOTHING)
            GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)
            self._ctx.memory_barrier()

    def draw(
        self,
        splats: ProjectedSplats,
        rows: tuple[int, int],
        target: moderngl.TextureArray,
        number: int,
        textures: dict[str, moderngl.Texture],
        **uniforms: object,
    ) -> None:
        """Clear a slice and draw some splats into it. Only within `drawing`.

        Args:
            splats: splats in a view.
            rows: first of them that is drawn, and one past the last.
            target: texture array.
            number: its slice.
            textures: textures that the shader reads, by name.
            uniforms: other uniforms of the shader.
        """
        GL.glFramebufferTextureLayer(GL.GL_FRAMEBUFFER, GL.GL_COLOR_ATTACHMENT0, target.glo, 0, number)
        status = GL.glCheckFramebufferStatus(GL.GL_FRAMEBUFFER)
        if status != GL.GL_FRAMEBUFFER_COMPLETE:
            raise GraphicsError(f"the device refuses the framebuffer of splats (status {status:#x})")
        width, height, _ = target.size
        GL.glViewport(0, 0, width, height)
        GL.glClearBufferfv(GL.GL_COLOR, 0, np.zeros(4, np.float32))
        self._quads.draw(splats, rows, (width, height), textures, **uniforms)

    def release(self) -> None:
        """Release the memory."""
        self._quads.release()
        GL.glDeleteFramebuffers(1, [self._framebuffer])
