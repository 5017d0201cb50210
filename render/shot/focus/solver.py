"""Cameras of a shot with their focus solved: what the parts of `Shot` read, and what pictures are taken with."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from pxr import Usd

from render.model.camera import Camera
from render.shot.camera.lookup import CameraLookup
from render.shot.edits.edit_layer import Edits
from render.shot.focus.focused_camera import FocusedCamera, focus_without_points
from render.shot.focus.tracker import FocusTracker
from render.shot.times import check_reading_time
from render.stage import conform_camera, conform_to_stage


class FocusObserver(Protocol):
    """Receives each solved camera, such as to collect findings."""

    def note_close_focus(self, focused: FocusedCamera) -> None:
        """Receive a camera that was solved at one time."""

    def note_points(self, focused: FocusedCamera) -> None:
        """Receive a camera that was solved at one time, or at one of many."""


class FocusSolver:
    """Solves the focus of the cameras of one shot.

    Args:
        stage: the shot.
        edits: their revision tells which earlier solutions still hold.
        cameras: finds cameras by path.
        tracker: focuses the stage's cameras.
        observer: receives each solved camera.
    """

    def __init__(
        self, stage: Usd.Stage, edits: Edits, cameras: CameraLookup, tracker: FocusTracker, observer: FocusObserver
    ) -> None:
        self._stage = stage
        self._edits = edits
        self._cameras = cameras
        self._tracker = tracker
        self._observer = observer

    def solve(self, camera_path: str | None, time: float) -> FocusedCamera:
        """Solve the focus of a camera at one time. Where the default camera is a framing camera, it has no focus points.

        Args:
            camera_path: of a camera.
            time: USD time code.

        Raises:
            CameraError: there is no such camera, or its numbers are impossible.
            SettingsError: the time is not finite.
        """
        check_reading_time(time)
        choice = self._cameras.default(time) if camera_path is None else None
        if choice is not None and choice.framing is not None:
            return focus_without_points(choice.framing)
        focused = self._tracker.at(self._cameras.path(camera_path), time, self._edits.revision)
        self._observer.note_close_focus(focused)
        self._observer.note_points(focused)
        return focused

    def solve_over(self, camera_path: str, times: Sequence[float]) -> list[FocusedCamera]:
        """Solve the focus of a camera at rising times.

        Args:
            camera_path: of a camera.
            times: rising USD time codes.

        Raises:
            CameraError: there is no such camera, or its numbers are impossible.
        """
        over = self._tracker.over(camera_path, times, self._edits.revision)
        for focused in over:
            self._observer.note_points(focused)
        return over

    def solve_all(self, camera_path: str | None, times: Sequence[float]) -> list[FocusedCamera]:
        """Solve the focus of a camera at rising times, as `solve` does at each of them.

        Args:
            camera_path: of a camera; None for the default one, which may be a framing camera.
            times: rising USD time codes, at least one.

        Raises:
            CameraError: there is no such camera, or its numbers are impossible.
        """
        choice = self._cameras.default(times[0]) if camera_path is None else None
        if choice is not None and choice.framing is not None:
            return [self.solve(None, time) for time in times]
        return self.solve_over(self._cameras.path(camera_path), times)

    def fit_to_picture(
        self, focused: FocusedCamera, time: float, aspect: float | None, conform: str | None = None
    ) -> Camera:
        """Return a solved camera with its film gate conform_camera to a picture.

        Args:
            focused: the solved camera.
            time: USD time code at which it was solved.
            aspect: width over height of the picture; None keeps the camera's own film gate.
            conform: how the gate becomes the picture's shape, as in `read_camera`; None for the stage's own policy.
        """
        if aspect is None:
            return focused.camera
        if not focused.camera.path:
            return conform_camera(focused.camera, aspect, conform or "expandAperture")
        return conform_to_stage(focused.camera, self._stage, aspect, conform)
