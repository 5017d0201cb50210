"""The lens tracer: choose the layers' extent, peel, build N-buffers, trace."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Generator
from dataclasses import dataclass, replace
from typing import Literal, get_args

import moderngl
import numpy as np
from numpy.typing import NDArray

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint
from render.gl.shaders import ProgramCache
from render.layers.matte_numbers import MatteNumbers
from render.layers.nbuffers import NBufferBuilder, NBuffers
from render.layers.peel import Peeler
from render.layers.peeled import Layers
from render.layers.surface_hits import SurfaceDescription, without_holdouts
from render.layers.surface_sampling import layer_sampling
from render.layers.umbra import layers_needed, umbra_reach
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.model.lens import IrisShape
from render.model.limits import MAX_LAYERS, MAX_PICTURE_SIDE_PX
from render.model.mattes import MatteSum
from render.optics.distortion import chief_rays
from render.optics.view import PinholeView
from render.steps import step
from render.trace.aovs import Measurements, Measurer, chief_hits
from render.trace.bundles import BundleMaker, merge_wavelengths
from render.trace.focus_mapper import FocusMapper
from render.trace.highlights.carrier import HighlightCarrier
from render.trace.highlights.scattering import SPLAT_REACH_PX
from render.trace.layer_plan import LayerPlan
from render.trace.layer_view import make_layer_view
from render.trace.motion_tracer import MotionTracer
from render.trace.picture_focus import PictureFocus, picture_focus
from render.trace.rays import RayBundle, RayPattern, make_ray_pattern
from render.trace.splat_layers import Paint, SplatLayers, paint_nothing
from render.trace.tiling.plan import LayerBudget, plan_tiles, ray_reach_px
from render.trace.tiling.tile_tracer import TileTracer, TileWork
from render.trace.tracer import Tracer

Stage = Literal["rays", "peel", "nbuffers", "highlights", "trace"]
_MOST_SIDE_PX = 4 * MAX_PICTURE_SIDE_PX
"""Limit on a side of the layers, which no texture need hold as a whole: the largest supersampling of the largest picture."""
STAGES: tuple[Stage, ...] = get_args(Stage)
"""Stages of a picture in order: lens table, layers, N-buffers, highlights, rays."""


@dataclass(frozen=True)
class TracedPicture:
    """A traced picture and its layers.

    Attributes:
        color: ``(height, width, 4)`` float32, premultiplied.
        layers: valid until the peeler's next peeling.
        nbuffers: N-buffers of those layers, valid until the tracer's next picture.
    """

    color: FloatArray
    layers: Layers
    nbuffers: NBuffers


class LensTracer:
    """Traces lens pictures of a peeler's scene.

    Attributes:
        budget: memory of layers above which a picture is traced in tiles.
    """

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx = ctx
        self.budget = LayerBudget()
        self._nbuffers = NBufferBuilder(ctx, programs, cancellation)
        self._tracer = Tracer(ctx, programs, cancellation)
        self._highlights = HighlightCarrier(ctx, programs, cancellation)
        self._carried = self._highlights.nothing
        self._searched: tuple[Layers, float, NDArray[np.uint32] | None] | None = None
        self._tiles = TileTracer(ctx, self._nbuffers, self._tracer, self._highlights)
        self._bundles = BundleMaker(ctx, programs)
        self._splats = SplatLayers(ctx, programs)
        self.focus_mapper = FocusMapper(self._bundles, self._splats)
        self.motion_tracer = MotionTracer(
            ctx, programs, self._nbuffers, self._tracer, self._highlights, self._bundles, self._splats
        )

    def picture(
        self,
        peeler: Peeler,
        camera: Camera,
        view: PinholeView,
        pattern: RayPattern,
        *,
        wavelengths: int = 3,
        layers: int,
        supersample: float,
        texel_offset: tuple[float, float] = (0.0, 0.0),
        unlit: bool = False,
        connections: bool = True,
        bound_by_rays: bool = False,
        mattes: MatteSum | None = None,
        on_progress: Callable[[float], None] | None = None,
        on_stage: Callable[[Stage], None] = lambda stage: None,
    ) -> TracedPicture:
        """Run `trace_steps` to its end; ``on_progress`` is called with the share of the tracing that is done."""
        work = self.trace_steps(
            peeler,
            camera,
            view,
            pattern,
            wavelengths=wavelengths,
            layers=layers,
            supersample=supersample,
            texel_offset=texel_offset,
            unlit=unlit,
            connections=connections,
            bound_by_rays=bound_by_rays,
            mattes=mattes,
            on_stage=on_stage,
        )
        return _run(work, on_progress)

    def trace_steps(
        self,
        peeler: Peeler,
        camera: Camera,
        view: PinholeView,
        pattern: RayPattern,
        *,
        wavelengths: int = 3,
        layers: int,
        supersample: float,
        texel_offset: tuple[float, float] = (0.0, 0.0),
        unlit: bool = False,
        connections: bool = True,
        bound_by_rays: bool = False,
        mattes: MatteSum | None = None,
        on_stage: Callable[[Stage], None] = lambda stage: None,
    ) -> Generator[float, None, TracedPicture]:
        """Peel the loaded scene for this view and trace the camera's lens through it, piece by piece.

        Args:
            peeler: peeler with the scene loaded.
            camera: camera with its lens.
            view: view of the picture, from the pupil's centre.
            pattern: ray pattern.
            wavelengths: number of wavelengths to trace, for a lens with colour errors.
            layers: at most this many layers, and more where partly transparent surfaces are in front of opaque ones.
            supersample: layer pixels per picture pixel along each axis.
            texel_offset: position of the layers' pixels relative to those of other pictures of the mean, layer pixels.
            unlit: take the base colour as radiance.
            connections: carry highlights to the pixels of their blurred images (`render.trace.highlights.carrier`);
                not in a scene with splats, which would not hide them.
            bound_by_rays: see `Tracer.passes`.
            mattes: sum to add what the rays meet to.
            on_stage: called when all commands of a stage are issued; the device may still be working on them.

        Yields:
            The share of the tracing that is done, after each piece; `partial_picture` has the picture so far.

        Returns:
            The picture.
        """
        bundle = self._bundles.make_bundle(camera, view, pattern, wavelengths)
        connections = connections and not peeler.splats
        on_stage("rays")
        plan = self._plan(
            peeler,
            camera,
            view,
            bundle,
            pattern.whole,
            layers,
            supersample,
            texel_offset,
            unlit,
            connections,
            ids=mattes is not None,
        )
        bundle, focus, nearest_w = plan.bundle, plan.focus, plan.nearest_w
        noted = None if mattes is None else (mattes, peeler.number_surfaces(mattes))

        def peel(part: PinholeView) -> Layers:
            with step("peel layers"):
                return peeler.peel_by(plan.key_of(part))

        held = None if plan.tiles is None else plan.tiles.window_size
        paint = self._splats.painting(
            peeler.splats, plan.wide, view, focus, bundle.reach_m, held, with_mattes=mattes is not None
        )
        if plan.tiles is not None:
            work = TileWork(
                plan.tiles, peel, plan.sheets, bundle, focus, view, nearest_w, connections, bound_by_rays, noted, paint
            )
            return TracedPicture(*(yield from self._tiles.trace(work, on_stage)))
        peeled = peel(plan.wide)
        on_stage("peel")
        return (
            yield from self._trace_layers(
                peeled,
                bundle,
                focus,
                view,
                nearest_w,
                connections,
                bound_by_rays,
                mattes=noted,
                paint=paint,
                on_stage=on_stage,
            )
        )

    def keeps_layers(
        self,
        peeler: Peeler,
        camera: Camera,
        view: PinholeView,
        pattern: RayPattern,
        *,
        wavelengths: int = 3,
        layers: int,
        supersample: float,
        unlit: bool = False,
        connections: bool = True,
        ids: bool = False,
    ) -> bool:
        """Whether `trace_steps` would start with layers that the peeler keeps. Arguments as there; ``ids`` with mattes."""
        bundle = self._bundles.make_bundle(camera, view, pattern, wavelengths)
        plan = self._plan(
            peeler, camera, view, bundle, pattern.whole, layers, supersample, (0.0, 0.0), unlit, connections, ids=ids
        )
        return plan.tiles is None and peeler.keeps(plan.key_of(plan.wide))

    def _plan(
        self,
        peeler: Peeler,
        camera: Camera,
        view: PinholeView,
        bundle: RayBundle,
        rays: int,
        layers: int,
        supersample: float,
        texel_offset: tuple[float, float],
        unlit: bool,
        connections: bool,
        *,
        ids: bool,
    ) -> LayerPlan:
        focus = picture_focus(camera, view)
        w_f, pupil = focus.over_picture()
        widest = make_layer_view(view, bundle, focus, supersample, view.nearest_w, _MOST_SIDE_PX)
        nearest_w = peeler.nearest_w(widest)
        wide = make_layer_view(view, bundle, focus, supersample, nearest_w, _MOST_SIDE_PX)
        wide = replace(wide, cx=wide.cx + texel_offset[0], cy=wide.cy + texel_offset[1])
        f_px = max(wide.fx, wide.fy)
        pupil_px = f_px * bundle.reach_m * float(pupil.max())
        off_focus = pupil * np.maximum(np.abs(w_f), np.abs(nearest_w - w_f))
        bundle = merge_wavelengths(bundle, f_px, float(off_focus.max()))
        if peeler.is_opaque:
            layers = min(layers, layers_needed(pupil_px, nearest_w))
        sheets = layers if peeler.is_opaque or pupil_px == 0 else MAX_LAYERS
        plane = focus.affine
        sampling = layer_sampling(wide, view, plane or (0.0, 0.0, 0.0), bundle.reach_m, rays if plane else 1)
        scale = wide.fx / view.fx
        reach_px = ray_reach_px(bundle, focus, wide, scale, nearest_w)
        if connections and bundle.table is not None:
            reach_px += SPLAT_REACH_PX * scale
        most_side_px = int(self._ctx.info["GL_MAX_TEXTURE_SIZE"])
        tiles = plan_tiles(view, wide, reach_px, sheets, self.budget, most_side_px, lit=not unlit, ids=ids)
        umbra = umbra_reach(pupil_px)
        return LayerPlan(bundle, focus, wide, nearest_w, layers, sheets, umbra, unlit, sampling, ids, tiles)

    def trace_layers(
        self,
        peeled: Layers,
        camera: Camera,
        view: PinholeView,
        pattern: RayPattern,
        *,
        wavelengths: int,
        nearest_w: float,
        on_stage: Callable[[Stage], None] = lambda stage: None,
    ) -> FloatArray:
        """Trace the camera's lens through layers that were peeled for any focus and stop.

        Args:
            peeled: layers from the picture's own eye, at any resolution; beyond their edge they are continued by its pixels.
            camera: camera with its lens.
            view: view of the picture.
            pattern: ray pattern.
            wavelengths: number of wavelengths to trace, for a lens with colour errors.
            nearest_w: largest inverse depth of any surface in view, 1/m.
            on_stage: as for `trace_steps`.

        Returns:
            ``(height, width, 4)`` float32, premultiplied.
        """
        bundle = self._bundles.make_bundle(camera, view, pattern, wavelengths)
        focus = picture_focus(camera, view)
        w_f, pupil = focus.over_picture()
        off_focus = pupil * np.maximum(np.abs(w_f), np.abs(nearest_w - w_f))
        bundle = merge_wavelengths(bundle, max(peeled.view.fx, peeled.view.fy), float(off_focus.max()))
        connections = not peeled.splats
        candidates = self._candidates(peeled, camera, bundle, view, nearest_w) if connections else None
        work = self._trace_layers(
            peeled,
            bundle,
            focus,
            view,
            nearest_w,
            connections,
            candidates=candidates,
            paint=self._splats.painting(peeled.splats, peeled.whole, view, focus, bundle.reach_m),
            on_stage=on_stage,
        )
        return _run(work).color

    def _candidates(
        self, peeled: Layers, camera: Camera, bundle: RayBundle, view: PinholeView, nearest_w: float
    ) -> NDArray[np.uint32] | None:
        """Texels of layers that may be highlights at some focus: those that are with the focus at infinity or on the nearest
        surface. They are kept while the layers are, and the stop is not opened."""
        if self._searched is None or self._searched[0] is not peeled or bundle.reach_m > self._searched[1]:
            farthest_m = 1 / view.base_w if view.base_w > 0 else math.inf
            distances_m = farthest_m, 1 / max(nearest_w + view.base_w, 1e-6)
            cameras = (replace(camera, focus_distance_m=metres, focal_surface=None) for metres in distances_m)
            focused = (picture_focus(one, view) for one in cameras)
            texels = self._highlights.search_focused(peeled, bundle, focused, view)
            self._searched = peeled, bundle.reach_m, texels
        return self._searched[2]

    def _trace_layers(
        self,
        peeled: Layers,
        bundle: RayBundle,
        focus: PictureFocus,
        view: PinholeView,
        nearest_w: float,
        connections: bool = True,
        bound_by_rays: bool = False,
        candidates: NDArray[np.uint32] | None = None,
        mattes: tuple[MatteSum, MatteNumbers] | None = None,
        paint: Paint = paint_nothing,
        on_stage: Callable[[Stage], None] = lambda stage: None,
    ) -> Generator[float, None, TracedPicture]:
        nbuffers = self._nbuffers.build(peeled, nearest_w)
        on_stage("nbuffers")
        carried = self._carried = self._highlights.nothing
        if connections:
            found = self._highlights.find(peeled, bundle, focus, view, candidates=candidates)
            carried = self._carried = self._highlights.carry(found, peeled, nbuffers, bundle, focus, view)
        on_stage("highlights")
        sums, numbers = mattes or (None, None)
        passes = self._tracer.passes(
            peeled,
            nbuffers,
            bundle,
            focus,
            view,
            bound_by_rays=bound_by_rays,
            mattes=numbers,
            splats=paint(peeled),
        )
        for done in carried.without(passes):
            yield done.share
        color = carried.add_to(self._tracer.picture())
        if sums is not None:
            sums.put((0, 0, *view.size), *self._tracer.read_mattes())
        on_stage("trace")
        return TracedPicture(color, peeled, nbuffers)

    def partial_picture(self) -> tuple[FloatArray, FloatArray]:
        """Picture so far: see `Tracer.partial_picture`."""
        picture, shares = self._tracer.partial_picture()
        if self._tiles.is_at_work:
            return self._tiles.with_unfinished(picture, shares)
        return self._carried.add_to(picture), shares

    def measure_aovs(
        self, peeler: Peeler, camera: Camera, view: PinholeView, stage_from_world: DoubleArray, names: Collection[str]
    ) -> Measurements:
        """Measure AOVs along the picture's chief rays: see `render.trace.aovs`."""
        bundle = self._bundles.make_bundle(camera, view, make_ray_pattern(1, IrisShape()))
        hits = without_holdouts(chief_hits(peeler, view, chief_rays(camera), self._splats), peeler.index.draws)
        surfaces = SurfaceDescription(peeler.index.draws, hits, view.camera_from_world)
        focus = picture_focus(camera, view)
        return Measurer(view, bundle, focus, hits, surfaces, stage_from_world, camera.set_back_m).measure(names)

    def release_window(self) -> None:
        """Release the layers and N-buffers of the last tile, so that a large picture can be developed in their place."""
        if self._tiles.release_window():
            self._nbuffers.release()

    def release(self) -> None:
        """Release the memory."""
        self._searched = None
        self.focus_mapper.release()
        self._nbuffers.release()
        self._tiles.release_window()
        self._tracer.release()
        self._highlights.release()
        self._splats.release()


def _run(
    work: Generator[float, None, TracedPicture], on_progress: Callable[[float], None] | None = None
) -> TracedPicture:
    """Run a generator to its end, passing on its progress, and return its result."""
    while True:
        try:
            share = next(work)
        except StopIteration as end:
            traced: TracedPicture = end.value
            return traced
        if on_progress is not None:
            on_progress(share)
