"""The focus of a stage's cameras at any time; what follows over time is worked out once for the whole shot."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from pxr import Usd

from render.scene import Scene
from render.shot.focus_reading import FocusReading, read_focus
from render.shot.focus_solving import FocusTrack, follows_over_time, keeps_sides, solved
from render.shot.focusing import Focused, focused
from render.stage import AnchorReader, frame_range
from usd_schemas import LensCamera

MAX_FOLLOWED_FRAMES = 20_000
"""A hand that follows is followed from the first frame of the shot; of a longer shot, from so many frames before the time."""


@dataclass(frozen=True, eq=False)
class _Followed:
    """The focus over all frames of the shot, as it was with a revision of the edits."""

    revision: int
    track: FocusTrack


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
        self._followed: dict[str, _Followed] = {}

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
        if self._follows(camera_path, reading):
            track = _taken_from(track, self._whole(camera_path, times, revision))
        return [focused(reading, track, i) for i in range(len(times))]

    def _read(self, camera_path: str, times: Sequence[float]) -> FocusReading:
        return read_focus(self._stage, self._anchors, camera_path, times, self._scene_at)

    def _follows(self, camera_path: str, reading: FocusReading) -> bool:
        if reading.focus[0].mode == "manual":
            return False
        if keeps_sides(reading) or any(follows_over_time(focus) for focus in reading.focus):
            return True
        camera = LensCamera(self._stage.GetPrimAtPath(camera_path))
        return any(camera.keys(f"focus:{name}") for name in ("smoothing", "lag", "deadZone", "maxSpeed"))

    def _whole(self, camera_path: str, times: Sequence[float], revision: int) -> FocusTrack:
        """The focus from the first frame of the shot to its last, and to the asked times where they lie beyond."""
        kept = self._followed.get(camera_path)
        if kept is not None and kept.revision == revision and _covers(kept.track, times):
            return kept.track
        shot = frame_range(self._stage)
        step = self._stage.GetTimeCodesPerSecond() / self._stage.GetFramesPerSecond()
        first, last = min(shot.start, times[0]), max(shot.end, times[-1])
        first = max(first, last - (MAX_FOLLOWED_FRAMES - 1) * step)
        frames = shot.start + step * np.arange(
            np.floor((first - shot.start) / step), np.ceil((last - shot.start) / step) + 1
        )
        track = solved(self._read(camera_path, frames.tolist()))
        self._followed[camera_path] = _Followed(revision, track)
        return track


def _covers(track: FocusTrack, times: Sequence[float]) -> bool:
    return bool(track.times[0] <= times[0] and times[-1] <= track.times[-1])


def _taken_from(track: FocusTrack, whole: FocusTrack) -> FocusTrack:
    """The track with what follows over time taken from that of the whole shot, joined by straight lines between its frames."""

    def between(columns: np.ndarray) -> np.ndarray:
        made = [np.interp(track.times, whole.times, column) for column in columns.reshape(len(whole.times), -1).T]
        return np.array(made).T.reshape(len(track.times), *columns.shape[1:])

    return replace(
        track,
        planes=between(whole.planes),
        wanted_w=between(whole.wanted_w),
        f_stops=between(whole.f_stops),
        fades=between(whole.fades),
        sides=whole.sides,
    )
