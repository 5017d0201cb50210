"""The focus of a stage's cameras at any time; what follows over time is worked out once for the whole shot."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pxr import Usd

from render.model.arrays import DoubleArray
from render.model.scene import Scene
from render.shot.focus.focus_reading import FocusReading, read_focus
from render.shot.focus.focus_solving import FocusTrack, follows_over_time, keeps_sides, solved
from render.shot.focus.focused import Focused, focused
from render.stage import AnchorReader, frame_range
from usd_schemas import LensCamera

MAX_FOLLOWED_FRAMES = 20_000
"""A hand that follows is followed from the first frame of the shot to its last. In a longer shot, and beyond the ends of any, it
is followed from a while before the part of the shot in which the time lies."""

_PART, _BEFORE, _AFTER = 500, 1500, 250  # frames: a minute's run-up is longer than a hand is late
_KEPT = 8  # stretches of frames, of all cameras
_SAME_FRAME = 1e-6  # of a frame: nearer than this to a frame is that frame

_Stretch = tuple[int, int]
"""First and last frame of what is worked out at once, counted from the first of the shot."""


@dataclass(frozen=True)
class _Frames:
    """The frames of a shot: the first is frame 0."""

    start: float
    step: float
    count: int

    @classmethod
    def of(cls, stage: Usd.Stage) -> _Frames:
        """Those of a stage; one whose range is turned about has its first alone."""
        shot, step = frame_range(stage), stage.GetTimeCodesPerSecond() / stage.GetFramesPerSecond()
        return cls(shot.start, step, max(1, math.ceil((shot.end - shot.start) / step - _SAME_FRAME) + 1))

    def stretch(self, time: float) -> _Stretch:
        """Which frames the focus at a time follows from. It depends on nothing but the time, so that a frame has the same focus
        whatever was looked at before; and less than a frame beyond the shot, as a shutter opens, is in it still."""
        frame = (time - self.start) / self.step
        if -1 < frame < self.count and self.count <= MAX_FOLLOWED_FRAMES:
            return 0, self.count - 1
        part = math.floor(frame / _PART) * _PART
        first = part - _BEFORE
        return (max(first, 0) if frame > -1 else first), part + _PART + _AFTER

    def times(self, stretch: _Stretch, key_times: DoubleArray) -> DoubleArray:
        """The frames of a stretch, and the keys between them: what is exact there must be so between frames too."""
        first, last = stretch
        keys = (key_times - self.start) / self.step
        between = keys[(keys > first) & (keys < last) & (np.abs(keys - np.rint(keys)) > _SAME_FRAME)]
        return self.start + self.step * np.union1d(first + np.arange(last - first + 1.0), between)


class CameraFocus:
    """Focuses the cameras of one stage.

    Args:
        stage: the stage.
        anchors: finds focus points on it.
        scene_at: what is drawn at a time.
    """

    def __init__(self, stage: Usd.Stage, anchors: AnchorReader, scene_at: Callable[[float], Scene]) -> None:
        self._stage = stage
        self._anchors = anchors
        self._scene_at = scene_at
        self._followed: OrderedDict[tuple[str, int, _Stretch], FocusTrack] = OrderedDict()

    def at(self, camera_path: str, time: float, revision: int) -> Focused:
        """A camera at one time.

        Whether a point is inside the picture is asked of the camera's own film gate: where the focus lies must not depend on the
        size or shape of the picture that somebody looks at.

        Args:
            camera_path: of a camera.
            time: USD time code.
            revision: of the edits; what was worked out with another is old.

        Raises:
            CameraError: it is no camera, or it or its focus points have impossible numbers.
            InputError: its lens is none.
        """
        return self.over(camera_path, [time], revision)[0]

    def over(self, camera_path: str, times: Sequence[float], revision: int) -> list[Focused]:
        """A camera at rising times.

        Args:
            camera_path: of a camera.
            times: rising USD time codes.
            revision: of the edits.

        Raises:
            CameraError: as `at`.
            InputError: as `at`.
        """
        reading = self._read(camera_path, times)
        track = solved(reading)
        followed = self._followed_columns(camera_path, reading)
        if followed:
            track = self._as_followed(track, reading, revision, followed)
        return [focused(reading, track, i) for i in range(len(times))]

    def _read(self, camera_path: str, times: Sequence[float]) -> FocusReading:
        return read_focus(self._stage, self._anchors, camera_path, times, self._scene_at)

    def _followed_columns(self, camera_path: str, reading: FocusReading) -> tuple[str, ...]:
        """What of the focus at one time depends on other times."""
        if reading.focus[0].mode == "manual":
            return ()
        camera = LensCamera(self._stage.GetPrimAtPath(camera_path))
        keyed = (camera.keys(f"focus:{name}") for name in ("smoothing", "lag", "deadZone", "maxSpeed"))
        if any(follows_over_time(focus) for focus in reading.focus) or any(keyed):
            return _BY_A_HAND
        return ("sides",) if keeps_sides(reading) else ()

    def _as_followed(
        self, track: FocusTrack, reading: FocusReading, revision: int, followed: tuple[str, ...]
    ) -> FocusTrack:
        """The track with what follows over time taken from the frames before and after, joined by straight lines between them."""
        frames = _Frames.of(self._stage)
        stretches = [frames.stretch(time) for time in track.times.tolist()]
        columns: dict[str, Any] = {name: np.array(getattr(track, name)) for name in followed}
        for stretch in dict.fromkeys(stretches):
            rows = np.array([stretch == of_time for of_time in stretches])
            whole = self._over_stretch(reading, frames, stretch, revision)
            for name, column in columns.items():
                column[rows] = _between(whole.times, getattr(whole, name), track.times[rows])
        return replace(track, **columns)

    def _over_stretch(self, reading: FocusReading, frames: _Frames, stretch: _Stretch, revision: int) -> FocusTrack:
        path = reading.cameras[0].path
        key = path, revision, stretch
        if key not in self._followed:
            track = solved(self._read(path, frames.times(stretch, reading.key_times).tolist()))
            for old in [k for k in self._followed if k[1] != revision]:
                del self._followed[old]
            self._followed[key] = track
        self._followed.move_to_end(key)
        while len(self._followed) > _KEPT:
            self._followed.popitem(last=False)
        return self._followed[key]


_BY_A_HAND = ("planes", "wanted_w", "slowed_w", "f_stops", "fades", "points_w", "sides")


def _between(times: DoubleArray, column: DoubleArray, at: DoubleArray) -> DoubleArray:
    """``(m, ...)`` of a column ``(n, ...)``, joined by straight lines and level beyond its ends."""
    flat = column.reshape(len(times), -1)
    made = np.empty((len(at), flat.shape[1]))
    for i, values in enumerate(flat.T):
        made[:, i] = np.interp(at, times, values)
    return made.reshape(len(at), *column.shape[1:])
