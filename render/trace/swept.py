"""Motion from velocities: layers are peeled once, in the middle of the shutter's opening, and looked through at its moments.

The camera's own motion, its focus and its stop are those of each moment, exactly (`render.trace.glimpse`). What moves in the
scene is carried straight from where it is when the shutter opens to where it is in the middle, and straight on to where it is
when the shutter closes (``trace/march_moving.glsl``); its shading and its shadows stay those of the middle, and so does what
is to be
seen at all. Peeling every moment anew is slower, and has none of these limits.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass

import moderngl
import numpy as np

from render.gl.shaders import ProgramCache
from render.layers.movement import Movement, slopes_crossed
from render.layers.movers import Movers
from render.layers.nbuffers import NBufferBuilder
from render.layers.peel import Layers, Peeler
from render.layers.surface_sampling import sampling_of_layers
from render.layers.umbra import layers_needed, umbra_reach
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.optics.view import PinholeView
from render.trace.bundles import BundleMaker, shared_rays
from render.trace.glimpse import Glimpse
from render.trace.layer_view import MAX_BLUR_SHARE, MAX_SLOPE, Extent, layer_view_of, reached, reached_from
from render.trace.picture_focus import PictureFocus, picture_focus
from render.trace.rays import RayBundle, RayPattern
from render.trace.tracer import Tracer


@dataclass(frozen=True, eq=False)
class ShutterSample:
    """Camera and picture at one moment of the shutter interval.

    Attributes:
        camera: camera with its lens.
        view: its picture's view.
        since: time, from -0.5, where the shutter opens, to 0.5.
        pattern: points of the pupil that its rays start from.
        lines: half-open range of the picture's lines exposed then.
    """

    camera: Camera
    view: PinholeView
    since: float
    pattern: RayPattern
    lines: tuple[int, int]


class SweptEngine:
    """Traces moments through layers that are peeled once."""

    def __init__(
        self,
        ctx: moderngl.Context,
        programs: ProgramCache,
        nbuffers: NBufferBuilder,
        tracer: Tracer,
        bundles: BundleMaker,
    ) -> None:
        self._ctx, self._programs = ctx, programs
        self._nbuffers, self._tracer, self._bundles = nbuffers, tracer, bundles

    def pictures(
        self,
        peeler: Peeler,
        middle: PinholeView,
        looks: Sequence[ShutterSample],
        moves: Mapping[int, Movement],
        *,
        wavelengths: int = 3,
        layers: int,
        supersample: float,
        unlit: bool = False,
        on_progress: Callable[[float], None] | None = None,
    ) -> Generator[FloatArray, None, None]:
        """The picture of each moment, by its part of the rays. To be closed where it is not gone through to its end.

        Args:
            peeler: with the scene of the middle loaded.
            middle: the picture in the middle of the time.
            looks: the moments.
            moves: how the scene's batches move.
            wavelengths: how many to trace, for a lens with colour errors.
            layers: at most this many layers.
            supersample: layer pixels per picture pixel along each axis.
            unlit: take base colour for radiance.
            on_progress: called with the share that is done.
        """
        sweep = _Sweep(self._bundles, middle, looks, wavelengths)
        peeled, nearest_w = sweep.peeled(peeler, moves, layers, supersample, unlit)
        with ExitStack() as stack:
            movers = stack.enter_context(Movers(self._ctx, self._programs, peeled)) if peeled.may_move else None
            nbuffers = self._nbuffers.build(peeled, movers)
            for i, look in enumerate(looks):
                glimpse = Glimpse(middle, look.view, look.since)
                if movers is not None:
                    movers.land(look.since)
                focus = picture_focus(look.camera, look.view)
                bundle = _shared(sweep.bundle(look), focus, max(peeled.view.fx, peeled.view.fy), nearest_w)
                passes = self._tracer.passes(
                    peeled, nbuffers, bundle, focus, look.view, glimpse=glimpse, movers=movers, lines=look.lines
                )
                for _ in passes:
                    pass
                yield self._tracer.picture()
                if on_progress is not None:
                    on_progress((i + 1) / len(looks))


class _Sweep:
    """Sweep over the moments of one shutter interval. Bundles are made one at a time, since all at once may be too large."""

    def __init__(
        self, bundles: BundleMaker, middle: PinholeView, looks: Sequence[ShutterSample], wavelengths: int
    ) -> None:
        self._bundles, self._middle, self._looks, self._wavelengths = bundles, middle, looks, wavelengths

    def bundle(self, look: ShutterSample) -> RayBundle:
        return self._bundles.bundle(look.camera, look.view, look.pattern, self._wavelengths)

    def peeled(
        self, peeler: Peeler, moves: Mapping[int, Movement], layers: int, supersample: float, unlit: bool
    ) -> tuple[Layers, float]:
        """The layers of the middle, wide and deep enough for all moments, and the largest inverse depth of anything, 1/m."""
        middle = self._middle
        crossed = slopes_crossed(moves.values(), middle)
        nearest_w = peeler.nearest_w(layer_view_of(middle, self._extent(1 / middle.near_m, crossed), supersample))
        ahead_m = max(float(np.linalg.norm(Glimpse(middle, look.view, 0).move_m)) for look in self._looks)
        nearest_w = 1 / max(middle.near_m, 1 / nearest_w - ahead_m) if nearest_w > 0 else nearest_w
        wide = layer_view_of(middle, self._extent(nearest_w, crossed), supersample)
        f_px = max(wide.fx, wide.fy)
        look = self._looks[len(self._looks) // 2]
        focus = picture_focus(look.camera, look.view)
        pupil_m = max(self._pupil_m(look) for look in self._looks)
        carried_m = max(_carried_m(Glimpse(middle, look.view, look.since)) for look in self._looks)
        pupil_px = f_px * (pupil_m + carried_m)
        if peeler.is_opaque and not moves:
            layers = min(layers, layers_needed(pupil_px, nearest_w))
        plane = focus.affine
        rays = look.pattern.whole if plane else 1
        sampling = sampling_of_layers(wide, middle, plane or (0.0, 0.0, 0.0), pupil_m, rays)
        umbra = umbra_reach(pupil_px)
        return peeler.peel(wide, layers=layers, umbra=umbra, unlit=unlit, sampling=sampling, moves=moves), nearest_w

    def _pupil_m(self, look: ShutterSample) -> float:
        _, pupil = picture_focus(look.camera, look.view).over_picture()
        return self.bundle(look).reach_m * float(pupil.max())

    def _extent(self, nearest_w: float, crossed: DoubleArray) -> Extent:
        """Bounds of the rays of all moments, in slopes seen from the middle, widened by what moves into them."""
        most = MAX_BLUR_SHARE * self._middle.width / self._middle.fx
        extents = []
        for look in self._looks:
            glimpse = Glimpse(self._middle, look.view, look.since)
            own = reached(look.view, self.bundle(look), picture_focus(look.camera, look.view), nearest_w)
            extents.append(reached_from(own, glimpse.turn, glimpse.move_m, nearest_w))
        left, top = min(extent.left for extent in extents), min(extent.top for extent in extents)
        right, bottom = max(extent.right for extent in extents), max(extent.bottom for extent in extents)
        return Extent(
            min(left, max(crossed[0], left - most)),
            min(top, max(crossed[1], top - most)),
            max(right, min(crossed[2], right + most)),
            max(bottom, min(crossed[3], bottom + most)),
        )


def _shared(bundle: RayBundle, focus: PictureFocus, f_px: float, nearest_w: float) -> RayBundle:
    w_f, pupil = focus.over_picture()
    off_focus = pupil * np.maximum(np.abs(w_f), np.abs(nearest_w - w_f))
    return shared_rays(bundle, f_px, float(off_focus.max()))


def _carried_m(glimpse: Glimpse) -> float:
    """Greatest sideways offset of the camera from its place in the middle, for rays to the corners of its picture, metres."""
    view = glimpse.view
    x = max(view.cx, view.width - view.cx) / view.fx
    y = max(view.cy, view.height - view.cy) / view.fy
    corners = np.array([[i * x, j * y, 1.0] for i in (-1, 1) for j in (-1, 1)]) @ glimpse.turn.T
    slopes = np.abs(corners[:, :2] / np.maximum(corners[:, 2:], 1 / MAX_SLOPE)).max(axis=0)
    move = np.abs(glimpse.move_m)
    return float(np.hypot(*(move[:2] + move[2] * slopes)))
