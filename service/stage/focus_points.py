"""What the stage process is asked about focus points and their keys; see `service.stage.shots`."""

from __future__ import annotations

from dataclasses import dataclass

from service.models.focus import (
    FocusPoint,
    FocusPointCreate,
    FocusPointEdit,
    FocusPointList,
    KeyedAttribute,
    KeyEdit,
)
from service.stage.applying import apply_key, apply_to_point
from service.stage.opened import OpenedShots
from service.storage.store import ShotRecord
from service.terms import Terms


@dataclass(frozen=True)
class ListFocusPoints:
    """The focus points of a camera in a picture."""

    record: ShotRecord
    camera: str | None
    time: float
    aspect: float | None

    def run(self, opened: OpenedShots) -> FocusPointList:
        """Raises `CameraError`."""
        from service.stage.read_shot import points_tag, read_points

        with opened.use(self.record) as shot:
            points = read_points(shot, self.camera, self.time, self.aspect)
            return FocusPointList(etag=points_tag(shot, self.camera), focus_points=points)


@dataclass(frozen=True)
class ReadFocusPoint:
    """One focus point."""

    record: ShotRecord
    camera: str | None
    time: float
    name: str

    def run(self, opened: OpenedShots) -> FocusPoint:
        """Raises `NotFoundError`."""
        from service.stage.read_shot import read_point

        with opened.use(self.record) as shot:
            return read_point(shot, self.camera, self.time, self.name)


@dataclass(frozen=True)
class AddFocusPoint:
    """Place a focus point."""

    record: ShotRecord
    camera: str | None
    time: float
    point: FocusPointCreate
    terms: Terms

    def run(self, opened: OpenedShots) -> FocusPoint:
        """The point that was made. Raises `SettingsError`: its name is taken, or a value is not allowed."""
        from service.stage.read_shot import free_name, new_point, points_tag, read_point

        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(points_tag(shot, self.camera), "the list of focus points")
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
    terms: Terms

    def run(self, opened: OpenedShots) -> FocusPoint:
        """The point as it is then. Raises `NotFoundError` or `SettingsError`."""
        from service.stage.read_shot import point_tag, read_point

        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(point_tag(shot, self.camera, self.name), f"focus point {self.name!r}")
            apply_to_point(shot, self.camera, self.time, self.name, self.edit)
            return read_point(shot, self.camera, self.time, self.name)


@dataclass(frozen=True)
class RemoveFocusPoint:
    """Remove a focus point."""

    record: ShotRecord
    camera: str | None
    name: str
    terms: Terms

    def run(self, opened: OpenedShots) -> None:
        """Raises `NotFoundError`."""
        from service.stage.read_shot import point_tag

        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(point_tag(shot, self.camera, self.name), f"focus point {self.name!r}")
            shot.remove_focus_point(self.camera, self.name)


@dataclass(frozen=True)
class SetKey:
    """Set or replace a key of a focus point."""

    record: ShotRecord
    camera: str | None
    name: str
    attribute: KeyedAttribute
    key: KeyEdit
    terms: Terms

    def run(self, opened: OpenedShots) -> FocusPoint:
        """The point at the key's time. Raises `NotFoundError` or `SettingsError`."""
        from service.stage.read_shot import point_tag, read_point

        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(point_tag(shot, self.camera, self.name), f"focus point {self.name!r}")
            apply_key(shot, self.camera, self.name, self.attribute, self.key)
            return read_point(shot, self.camera, self.key.time, self.name)


@dataclass(frozen=True)
class RemoveKey:
    """Remove a key of a focus point."""

    record: ShotRecord
    camera: str | None
    name: str
    attribute: str
    time: float
    terms: Terms

    def run(self, opened: OpenedShots) -> FocusPoint:
        """The point at that time. Raises `NotFoundError`."""
        from service.stage.read_shot import point_tag, read_point

        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(point_tag(shot, self.camera, self.name), f"focus point {self.name!r}")
            shot.remove_key(self.camera, self.name, self.attribute, self.time)
            return read_point(shot, self.camera, self.time, self.name)
