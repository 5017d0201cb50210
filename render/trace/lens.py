"""The lens engine: how large the layers must be, peel, bound, trace."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import moderngl
import numpy as np

from render.gl.shaders import ProgramCache
from render.layers.nbuffers import NBufferBuilder
from render.layers.peel import Layers, Peeler, umbra_reach
from render.optics.view import MAX_PICTURE_SIDE_PX, PinholeView
from render.scene import Camera, FloatArray
from render.trace.bundles import BundleMaker, shared_rays
from render.trace.rays import FocalSurface, RayBundle, RayPattern, plane_of_focus
from render.trace.tracer import Tracer

MAX_GUARD_SHARE = 0.08
"""The guard band's width on each side is at most this share of the picture's longer side: beyond it, rays see the edge's
pixels repeated. Only surfaces whose circle of confusion is larger than that, near the picture's edge, are touched by it."""


@dataclass(frozen=True)
class TracedPicture:
    """A traced picture and what it was traced from.

    Attributes:
        color: ``(height, width, 4)`` float32, premultiplied.
        layers: valid until the peeler's next peeling.
        guard_px: guard band in layer pixels.
    """

    color: FloatArray
    layers: Layers
    guard_px: int


class LensEngine:
    """Traces lens pictures of a peeler's scene."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._nbuffers = NBufferBuilder(ctx, programs)
        self._tracer = Tracer(ctx, programs)
        self._bundles = BundleMaker(ctx, programs)

    def picture(
        self,
        peeler: Peeler,
        camera: Camera,
        view: PinholeView,
        pattern: RayPattern,
        *,
        wavelengths: int = 3,
        layers: int,
        supersample: int,
        unlit: bool = False,
        on_progress: Callable[[float], None] | None = None,
    ) -> TracedPicture:
        """Peel the loaded scene for this view and trace the camera's lens through it.

        Args:
            peeler: with the scene loaded.
            camera: with its lens.
            view: the picture, from the pupil's centre.
            pattern: where the rays start.
            wavelengths: how many to trace, for a lens with colour errors.
            layers: at most this many layers.
            supersample: layer pixels per picture pixel along each axis.
            unlit: take base colour for radiance.
            on_progress: called with the share of the tracing that is done.
        """
        bundle = self._bundles.bundle(camera, view, pattern, wavelengths)
        surface = plane_of_focus(camera)
        guard_px = guard_band_px(view, bundle, surface, supersample)
        wide = view.enlarged(supersample, guard_px)
        pupil_px = max(wide.fx, wide.fy) * bundle.reach_m
        umbra = umbra_reach(pupil_px)
        bundle = shared_rays(bundle, max(wide.fx, wide.fy), max(surface.w0, 1 / view.near_m - surface.w0))
        peeled = peeler.peel(wide, layers=layers, umbra=umbra, unlit=unlit, picture_px=float(supersample))
        nbuffers = self._nbuffers.build(peeled)
        for done in self._tracer.passes(peeled, nbuffers, bundle, surface, view):
            if on_progress is not None:
                on_progress(done.share)
        return TracedPicture(self._tracer.picture(), peeled, guard_px)

    def release(self) -> None:
        """Give the memory back."""
        self._nbuffers.release()
        self._tracer.release()


def guard_band_px(view: PinholeView, bundle: RayBundle, surface: FocalSurface, supersample: int) -> int:
    """Layer pixels beyond each edge of the picture that its rays may reach: the largest circle of confusion, capped."""
    x, y = np.array([0, view.width, 0, view.width]), np.array([0, 0, view.height, view.height])
    focus = surface.w0 + surface.slope_x * x + surface.slope_y * y
    largest = max(view.fx, view.fy) * bundle.reach_m * max(np.abs(focus).max(), np.abs(1 / view.near_m - focus).max())
    room = (MAX_PICTURE_SIDE_PX - supersample * max(view.width, view.height)) // 2
    cap = min(MAX_GUARD_SHARE * max(view.width, view.height), largest) * supersample
    return int(min(np.ceil(cap) + 2 * supersample, max(room, 0)))
