"""The lens tracer: layers, rays and a focal surface in; radiance out. Lee, Eisemann & Seidel 2010, section 3.1."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import moderngl
import numpy as np

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint, PieceSize
from render.gl.compat import GL
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.movers import Movers
from render.layers.nbuffers import NBuffers, bind_layers
from render.layers.peel import Layers
from render.model.arrays import FloatArray
from render.optics.view import PinholeView
from render.trace.focal_map import FocalMaps
from render.trace.moment_view import MomentView
from render.trace.picture_focus import PictureFocus
from render.trace.ray_buffers import RayBuffers
from render.trace.rays import RayBundle
from render.trace.tiling.picture import Area

RAYS_PER_PASS = 128
"""Rays per dispatch. Work per pixel that does not depend on the ray (footprint bounds, lens table row) is done once a pass."""
_RAYS_PER_DISPATCH = 1 << 24
"""Rays of one dispatch. A picture is traced in bands of lines, so that no dispatch runs into a display driver's timeout."""
_FIRST_UNIT = 0
"""First texture unit of the tracer."""
_LAYER_UNITS = 11
"""Number of texture units for layers, N-buffers, focal map and movers, which have the last two; the ray buffers come after."""
_TILE = 8  # side of the shader's work groups, px


@dataclass(frozen=True)
class TracePass:
    """Progress of a picture after a tile.

    Attributes:
        rays: rays per pixel of the passes that are complete.
        share: share of all rays of all pixels that were traced, 0 to 1.
    """

    rays: int
    share: float


class Tracer:
    """Traces pictures. The accumulation image and the ray buffers are reused for pictures of the same size."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx = ctx
        self._programs = programs
        self._cancellation, self._piece = cancellation, PieceSize(1 << 16, least=_TILE * _TILE)
        self._buffers = RayBuffers(ctx)
        self._maps = FocalMaps(ctx, programs)
        self._sum: moderngl.Texture | None = None
        self._shares = np.zeros((0, 0), np.float32)
        self._is_bound = False

    def passes(
        self,
        layers: Layers,
        nbuffers: NBuffers,
        bundle: RayBundle,
        focus: PictureFocus,
        view: PinholeView,
        *,
        rays_per_pass: int = RAYS_PER_PASS,
        bound_by_rays: bool = False,
        moment_view: MomentView | None = None,
        movers: Movers | None = None,
        area: Area | None = None,
    ) -> Iterator[TracePass]:
        """Trace a picture pass by pass, and each pass tile by tile. `picture` has the mean over all rays after the last tile;
        `partial_picture` has the mean over the rays traced so far after any tile.

        Args:
            layers: layers from the picture's own eye (or that of ``moment_view``), at any resolution and with any margin.
            nbuffers: N-buffers of those layers.
            bundle: rays of the lens.
            focus: focal surface.
            view: projection of the picture.
            rays_per_pass: largest number of rays per pixel in a pass.
            bound_by_rays: bound a pixel's footprint by the quad around its rays, not in closed form; always with ``moment_view``.
            moment_view: the camera at a moment, where it may have moved from the position that the layers were peeled from.
            movers: moving surfaces of the layers, set to that moment.
            area: part of the picture to trace; None for all of it.

        Yields:
            Progress after each tile.
        """
        left, top, width, height = area = area or (0, 0, view.width, view.height)
        self._shares = np.zeros((height, width), np.float32)
        _clear(self._allocate_sum((width, height)))
        focal_map = None if focus.affine is not None else self._maps.draw(focus, area)
        program = self._program(
            layers,
            bundle,
            bound_by_rays=bound_by_rays or moment_view is not None,
            by_map=focal_map is not None,
            moment={"CARRIED_CAMERA": moment_view is not None, "MOVERS": movers is not None},
        )

        def bind() -> None:
            self._bind(program, layers, nbuffers, focal_map)
            self._buffers.bind(program, bundle, first_unit=_FIRST_UNIT + _LAYER_UNITS)
            self._allocate_sum((width, height))
            if movers is not None:
                movers.bind(program, _FIRST_UNIT + _LAYER_UNITS - 2)

        self._is_bound = False
        set_uniforms(program, **layer_uniforms(layers, view))
        if moment_view is not None:
            set_uniforms(program, **moment_view.uniforms(layers.view))
        set_uniforms(program, focus=focus.affine or (0.0, 0.0, 0.0), area_first=(left, top))
        for first in range(0, bundle.count, rays_per_pass):
            count = min(rays_per_pass, bundle.count - first)
            set_uniforms(program, first_ray=first, ray_count=count)
            for share in self._trace_tiles(bind, program, bundle, area, count):
                yield TracePass(first + (count if share == 1 else 0), (first + count * share) / bundle.count)

    def _trace_tiles(
        self,
        bind: Callable[[], None],
        program: moderngl.ComputeShader,
        bundle: RayBundle,
        area: Area,
        rays: int,
    ) -> Iterator[float]:
        """Trace an area of the picture piece by piece, and yield the share that is done."""
        left, top, width, height = area
        light = (
            np.append(bundle.rgb * bundle.transmittance, bundle.rgb.mean(axis=1, keepdims=True), axis=1) / bundle.count
        )
        for x, y, across, down in self._tiles(rays * len(bundle.rgb), width, height):
            if not self._is_bound:
                bind()
                self._is_bound = True
            set_uniforms(program, first_pixel=(left + x, top + y), end_pixel=(left + x + across, top + y + down))
            for wavelength in range(len(bundle.rgb)):
                set_uniforms(program, light=tuple(light[wavelength]))
                self._buffers.choose_wavelength(program, bundle, wavelength)
                program.run(-(-across // _TILE), -(-down // _TILE))
                self._ctx.memory_barrier()
            if self._cancellation.is_cancellable:
                self._piece.learn(rays * len(bundle.rgb) * across * down, self._cancellation.poll())
            else:
                self._ctx.finish()
            self._shares[y : y + down, x : x + across] += rays / bundle.count
            yield (y + down * (x + across) / width) / height

    def _tiles(self, rays_per_pixel: int, width: int, height: int) -> Iterator[Area]:
        """Cut an area into pieces: short enough to cancel between, or bands."""
        x = y = 0
        while y < height:
            pixels = (self._piece.units if self._cancellation.is_cancellable else _RAYS_PER_DISPATCH) // rays_per_pixel
            if (x == 0 and pixels >= width * _TILE) or not self._cancellation.is_cancellable:
                down = min(max(_TILE, pixels // width // _TILE * _TILE), height - y)
                yield 0, y, width, down
                y += down
                continue
            across, down = min(max(_TILE, pixels // _TILE // _TILE * _TILE), width - x), min(_TILE, height - y)
            yield x, y, across, down
            x += across
            if x == width:
                x, y = 0, y + down

    def picture(self) -> FloatArray:
        """Return the mean over all rays of the area that was traced. Call it after the last pass.

        Returns:
            ``(height, width, 4)`` float32 of the area: radiance, premultiplied, over the background; alpha is coverage.
        """
        image = self._sum
        if image is None:
            raise ValueError("no picture has been traced")
        color = np.empty((image.height, image.width, 4), np.float32)
        image.read_into(color)
        return color

    def partial_picture(self) -> tuple[FloatArray, FloatArray]:
        """Return the mean over the rays traced so far, and ``(height, width, 1)`` their share of all rays of each pixel.

        The device may do other work before the next tile; the picture's layers and N-buffers must not change.
        """
        shares = self._shares[..., None].copy()
        self._is_bound = False
        return np.divide(color := self.picture(), np.where(shares > 0, shares, 1), out=color), shares

    def release(self) -> None:
        """Release the memory."""
        if self._sum is not None:
            self._sum.release()
        self._buffers.release()
        self._maps.release()

    def _program(
        self, layers: Layers, bundle: RayBundle, *, bound_by_rays: bool, by_map: bool, moment: dict[str, bool]
    ) -> moderngl.ComputeShader:
        defines: dict[str, int | float | str] = {name: 1 for name, is_set in moment.items() if is_set}
        if layers.count > 4:
            defines["EIGHT_LAYERS"] = 1
        if layers.may_be_translucent:
            defines["MAY_BE_TRANSLUCENT"] = 1
        if bound_by_rays:
            defines["BOUND_BY_RAYS"] = 1
        if by_map:
            defines["FOCAL_MAP"] = 1
        return self._programs.compute("trace/trace.comp", defines | self._buffers.defines(bundle))

    def _bind(
        self,
        program: moderngl.ComputeShader,
        layers: Layers,
        nbuffers: NBuffers,
        focal_map: moderngl.Texture | None,
    ) -> None:
        unit = bind_layers(program, layers, nbuffers, _FIRST_UNIT)
        if focal_map is not None:
            focal_map.use(unit)
            program["focal_map"] = unit

    def _allocate_sum(self, size: tuple[int, int]) -> moderngl.Texture:
        if self._sum is None or self._sum.size != size:
            if self._sum is not None:
                self._sum.release()
                self._sum = None
            self._sum = self._ctx.texture(size, 4, dtype="f4")
        self._sum.bind_to_image(0, read=True, write=True)
        return self._sum


def _clear(texture: moderngl.Texture) -> None:
    """Set all texels to 0, without a copy of the texture in memory."""
    GL.glClearTexImage(texture.glo, 0, GL.GL_RGBA, GL.GL_FLOAT, np.zeros(4, np.float32))


def layer_uniforms(layers: Layers, view: PinholeView) -> dict[str, object]:
    """Uniforms of ``lens/lens_rays.glsl`` and ``trace/footprints.glsl`` that place a picture on its layers."""
    whole, origin, held = layers.whole, layers.origin, layers.view.size
    scale = whole.fx / view.fx
    return {
        "scale": scale,
        "offset": (whole.cx - scale * view.cx, whole.cy - scale * view.cy),
        "axis": (whole.cx, whole.cy),
        "focal_px": (whole.fx, whole.fy),
        "layer_first": origin,
        "layer_last": tuple(min(whole.size[i] - origin[i], held[i]) - 1 for i in (0, 1)),
    }
