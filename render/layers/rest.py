"""Partly transparent surfaces that a peeling has no layer left for, merged into its last two layers.

A pixel has a limited number of layers. The last one takes the nearest opaque surface behind the layer before, or the nearest of
all where there is none. What is partly transparent in between, or behind it, is peeled surface by surface and composited front to
back. The result is merged into one surface of the pixel (``layers/rest_merge.comp``):

- behind the last layer, where that is partly transparent;
- behind the layer before, where that is partly transparent and the last one is opaque;
- over the last layer, where both are opaque.

What is behind surfaces that let less than 0.1 % of the light through, as opaque ones, is left out.

The merged surface keeps its depth. A ray that crosses the same surfaces sees what it would see with a layer for each of them;
the surfaces that were merged are blurred like the one that holds them, and rays that cross the border of a surface within such a
stack see a part of it twice or not at all. A partly transparent holdout of such a stack counts as a black surface: the light that
a pixel gets is right, and its alpha is too large.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import moderngl
import numpy as np

from render.errors import GraphicsError
from render.gl.compat import GL
from render.gl.resources import Construction
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.renderer import LayerPass, Rest
from render.layers.targets import DepthTexture, LayerTargets, LitSlot, Reflectors, Slot, make_framebuffer

_GROUP = 8


@dataclass(frozen=True)
class _RestTargets:
    """Textures of one size: radiance (RGBA16F, one slice) and w (R32F) of one surface, light (RGBA32F) of all so far,
    premultiplied; what light falls on, None for unlit ones."""

    radiance: moderngl.TextureArray
    w: moderngl.Texture
    light: moderngl.Texture
    depth: DepthTexture
    reflectors: Reflectors | None
    slot: Slot

    def release(self) -> None:
        for texture in (self.radiance, self.w, self.light, self.depth, self.reflectors, self.slot):
            if texture is not None:
                texture.release()


class RestMerger:
    """Merges what is left behind the layers of one peeling after another.

    Args:
        ctx: context of the device.
        programs: its programs.
    """

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs
        self._targets: _RestTargets | None = None

    def merge(self, draw: Callable[[LayerPass], bool], last: LayerPass, targets: LayerTargets, index: int) -> None:
        """Merge what is left into the last two layers, however many surfaces that is.

        Args:
            draw: draws a pass, and says whether it filled any pixel.
            last: the pass of the last layer, which is drawn.
            targets: the layers.
            index: index of the last layer in the targets.
        """
        draws = [some for some in last.draws if some.may_be_translucent]
        if not draws:
            return
        held = self._allocate(targets.width, targets.height, lit=not last.unlit)
        GL.glClearTexImage(held.light.glo, 0, GL.GL_RGBA, GL.GL_FLOAT, np.zeros(4, np.float32))
        rest = Rest(last.slot, held.light)
        layer = replace(last, draws=draws, slot=held.slot, solid_first=False, reach=None, rest=rest)
        if not draw(layer):
            return
        behind = replace(layer, previous=held.slot, most_opaque=0, first=None)
        self._add(held)
        while draw(behind):
            self._add(held)
        self._merge(held, last, targets, index)

    def release(self) -> None:
        """Release the memory on the device."""
        if self._targets is not None:
            self._targets.release()
            self._targets = None

    def _add(self, held: _RestTargets) -> None:
        """Composite the drawn surfaces behind those before."""
        program = self._programs.compute("layers/rest_add.comp")
        self._ctx.memory_barrier()
        held.w.use(0)
        held.radiance.use(1)
        set_uniforms(program, w=0, radiance=1)
        held.light.bind_to_image(0, read=True, write=True)
        program.run(-(-held.w.width // _GROUP), -(-held.w.height // _GROUP))
        self._ctx.memory_barrier()

    def _merge(self, held: _RestTargets, last: LayerPass, targets: LayerTargets, index: int) -> None:
        """Merge the light of all into the last two layers."""
        program = self._programs.compute("layers/rest_merge.comp")
        before = last.previous or last.slot
        held.light.use(0)
        last.slot.w.use(1)
        before.w.use(2)
        set_uniforms(program, light=0, last_w=1, before_w=2)
        set_uniforms(program, last_channel=last.slot.channel, before_channel=before.channel)
        set_uniforms(program, last_slice=index, before_slice=index - 1 if last.previous is not None else index)
        targets.radiance.bind_to_image(0, read=True, write=True)
        program.run(-(-targets.width // _GROUP), -(-targets.height // _GROUP))
        self._ctx.memory_barrier()

    def _allocate(self, width: int, height: int, *, lit: bool) -> _RestTargets:
        held = self._targets
        if held is None or held.w.size != (width, height) or (held.reflectors is None and lit):
            self.release()
            held = self._targets = _allocate(self._ctx, width, height, lit=lit)
        return held


def _allocate(ctx: moderngl.Context, width: int, height: int, *, lit: bool) -> _RestTargets:
    with Construction() as making:
        try:
            radiance = making.keep(ctx.texture_array((width, height, 1), 4, dtype="f2"))
            reflectors = Reflectors.allocate(making, ctx, (width, height)) if lit else None
            w = making.keep(ctx.texture((width, height), 1, dtype="f4"))
            light = making.keep(ctx.texture((width, height), 4, dtype="f4"))
        except moderngl.Error as error:
            raise GraphicsError(f"the device cannot hold a layer of {width}x{height}: {error}") from error
        for texture in (radiance, w, light):
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        depth = making.keep(DepthTexture(width, height))
        others = () if reflectors is None else (None, None, None, *reflectors.textures)
        framebuffer = make_framebuffer(making, depth, (radiance, 0), w, *others)
        own = None if reflectors is None else LitSlot(radiance, 0, reflectors)
        slot = Slot(make_framebuffer(making, depth), framebuffer, w, 0, own)
    return _RestTargets(radiance, w, light, depth, reflectors, slot)
