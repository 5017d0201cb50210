"""Admission of pictures: one whose estimated cost is beyond the limit is refused before any work begins.

The estimate is processor time on two cores of a common machine with Mesa's rasteriser, as each engine states it
(`Engine.cost_s`). How much a shot costs beside others is learned from its frames over HTTP.
"""

from __future__ import annotations

import math
import threading
from bisect import bisect_right
from collections import OrderedDict
from math import ceil
from typing import NamedTuple

from render.engines import all_engines
from render.engines.shared.cost import PictureWork
from render.model.shutter_intervals import MAX_MOMENTS, MIN_RAYS
from service.http.errors import ServiceError
from service.models.frames import PictureQuery
from service.models.long_exposure import LongExposureBegin
from service.workers.errors import WorkerDiedError
from service.workers.jobs import Finished

SHAPE = 9 / 16
"""Height over width of a picture that takes the shape of the film gate."""
MEASURABLE_S = 2.0
"""Pictures of a lower estimate say nothing about their shot: opening it and drawing it once is what they cost."""
MAX_FACTOR = 8.0
"""Greatest factor by which a shot is taken to cost more than an ordinary one. The least is 1: a picture from layers that were
kept is cheap, and the next one may not be."""
MAX_SHOTS = 1000
"""Shots whose cost is remembered."""

PictureSettings = PictureQuery | LongExposureBegin


class Estimate(NamedTuple):
    """Expected processor time of a picture, s.

    Attributes:
        ordinary_s: if the shot costs as much as most.
        expected_s: by what has been learned of the shot.
    """

    ordinary_s: float
    expected_s: float


def estimate_s(picture: PictureSettings, height: int | None = None) -> float:
    """Estimate the processor time of a picture of an ordinary shot, s; infinite where it is beyond all numbers.

    An interval of a long exposure that chooses its moments counts as one of the most moments, with the rays that they take.

    Args:
        picture: its settings.
        height: px, in place of the picture's own.
    """
    motion, rays = picture.motion, picture.rays
    if isinstance(picture, LongExposureBegin) and motion == 1:
        motion, rays = MAX_MOMENTS, max(rays, MIN_RAYS * MAX_MOMENTS)
    engine = next(engine for engine in all_engines() if engine.name == picture.engine)
    work = PictureWork(
        width=picture.width,
        height=height or picture.height or SHAPE * picture.width,
        rays=rays,
        layers=picture.layers,
        supersample=picture.supersample,
        noise=picture.noise,
        wavelengths=picture.wavelengths,
        motion=motion,
        motion_by=picture.motion_by,
    )
    try:
        return engine.cost_s(work)
    except OverflowError:
        return math.inf


class Admission:
    """Judge of pictures. Any thread may use it.

    Args:
        limit_s: estimated processor time of a picture that is admitted, s.
    """

    def __init__(self, limit_s: float) -> None:
        self._limit_s = limit_s
        self._factors: OrderedDict[str, float] = OrderedDict()
        self._lock = threading.Lock()

    def check(self, shot_id: str, picture: PictureSettings) -> Estimate:
        """Estimate the processor time of a picture.

        Args:
            shot_id: the shot.
            picture: its settings. One without a height is taken for 16:9; `most_px` bounds the height that its camera gives it.

        Raises:
            ServiceError: 422, the picture is expected to take longer than the limit.
        """
        ordinary_s = estimate_s(picture)
        with self._lock:
            expected_s = ordinary_s * self._factors.get(shot_id, 1.0)
        if expected_s > self._limit_s:
            detail = (
                f"This picture is expected to take {expected_s:,.0f} s of processor time; at most {self._limit_s:,.0f} s are "
                "given. Ask for fewer rays, pixels, moments, layers, less supersampling or another engine."
            )
            path = "body" if isinstance(picture, LongExposureBegin) else "query"
            raise ServiceError(422, "too_costly", detail, path=path)
        return Estimate(ordinary_s, expected_s)

    def most_px(self, shot_id: str, picture: PictureSettings, limit_px: int) -> int:
        """Return the most pixels that a picture may have: where its camera chooses the height, those that its cost allows too.

        A picture of the shape that `check` has taken it for may always have its pixels.

        Args:
            shot_id: the shot.
            picture: its settings.
            limit_px: limit of width times height of any picture.
        """
        if picture.height is not None:
            return limit_px
        with self._lock:
            most_s = self._limit_s / self._factors.get(shot_id, 1.0)
        heights = range(1, limit_px // picture.width + 1)
        height = bisect_right(heights, most_s, key=lambda height: estimate_s(picture, height))
        return min(limit_px, picture.width * max(height, ceil(SHAPE * picture.width)))

    def learn(self, finished: Finished) -> None:
        """Learn from a picture how much its shot costs: more than others, or as much.

        One that a worker had no time for counts as twice what it had used. Any other that is the first of its process is left
        out, since its time includes opening the shot.
        """
        shot_id, error = finished.place.key, finished.error
        had_no_time = isinstance(error, WorkerDiedError) and error.end in ("timeout", "cpu")
        if shot_id is None or finished.estimate_s < MEASURABLE_S or not (error is None or had_no_time):
            return
        if finished.has_started_process and not had_no_time:
            return
        ratio = min(max((2 if had_no_time else 1) * finished.cpu_s / finished.estimate_s, 1.0), MAX_FACTOR)
        with self._lock:
            before = self._factors.pop(shot_id, 1.0)
            self._factors[shot_id] = max(before, ratio) if had_no_time else (before + ratio) / 2
            if len(self._factors) > MAX_SHOTS:
                self._factors.popitem(last=False)
