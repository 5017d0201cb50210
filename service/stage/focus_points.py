"""Functions of the stage process that read and change focus points and their keys."""

from __future__ import annotations

from service.edit_context import EditContext
from service.models.changes import AddPoint, AlterPoint, KeyPoint, RemovePoint, UnkeyPoint
from service.models.focus import FocusPoint, FocusPointList
from service.stage.editing import apply_in_context
from service.stage.opened import OpenedShot, stage_function
from service.stage.read_points import point_list, read_point
from service.storage.store import ShotRecord


@stage_function
def list_focus_points(
    opened: OpenedShot, record: ShotRecord, camera: str | None, time: float, aspect: float | None
) -> FocusPointList:
    """Read the focus points of a camera and their positions in the picture. Raises `CameraError`."""
    with opened.use(record) as shot:
        return point_list(shot, camera, time, aspect)


@stage_function
def read_focus_point(opened: OpenedShot, record: ShotRecord, camera: str | None, time: float, name: str) -> FocusPoint:
    """Read one focus point. Raises `NotFoundError`."""
    with opened.use(record) as shot:
        return read_point(shot, camera, time, name)


@stage_function
def add_focus_point(
    opened: OpenedShot, record: ShotRecord, camera: str | None, change: AddPoint, time: float, context: EditContext
) -> FocusPoint:
    """Add a focus point, and read it at a time. Raises `SettingsError`: its name is taken, or a value is not allowed."""
    with opened.edit(record, context) as shot:
        (name,) = apply_in_context(shot, camera, [change], context)
        return read_point(shot, camera, time, str(name))


@stage_function
def change_focus_point(
    opened: OpenedShot,
    record: ShotRecord,
    camera: str | None,
    change: AlterPoint | KeyPoint | UnkeyPoint,
    time: float,
    context: EditContext,
) -> FocusPoint:
    """Change a focus point, and read it at a time. Raises `NotFoundError` or `SettingsError`."""
    with opened.edit(record, context) as shot:
        apply_in_context(shot, camera, [change], context)
        return read_point(shot, camera, time, change.name)


@stage_function
def remove_focus_point(
    opened: OpenedShot, record: ShotRecord, camera: str | None, change: RemovePoint, context: EditContext
) -> None:
    """Remove a focus point. Raises `NotFoundError`."""
    with opened.edit(record, context) as shot:
        apply_in_context(shot, camera, [change], context)
