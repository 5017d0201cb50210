"""Motion from velocities: layers are peeled once, in the middle of the shutter's opening, and looked through at its moments.

The camera's own motion, its focus and its stop are those of each moment, exactly (`render.trace.glimpse`). What moves in the
scene is carried along the straight way between where it is when the shutter opens and when it closes (``march_moving.glsl``); its
shading and its shadows stay those of the middle. Peeling every moment anew is slower, and has neither of these two limits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import moderngl
import numpy as np

from render.gl.shaders import ProgramCache
from render.layers.movement import Movement
from render.layers.movers import Movers
from render.layers.nbuffers import NBufferBuilder, NBuffers
from render.layers.peel import Layers, Peeler
from render.layers.surface_sampling import sampling_of_layers
from render.layers.umbra import layers_needed, umbra_reach
from render.optics.view import PinholeView
from render.scene import Camera, FloatArray
from render.trace.bundles import BundleMaker, shared_rays
from render.trace.glimpse import Glimpse
from render.trace.layer_view import Extent, layer_view_of, reached, reached_from
from render.trace.picture_focus import PictureFocus, picture_focus
from render.trace.rays import RayBundle, RayPattern
from render.trace.tracer import Tracer


@dataclass(frozen=True, eq=False)
class Look:
    """What is looked at in one moment of the shutter's opening.

    Attributes:
        camera: with its lens.
        view: its picture.
        since: when: from -0.5, as the shutter opens, to 0.5.
        lines: of the picture that are exposed then, from the first to before the last.
    """

    camera: Camera
    view: PinholeView
    since: float
    lines: tuple[int, int]


@dataclass(frozen=True, eq=False)
class SweptMoment:
    """One moment of the shutter's opening.

    Attributes:
        glimpse: what the camera sees then.
        bundle: its rays.
        focus: where it is focused.
        lines: of the picture that are exposed.
    """

    glimpse: Glimpse
    bundle: RayBundle
    focus: PictureFocus
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
        looks: Sequence[Look],
        moves: Mapping[int, Movement],
        pattern: RayPattern,
        *,
        apart: int,
        wavelengths: int = 3,
        layers: int,
        supersample: float,
        unlit: bool = False,
        on_progress: Callable[[float], None] | None = None,
    ) -> Iterator[FloatArray]:
        """The picture of each moment, by its part of the rays.

        Args:
            peeler: with the scene of the middle loaded.
            middle: the picture in the middle of the time.
            looks: the moments.
            moves: how the scene's batches move.
            pattern: where the rays start of all moments that expose a place.
            apart: how many these are at most: each moment has such a part of the rays.
            wavelengths: how many to trace, for a lens with colour errors.
            layers: at most this many layers.
            supersample: layer pixels per picture pixel along each axis.
            unlit: take base colour for radiance.
            on_progress: called with the share that is done.
        """
        moments = [
            SweptMoment(
                Glimpse(middle, look.view, look.since),
                self._bundles.bundle(look.camera, look.view, pattern.part(i % apart, apart), wavelengths),
                picture_focus(look.camera, look.view),
                look.lines,
            )
            for i, look in enumerate(looks)
        ]
        peeled, moments = self._peeled(peeler, middle, moments, moves, pattern, layers, supersample, unlit)
        if not peeled.may_move:
            nbuffers = self._nbuffers.build(peeled)
            yield from self._traced(peeled, nbuffers, moments, None, on_progress)
            return
        with Movers(self._ctx, self._programs, peeled) as movers:
            nbuffers = self._nbuffers.build(peeled, movers)
            yield from self._traced(peeled, nbuffers, moments, movers, on_progress)

    def _traced(
        self,
        layers: Layers,
        nbuffers: NBuffers,
        moments: Sequence[SweptMoment],
        movers: Movers | None,
        on_progress: Callable[[float], None] | None,
    ) -> Iterator[FloatArray]:
        for i, moment in enumerate(moments):
            if movers is not None:
                movers.land(moment.glimpse.since)
            for _ in self._tracer.passes(
                layers,
                nbuffers,
                moment.bundle,
                moment.focus,
                moment.glimpse.view,
                glimpse=moment.glimpse,
                movers=movers,
                lines=moment.lines,
            ):
                pass
            yield self._tracer.picture()
            if on_progress is not None:
                on_progress((i + 1) / len(moments))

    def _peeled(
        self,
        peeler: Peeler,
        middle: PinholeView,
        moments: Sequence[SweptMoment],
        moves: Mapping[int, Movement],
        pattern: RayPattern,
        layers: int,
        supersample: float,
        unlit: bool,
    ) -> tuple[Layers, list[SweptMoment]]:
        """The layers of the middle, wide and deep enough for all moments; and the moments, without rays that are alike."""
        nearest_w = peeler.nearest_w(layer_view_of(middle, _extent(moments, 1 / middle.near_m), supersample))
        wide = layer_view_of(middle, _extent(moments, nearest_w), supersample)
        f_px = max(wide.fx, wide.fy)
        pupil_m = max(moment.bundle.reach_m * float(moment.focus.over_picture()[1].max()) for moment in moments)
        carried_m = max(_carried_m(moment.glimpse) for moment in moments) + peeler.reach_of(moves, wide) / 2
        pupil_px = f_px * (pupil_m + carried_m)
        if peeler.is_opaque:
            layers = min(layers, layers_needed(pupil_px, nearest_w))
        plane = moments[len(moments) // 2].focus.affine
        sampling = sampling_of_layers(wide, middle, plane or (0.0, 0.0, 0.0), pupil_m, pattern.whole if plane else 1)
        peeled = peeler.peel(
            wide, layers=layers, umbra=umbra_reach(pupil_px), unlit=unlit, sampling=sampling, moves=moves
        )
        return peeled, [replace(m, bundle=_shared(m, f_px, nearest_w)) for m in moments]


def _shared(moment: SweptMoment, f_px: float, nearest_w: float) -> RayBundle:
    w_f, pupil = moment.focus.over_picture()
    off_focus = pupil * np.maximum(np.abs(w_f), np.abs(nearest_w - w_f))
    return shared_rays(moment.bundle, f_px, float(off_focus.max()))


def _extent(moments: Sequence[SweptMoment], nearest_w: float) -> Extent:
    """What the rays of all moments reach, seen from the middle."""
    extents = [
        reached_from(
            reached(moment.glimpse.view, moment.bundle, moment.focus, nearest_w),
            moment.glimpse.turn,
            moment.glimpse.move_m,
            nearest_w,
        )
        for moment in moments
    ]
    return Extent(
        min(extent.left for extent in extents),
        min(extent.top for extent in extents),
        max(extent.right for extent in extents),
        max(extent.bottom for extent in extents),
    )


def _carried_m(glimpse: Glimpse) -> float:
    """How far beside its place in the middle the camera is, for rays to the corners of its picture, metres."""
    view = glimpse.view
    x = max(view.cx, view.width - view.cx) / view.fx
    y = max(view.cy, view.height - view.cy) / view.fy
    move = np.abs(glimpse.move_m)
    return float(np.hypot(move[0] + move[2] * x, move[1] + move[2] * y))
