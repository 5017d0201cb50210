"""What the stage process is asked about cameras; see `service.stage.shots`."""

from __future__ import annotations

from dataclasses import dataclass

from service.models.cameras import CameraEdit, CameraList, CameraState, PlaceReadout, Readout
from service.stage.applying import apply_to_camera
from service.stage.opened import OpenedShots
from service.storage.store import ShotRecord
from service.terms import Terms


@dataclass(frozen=True)
class ListCameras:
    """The cameras at one time."""

    record: ShotRecord
    time: float

    def run(self, opened: OpenedShots) -> CameraList:
        """Cameras that make no picture are listed as such."""
        from service.stage.read_shot import list_cameras

        with opened.use(self.record) as shot:
            return list_cameras(shot, self.time)


@dataclass(frozen=True)
class ReadCamera:
    """One camera at one time."""

    record: ShotRecord
    camera: str | None
    time: float

    def run(self, opened: OpenedShots) -> CameraState:
        """Raises `CameraError`."""
        from service.stage.read_shot import read_camera_state

        with opened.use(self.record) as shot:
            return read_camera_state(shot, self.camera, self.time)


@dataclass(frozen=True)
class EditCamera:
    """Set the lens."""

    record: ShotRecord
    camera: str | None
    edit: CameraEdit
    terms: Terms

    def run(self, opened: OpenedShots) -> CameraState:
        """The camera as it is then. Raises `CameraError` or `SettingsError`."""
        from service.stage.read_shot import camera_tag, read_camera_state

        edit = self.edit
        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(camera_tag(shot, self.camera), "the camera")
            apply_to_camera(shot, self.camera, edit)
            return read_camera_state(shot, self.camera, shot.frame_range.start if edit.time is None else edit.time)


@dataclass(frozen=True)
class ReadLens:
    """Read the lens off at one time."""

    record: ShotRecord
    camera: str | None
    time: float

    def run(self, opened: OpenedShots) -> Readout:
        """Raises `CameraError`."""
        from service.stage.read_shot import as_readout

        with opened.use(self.record) as shot:
            return as_readout(shot.readout(self.camera, self.time), self.time)


@dataclass(frozen=True)
class ReadPlace:
    """Read the lens off at a place of the picture, or at a focus point.

    Attributes:
        record: of which shot.
        camera: prim path, or None for the default camera.
        time: USD time code.
        place: name of a focus point, or place in the picture and depth in metres of the thing there.
        aspect: width over height of the picture; None takes the film gate's.
    """

    record: ShotRecord
    camera: str | None
    time: float
    place: str | tuple[tuple[float, float], float]
    aspect: float | None

    def run(self, opened: OpenedShots) -> PlaceReadout:
        """Raises `CameraError`, `NotFoundError` or `InputError`."""
        from service.stage.read_shot import as_place_readout

        with opened.use(self.record) as shot:
            path = self.camera or shot.default_camera().path
            if isinstance(self.place, str):
                at = shot.readout_at_point(self.camera, self.time, self.place, aspect=self.aspect)
                return as_place_readout(at, path, self.time, self.place)
            screen, depth_m = self.place
            at = shot.readout_at(self.camera, self.time, screen, depth_m, aspect=self.aspect)
            return as_place_readout(at, path, self.time, None)
