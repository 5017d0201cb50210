"""What the stage process is asked for: everything about a shot that needs USD and no GL.

It is the one place where shots are edited: requests run one after the other, and each edit is on disk before it is
answered. Each request is a small value that is sent there, and its ``run`` answers with a model. The process that speaks
HTTP imports this module to make them, so what needs USD is imported where it runs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from render.errors import SettingsError
from service.lens_work import lens_to_mount
from service.models.cameras import CameraEdit, CameraList, CameraState, Readout
from service.models.focus import FocusPoint, FocusPointCreate, FocusPointEdit, FocusPointList, KeyEdit
from service.models.inspection import Inspection
from service.models.shots import Shot
from service.opened import OpenedShots
from service.store import ShotRecord


@dataclass(frozen=True)
class DescribeShot:
    """Open a shot and say what does not change while it is looked at."""

    record: ShotRecord

    def run(self, opened: OpenedShots) -> Shot:
        """Raises what `render.shot.Shot.open` raises."""
        from service.reading import describe

        with opened.use(self.record) as shot:
            return describe(self.record, shot)


@dataclass(frozen=True)
class InspectShot:
    """Read a shot at its first frame and say what is in it and what of it is not honoured."""

    record: ShotRecord

    def run(self, opened: OpenedShots) -> Inspection:
        """Raises `StageError`: it cannot be read."""
        from service.reading import inspect

        with opened.use(self.record) as shot:
            return inspect(self.record, shot)


@dataclass(frozen=True)
class ForgetShot:
    """Close a shot that was removed or refused."""

    shot_id: str

    def run(self, opened: OpenedShots) -> None:
        """Close it."""
        opened.forget(self.shot_id)


@dataclass(frozen=True)
class WriteDemo:
    """Author the demo shot."""

    folder: Path

    def run(self, opened: OpenedShots) -> str:
        """Its root layer, relative to the folder. Raises `OutputError`."""
        from render.demo import write_demo

        return write_demo(self.folder).relative_to(self.folder).as_posix()


@dataclass(frozen=True)
class ListCameras:
    """The cameras at one time."""

    record: ShotRecord
    time: float

    def run(self, opened: OpenedShots) -> CameraList:
        """Cameras that make no picture are listed as such."""
        from service.reading import list_cameras

        with opened.use(self.record) as shot:
            return list_cameras(shot, self.time)


@dataclass(frozen=True)
class EditCamera:
    """Set the lens."""

    record: ShotRecord
    camera: str | None
    edit: CameraEdit

    def run(self, opened: OpenedShots) -> CameraState:
        """The camera as it is then. Raises `CameraError` or `SettingsError`."""
        from service.reading import read_camera_state

        edit = self.edit
        with opened.edit(self.record) as shot:
            if "lens" in edit.model_fields_set:
                shot.mount_lens(self.camera, lens_to_mount(edit.lens))
            shot.set_camera(
                self.camera,
                f_stop=edit.f_stop,
                focal_length_mm=edit.focal_length_mm,
                focus_distance_m=math.inf if edit.focus_distance_m == 0 else edit.focus_distance_m,
                focus_mode=edit.focus_mode,
                time=edit.time,
            )
            return read_camera_state(shot, self.camera, shot.frame_range.start if edit.time is None else edit.time)


@dataclass(frozen=True)
class RestoreEdits:
    """Take back all edits since a revision."""

    record: ShotRecord
    revision: str

    def run(self, opened: OpenedShots) -> Shot:
        """The shot as it is then. Raises `NotFoundError`: the revision is not kept any more."""
        from service.reading import describe

        with opened.edit(self.record) as shot:
            shot.replace_edits(opened.kept(self.record, self.revision))
        with opened.use(self.record) as shot:
            return describe(self.record, shot)


@dataclass(frozen=True)
class ReadLens:
    """Read the lens off at one time."""

    record: ShotRecord
    camera: str | None
    time: float

    def run(self, opened: OpenedShots) -> Readout:
        """Raises `CameraError`."""
        from service.reading import as_readout

        with opened.use(self.record) as shot:
            return as_readout(shot.readout(self.camera, self.time), self.time)


@dataclass(frozen=True)
class ListFocusPoints:
    """The focus points of a camera in a picture."""

    record: ShotRecord
    camera: str | None
    time: float
    aspect: float | None

    def run(self, opened: OpenedShots) -> FocusPointList:
        """Raises `CameraError`."""
        from service.reading import read_points

        with opened.use(self.record) as shot:
            return FocusPointList(focus_points=read_points(shot, self.camera, self.time, self.aspect))


@dataclass(frozen=True)
class ReadFocusPoint:
    """One focus point."""

    record: ShotRecord
    camera: str | None
    time: float
    name: str

    def run(self, opened: OpenedShots) -> FocusPoint:
        """Raises `NotFoundError`."""
        from service.reading import read_point

        with opened.use(self.record) as shot:
            return read_point(shot, self.camera, self.time, self.name)


@dataclass(frozen=True)
class AddFocusPoint:
    """Place a focus point."""

    record: ShotRecord
    camera: str | None
    time: float
    point: FocusPointCreate

    def run(self, opened: OpenedShots) -> FocusPoint:
        """The point that was made. Raises `SettingsError`: its name is taken, or a value is not allowed."""
        from service.reading import free_name, new_point, read_point

        with opened.edit(self.record) as shot:
            name = self.point.name or free_name(shot, self.camera, self.time)
            shot.add_focus_point(self.camera, name, new_point(name, self.point))
            return read_point(shot, self.camera, self.time, name)


@dataclass(frozen=True)
class EditFocusPoint:
    """Change some values of a focus point."""

    record: ShotRecord
    camera: str | None
    time: float
    name: str
    edit: FocusPointEdit

    def run(self, opened: OpenedShots) -> FocusPoint:
        """The point as it is then. Raises `NotFoundError` or `SettingsError`."""
        from service.reading import point_fields, read_point

        with opened.edit(self.record) as shot:
            shot.update_focus_point(self.camera, self.name, time=self.time, **point_fields(self.edit))
            return read_point(shot, self.camera, self.time, self.name)


@dataclass(frozen=True)
class RemoveFocusPoint:
    """Remove a focus point."""

    record: ShotRecord
    camera: str | None
    name: str

    def run(self, opened: OpenedShots) -> None:
        """Raises `NotFoundError`."""
        with opened.edit(self.record) as shot:
            shot.remove_focus_point(self.camera, self.name)


@dataclass(frozen=True)
class SetKey:
    """Set or replace a key of a focus point."""

    record: ShotRecord
    camera: str | None
    name: str
    attribute: str
    key: KeyEdit

    def run(self, opened: OpenedShots) -> FocusPoint:
        """The point at the key's time. Raises `NotFoundError` or `SettingsError`."""
        from service.reading import read_point

        key = self.key
        if self.attribute == "enabled" and key.value not in (0, 1):
            raise SettingsError(f"a key of 'enabled' is 0 or 1, got {key.value:g}", code="bad_key", path="value")
        value = bool(key.value) if self.attribute == "enabled" else key.value
        interpolation = "held" if self.attribute == "enabled" else key.interpolation
        with opened.edit(self.record) as shot:
            shot.set_key(self.camera, self.name, self.attribute, key.time, value, interpolation)
            return read_point(shot, self.camera, key.time, self.name)


@dataclass(frozen=True)
class RemoveKey:
    """Remove a key of a focus point."""

    record: ShotRecord
    camera: str | None
    name: str
    attribute: str
    time: float

    def run(self, opened: OpenedShots) -> FocusPoint:
        """The point at that time. Raises `NotFoundError`."""
        from service.reading import read_point

        with opened.edit(self.record) as shot:
            shot.remove_key(self.camera, self.name, self.attribute, self.time)
            return read_point(shot, self.camera, self.time, self.name)
