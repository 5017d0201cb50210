"""Motion from velocities: layers are peeled once, in the middle of the shutter interval, and traced at each of its moments.

The camera's own motion, focus and stop are exact at each moment (`render.trace.moment_view`). Moving surfaces follow a
straight line from their position as the shutter opens to that in the middle, and another to that as it closes
(``trace/march_moving.glsl``); their shading, shadows and visibility stay those of the middle. Highlights are carried at each
moment to where its camera sees them (`render.trace.highlights.carrier`). Peeling every moment is slower, and has none of these
limits.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypedDict

import moderngl
import numpy as np

from render.gl.shaders import ProgramCache
from render.layers.movement import Movement, nearest_moving_w, swept_bounds
from render.layers.movers import Movers
from render.layers.nbuffers import NBufferBuilder
from render.layers.peel import Peeler
from render.layers.peeled import Layers
from render.layers.reach import CLOSED
from render.layers.surface_sampling import layer_sampling
from render.layers.umbra import layers_needed, umbra_reach
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.model.limits import MAX_LAYERS
from render.model.mattes import MatteSum
from render.optics.view import PinholeView
from render.trace.bundles import BundleMaker, merge_wavelengths
from render.trace.highlights.carrier import HighlightCarrier, SeenMoment
from render.trace.layer_view import MAX_BLUR_SHARE, MAX_SLOPE, RayExtent, bound_rays, extend_view, transform_extent
from render.trace.moment_view import MomentView
from render.trace.picture_focus import PictureFocus, picture_focus
from render.trace.rays import RayBundle, RayPattern
from render.trace.splat_layers import SplatLayers
from render.trace.tracer import Tracer

if TYPE_CHECKING:  # loaded where a scene has splats
    from render.trace.splats.planes import SplatPlanes


@dataclass(frozen=True, eq=False)
class ShutterSample:
    """Camera and picture at one moment of the shutter interval.

    Attributes:
        camera: camera with its lens.
        view: its picture's view.
        shutter_time: time, from -0.5, where the shutter opens, to 0.5.
        pattern: points of the pupil that its rays start from.
        lines: half-open range of the picture's lines exposed then.
    """

    camera: Camera
    view: PinholeView
    shutter_time: float
    pattern: RayPattern
    lines: tuple[int, int]


class _MomentArguments(TypedDict):
    """Arguments that say at which moment layers are traced."""

    moment_view: MomentView
    movers: Movers | None


class MotionTracer:
    """Traces the moments of a shutter interval through layers that are peeled once."""

    def __init__(
        self,
        ctx: moderngl.Context,
        programs: ProgramCache,
        nbuffers: NBufferBuilder,
        tracer: Tracer,
        highlights: HighlightCarrier,
        bundles: BundleMaker,
        splats: SplatLayers,
    ) -> None:
        self._ctx, self._programs = ctx, programs
        self._nbuffers, self._tracer, self._highlights, self._bundles = nbuffers, tracer, highlights, bundles
        self._splats = splats

    def trace_moments(
        self,
        peeler: Peeler,
        middle: PinholeView,
        samples: Sequence[ShutterSample],
        moves: Mapping[int, Movement],
        *,
        wavelengths: int = 3,
        layers: int,
        supersample: float,
        unlit: bool = False,
        connections: bool = True,
        mattes: MatteSum | None = None,
        on_progress: Callable[[float], None] | None = None,
    ) -> Generator[FloatArray, None, None]:
        """Trace the picture of each moment by its part of the rays. Close the generator if it is not exhausted.

        Args:
            peeler: with the scene of the middle loaded.
            middle: view in the middle of the interval.
            samples: moments of the interval.
            moves: movements of the scene's batches.
            wavelengths: number of wavelengths to trace, for a lens with colour errors.
            layers: at most this many layers, and more where partly transparent surfaces are in front of opaque ones.
            supersample: layer pixels per picture pixel along each axis.
            unlit: take the base colour as radiance.
            connections: carry highlights to the pixels of their blurred images (`render.trace.highlights.carrier`).
            mattes: sum to add what the rays of each moment meet to.
            on_progress: called with the share that is done.
        """
        sweep = _ShutterSweep(self._bundles, middle, samples, wavelengths)
        peeled, nearest_w = sweep.peel(peeler, moves, layers, supersample, unlit, ids=mattes is not None)
        numbers = None if mattes is None else peeler.number_surfaces(mattes)
        with ExitStack() as stack:
            movers = stack.enter_context(Movers(self._ctx, self._programs, peeled)) if peeled.may_move else None
            nearest = max(nearest_w, nearest_moving_w(moves.values(), peeled.view))
            nbuffers = self._nbuffers.build(peeled, nearest, movers)

            def seen(sample: ShutterSample) -> SeenMoment:
                focus = picture_focus(sample.camera, sample.view)
                bundle = _merge_wavelengths(sweep.bundle(sample), focus, max(peeled.view.fx, peeled.view.fy), nearest_w)
                return bundle, focus, MomentView(middle, sample.view, sample.shutter_time)

            drawn = self._paint(peeled, middle, samples[len(samples) // 2], sweep, with_mattes=mattes is not None)
            candidates = None
            if connections and drawn is None:
                searched = [samples[i] for i in sorted({0, len(samples) // 2, len(samples) - 1})]
                candidates = self._highlights.search(peeled, map(seen, searched), movers)
            for i, sample in enumerate(samples):
                first, stop = sample.lines
                if stop <= first:
                    yield np.zeros((sample.view.height, sample.view.width, 4), np.float32)
                    continue
                if movers is not None:
                    movers.update(sample.shutter_time)
                bundle, focus, moment_view = seen(sample)
                area = 0, first, sample.view.width, stop - first
                moment: _MomentArguments = {"moment_view": moment_view, "movers": movers}
                carried = self._highlights.nothing
                if candidates is not None:
                    found = self._highlights.find(
                        peeled, bundle, focus, sample.view, area=area, candidates=candidates, **moment
                    )
                    carried = self._highlights.carry(
                        found, peeled, nbuffers, bundle, focus, sample.view, area, **moment
                    )
                for _ in carried.without(
                    self._tracer.passes(
                        peeled, nbuffers, bundle, focus, sample.view, area=area, mattes=numbers, splats=drawn, **moment
                    )
                ):
                    pass
                if mattes is not None:
                    mattes.put(area, *self._tracer.read_mattes())
                yield _pad_lines(carried.add_to(self._tracer.picture()), first, sample.view.height)
                if on_progress is not None:
                    on_progress((i + 1) / len(samples))

    def _paint(
        self, peeled: Layers, middle: PinholeView, sample: ShutterSample, sweep: _ShutterSweep, *, with_mattes: bool
    ) -> SplatPlanes | None:
        """Draw the splats between the layers, for the focus half-way; None where the scene has none."""
        if not peeled.splats:
            return None
        focus = picture_focus(sample.camera, sample.view)
        pupil_m = sweep.bundle(sample).reach_m
        paint = self._splats.painting(peeled.splats, peeled.whole, middle, focus, pupil_m, with_mattes=with_mattes)
        return paint(peeled)


class _ShutterSweep:
    """Sweep over the moments of one shutter interval. Bundles are made one at a time, since all at once may be too large."""

    def __init__(
        self, bundles: BundleMaker, middle: PinholeView, samples: Sequence[ShutterSample], wavelengths: int
    ) -> None:
        self._bundles, self._middle, self._samples, self._wavelengths = bundles, middle, samples, wavelengths

    def bundle(self, sample: ShutterSample) -> RayBundle:
        return self._bundles.make_bundle(sample.camera, sample.view, sample.pattern, self._wavelengths)

    def peel(
        self, peeler: Peeler, moves: Mapping[int, Movement], layers: int, supersample: float, unlit: bool, *, ids: bool
    ) -> tuple[Layers, float]:
        """Peel the layers of the middle for all moments; return them and the largest inverse depth of any surface, 1/m."""
        middle = self._middle
        swept_slopes = swept_bounds(moves.values(), middle)
        nearest_w = peeler.nearest_w(extend_view(middle, self._extent(1 / middle.near_m, swept_slopes), supersample))
        ahead_m = max(float(np.linalg.norm(MomentView(middle, sample.view, 0).move_m)) for sample in self._samples)
        nearest_w = 1 / max(middle.near_m, 1 / nearest_w - ahead_m) if nearest_w > 0 else nearest_w
        wide = extend_view(middle, self._extent(nearest_w, swept_slopes), supersample)
        f_px = max(wide.fx, wide.fy)
        sample = self._samples[len(self._samples) // 2]
        focus = picture_focus(sample.camera, sample.view)
        pupil_m = max(self._pupil_m(sample) for sample in self._samples)
        camera_offset_m = max(
            _camera_offset_m(MomentView(middle, sample.view, sample.shutter_time)) for sample in self._samples
        )
        pupil_px = f_px * (pupil_m + camera_offset_m)
        if peeler.is_opaque and not moves:
            layers = min(layers, layers_needed(pupil_px, nearest_w))
        plane = focus.affine
        rays = sample.pattern.whole if plane else 1
        sampling = layer_sampling(wide, middle, plane or (0.0, 0.0, 0.0), pupil_m, rays)
        umbra = umbra_reach(pupil_px)
        sheets = layers if peeler.is_opaque or pupil_px == 0 else MAX_LAYERS
        peeled = peeler.peel(
            wide,
            layers=layers,
            umbra=umbra,
            unlit=unlit,
            sampling=sampling,
            moves=moves,
            reachable=CLOSED,
            sheets=sheets,
            ids=ids,
        )
        return peeled, nearest_w

    def _pupil_m(self, sample: ShutterSample) -> float:
        _, pupil = picture_focus(sample.camera, sample.view).over_picture()
        return self.bundle(sample).reach_m * float(pupil.max())

    def _extent(self, nearest_w: float, swept_slopes: DoubleArray) -> RayExtent:
        """Bounds of the rays of all moments, in slopes seen from the middle, widened by what moves into them."""
        most = MAX_BLUR_SHARE * self._middle.width / self._middle.fx
        extents = []
        for sample in self._samples:
            moment_view = MomentView(self._middle, sample.view, sample.shutter_time)
            own = bound_rays(sample.view, self.bundle(sample), picture_focus(sample.camera, sample.view), nearest_w)
            extents.append(transform_extent(own, moment_view.turn, moment_view.move_m, nearest_w))
        left, top = min(extent.left for extent in extents), min(extent.top for extent in extents)
        right, bottom = max(extent.right for extent in extents), max(extent.bottom for extent in extents)
        return RayExtent(
            min(left, max(swept_slopes[0], left - most)),
            min(top, max(swept_slopes[1], top - most)),
            max(right, min(swept_slopes[2], right + most)),
            max(bottom, min(swept_slopes[3], bottom + most)),
        )


def _pad_lines(color: FloatArray, first: int, height: int) -> FloatArray:
    """Add empty lines before and after some lines of a picture."""
    if len(color) == height:
        return color
    return np.pad(color, ((first, height - first - len(color)), (0, 0), (0, 0)))


def _merge_wavelengths(bundle: RayBundle, focus: PictureFocus, f_px: float, nearest_w: float) -> RayBundle:
    w_f, pupil = focus.over_picture()
    off_focus = pupil * np.maximum(np.abs(w_f), np.abs(nearest_w - w_f))
    return merge_wavelengths(bundle, f_px, float(off_focus.max()))


def _camera_offset_m(moment_view: MomentView) -> float:
    """Greatest sideways offset of the camera from its place in the middle, for rays to the corners of its picture, metres."""
    view = moment_view.view
    x = max(view.cx, view.width - view.cx) / view.fx
    y = max(view.cy, view.height - view.cy) / view.fy
    corners = np.array([[i * x, j * y, 1.0] for i in (-1, 1) for j in (-1, 1)]) @ moment_view.turn.T
    slopes = np.abs(corners[:, :2] / np.maximum(corners[:, 2:], 1 / MAX_SLOPE)).max(axis=0)
    move = np.abs(moment_view.move_m)
    return float(np.hypot(*(move[:2] + move[2] * slopes)))
