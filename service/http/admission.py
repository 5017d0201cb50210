"""Admission of pictures: one beyond the limits of pixels or of estimated cost is refused before any work begins.

How much a shot costs beside others is learned from its frames over HTTP.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Sequence
from typing import NamedTuple

from service.models.long_exposure import LongExposureBegin
from service.models.picture_limits import PictureCost, PictureLimits, PictureSettings, check_cost, check_pixels
from service.workers.errors import WorkerDiedError
from service.workers.jobs import Finished

MEASURABLE_S = 2.0
"""Pictures of a lower estimate say nothing about their shot: opening it and drawing it once is what they cost."""
MAX_FACTOR = 8.0
"""Greatest factor by which a shot is taken to cost more than an ordinary one. The least is 1: a picture from layers that were
kept is cheap, and the next one may not be."""
MAX_SHOTS = 1000
"""Shots whose cost is remembered."""


class Admitted(NamedTuple):
    """A picture within the limits.

    Attributes:
        cost: what it is expected to cost.
        limits: what it may have.
    """

    cost: PictureCost
    limits: PictureLimits


class Admission:
    """Judge of pictures. Any thread may use it.

    Args:
        max_s: limit of the expected processor time of a picture, s.
        max_px: limit of its width times height.
    """

    def __init__(self, max_s: float, max_px: int) -> None:
        self._max_s, self._max_px = max_s, max_px
        self._factors: OrderedDict[str, float] = OrderedDict()
        self._lock = threading.Lock()

    def check(
        self, shot_id: str, picture: PictureSettings, path: str | None = None, aovs: Sequence[str] = ()
    ) -> Admitted:
        """Admit a picture.

        Args:
            shot_id: the shot.
            picture: its settings. One without a height is judged as 16:9 here, and in the shape of its film gate by the worker.
            path: part of the request that errors name; by default where such settings are sent.
            aovs: measured beside the colour.

        Raises:
            SettingsError: the picture has too many pixels, or is expected to take too long.
        """
        path = path or _path_of(picture)
        check_pixels(picture.width, picture.height, self._max_px, path)
        with self._lock:
            factor = self._factors.get(shot_id, 1.0)
        cost = PictureCost.of(picture, factor, aovs)
        check_cost(cost, self._max_s, path)
        return Admitted(cost, PictureLimits(self._max_px, self._max_s, cost, path))

    def check_preview(self, picture: PictureSettings) -> PictureLimits:
        """Return the limits of a preview, drawn in the time that it is given. Raises `SettingsError`: it has too many pixels."""
        path = _path_of(picture)
        check_pixels(picture.width, picture.height, self._max_px, path)
        return PictureLimits(self._max_px, path=path)

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


def _path_of(picture: PictureSettings) -> str:
    return "body" if isinstance(picture, LongExposureBegin) else "query"
