"""The lens tracer: layers, a ray table and a focal surface in; radiance out. Lee, Eisemann & Seidel 2010, section 3.1."""

from __future__ import annotations

from collections.abc import Callable

import moderngl
import numpy as np

from render.gl.shaders import ProgramCache
from render.layers.nbuffers import NBuffers
from render.layers.peel import Layers
from render.scene import FloatArray
from render.trace.rays import FocalSurface, RayBundle

SLOPE_SLACK = 0.005
"""Share of w by which a surface may slope away within a pixel and still be hit."""
HALF_PIXEL_SHARE = 0.5
"""How far, in pixels, a pixel's surface reaches beyond the pixel: to its neighbours' centres, as the umbra assumed."""
_RAYS_PER_PASS = 32
_UNITS = {"packed_w": 0, "radiance": 1, "ranges": 2, "background": 3}

Progress = Callable[[float], None]


class Tracer:
    """Traces pictures, keeping its accumulation image and ray buffer for the next picture of the same size."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx = ctx
        self._program = programs.compute("trace.comp", {"HALF_PIXEL_SHARE": HALF_PIXEL_SHARE})
        self._sum: moderngl.Texture | None = None
        self._rays: moderngl.Buffer | None = None

    def trace(
        self,
        layers: Layers,
        nbuffers: NBuffers,
        bundle: RayBundle,
        surface: FocalSurface,
        *,
        size: tuple[int, int],
        supersample: int,
        guard_px: int,
        on_progress: Progress | None = None,
    ) -> FloatArray:
        """Mean radiance of each pixel's rays.

        Args:
            layers: peeled at ``supersample`` times the picture's resolution with ``guard_px`` more on each side.
            nbuffers: of those layers.
            bundle: the lens.
            surface: where it is focused.
            size: picture width and height in pixels.
            supersample: layer pixels per picture pixel, along each axis.
            guard_px: in layer pixels.
            on_progress: called with the share that is done, after each pass over the picture.

        Returns:
            ``(height, width, 4)`` float32: radiance premultiplied by coverage (with the background behind), coverage.
        """
        image = self._sized_sum(size)
        image.write(np.zeros((size[1], size[0], 4), np.float32).tobytes())
        self._bind(layers, nbuffers, bundle)
        self._set_uniforms(layers, nbuffers, bundle, surface, supersample, guard_px)
        for first in range(0, bundle.count, _RAYS_PER_PASS):
            count = min(_RAYS_PER_PASS, bundle.count - first)
            self._program["first_ray"] = first
            self._program["ray_count"] = count
            self._program.run(-(-size[0] // 8), -(-size[1] // 8))
            self._ctx.memory_barrier()
            self._ctx.finish()
            if on_progress is not None:
                on_progress((first + count) / bundle.count)
        return np.frombuffer(image.read(), np.float32).reshape(size[1], size[0], 4).copy()

    def release(self) -> None:
        """Give the memory back."""
        for held in (self._sum, self._rays):
            if held is not None:
                held.release()

    def _bind(self, layers: Layers, nbuffers: NBuffers, bundle: RayBundle) -> None:
        targets = layers.targets
        textures: dict[str, moderngl.Texture | moderngl.TextureArray] = {
            "packed_w": targets.packed_w,
            "radiance": targets.radiance,
            "ranges": nbuffers.ranges,
            "background": targets.background,
        }
        for name, texture in textures.items():
            texture.use(_UNITS[name])
            self._program[name] = _UNITS[name]
        if self._rays is not None:
            self._rays.release()
            self._rays = None
        self._rays = self._ctx.buffer(np.ascontiguousarray(bundle.table).tobytes())
        self._rays.bind_to_storage_buffer(4)

    def _set_uniforms(
        self,
        layers: Layers,
        nbuffers: NBuffers,
        bundle: RayBundle,
        surface: FocalSurface,
        supersample: int,
        guard_px: int,
    ) -> None:
        program = self._program
        program["tile_origin"] = (0, 0)
        program["supersample"] = supersample
        program["guard_px"] = float(guard_px)
        program["pupil_px"] = (layers.view.fx * bundle.pupil_radius_m, layers.view.fy * bundle.pupil_radius_m)
        program["focus"] = (surface.w0, surface.slope_x, surface.slope_y)
        program["pattern_rays"] = bundle.count
        program["tile_side"] = int(np.sqrt(bundle.table.shape[0]))
        program["last_level"] = nbuffers.levels - 1
        program["slope_slack"] = SLOPE_SLACK

    def _sized_sum(self, size: tuple[int, int]) -> moderngl.Texture:
        if self._sum is None or self._sum.size != size:
            if self._sum is not None:
                self._sum.release()
                self._sum = None
            self._sum = self._ctx.texture(size, 4, dtype="f4")
        self._sum.bind_to_image(0, read=True, write=True)
        return self._sum
