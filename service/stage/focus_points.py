"""Functions of the stage process that read and edit focus points and their keys."""

from __future__ import annotations

from service.edit_context import EditContext
from service.models.focus import (
    FocusPoint,
    FocusPointCreate,
    FocusPointEdit,
    FocusPointList,
    KeyedAttribute,
    KeyEdit,
)
from service.stage.applying import apply_key, apply_to_point
from service.stage.opened import OpenedShots, stage_function
from service.stage.read_shot import free_name, new_point, point_tag, points_tag, read_point, read_points
from service.storage.store import ShotRecord


@stage_function
def list_focus_points(
    opened: OpenedShots, record: ShotRecord, camera: str | None, time: float, aspect: float | None
) -> FocusPointList:
    """Read the focus points of a camera and their positions in the picture. Raises `CameraError`."""
    with opened.use(record) as shot:
        points = read_points(shot, camera, time, aspect)
        return FocusPointList(etag=points_tag(shot, camera), focus_points=points)


@stage_function
def read_focus_point(opened: OpenedShots, record: ShotRecord, camera: str | None, time: float, name: str) -> FocusPoint:
    """Read one focus point. Raises `NotFoundError`."""
    with opened.use(record) as shot:
        return read_point(shot, camera, time, name)


@stage_function
def add_focus_point(
    opened: OpenedShots,
    record: ShotRecord,
    camera: str | None,
    time: float,
    point: FocusPointCreate,
    context: EditContext,
) -> FocusPoint:
    """Add a focus point. Raises `SettingsError`: its name is taken, or a value is not allowed."""
    with opened.edit(record, context) as shot:
        context.check_tag(points_tag(shot, camera), "the list of focus points")
        name = point.name or free_name(shot, camera, time)
        shot.focus.add_point(camera, name, new_point(name, point))
        return read_point(shot, camera, time, name)


@stage_function
def edit_focus_point(
    opened: OpenedShots,
    record: ShotRecord,
    camera: str | None,
    time: float,
    name: str,
    edit: FocusPointEdit,
    context: EditContext,
) -> FocusPoint:
    """Change some values of a focus point. Raises `NotFoundError` or `SettingsError`."""
    with opened.edit(record, context) as shot:
        context.check_tag(point_tag(shot, camera, name), f"focus point {name!r}")
        apply_to_point(shot, camera, time, name, edit)
        return read_point(shot, camera, time, name)


@stage_function
def remove_focus_point(
    opened: OpenedShots, record: ShotRecord, camera: str | None, name: str, context: EditContext
) -> None:
    """Remove a focus point. Raises `NotFoundError`."""
    with opened.edit(record, context) as shot:
        context.check_tag(point_tag(shot, camera, name), f"focus point {name!r}")
        shot.focus.remove_point(camera, name)


@stage_function
def set_key(
    opened: OpenedShots,
    record: ShotRecord,
    camera: str | None,
    name: str,
    attribute: KeyedAttribute,
    key: KeyEdit,
    context: EditContext,
) -> FocusPoint:
    """Set or replace a key of a focus point, and read the point at the key's time. Raises `NotFoundError` or `SettingsError`."""
    with opened.edit(record, context) as shot:
        context.check_tag(point_tag(shot, camera, name), f"focus point {name!r}")
        apply_key(shot, camera, name, attribute, key)
        return read_point(shot, camera, key.time, name)


@stage_function
def remove_key(
    opened: OpenedShots,
    record: ShotRecord,
    camera: str | None,
    name: str,
    attribute: str,
    time: float,
    context: EditContext,
) -> FocusPoint:
    """Remove a key of a focus point, and read the point at that time. Raises `NotFoundError`."""
    with opened.edit(record, context) as shot:
        context.check_tag(point_tag(shot, camera, name), f"focus point {name!r}")
        shot.focus.remove_key(camera, name, attribute, time)
        return read_point(shot, camera, time, name)
