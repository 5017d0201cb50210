"""Render targets for layers and surfaces, allocated per size and reallocated when the size changes.

The inverse depths of four layers share one texture, a channel each, since the tracer tests four layers at once (Lee, Eisemann
& Seidel 2010, section 3.1, "Multi-Layer Packing"). Each layer is drawn into its channel under a colour mask; since a layer
reads the channel of the one before it, its depths are drawn into a framebuffer without colour. The slope of inverse depth
over a pixel is packed in the same way.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import moderngl
import numpy as np

from render.errors import GraphicsError, SettingsError
from render.gl.compat import GL
from render.gl.resources import Construction

LAYERS_PER_PACK = 4
MOST_RADIANCE = 65000.0
"""Limit on radiance, which layers hold in half precision."""
MAX_LAYER_PIXELS = 80_000_000
"""Limit on a layer's pixels. Eight lit layers take some 150 bytes a pixel: twelve gigabytes; with motion, nearly twice that."""
_NEAREST = (moderngl.NEAREST, moderngl.NEAREST)

Attachment = moderngl.Texture | tuple[moderngl.TextureArray, int] | None
"""Attachment of a framebuffer: a texture, a slice of one, or none."""


@dataclass(frozen=True)
class Reflectors:
    """Textures of the surfaces of one layer that light falls on (``layers/reflector.glsl``), until they are shaded.

    Attributes:
        albedo: RGBA16F, albedo and roughness; this below 0 where opacity fades the diffuse response alone.
        reflectance: RGBA16F, reflectance at normal incidence and occlusion.
        normal: RGBA16, octahedral coordinates of the normal, and amount and roughness of the clear coat.
    """

    albedo: moderngl.Texture
    reflectance: moderngl.Texture
    normal: moderngl.Texture

    @classmethod
    def allocate(cls, making: Construction, ctx: moderngl.Context, size: tuple[int, int]) -> Reflectors:
        """Allocate the textures; ``making`` releases them where the construction fails."""
        textures = [making.keep(ctx.texture(size, 4, dtype=dtype)) for dtype in ("f2", "f2", "nu2")]
        for texture in textures:
            texture.filter = _NEAREST
        return cls(*textures)

    @property
    def textures(self) -> tuple[moderngl.Texture, moderngl.Texture, moderngl.Texture]:
        """All three, in the order of the colour pass's outputs."""
        return self.albedo, self.reflectance, self.normal

    def release(self) -> None:
        """Release the memory."""
        for texture in self.textures:
            texture.release()


REFLECTOR_BYTES_PER_PX = 24
"""Memory of `Reflectors`, bytes per pixel."""


@dataclass(frozen=True)
class LitSlot:
    """Part of a slot that light is added to (`render.layers.shading`).

    Attributes:
        radiance: RGBA16F array.
        slice: the layer's slice of it.
        reflectors: its surfaces.
    """

    radiance: moderngl.TextureArray
    slice: int
    reflectors: Reflectors


@dataclass(frozen=True)
class Slot:
    """Target of one layer.

    Attributes:
        depth_framebuffer: OpenGL name; depth alone.
        framebuffer: OpenGL name; the same depth, radiance at 0, inverse depth at 1, ids at 2, slopes at 3, motion at 4, and the
            reflectors' textures from 5 on.
        w: the inverse depth's texture.
        channel: the layer's channel in that texture.
        lit: what is drawn lit; None where surfaces can be drawn unlit alone.
    """

    depth_framebuffer: int
    framebuffer: int
    w: moderngl.Texture
    channel: int
    lit: LitSlot | None = None

    def begin_depth(self) -> None:
        """Bind and clear the depth framebuffer."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self.depth_framebuffer)
        GL.glDepthMask(True)
        GL.glClearBufferfv(GL.GL_DEPTH, 0, np.zeros(4, np.float32))

    def begin_colour(self, *, fill: bool = False) -> None:
        """Bind the colour framebuffer. The first layer of a texture of inverse depths clears all four channels.

        Args:
            fill: keep the contents.
        """
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self.framebuffer)
        GL.glColorMask(True, True, True, True)
        if self.channel == 0 and not fill:
            GL.glClearBufferfv(GL.GL_COLOR, 1, np.zeros(4, np.float32))
        for packed in (1, 3):
            GL.glColorMaski(packed, *(channel == self.channel for channel in range(LAYERS_PER_PACK)))

    def release(self) -> None:
        """Delete the framebuffers."""
        _delete_framebuffers(self.depth_framebuffer, self.framebuffer)


class DepthTexture:
    """Depth buffer of 32-bit floats that shaders can read."""

    def __init__(self, width: int, height: int) -> None:
        self._name = int(GL.glGenTextures(1))
        GL.glBindTexture(GL.GL_TEXTURE_2D, self._name)
        GL.glTexStorage2D(GL.GL_TEXTURE_2D, 1, GL.GL_DEPTH_COMPONENT32F, width, height)
        for setting in (GL.GL_TEXTURE_MIN_FILTER, GL.GL_TEXTURE_MAG_FILTER):
            GL.glTexParameteri(GL.GL_TEXTURE_2D, setting, GL.GL_NEAREST)
        GL.glBindTexture(GL.GL_TEXTURE_2D, 0)

    def use(self, unit: int) -> None:
        """Bind to a texture unit."""
        GL.glActiveTexture(GL.GL_TEXTURE0 + unit)
        GL.glBindTexture(GL.GL_TEXTURE_2D, self._name)

    def attach(self) -> None:
        """Attach to the bound framebuffer."""
        GL.glFramebufferTexture2D(GL.GL_FRAMEBUFFER, GL.GL_DEPTH_ATTACHMENT, GL.GL_TEXTURE_2D, self._name, 0)

    def release(self) -> None:
        """Release the memory."""
        GL.glDeleteTextures([self._name])


@dataclass(frozen=True)
class LayerTargets:
    """Textures of the layers of one size.

    Attributes:
        width: pixels.
        height: pixels.
        radiance: a slice of RGBA16F for each layer (``layers/coverage.glsl``); undefined where the layer's w is 0.
        packed_w: RGBA32F, the inverse depths of layers 0 to 3 and, if any, 4 to 7: 0 where empty, negative where partly
            transparent.
        packed_slopes: RGBA16UI, how these slope, packed likewise (``trace/slopes.glsl``); undefined where w is 0.
        background: RGBA16F, radiance of rays that meet no surface.
        motion: a slice of RGBA32UI for each layer, motion of its surfaces while the shutter is open (``layers/carried.glsl``),
            undefined where w is 0; None without motion.
        ids: a slice of RG32UI for each layer, object number + 1 and triangle, undefined where w is 0; None without ids.
        reflectors: surfaces of the layer that was drawn last, which all layers share; None where they can be drawn unlit alone.
        slots: target of each layer.
        depth: OpenGL name of the depth renderbuffer that they share.
    """

    width: int
    height: int
    radiance: moderngl.TextureArray
    packed_w: tuple[moderngl.Texture, ...]
    packed_slopes: tuple[moderngl.Texture, ...]
    background: moderngl.Texture
    motion: moderngl.TextureArray | None
    ids: moderngl.TextureArray | None
    reflectors: Reflectors | None
    slots: tuple[Slot, ...]
    depth: int

    @classmethod
    def allocate(
        cls,
        ctx: moderngl.Context,
        width: int,
        height: int,
        layers: int,
        *,
        motion: bool = False,
        lit: bool = False,
        ids: bool = False,
    ) -> LayerTargets:
        """Allocate ``layers`` layers of ``width`` by ``height``, with or without motion and ids, to be drawn unlit alone or lit
        too.

        Raises:
            GraphicsError: the device refuses the size.
        """
        size, packs = (width, height), range(-(-layers // LAYERS_PER_PACK))
        with Construction() as making:
            try:
                radiance = making.keep(ctx.texture_array((*size, layers), 4, dtype="f2"))
                packed_w = tuple(making.keep(ctx.texture(size, 4, dtype="f4")) for _ in packs)
                slopes = tuple(making.keep(ctx.texture(size, 4, dtype="u2")) for _ in packs)
                background = making.keep(ctx.texture(size, 4, dtype="f2"))
                moves = making.keep(ctx.texture_array((*size, layers), 4, dtype="u4")) if motion else None
                numbers = making.keep(ctx.texture_array((*size, layers), 2, dtype="u4")) if ids else None
                reflectors = Reflectors.allocate(making, ctx, size) if lit else None
            except moderngl.Error as error:
                raise GraphicsError(f"the device cannot hold {layers} layers of {width}x{height}: {error}") from error
            radiance.filter = _NEAREST
            for array in (moves, numbers):
                if array is not None:
                    array.filter = _NEAREST
            for texture in (*packed_w, *slopes, background):
                texture.filter = _NEAREST
            depth = _depth_buffer(making, width, height)
            depth_framebuffer = make_framebuffer(making, depth)
            slots = []
            for layer in range(layers):
                pack, channel = divmod(layer, LAYERS_PER_PACK)
                moved = None if moves is None else (moves, layer)
                framebuffer = make_framebuffer(
                    making,
                    depth,
                    (radiance, layer),
                    packed_w[pack],
                    None if numbers is None else (numbers, layer),
                    slopes[pack],
                    moved,
                    *(() if reflectors is None else reflectors.textures),
                )
                own = None if reflectors is None else LitSlot(radiance, layer, reflectors)
                slots.append(Slot(depth_framebuffer, framebuffer, packed_w[pack], channel, own))
        return cls(
            width, height, radiance, packed_w, slopes, background, moves, numbers, reflectors, tuple(slots), depth
        )

    def fits(
        self, width: int, height: int, layers: int, *, motion: bool = False, lit: bool = False, ids: bool = False
    ) -> bool:
        """Whether this many layers of this size can be drawn here, with motion and lit where requested, with ids only there."""
        fits = (self.width, self.height) == (width, height) and len(self.slots) >= layers
        held = (self.motion is not None or not motion) and (self.reflectors is not None or not lit)
        return fits and held and (self.ids is not None) == ids

    @property
    def bytes(self) -> int:
        """Memory on the device, bytes."""
        return 4 * self.width * self.height * bool(self.depth) + sum(map(texture_bytes, self._textures))

    @property
    def _textures(self) -> list[moderngl.Texture | moderngl.TextureArray]:
        arrays = [array for array in (self.radiance, self.motion, self.ids) if array is not None]
        lit = () if self.reflectors is None else self.reflectors.textures
        return [*arrays, self.background, *self.packed_w, *self.packed_slopes, *lit]

    def without_slots(self) -> LayerTargets:
        """Release what only drawing needs. Returns the textures that were drawn, which no layer can be drawn into any more."""
        if self.reflectors is not None:
            for texture in self.reflectors.textures:
                texture.release()
        self._delete_slots()
        return replace(self, reflectors=None, slots=(), depth=0)

    def release(self) -> None:
        """Release the memory."""
        for texture in self._textures:
            texture.release()
        self._delete_slots()

    def _delete_slots(self) -> None:
        _delete_framebuffers(
            *{slot.depth_framebuffer for slot in self.slots}, *(slot.framebuffer for slot in self.slots)
        )
        GL.glDeleteRenderbuffers(1, [self.depth])


@dataclass(frozen=True)
class SurfaceTargets:
    """Textures of the nearest surfaces: inverse depth and ids.

    Attributes:
        width: pixels.
        height: pixels.
        w: R32F, inverse depth; 0 where empty, negative where partly transparent.
        ids: RG32UI, object number + 1 (0 where empty) and triangle.
        slot: target that they are drawn into.
        depth: OpenGL name of the depth renderbuffer.
    """

    width: int
    height: int
    w: moderngl.Texture
    ids: moderngl.Texture
    slot: Slot
    depth: int

    @classmethod
    def allocate(cls, ctx: moderngl.Context, width: int, height: int) -> SurfaceTargets:
        """Allocate the textures.

        Raises:
            GraphicsError: the device refuses the size.
        """
        with Construction() as making:
            try:
                w = making.keep(ctx.texture((width, height), 1, dtype="f4"))
                ids = making.keep(ctx.texture((width, height), 2, dtype="u4"))
            except moderngl.Error as error:
                raise GraphicsError(f"the device cannot hold the ids of {width}x{height} pixels: {error}") from error
            for texture in (w, ids):
                texture.filter = _NEAREST
            depth = _depth_buffer(making, width, height)
            slot = Slot(make_framebuffer(making, depth), make_framebuffer(making, depth, None, w, ids), w, 0)
        return cls(width, height, w, ids, slot, depth)

    def clear_ids(self) -> None:
        """Clear the ids; the rest is cleared when it is drawn."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self.slot.framebuffer)
        GL.glColorMask(True, True, True, True)
        GL.glClearBufferuiv(GL.GL_COLOR, 2, np.zeros(4, np.uint32))

    def release(self) -> None:
        """Release the memory."""
        self.w.release()
        self.ids.release()
        _delete_framebuffers(self.slot.depth_framebuffer, self.slot.framebuffer)
        GL.glDeleteRenderbuffers(1, [self.depth])


def check_layer_size(ctx: moderngl.Context, width: int, height: int) -> None:
    """Raise `SettingsError` where layers of this size exceed the device's limits or a sensible amount of memory."""
    side = int(ctx.info["GL_MAX_TEXTURE_SIZE"])
    if max(width, height) > side or width * height > MAX_LAYER_PIXELS:
        raise SettingsError(
            f"the picture's layers would have {width}x{height} pixels, supersampled and with their margin; at most {side} on a "
            f"side and {MAX_LAYER_PIXELS // 1_000_000} million in all can be held: ask for a smaller picture or supersample less"
        )


def layer_bytes_per_px(layers: int, *, motion: bool = False, lit: bool = False, ids: bool = False) -> int:
    """Memory of so many layers, with their background and depth buffer, bytes per pixel: that of `LayerTargets.bytes`."""
    packs = -(-layers // LAYERS_PER_PACK)
    return layers * (8 + 16 * motion + 8 * ids) + packs * (16 + 8) + 8 + 4 + REFLECTOR_BYTES_PER_PX * lit


def texture_bytes(texture: moderngl.Texture | moderngl.TextureArray) -> int:
    """Memory of a texture without mipmaps, from its size and format."""
    texels = int(np.prod(texture.size))
    return texels * texture.components * int(texture.dtype[-1])


def _depth_buffer(making: Construction, width: int, height: int) -> int:
    name: int = GL.glGenRenderbuffers(1)
    making.callback(GL.glDeleteRenderbuffers, 1, [name])
    GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, name)
    GL.glRenderbufferStorage(GL.GL_RENDERBUFFER, GL.GL_DEPTH_COMPONENT32F, width, height)
    return name


def make_framebuffer(making: Construction, depth: int | DepthTexture, *colours: Attachment) -> int:
    """Make a framebuffer with a depth buffer (a renderbuffer's name or a texture) and a texture for each fragment output; None
    discards an output."""
    name: int = GL.glGenFramebuffers(1)
    making.callback(_delete_framebuffers, name)
    GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, name)
    if isinstance(depth, DepthTexture):
        depth.attach()
    else:
        GL.glFramebufferRenderbuffer(GL.GL_FRAMEBUFFER, GL.GL_DEPTH_ATTACHMENT, GL.GL_RENDERBUFFER, depth)
    buffers = []
    for output, colour in enumerate(colours):
        place = GL.GL_COLOR_ATTACHMENT0 + output
        buffers.append(GL.GL_NONE if colour is None else place)
        if isinstance(colour, moderngl.Texture):
            GL.glFramebufferTexture2D(GL.GL_FRAMEBUFFER, place, GL.GL_TEXTURE_2D, colour.glo, 0)
        elif colour is not None:
            GL.glFramebufferTextureLayer(GL.GL_FRAMEBUFFER, place, colour[0].glo, 0, colour[1])
    GL.glDrawBuffers(max(1, len(buffers)), buffers or [GL.GL_NONE])
    status = GL.glCheckFramebufferStatus(GL.GL_FRAMEBUFFER)
    if status != GL.GL_FRAMEBUFFER_COMPLETE:
        raise GraphicsError(f"the device refuses the layers' framebuffer (status {status:#x})")
    return name


def _delete_framebuffers(*names: int) -> None:
    GL.glDeleteFramebuffers(len(names), list(names))
