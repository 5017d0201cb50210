"""Admission of pictures: one whose estimated cost is beyond the limit is refused before any work begins.

The estimate is processor time on two cores of a common machine with Mesa's rasteriser. How much a shot costs beside others is
learned from its pictures.
"""

from __future__ import annotations

import math
import threading
from collections import OrderedDict

from render.engines import all_engines
from service.http.errors import ServiceError
from service.models.frames import PictureQuery
from service.models.long_exposure import LongExposureBegin
from service.workers.jobs import Finished

RAY_S = 1e-7
"""Processor time of one ray."""
LAYER_PIXEL_S = 3e-8
"""Processor time of one pixel of one layer."""
SCENE_S = 0.1
"""Processor time to draw the scene once, whatever the size of the picture."""
SUPERSAMPLE = 1.5
"""Layer pixels for each picture pixel along each axis, where the engine chooses."""
NOISE_RAYS = 256
"""Rays for each pixel, where the request names the wanted noise."""
SHAPE = 9 / 16
"""Height over width of a picture that takes the shape of the film gate."""
MEASURABLE_S = 2.0
"""Pictures of a lower estimate say nothing about their shot: opening it and drawing it once is what they cost."""
MAX_FACTOR = 8.0
"""Limit of what a shot costs beside others, and of what it saves."""
MAX_SHOTS = 1000
"""Shots whose cost is remembered."""

PictureSettings = PictureQuery | LongExposureBegin


def estimate_s(picture: PictureSettings) -> float:
    """Estimate the processor time of a picture of an ordinary shot, s.

    Args:
        picture: its settings.
    """
    engine = next(engine for engine in all_engines() if engine.name == picture.engine)
    pixels = float(picture.width) * (picture.height or SHAPE * picture.width)
    rays = max(picture.rays, NOISE_RAYS) if picture.noise else picture.rays
    draws = float(picture.motion if picture.motion_by == "moments" else 1)
    if engine.draws_each_ray:
        draws = max(draws, rays)
    layer_pixels = pixels * picture.layers * (picture.supersample or SUPERSAMPLE) ** 2
    return draws * (SCENE_S + LAYER_PIXEL_S * layer_pixels) + (RAY_S * pixels * rays if engine.has_rays else 0.0)


class Admission:
    """Judge of pictures. Any thread may use it.

    Args:
        limit_s: estimated processor time of a picture that is admitted, s.
    """

    def __init__(self, limit_s: float) -> None:
        self._limit_s = limit_s
        self._factors: OrderedDict[str, float] = OrderedDict()
        self._lock = threading.Lock()

    def check(self, shot_id: str, picture: PictureSettings) -> float:
        """Estimate the processor time of a picture of an ordinary shot, s.

        Args:
            shot_id: the shot.
            picture: its settings.

        Raises:
            ServiceError: 422, the picture is expected to take longer than the limit.
        """
        try:
            ordinary_s = estimate_s(picture)
        except OverflowError:
            ordinary_s = math.inf
        with self._lock:
            expected_s = ordinary_s * self._factors.get(shot_id, 1.0)
        if expected_s > self._limit_s:
            detail = (
                f"This picture is expected to take {expected_s:,.0f} s of processor time; at most {self._limit_s:,.0f} s are "
                "given. Ask for fewer rays, pixels, moments, layers or less supersampling."
            )
            raise ServiceError(422, "too_costly", detail, path="query")
        return ordinary_s

    def learn(self, finished: Finished) -> None:
        """Learn from a finished picture how much its shot costs."""
        shot_id = finished.place.key
        if (
            shot_id is None
            or finished.error is not None
            or not finished.estimate_s
            or finished.estimate_s < MEASURABLE_S
        ):
            return
        with self._lock:
            before = self._factors.pop(shot_id, 1.0)
            factor = min(max(finished.cpu_s / finished.estimate_s, 1 / MAX_FACTOR), MAX_FACTOR)
            self._factors[shot_id] = (before + factor) / 2
            if len(self._factors) > MAX_SHOTS:
                self._factors.popitem(last=False)
