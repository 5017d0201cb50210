"""The accumulation buffer: the mean of pinhole views through points of the pupil (Haeberli & Akeley 1990).

Each view is drawn from its own point of the pupil, so visibility is exact at pixel centres, through any number of surfaces that
are partly transparent. The sensor offset of each view anti-aliases. All
pixels share one pattern.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import moderngl
import numpy as np

from render.gl.resources import Resources
from render.gl.shaders import ProgramCache
from render.layers.peel import Peeler
from render.layers.peeled import LayerGroup
from render.layers.surface_sampling import PLAIN, SurfaceSampling, patch_px_m
from render.layers.targets import LAYERS_PER_PACK
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.model.focal_surface import FocalPlane
from render.optics.sampling import lens_samples
from render.optics.thin_lens import focal_surface, pupil_radius_m
from render.optics.view import PinholeView

if TYPE_CHECKING:  # loaded where a scene has splats
    from render.trace.splats.between import SplatsBetweenLayers


def make_lens_points(camera: Camera, rays: int, seed: int = 0) -> DoubleArray:
    """Make the lens points of `Accumulator.accumulate`: the rays that the lens tracer has where its pattern is not tiled."""
    samples = lens_samples(rays, camera.iris, seed=seed, tiled=False)
    pupil = samples.pupil[0] * pupil_radius_m(camera) / [camera.lens.squeeze, 1.0]
    return np.concatenate([pupil, samples.pixel[0]], axis=1)


def choose_view_sampling(camera: Camera, view: PinholeView, rays: int, supersample: float) -> SurfaceSampling:
    """Give the filter of the views. It is that of layers of the same supersample: the views' offsets sample between the pixels,
    and each view stands for its share of the pupil."""
    patch = patch_px_m(max(view.fx, view.fy), pupil_radius_m(camera), rays)
    return SurfaceSampling(supersample, patch, view.across(focal_surface(camera).plane))


class Accumulator:
    """Accumulates pinhole views of a peeler's scene."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs

    def accumulate(
        self,
        peeler: Peeler,
        view: PinholeView,
        lens_points: FloatArray | DoubleArray,
        plane: FocalPlane,
        *,
        unlit: bool = False,
        sampling: SurfaceSampling = PLAIN,
        on_progress: Callable[[float], None] | None = None,
    ) -> FloatArray:
        """Average the views through the lens points.

        Args:
            peeler: with the scene loaded.
            view: the picture, from the pupil's centre.
            lens_points: ``(n, 4)``: x right and y up on the pupil in metres, x right and y down on the sensor in pixels.
            plane: the plane of focus.
            unlit: take base colour for radiance.
            sampling: `choose_view_sampling`.
            on_progress: called with the share that is done.

        Returns:
            ``(height, width, 4)`` float32: radiance premultiplied by coverage (with the background behind), coverage.
        """
        size = (view.width, view.height)
        with Resources() as scope:
            total, seen = (scope.keep(self._ctx.texture(size, 4, dtype="f4")) for _ in range(2))
            through = scope.keep(self._ctx.texture(size, 1, dtype="f4"))
            total.write(np.zeros((view.height, view.width, 4), np.float32).tobytes())
            splats = self._splats(peeler, size, scope)
            for i, (x, y, dx, dy) in enumerate(np.asarray(lens_points, np.float64)):
                through_lens = view.through(x, y, plane, (dx, dy))
                if splats is not None:
                    splats.begin(through_lens)
                for group in peeler.peel_groups(through_lens, unlit=unlit, sampling=sampling):
                    if splats is not None:
                        splats.draw(group)
                    self._composite(group, seen, through, total, 1.0 / len(lens_points), splats)
                if on_progress is not None:
                    on_progress((i + 1) / len(lens_points))
            return np.frombuffer(total.read(), np.float32).reshape(view.height, view.width, 4).copy()

    def _splats(self, peeler: Peeler, size: tuple[int, int], scope: Resources) -> SplatsBetweenLayers | None:
        """Drawer of the scene's splats; None where it has none."""
        if not peeler.splats:
            return None
        from render.trace.splats.between import SplatsBetweenLayers

        return scope.enter_context(SplatsBetweenLayers(self._ctx, self._programs, peeler.splats, size))

    def _composite(
        self,
        group: LayerGroup,
        seen: moderngl.Texture,
        through: moderngl.Texture,
        total: moderngl.Texture,
        weight: float,
        splats: SplatsBetweenLayers | None,
    ) -> None:
        """Composite a group behind the view so far, and what that lets through. After the last group add the background, and
        the view to the total."""
        defines = {} if splats is None else {"SPLATS": 1} | ({"HELD_SPLATS": 1} if splats.has_holdouts else {})
        program = self._programs.compute("trace/accumulate.comp", defines)
        targets = group.targets
        textures: dict[str, moderngl.Texture | moderngl.TextureArray] = {
            "packed_w": targets.packed_w[group.slot // LAYERS_PER_PACK],
            "radiance": targets.radiance,
            "background": targets.background,
        }
        if splats is not None:
            textures["between"] = splats.texture
        for unit, (name, texture) in enumerate(textures.items()):
            texture.use(unit)
            program[name] = unit
        program["slice_of_first"], program["count"] = group.slot, group.count
        program["is_first"], program["is_last"] = group.is_first, group.is_last
        program["weight"] = weight
        total.bind_to_image(0, read=True, write=True)
        seen.bind_to_image(1, read=True, write=True)
        through.bind_to_image(2, read=True, write=True)
        program.run(-(-total.width // 8), -(-total.height // 8))
        self._ctx.memory_barrier()
