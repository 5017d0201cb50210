"""Glints of surfaces out of focus: highlights narrower than a texel, whose radiance is the mean of several samples.

Blur leaves no edge of a texel to be seen, but it does not mend a texel's radiance: a glint on a thin rim is brighter than its
surroundings by a hundred times, and a sample at the texel's centre finds it or does not. Where neighbouring texels differ so
much that the difference, spread over the circle of confusion, changes a pixel by more than 0.01, the nearest opaque surfaces are
shaded at `FINER` times the resolution along each axis, and a texel takes the mean of those samples that are about as blurred.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import moderngl
import numpy as np

from render.errors import GraphicsError
from render.gl.compat import GL
from render.gl.resources import Construction, Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.sharp_layer import FocusZone
from render.layers.surface_sampling import SurfaceSampling
from render.layers.targets import DepthTexture, LayerTargets, Slot, make_framebuffer
from render.optics.view import PinholeView

FINER = 2
"""Samples per texel along each axis."""
ALIKE = 0.5
"""Difference of inverse depth up to which samples are about as blurred, relative to the half width of the zone of focus."""
_NEAREST = (moderngl.NEAREST, moderngl.NEAREST)
_GROUP = 8


@dataclass(frozen=True)
class GlintSamples:
    """Finer samples of the nearest opaque surfaces.

    Attributes:
        marks: R8UI, 1 for texels of the layers that are to be sampled.
        radiance: RGBA16F, `FINER` times the layers' size; undefined where nothing is drawn.
        depth: the samples' depth buffer.
        slot: target that they are drawn into.
    """

    marks: moderngl.Texture
    radiance: moderngl.Texture
    depth: DepthTexture
    slot: Slot


BYTES_PER_PX = 1 + 12 * FINER**2
"""Memory per texel of the layers, bytes, while the samples are drawn."""


def finer_view(view: PinholeView) -> PinholeView:
    """View of the samples of a view's texels."""
    return replace(
        view,
        width=FINER * view.width,
        height=FINER * view.height,
        fx=FINER * view.fx,
        fy=FINER * view.fy,
        cx=FINER * view.cx,
        cy=FINER * view.cy,
    )


def finer_sampling(sampling: SurfaceSampling) -> SurfaceSampling:
    """Footprint of textures for the samples, the same on the surface as that of the layers' texels."""
    corner, right, down = sampling.focus
    return replace(sampling, patch_px_m=FINER * sampling.patch_px_m, focus=(corner, right / FINER, down / FINER))


class GlintSampler:
    """Finds texels that need more samples than one, and averages these."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs

    def mark(
        self, scope: Resources, targets: LayerTargets, first: tuple[int, int], zone: FocusZone, layers: int
    ) -> GlintSamples | None:
        """Mark the texels of layers that need more samples; None where there are none.

        Args:
            scope: owner of the textures.
            targets: the layers.
            first: their first texel in the layers of the whole picture.
            zone: zone of focus; surfaces within it are not marked.
            layers: number of layers that hold surfaces.

        Raises:
            GraphicsError: the device refuses the size.
        """
        size = targets.width, targets.height
        program = self._programs.compute("layers/glint_mark.comp")
        marks = scope.keep(self._ctx.texture(size, 1, dtype="u1"))
        marks.filter = _NEAREST
        grid = scope.keep(zone.draw_focus(self._ctx))
        found = scope.keep(self._ctx.buffer(np.zeros(1, np.uint32).tobytes()))
        found.bind_to_storage_buffer(0)
        textures: dict[str, moderngl.Texture | moderngl.TextureArray] = {
            "packed_w": targets.packed_w[0],
            "radiance": targets.radiance,
            "focus_grid": grid,
        }
        for unit, (name, texture) in enumerate(textures.items()):
            texture.use(unit)
            set_uniforms(program, **{name: unit})
        set_uniforms(program, layer_count=min(layers, 4), first=first, whole=zone.whole.size)
        set_uniforms(program, half_width=zone.half_width, least_texels=np.pi * zone.coc_px**2)
        marks.bind_to_image(0, read=False, write=True)
        program.run(-(-size[0] // _GROUP), -(-size[1] // _GROUP))
        self._ctx.memory_barrier()
        if not np.frombuffer(found.read(), np.uint32)[0]:
            return None
        width, height = FINER * size[0], FINER * size[1]
        with Construction() as making:
            try:
                radiance = scope.keep(self._ctx.texture((width, height), 4, dtype="f2"))
            except moderngl.Error as error:
                raise GraphicsError(f"the device cannot hold {width}x{height} samples: {error}") from error
            radiance.filter = _NEAREST
            depth = scope.keep(DepthTexture(width, height))
            slot = scope.keep(
                Slot(make_framebuffer(making, depth), make_framebuffer(making, depth, radiance), radiance, 0)
            )
        return GlintSamples(marks, radiance, depth, slot)

    def mask(self, samples: GlintSamples) -> None:
        """Leave in the depth buffer only the samples of marked texels."""
        program = self._programs.drawing("layers/whole_target.vert", "layers/glint_mask.frag")
        samples.marks.use(0)
        set_uniforms(program, marks=0, finer=FINER)
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, samples.slot.depth_framebuffer)
        GL.glViewport(0, 0, *samples.radiance.size)
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_ALWAYS)
        GL.glDepthMask(True)
        triangle = self._ctx.vertex_array(program, [])
        try:
            triangle.render(moderngl.TRIANGLES, vertices=3)
        finally:
            triangle.release()
            GL.glDisable(GL.GL_DEPTH_TEST)

    def average(
        self, samples: GlintSamples, targets: LayerTargets, view: PinholeView, zone: FocusZone, layers: int
    ) -> None:
        """Replace the radiance of marked texels by the mean of their samples.

        Args:
            samples: their depth and radiance are drawn.
            targets: the layers.
            view: view of the samples.
            zone: zone of focus.
            layers: number of layers that hold surfaces.
        """
        program = self._programs.compute("layers/glint_average.comp")
        samples.depth.use(0)
        set_uniforms(program, depth_map=0)
        textures = {"marks": samples.marks, "samples": samples.radiance, "packed_w": targets.packed_w[0]}
        for unit, (name, texture) in enumerate(textures.items(), start=1):
            texture.use(unit)
            set_uniforms(program, **{name: unit})
        farthest = 0.0 if np.isinf(view.far_m) else 1 / view.far_m
        set_uniforms(program, layer_count=min(layers, 4), finer=FINER, w_range=(farthest, 1 / view.near_m))
        set_uniforms(program, alike=ALIKE * zone.half_width)
        targets.radiance.bind_to_image(0, read=False, write=True)
        program.run(-(-targets.width // _GROUP), -(-targets.height // _GROUP))
        self._ctx.memory_barrier()
