"""Focus of a stage's cameras at any time. A focus that depends on other times is solved once for a stretch of frames."""

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
from render.shot.focus.focused_camera import FocusedCamera, focus_camera
from render.shot.focus.inputs import FocusInputs, read_focus_inputs
from render.shot.focus.track import FocusTrack, follows_over_time, keeps_sides, solve_track
from render.stage import AnchorReader, frame_range
from usd_schemas import LensCamera

MAX_FOLLOWED_FRAMES = 20_000
"""Longest shot that is solved as one stretch, from its first frame to its last. A longer shot, and times beyond the ends of any
shot, are solved in parts with a run-up before each."""

_PART, _BEFORE, _AFTER = 500, 1500, 250
"""Length, run-up and run-out of a part, in frames. The run-up is about a minute, longer than any lag of the hand."""
_MAX_STRETCHES = 8
"""Solved stretches that are kept, of all cameras together."""
_SAME_FRAME = 1e-6
"""Times within this share of a frame are the same frame."""

_Stretch = tuple[int, int]
"""First and last frame that are solved together, counted from the first of the shot."""


@dataclass(frozen=True)
class _Frames:
    """The frames of a shot: the first is frame 0."""

    start: float
    step: float
    count: int

    @classmethod
    def from_stage(cls, stage: Usd.Stage) -> _Frames:
        """Frames of a stage; only the first where the end lies before the start."""
        shot, step = frame_range(stage), stage.GetTimeCodesPerSecond() / stage.GetFramesPerSecond()
        return cls(shot.start, step, max(1, math.ceil((shot.end - shot.start) / step - _SAME_FRAME) + 1))

    def stretch(self, time: float) -> _Stretch:
        """Frames that are solved together for the focus at a time.

        They depend on the time alone, so that a frame has the same focus whichever times were read before. Times less than a
        frame beyond the shot, such as when a shutter opens, count as within it.
        """
        frame = (time - self.start) / self.step
        if -1 < frame < self.count and self.count <= MAX_FOLLOWED_FRAMES:
            return 0, self.count - 1
        part = math.floor(frame / _PART) * _PART
        first = part - _BEFORE
        return (max(first, 0) if frame > -1 else first), part + _PART + _AFTER

    def times(self, stretch: _Stretch, key_times: DoubleArray) -> DoubleArray:
        """Time codes of the frames of a stretch, and of the keys between frames, where the focus must be exact too."""
        first, last = stretch
        keys = (key_times - self.start) / self.step
        between_frames = keys[(keys > first) & (keys < last) & (np.abs(keys - np.rint(keys)) > _SAME_FRAME)]
        return self.start + self.step * np.union1d(first + np.arange(last - first + 1.0), between_frames)


class FocusTracker:
    """Solves the focus of the cameras of one stage, and keeps what was solved over time.

    Args:
        stage: the stage.
        anchors: finds focus points on it.
        scene_at: the scene at a time, as a camera has it drawn.
    """

    def __init__(self, stage: Usd.Stage, anchors: AnchorReader, scene_at: Callable[[float, str], Scene]) -> None:
        self._stage = stage
        self._anchors = anchors
        self._scene_at = scene_at
        self._tracks: OrderedDict[tuple[str, int, _Stretch], FocusTrack] = OrderedDict()

    def at(self, camera_path: str, time: float, revision: int) -> FocusedCamera:
        """Focus a camera at one time.

        Points are inside the picture if they are inside the camera's own film gate, so that the focus does not depend on the size
        or shape of the picture that is rendered.

        Args:
            camera_path: of a camera.
            time: USD time code.
            revision: of the edits; tracks of other revisions are dropped.

        Raises:
            CameraError: it is no camera, or it or its focus points have impossible values.
            InputError: its lens has no focal length.
        """
        return self.over(camera_path, [time], revision)[0]

    def over(self, camera_path: str, times: Sequence[float], revision: int) -> list[FocusedCamera]:
        """Focus a camera at rising times.

        Args:
            camera_path: of a camera.
            times: rising USD time codes.
            revision: of the edits.

        Raises:
            CameraError: as `at`.
            InputError: as `at`.
        """
        inputs = self._read(camera_path, times)
        track = solve_track(inputs)
        columns = self._columns_over_time(camera_path, inputs)
        if columns:
            track = self._with_columns_over_time(track, inputs, revision, columns)
        return [focus_camera(inputs, track, i) for i in range(len(times))]

    def _read(self, camera_path: str, times: Sequence[float]) -> FocusInputs:
        return read_focus_inputs(self._stage, self._anchors, camera_path, times, self._scene_at)

    def _columns_over_time(self, camera_path: str, inputs: FocusInputs) -> tuple[str, ...]:
        """Columns of `FocusTrack` that depend on other times."""
        if inputs.focus[0].mode == "manual" or np.isnan(inputs.times).any():  # no frames lie beside the default time
            return ()
        camera = LensCamera(self._stage.GetPrimAtPath(camera_path))
        keyed = (camera.keys(f"focus:{name}") for name in ("smoothing", "lag", "deadZone", "maxSpeed"))
        if any(follows_over_time(focus) for focus in inputs.focus) or any(keyed):
            return _FOLLOWED
        return ("sides",) if keeps_sides(inputs) else ()

    def _with_columns_over_time(
        self, track: FocusTrack, inputs: FocusInputs, revision: int, names: tuple[str, ...]
    ) -> FocusTrack:
        """Replace columns of a track by those of the stretches around its times, interpolated linearly between frames."""
        frames = _Frames.from_stage(self._stage)
        stretches = [frames.stretch(time) for time in track.times.tolist()]
        columns: dict[str, Any] = {name: np.array(getattr(track, name)) for name in names}
        for stretch in dict.fromkeys(stretches):
            rows = np.array([stretch == other for other in stretches])
            whole = self._solve_stretch(inputs, frames, stretch, revision)
            for name, column in columns.items():
                column[rows] = _interpolate(whole.times, getattr(whole, name), track.times[rows])
        return replace(track, **columns)

    def _solve_stretch(self, inputs: FocusInputs, frames: _Frames, stretch: _Stretch, revision: int) -> FocusTrack:
        path = inputs.cameras[0].path
        key = path, revision, stretch
        if key not in self._tracks:
            track = solve_track(self._read(path, frames.times(stretch, inputs.key_times).tolist()))
            for outdated in [k for k in self._tracks if k[1] != revision]:
                del self._tracks[outdated]
            self._tracks[key] = track
        self._tracks.move_to_end(key)
        while len(self._tracks) > _MAX_STRETCHES:
            self._tracks.popitem(last=False)
        return self._tracks[key]


_FOLLOWED = ("planes", "requested_w", "slowed_w", "f_stops", "fades", "points_w", "sides")


def _interpolate(times: DoubleArray, column: DoubleArray, at: DoubleArray) -> DoubleArray:
    """Interpolate a column ``(n, ...)`` linearly at ``(m,)`` times, constant beyond its ends."""
    flat = column.reshape(len(times), -1)
    values_at = np.empty((len(at), flat.shape[1]))
    for i, values in enumerate(flat.T):
        values_at[:, i] = np.interp(at, times, values)
    return values_at.reshape(len(at), *column.shape[1:])
