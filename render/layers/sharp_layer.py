"""The sharp layer: opaque surfaces that are nearly in focus, at twice the layers' resolution.

Where blur is less than about a pixel, the layers' texels show as staircases along edges; where it is more, they do not. So the
nearest opaque surfaces within a range of inverse depth around the focus are drawn once more at twice the resolution, but only
their depth. Their radiance and slope are those of the nearby texel of the layers that lies on the same surface (Chajdas, McGuire
& Luebke 2011, "Subpixel reconstruction antialiasing for deferred shading", section 3); surfaces that no such texel holds, as
thin bars, are shaded. What the sharp layer holds is removed from the layers, so that a ray meets each surface once.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import moderngl
import numpy as np

from render.errors import GraphicsError
from render.gl.compat import GL
from render.gl.resources import Construction, Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.surface_sampling import SurfaceSampling
from render.layers.targets import DepthTexture, LayerTargets, Slot, make_framebuffer, texture_bytes
from render.model.arrays import FloatArray
from render.optics.view import PinholeView

FINER = 2
"""Texels of the sharp layer per texel of the layers along each axis."""
SLACK = 0.25
"""Share of inverse depth by which the surfaces of a texel that is partly in the zone may leave it."""
_NEAREST = (moderngl.NEAREST, moderngl.NEAREST)
_GROUP = 8


@dataclass(frozen=True, eq=False)
class FocusZone:
    """Surfaces of a picture that are nearly in focus.

    Attributes:
        whole: view of the whole picture's layers.
        focus: ``(rows, columns)`` float32 w in focus on a grid over these, corners included, 1/m.
        half_width: largest difference from that, 1/m.
        coc_px: radius of the circle of confusion there, texels of the layers.
    """

    whole: PinholeView
    focus: FloatArray
    half_width: float
    coc_px: float

    def matches(self, other: FocusZone | None) -> bool:
        """Whether both are the same."""
        if other is None:
            return False
        same_width = (self.half_width, self.coc_px) == (other.half_width, other.coc_px)
        return same_width and self.whole.matches(other.whole) and np.array_equal(self.focus, other.focus)

    def draw_focus(self, ctx: moderngl.Context) -> moderngl.Texture:
        """Texture of the w in focus, for ``layers/sharp_focus.glsl``; the caller releases it."""
        grid = ctx.texture(self.focus.shape[::-1], 1, self.focus.tobytes(), dtype="f4")
        grid.filter = _NEAREST
        return grid


@dataclass(frozen=True, eq=False)
class SharpZone:
    """Contents of a sharp layer.

    Attributes:
        view: view of its texels: `FINER` times the layers' resolution, between ``1 / near_m`` and ``1 / far_m``.
        first: its corner's texel in the layers of the whole picture.
        offset: its corner's texel in the layers that it belongs to, which may be a part of these.
        zone: what is nearly in focus.
        sampling: how finely the finished picture samples surfaces.
    """

    view: PinholeView
    first: tuple[int, int]
    offset: tuple[int, int]
    zone: FocusZone
    sampling: SurfaceSampling

    def matches(self, other: SharpZone | None) -> bool:
        """Whether both hold the same."""
        if other is None or not (self.view.matches(other.view) and self.zone.matches(other.zone)):
            return False
        return (self.first, self.offset, self.sampling) == (other.first, other.offset, other.sampling)

    @property
    def w_range(self) -> tuple[float, float]:
        """Range of inverse depth in which rays may meet its surfaces, which go on beyond the centres of their texels, 1/m."""
        farthest = 0.0 if np.isinf(self.view.far_m) else 1 / self.view.far_m
        return (1 - SLACK) * farthest, (1 + SLACK) / self.view.near_m

    def within(self, layers: PinholeView, part: PinholeView) -> SharpZone | None:
        """Part of the zone that lies in a part of the layers; None where there is none.

        Args:
            layers: view of the layers that this zone is for.
            part: view of some of their texels.
        """
        corner = round(layers.cx - part.cx), round(layers.cy - part.cy)
        low = [max(self.offset[i], corner[i]) for i in (0, 1)]
        high = [min(self.offset[i] + self.view.size[i] // FINER, corner[i] + part.size[i]) for i in (0, 1)]
        if high[0] <= low[0] or high[1] <= low[1]:
            return None
        x, y = (FINER * (low[i] - self.offset[i]) for i in (0, 1))
        width, height = (FINER * (high[i] - low[i]) for i in (0, 1))
        view = replace(self.view, width=width, height=height, cx=self.view.cx - x, cy=self.view.cy - y)
        offset = low[0] - corner[0], low[1] - corner[1]
        sampling = self.sampling.at_corner(x, y)
        return replace(self, view=view, first=(low[0], low[1]), offset=offset, sampling=sampling)


@dataclass(frozen=True)
class SharpLayer:
    """Textures of a sharp layer.

    Attributes:
        zone: what it holds.
        w: R32F, inverse depth in 1/m; 0 where empty.
        slopes: R16UI, slope of w (``trace/slopes.glsl``).
        radiance: RGBA16F; undefined where w is 0.
        depth: the depth buffer.
        slot: target that its surfaces are drawn into.
    """

    zone: SharpZone
    w: moderngl.Texture
    slopes: moderngl.Texture
    radiance: moderngl.Texture
    depth: DepthTexture
    slot: Slot

    @property
    def bytes(self) -> int:
        """Memory on the device, bytes."""
        return sum(map(texture_bytes, (self.w, self.slopes, self.radiance))) + 4 * self.w.width * self.w.height

    def release(self) -> None:
        """Release the memory."""
        for texture in (self.w, self.slopes, self.radiance):
            texture.release()
        self.slot.release()
        self.depth.release()


BYTES_PER_PX = 18 * FINER**2
"""Memory of a sharp layer per texel of the layers, bytes."""


def allocate_sharp_layer(ctx: moderngl.Context, zone: SharpZone) -> SharpLayer:
    """Allocate a sharp layer.

    Raises:
        GraphicsError: the device refuses the size.
    """
    width, height = zone.view.size
    with Construction() as making:
        try:
            w = making.keep(ctx.texture((width, height), 1, dtype="f4"))
            slopes = making.keep(ctx.texture((width, height), 1, dtype="u2"))
            radiance = making.keep(ctx.texture((width, height), 4, dtype="f2"))
        except moderngl.Error as error:
            raise GraphicsError(f"the device cannot hold a sharp layer of {width}x{height}: {error}") from error
        for texture in (w, slopes, radiance):
            texture.filter = _NEAREST
        depth = making.keep(DepthTexture(width, height))
        slot = Slot(make_framebuffer(making, depth), make_framebuffer(making, depth, radiance, w, None, slopes), w, 0)
    return SharpLayer(zone, w, slopes, radiance, depth, slot)


class SharpResolver:
    """Fills sharp layers from their depth and from the layers."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs

    def resolve(self, sharp: SharpLayer, targets: LayerTargets) -> bool:
        """Give each texel of the sharp layer the radiance of the layers' texel on its surface, and remove from the layers
        what the sharp layer holds.

        Args:
            sharp: its depth is drawn.
            targets: the layers.

        Returns:
            Whether there are surfaces that the layers have no texel of; these are still empty, and the depth buffer keeps them
            alone.
        """
        zone, view = sharp.zone, sharp.zone.view
        resolve = self._programs.compute("layers/sharp_resolve.comp")
        remove = self._programs.compute("layers/sharp_remove.comp")
        with Resources() as scope:
            missing = scope.keep(self._ctx.buffer(np.zeros(1, np.uint32).tobytes()))
            grid = scope.keep(zone.zone.draw_focus(self._ctx))
            missing.bind_to_storage_buffer(0)
            sharp.depth.use(0)
            textures: dict[str, moderngl.Texture | moderngl.TextureArray] = {
                "packed_w": targets.packed_w[0],
                "slopes": targets.packed_slopes[0],
                "radiance": targets.radiance,
            }
            for unit, (name, texture) in enumerate(textures.items(), start=1):
                texture.use(unit)
                set_uniforms(resolve, **{name: unit})
                set_uniforms(remove, **{name: unit})
            set_uniforms(
                resolve,
                depth_map=0,
                w_range=(0.0 if np.isinf(view.far_m) else 1 / view.far_m, 1 / view.near_m),
            )
            grid.use(4)
            for program in (resolve, remove):
                set_uniforms(program, offset=zone.offset, first=zone.first, half_width=zone.zone.half_width)
                set_uniforms(program, focus_grid=4, whole=zone.zone.whole.size)
            sharp.w.bind_to_image(0, read=False, write=True)
            sharp.slopes.bind_to_image(1, read=False, write=True)
            sharp.radiance.bind_to_image(2, read=False, write=True)
            resolve.run(-(-view.width // _GROUP), -(-view.height // _GROUP))
            self._ctx.memory_barrier()
            sharp.w.use(0)
            set_uniforms(remove, sharp_w=0)
            for packed_w, slopes in zip(targets.packed_w, targets.packed_slopes, strict=True):
                slopes.use(2)
                packed_w.bind_to_image(0, read=True, write=True)
                remove.run(-(-view.width // (_GROUP * FINER)), -(-view.height // (_GROUP * FINER)))
            self._ctx.memory_barrier()
            return bool(np.frombuffer(missing.read(), np.uint32)[0])

    def mask_held(self, sharp: SharpLayer) -> None:
        """Leave in the depth buffer only what `resolve` found missing."""
        program = self._programs.drawing("layers/whole_target.vert", "layers/sharp_missing.frag")
        sharp.w.use(0)
        set_uniforms(program, sharp_w=0)
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, sharp.slot.depth_framebuffer)
        GL.glViewport(0, 0, *sharp.zone.view.size)
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_ALWAYS)
        GL.glDepthMask(True)
        triangle = self._ctx.vertex_array(program, [])
        try:
            triangle.render(moderngl.TRIANGLES, vertices=3)
        finally:
            triangle.release()
            GL.glDisable(GL.GL_DEPTH_TEST)
