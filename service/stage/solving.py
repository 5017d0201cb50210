"""Functions of the stage process that read and change how a camera's focus is found."""

from __future__ import annotations

from service.edit_context import EditContext
from service.models.changes import KeySetting, MakeRack, SetFocus, UnkeySetting
from service.models.solving import FocusSettings, Rack
from service.stage import read_solving
from service.stage.editing import apply_in_context
from service.stage.opened import OpenedShot, stage_function
from service.storage.store import ShotRecord


@stage_function
def read_focus_settings(opened: OpenedShot, record: ShotRecord, camera: str | None, time: float) -> FocusSettings:
    """Read the focus settings at one time. Raises `CameraError`."""
    with opened.use(record) as shot:
        return read_solving.read_focus_settings(shot, camera, time)


@stage_function
def change_focus_settings(
    opened: OpenedShot,
    record: ShotRecord,
    camera: str | None,
    change: SetFocus | KeySetting | UnkeySetting,
    time: float | None,
    context: EditContext,
) -> FocusSettings:
    """Change the focus settings, and read them at a time; None is the first frame.

    Raises:
        CameraError: there is no such camera.
        SettingsError: a value is not allowed.
        NotFoundError: there is no such key.
    """
    with opened.edit(record, context) as shot:
        apply_in_context(shot, camera, [change], context)
        return read_solving.read_focus_settings(shot, camera, shot.frame_range.start if time is None else time)


@stage_function
def make_rack(
    opened: OpenedShot, record: ShotRecord, camera: str | None, change: MakeRack, context: EditContext
) -> Rack:
    """Rack from one focus point to another. Raises `NotFoundError` or `SettingsError`."""
    with opened.edit(record, context) as shot:
        (rack,) = apply_in_context(shot, camera, [change], context)
        assert isinstance(rack, Rack)
        return rack
