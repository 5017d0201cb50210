"""The lens tracer: layers, rays and a focal surface in; radiance out. Lee, Eisemann & Seidel 2010, section 3.1."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import moderngl
import numpy as np
from numpy.typing import NDArray

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint, PieceSize
from render.gl.compat import GL
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.matte_numbers import MatteNumbers
from render.layers.movers import Movers
from render.layers.nbuffers import NBuffers, bind_layers
from render.layers.peeled import Layers
from render.model.area import Area
from render.model.arrays import FloatArray, IntArray
from render.optics.view import PinholeView
from render.trace.adaptive import TILE, RayBudget, Values, allocate, over_pixels, tile_errors, tile_pixels
from render.trace.focal_map import FocalMaps
from render.trace.matte_tables import SLOTS, MatteTables
from render.trace.moment_view import MomentView
from render.trace.picture_focus import PictureFocus
from render.trace.ray_buffers import RayBuffers
from render.trace.rays import RayBundle

if TYPE_CHECKING:  # loaded where a scene has splats
    from render.trace.splats.planes import SplatPlanes

RAYS_PER_PASS = 128
"""Rays per dispatch. Work per pixel that does not depend on the ray (footprint bounds, lens table row) is done once a pass."""
_RAYS_PER_DISPATCH = 1 << 24
"""Rays of one dispatch. A picture is traced in pieces, so that no dispatch runs into a display driver's timeout."""
_GROUPS_PER_DISPATCH = 65_535
"""Work groups of one dispatch that every driver takes."""
_TILES = 1  # as the shader binds them
_FIRST_UNIT = 0
"""First texture unit of the tracer."""
_LAYER_UNITS = 11
"""Number of texture units for layers, N-buffers, focal map, and movers, which have the last two; the ray buffers come after."""
_RAY_UNITS = 3
"""Number of texture units for rays: points, iris and lens table. Ids of mattes and planes of splats have the last two of 16."""


_MOST_LOOPS = 60_000
"""Rounds of the loops of one invocation: Mesa's rasteriser ends loops in silence after 65,535."""
_MOST_SEGMENTS = 8 * 160
"""Segments of a ray's walk: those of all intervals (``trace/footprints.glsl``, ``trace/march.glsl``)."""
_PLANES = 32
"""Planes of splats."""
_APART = 6
"""Rounds for a segment: rays of neighbouring pixels, which run together, wait for each other."""
_MOVING = 4
"""Times as many where surfaces move, for which each segment is searched."""


def _rays_within_loops(reach_m: float, layers: Layers, nbuffers: NBuffers, *, has_splats: bool, moves: bool) -> int:
    """Rays of a pixel that one invocation can trace, however far they walk; ``reach_m``: farthest from the eye in the pupil."""
    crossed_px = max(layers.view.fx, layers.view.fy) * reach_m * nbuffers.nearest_w
    segments = min(crossed_px + 8, _MOST_SEGMENTS) + (_PLANES if has_splats else 0)
    return max(1, int(_MOST_LOOPS / (_APART * (_MOVING if moves else 1) * segments)))


@dataclass(frozen=True)
class TracePass:
    """Progress of a picture after a tile.

    Attributes:
        rays: rays that each pixel has at least.
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
        self._ends_loops = "llvmpipe" in ctx.info["GL_RENDERER"]
        self._programs = programs
        self._cancellation, self._piece = cancellation, PieceSize(1 << 16, least=TILE * TILE)
        self._buffers = RayBuffers(ctx)
        self._mattes = MatteTables(ctx)
        self._maps = FocalMaps(ctx, programs)
        self._sum: moderngl.Texture | None = None
        self._tiles = _TileRays((0, 0, 0, 0), 0)
        self._tile_buffer: moderngl.Buffer | None = None
        self._is_bound, self._base_w = False, 0.0

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
        mattes: MatteNumbers | None = None,
        splats: SplatPlanes | None = None,
    ) -> Iterator[TracePass]:
        """Trace a picture pass by pass, and each pass piece by piece. `picture` has the mean over all rays after the last piece;
        `partial_picture` has the mean over the rays traced so far after any piece. Where the bundle has a budget, its rays are
        distributed over the tiles of the area (`render.trace.adaptive`).

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
            mattes: numbers of the surfaces, to note what the rays meet (`read_mattes`); the layers hold ids then.
            splats: planes of splats between the layers.

        Yields:
            Progress after each piece.
        """
        if self._ends_loops:
            reach_m = bundle.reach_m * float(focus.over_picture()[1].max())
            reach_m += 0.0 if moment_view is None else float(np.linalg.norm(moment_view.move_m))
            splats_there, moves = splats is not None, movers is not None
            most = _rays_within_loops(reach_m, layers, nbuffers, has_splats=splats_there, moves=moves)
            rays_per_pass = min(rays_per_pass, most)
        left, top, width, height = area = area or (0, 0, view.width, view.height)
        budget = bundle.pattern.budget
        tiles = self._tiles = _TileRays(area, bundle.count if budget is None else budget.rays)
        _clear(self._allocate_sum((width, height)))
        focal_map = None if focus.affine is not None else self._maps.draw(focus, area)
        program = self._program(
            layers,
            bundle,
            bound_by_rays=bound_by_rays or moment_view is not None,
            by_map=focal_map is not None,
            parts={
                "CARRIED_CAMERA": moment_view is not None,
                "MOVERS": movers is not None,
                "SPLATS": splats is not None,
                "HELD_SPLATS": splats is not None and splats.has_holdouts,
            },
            mattes=mattes,
        )
        set_uniforms(program, nearest_w=layers.view.nearest_w)
        if mattes is not None:
            self._mattes.begin(mattes, (width, height))

        def bind() -> None:
            self._bind(program, layers, nbuffers, focal_map)
            self._buffers.bind(program, bundle, first_unit=_FIRST_UNIT + _LAYER_UNITS)
            self._allocate_sum((width, height))
            if movers is not None:
                movers.bind(program, _FIRST_UNIT + _LAYER_UNITS - 2)

        def bind_more() -> None:
            """Bind what others bind between two pieces."""
            if mattes is not None:
                self._mattes.bind(program, layers, _FIRST_UNIT + _LAYER_UNITS + _RAY_UNITS)
            if splats is not None:
                clouds = () if mattes is None else mattes.splats
                splats.bind(program, _FIRST_UNIT + _LAYER_UNITS + _RAY_UNITS + 1, clouds)

        self._is_bound, self._base_w = False, layers.view.base_w
        set_uniforms(program, **layer_uniforms(layers, view))
        if moment_view is not None:
            set_uniforms(program, **moment_view.uniforms(layers.view))
        set_uniforms(program, focus=focus.affine or (0.0, 0.0, 0.0), area_first=(left, top))
        set_uniforms(program, end_pixel=(left + width, top + height))

        def trace_to(rays: IntArray, done: float, share: float) -> Iterator[TracePass]:
            """Trace the first rays of each tile, which are this share of the work after that which is done."""
            for part in self._trace_tiles(bind, bind_more, program, bundle, tiles, rays, rays_per_pass):
                yield TracePass(int(tiles.traced.min()), done + share * part)

        if budget is None:
            yield from trace_to(np.full_like(tiles.traced, bundle.count), 0.0, 1.0)
        else:
            yield from self._trace_adaptively(trace_to, tiles, budget)

    def _trace_adaptively(
        self,
        trace_to: Callable[[IntArray, float, float], Iterator[TracePass]],
        tiles: _TileRays,
        budget: RayBudget,
    ) -> Iterator[TracePass]:
        """Trace rays in two halves, and by their difference choose the next: once, or until a wanted error is reached."""
        wanted, done, share = np.full_like(tiles.traced, budget.first), 0.0, min(0.9, budget.first / budget.rays)
        total = np.zeros((tiles.height, tiles.width, 4), np.float32)
        apart = np.zeros_like(total)
        while True:
            for half in range(2):
                target = wanted if half else (tiles.traced + wanted) // 2
                yield from trace_to(target, done + half * share / 2, share / 2)
                now = self._read_sum()
                apart += now - total if half else total - now
                total = now
            done += share
            errors = tile_errors(total, apart, tiles.traced, budget.exposure)
            tiles.expected = wanted = allocate(errors, tiles.traced, tiles.pixels, budget)
            if budget.noise == 0 or (wanted == tiles.traced).all():
                yield from trace_to(wanted, done, 1 - done)
                return
            share = (1 - done) / 2

    def _trace_tiles(
        self,
        bind: Callable[[], None],
        bind_more: Callable[[], None],
        program: moderngl.ComputeShader,
        bundle: RayBundle,
        tiles: _TileRays,
        rays: IntArray,
        rays_per_pass: int,
    ) -> Iterator[float]:
        """Trace those first rays of each tile that were not traced yet, and yield the share that is done."""
        light = np.append(bundle.rgb * bundle.transmittance, bundle.rgb.mean(axis=1, keepdims=True), axis=1)
        per_ray = TILE * TILE * len(bundle.rgb)
        traced, whole, done = tiles.traced.reshape(-1), int((rays - tiles.traced).sum()), 0
        while (todo := np.flatnonzero(tiles.traced < rays)).size:
            counts = np.minimum(rays.ravel()[todo] - traced[todo], rays_per_pass)
            self._upload_tiles(np.column_stack([tiles.corners[todo], traced[todo], counts]))
            for begin, end in self._pieces(counts, per_ray):
                if not self._is_bound:
                    bind()
                    self._is_bound = True
                self._bind_tiles()
                bind_more()
                set_uniforms(program, first_tile=begin)
                for wavelength in range(len(bundle.rgb)):
                    set_uniforms(program, light=tuple(light[wavelength]))
                    self._buffers.choose_wavelength(program, bundle, wavelength)
                    program.run(end - begin)
                    self._ctx.memory_barrier()
                spent = int(counts[begin:end].sum())
                if self._cancellation.is_cancellable:
                    self._piece.learn(spent * per_ray, self._cancellation.poll())
                else:
                    self._ctx.finish()
                traced[todo[begin:end]] += counts[begin:end]
                done += spent
                yield done / whole

    def _pieces(self, counts: IntArray, per_ray: int) -> Iterator[tuple[int, int]]:
        """Cut a list of tiles, given the rays of each, into runs: short enough to cancel between, or to be one dispatch."""
        ends, begin = np.cumsum(counts, dtype=np.int64), 0
        while begin < len(counts):
            most = (self._piece.units if self._cancellation.is_cancellable else _RAYS_PER_DISPATCH) // per_ray
            before = int(ends[begin - 1]) if begin else 0
            end = max(begin + 1, int(np.searchsorted(ends, before + most, side="right")))
            end = min(end, begin + _GROUPS_PER_DISPATCH)
            yield begin, end
            begin = end

    def _upload_tiles(self, entries: IntArray) -> None:
        if self._tile_buffer is not None:
            self._tile_buffer.release()
        self._tile_buffer = self._ctx.buffer(np.ascontiguousarray(entries, np.int32).tobytes())

    def _bind_tiles(self) -> None:
        if self._tile_buffer is not None:
            self._tile_buffer.bind_to_storage_buffer(_TILES)

    def picture(self) -> FloatArray:
        """Return the mean over all rays of the area that was traced. Call it after the last pass.

        Returns:
            ``(height, width, 4)`` float32 of the area: radiance, premultiplied, over the background; alpha is coverage.
        """
        color = self._read_sum()
        return np.divide(color, np.maximum(self._tiles.over_pixels(self._tiles.traced), 1), out=color)

    def read_mattes(self) -> tuple[NDArray[np.uint32], FloatArray, float]:
        """Read what the rays met, as the mean over all rays. Call it after the last pass of a picture with mattes.

        Returns:
            What `MatteSum.put` takes: numbers of surfaces, values, and the base of inverse depths.
        """
        numbers, values = self._mattes.read()
        rays = np.maximum(self._tiles.over_pixels(self._tiles.traced), 1)
        return numbers, values / rays.astype(np.float32), self._base_w

    def partial_picture(self) -> tuple[FloatArray, FloatArray]:
        """Return the mean over the rays traced so far, and ``(height, width, 1)`` their share of all rays of each pixel.

        The device may do other work before the next piece; the picture's layers and N-buffers must not change.
        """
        tiles = self._tiles
        shares = np.minimum(tiles.traced / np.maximum(tiles.expected, 1), 1).astype(np.float32)
        self._is_bound = False
        return self.picture(), tiles.over_pixels(shares)

    def _read_sum(self) -> FloatArray:
        image = self._sum
        if image is None:
            raise ValueError("no picture has been traced")
        color = np.empty((image.height, image.width, 4), np.float32)
        image.read_into(color)
        return color

    def release(self) -> None:
        """Release the memory."""
        if self._sum is not None:
            self._sum.release()
        if self._tile_buffer is not None:
            self._tile_buffer.release()
        self._buffers.release()
        self._mattes.release()
        self._maps.release()

    def _program(
        self,
        layers: Layers,
        bundle: RayBundle,
        *,
        bound_by_rays: bool,
        by_map: bool,
        parts: dict[str, bool],
        mattes: MatteNumbers | None,
    ) -> moderngl.ComputeShader:
        defines: dict[str, int | float | str] = {name: 1 for name, is_set in parts.items() if is_set}
        if layers.count > 4:
            defines["EIGHT_LAYERS"] = 1
        if layers.may_be_translucent:
            defines["MAY_BE_TRANSLUCENT"] = 1
        if bound_by_rays:
            defines["BOUND_BY_RAYS"] = 1
        if by_map:
            defines["FOCAL_MAP"] = 1
        if mattes is not None:
            defines |= {"MATTES": 1, "SLOTS": SLOTS}
            defines |= {"DEEP": 1} if mattes.is_deep else {}
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


class _TileRays:
    """Rays of the tiles of an area.

    Args:
        area: left, top, width and height in pixels.
        rays: rays that are expected for each pixel.

    Attributes:
        width: pixels.
        height: pixels.
        pixels: ``(rows, columns)`` pixels of each tile.
        corners: ``(n, 2)`` first pixel of each tile in the picture, row by row.
        traced: ``(rows, columns)`` rays per pixel so far.
        expected: ``(rows, columns)`` rays per pixel at the end.
    """

    def __init__(self, area: Area, rays: int) -> None:
        left, top, self.width, self.height = area
        self.pixels = tile_pixels(self.width, self.height)
        y, x = np.indices(self.pixels.shape) * TILE
        self.corners = np.stack([left + x, top + y], axis=-1).reshape(-1, 2)
        self.traced = np.zeros(self.pixels.shape, np.int32)
        self.expected: IntArray = np.full(self.pixels.shape, rays, np.int32)

    def over_pixels(self, values: Values) -> Values:
        """Values of tiles as ``(height, width, 1)`` of their pixels."""
        return over_pixels(values, self.width, self.height)


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
