"""Cameras and focus points of a stage, found by prim path and name."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pxr import Sdf, Tf, Usd

from render.errors import CameraError, NotFoundError
from render.model.camera import Camera
from render.stage import CameraChoice, default_camera, list_cameras, read_camera
from render.stage.camera.framing import framing_camera
from render.stage.notes import is_note
from usd_schemas import FocusPointView, LensCamera, SchemaError


class CameraLookup:
    """Finds the cameras of one stage. A list of them is kept until prims come or go.

    Args:
        stage: the stage.
        file: the file that was opened, named in errors.
        purposes: of what a framing camera has in view.
        mask: of what a framing camera has in view.
    """

    def __init__(self, stage: Usd.Stage, file: Path, purposes: Sequence[str], mask: Sequence[str] | None) -> None:
        self._stage = stage
        self._file = file
        self._purposes = purposes
        self._mask = mask
        self._paths: list[str] | None = None
        self._listener = Tf.Notice.Register(Usd.Notice.ObjectsChanged, self._on_change, stage)

    def paths(self) -> list[str]:
        """Prim paths of all cameras."""
        if self._paths is None:
            self._paths = list_cameras(self._stage)
        return list(self._paths)

    def default(self, time: float | None = None) -> CameraChoice:
        """The camera that is used when none is named, and why; one that frames the stage does so at a time, or at the first."""
        return default_camera(self._stage, time=time, cameras=self.paths(), purposes=self._purposes, mask=self._mask)

    def framing(self, time: float | None) -> Camera:
        """The camera that frames the stage where the shot has none to be shown through.

        Args:
            time: USD time code of what is framed; None for the stage's first.

        Raises:
            CameraError: the shot is shown through a camera of its own; code ``has_camera``.
            StageError: there is nothing to frame.
        """
        choice = self.default(time)
        if choice.framing is not None:
            return choice.framing
        at = self._stage.GetStartTimeCode() if time is None else time
        if not any(self._is_usable(path, at) for path in self.paths()):
            return framing_camera(self._stage, at, purposes=self._purposes, mask=self._mask)
        message = (
            f"{self._file.name} is shown through its own camera {choice.path}, so there is no view to create one from"
        )
        raise CameraError(message, code="has_camera", path=choice.path)

    def _is_usable(self, path: str, time: float) -> bool:
        """Whether a camera's numbers make a picture."""
        try:
            read_camera(self._stage, path, time)
        except CameraError:
            return False
        return True

    def path(self, camera_path: str | None) -> str:
        """Return a prim path, that of the default camera for None.

        Raises:
            CameraError: no camera is named, and there is none to prefer.
        """
        path = self.default().path if camera_path is None else camera_path
        if path is None:
            known = self.paths()
            none = "no camera: create one, or add one in a layer"
            what = f"{len(known)} cameras: name one of {', '.join(known)}" if known else none
            raise CameraError(f"{self._file.name} has {what}", code="no_camera", path=str(self._file))
        return path

    def camera(self, camera_path: str | None) -> LensCamera:
        """Return the schema view of a camera. Its numbers are not checked, so that a camera with bad ones can be edited.

        Raises:
            CameraError: there is no such camera.
        """
        path = self.path(camera_path)
        try:
            return LensCamera(self._stage.GetPrimAtPath(path) if Sdf.Path.IsValidPathString(path) else Usd.Prim())
        except SchemaError as error:
            known = ", ".join(self.paths()) or "none"
            raise CameraError(f"there is no camera at {path!r}, the cameras are: {known}", path=path) from error

    def editable(self, camera_path: str | None) -> LensCamera:
        """Return the schema view of a camera that USD can edit.

        Raises:
            CameraError: there is no such camera, or it lies in an instance.
        """
        camera = self.camera(camera_path)
        if camera.prim.IsInstanceProxy():
            path = str(camera.prim.GetPath())
            raise CameraError(f"camera {path} lies in an instance, which USD lets nobody edit", path=path)
        return camera

    def point(self, camera_path: str | None, name: str) -> FocusPointView:
        """Return the schema view of a focus point.

        Raises:
            CameraError: there is no such camera.
            NotFoundError: the camera has no such point.
        """
        camera = self.camera(camera_path)
        names = [view.name for view in camera.focus_points()]
        if name not in names:
            path = str(camera.prim.GetPath())
            raise NotFoundError(
                f"camera {path} has no focus point named {name!r}, it has: {', '.join(names) or 'none'}", path=path
            )
        return camera.focus_point(name)

    def editable_point(self, camera_path: str | None, name: str) -> FocusPointView:
        """Return the schema view of a focus point that USD can edit.

        Raises:
            CameraError: there is no such camera, or it lies in an instance.
            NotFoundError: the camera has no such point.
        """
        self.editable(camera_path)
        return self.point(camera_path, name)

    def _on_change(self, notice: Usd.Notice.ObjectsChanged, _sender: object) -> None:
        if not all(map(is_note, notice.GetResyncedPaths())):
            self._paths = None
