"""Samples of an open shutter for `Engine.draw_swept`: at each moment a camera, its part of the rays, and the exposed lines."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np

from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.lens import IrisShape
from render.model.moment import Moment
from render.optics.view import PinholeView
from render.trace.motion_tracer import ShutterSample
from render.trace.rays import RayPattern, make_ray_pattern


def make_shutter_samples(
    moments: Sequence[Moment], settings: FrameSettings, ray_parts: int, close_iris: Callable[[Camera], Camera]
) -> list[ShutterSample]:
    """Make a sample of each moment.

    Args:
        moments: evenly over the shutter's opening, in order; their scenes do not matter.
        settings: size, rays and seed.
        ray_parts: number of successive moments over which all rays are spread.
        close_iris: closes the iris of a camera where the engine is sharp.
    """

    @lru_cache(maxsize=1)  # the iris mostly stays the same
    def pattern_of(iris: IrisShape) -> RayPattern:
        return make_ray_pattern(settings.rays, iris, seed=settings.seed, tiled=settings.tiled)

    samples = []
    for i, moment in enumerate(moments):
        camera = close_iris(moment.camera)
        view = PinholeView.from_camera(camera, settings.width, settings.height)
        shutter_time = (i + 0.5) / len(moments) - 0.5
        pattern = pattern_of(camera.iris).part(i % ray_parts, ray_parts)
        samples.append(ShutterSample(camera, view, shutter_time, pattern, _exposed_lines(moment, settings)))
    return samples


def _exposed_lines(moment: Moment, settings: FrameSettings) -> tuple[int, int]:
    """Give the first exposed line of the picture and the one after the last; 0 and 0 where none is."""
    exposed = np.broadcast_to(np.asarray(moment.share) > 0, (settings.height, settings.width, 1))
    lines = np.flatnonzero(exposed.any(axis=(1, 2)))
    return (int(lines[0]), int(lines[-1]) + 1) if len(lines) else (0, 0)
