"""Framebuffers for the layers: made once for a size, and made again when the size changes."""

from __future__ import annotations

from dataclasses import dataclass

import moderngl
import numpy as np

from render.errors import GraphicsError, SettingsError
from render.gl.compat import GL
from render.layers.limits import MAX_LAYERS

MAX_LAYER_PIXELS = 80_000_000
"""Some 110 bytes each, all layers together: nine gigabytes."""
_NEAREST = (moderngl.NEAREST, moderngl.NEAREST)


@dataclass(frozen=True)
class LayerTargets:
    """Textures that the layers of one size are drawn into.

    Attributes:
        width: pixels.
        height: pixels.
        radiance: ``MAX_LAYERS`` slices of RGBA16F.
        w: one R32F texture a layer: inverse depth, 0 where empty, negative where partly transparent.
        ids: one RG32UI texture a layer: object number + 1 (0 where empty) and triangle.
        packed_w: RGBA32F, the four layers' inverse depths.
        background: RGBA16F, what a ray sees that meets no surface.
        framebuffers: OpenGL names, one a layer.
        depth: OpenGL name of the depth renderbuffer that they share.
    """

    width: int
    height: int
    radiance: moderngl.TextureArray
    w: tuple[moderngl.Texture, ...]
    ids: tuple[moderngl.Texture, ...]
    packed_w: moderngl.Texture
    background: moderngl.Texture
    framebuffers: tuple[int, ...]
    depth: int

    @classmethod
    def make(cls, ctx: moderngl.Context, width: int, height: int) -> LayerTargets:
        """Allocate everything for layers of ``width`` by ``height``.

        Raises:
            GraphicsError: the device refuses the size.
        """
        size = (width, height)
        try:
            radiance = ctx.texture_array((*size, MAX_LAYERS), 4, dtype="f2")
            w = tuple(ctx.texture(size, 1, dtype="f4") for _ in range(MAX_LAYERS))
            ids = tuple(ctx.texture(size, 2, dtype="u4") for _ in range(MAX_LAYERS))
            packed_w = ctx.texture(size, 4, dtype="f4")
            background = ctx.texture(size, 4, dtype="f2")
        except moderngl.Error as error:
            raise GraphicsError(f"the device cannot hold {MAX_LAYERS} layers of {width}x{height}: {error}") from error
        radiance.filter = _NEAREST
        for texture in (*w, *ids, packed_w, background):
            texture.filter = _NEAREST
        depth = GL.glGenRenderbuffers(1)
        GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, depth)
        GL.glRenderbufferStorage(GL.GL_RENDERBUFFER, GL.GL_DEPTH_COMPONENT32F, width, height)
        framebuffers = tuple(_framebuffer(radiance, w[i], ids[i], i, depth) for i in range(MAX_LAYERS))
        return cls(width, height, radiance, w, ids, packed_w, background, framebuffers, depth)

    def clear(self, layer: int) -> None:
        """Bind a layer's framebuffer and empty it."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self.framebuffers[layer])
        zero = np.zeros(4, np.float32)
        GL.glColorMask(True, True, True, True)
        GL.glDepthMask(True)
        GL.glClearBufferfv(GL.GL_COLOR, 0, zero)
        GL.glClearBufferfv(GL.GL_COLOR, 1, zero)
        GL.glClearBufferuiv(GL.GL_COLOR, 2, np.zeros(4, np.uint32))
        GL.glClearBufferfv(GL.GL_DEPTH, 0, zero)

    def release(self) -> None:
        """Give the memory back."""
        self.radiance.release()
        for texture in (*self.w, *self.ids, self.packed_w, self.background):
            texture.release()
        GL.glDeleteFramebuffers(len(self.framebuffers), list(self.framebuffers))
        GL.glDeleteRenderbuffers(1, [self.depth])


def check_layer_size(ctx: moderngl.Context, width: int, height: int) -> None:
    """Raise `SettingsError` where layers of this size are more than the device, or a sensible amount of memory, can hold."""
    side = int(ctx.info["GL_MAX_TEXTURE_SIZE"])
    if max(width, height) > side or width * height > MAX_LAYER_PIXELS:
        raise SettingsError(
            f"the picture's layers would have {width}x{height} pixels, supersampled and with their margin; at most {side} on a "
            f"side and {MAX_LAYER_PIXELS // 1_000_000} million in all can be held: ask for a smaller picture or supersample less"
        )


def _framebuffer(
    radiance: moderngl.TextureArray, w: moderngl.Texture, ids: moderngl.Texture, layer: int, depth: int
) -> int:
    name: int = GL.glGenFramebuffers(1)
    GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, name)
    GL.glFramebufferTextureLayer(GL.GL_FRAMEBUFFER, GL.GL_COLOR_ATTACHMENT0, radiance.glo, 0, layer)
    GL.glFramebufferTexture2D(GL.GL_FRAMEBUFFER, GL.GL_COLOR_ATTACHMENT1, GL.GL_TEXTURE_2D, w.glo, 0)
    GL.glFramebufferTexture2D(GL.GL_FRAMEBUFFER, GL.GL_COLOR_ATTACHMENT2, GL.GL_TEXTURE_2D, ids.glo, 0)
    GL.glFramebufferRenderbuffer(GL.GL_FRAMEBUFFER, GL.GL_DEPTH_ATTACHMENT, GL.GL_RENDERBUFFER, depth)
    GL.glDrawBuffers(3, [GL.GL_COLOR_ATTACHMENT0, GL.GL_COLOR_ATTACHMENT1, GL.GL_COLOR_ATTACHMENT2])
    status = GL.glCheckFramebufferStatus(GL.GL_FRAMEBUFFER)
    if status != GL.GL_FRAMEBUFFER_COMPLETE:
        raise GraphicsError(f"the device refuses the layers' framebuffer (status {status:#x})")
    return name
