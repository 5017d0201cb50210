"""Functions of the stage process that read and edit how a camera's focus is solved."""

from __future__ import annotations

import math
from typing import get_args

from render.shot import Shot
from service.edit_context import EditContext
from service.models.focus import KeyEdit
from service.models.solving import CameraKeyed, FocusSettings, FocusSettingsEdit, Rack, RackCreate
from service.stage.applying import apply_to_focus
from service.stage.authoring import authored_key
from service.stage.field_names import FOCUS_OF_FIELD
from service.stage.opened import OpenedShots, stage_function
from service.stage.read_shot import as_key, camera_tag, points_tag, told_of_camera
from service.storage.store import ShotRecord
from usd_schemas.racks import WeightRack

SWITCHES = ("solveStop", "drivenByPoints")


@stage_function
def read_focus_settings(opened: OpenedShots, record: ShotRecord, camera: str | None, time: float) -> FocusSettings:
    """Read the focus settings at one time. Raises `CameraError`."""
    with opened.use(record) as shot:
        return _settings(shot, camera, time)


@stage_function
def edit_focus_settings(
    opened: OpenedShots, record: ShotRecord, camera: str | None, edit: FocusSettingsEdit, context: EditContext
) -> FocusSettings:
    """Change the focus settings. Raises `CameraError` or `SettingsError`."""
    time = edit.time
    with opened.edit(record, context) as shot:
        context.check_tag(camera_tag(shot, camera), "the camera")
        looked_at = shot.frame_range.start if time is None else time
        with shot.keep_usable(camera, looked_at):
            apply_to_focus(shot, camera, edit)
        return _settings(shot, camera, looked_at)


@stage_function
def set_camera_key(
    opened: OpenedShots,
    record: ShotRecord,
    camera: str | None,
    attribute: CameraKeyed,
    key: KeyEdit,
    context: EditContext,
) -> FocusSettings:
    """Set or replace a key of a camera, and read the settings at the key's time. Raises `CameraError` or `SettingsError`."""
    authored = authored_key(key, attribute, is_switch=attribute in SWITCHES)
    with opened.edit(record, context) as shot:
        context.check_tag(camera_tag(shot, camera), "the camera")
        shot.camera.set_key(camera, setting_of(attribute), authored)
        return _settings(shot, camera, key.time)


@stage_function
def remove_camera_key(
    opened: OpenedShots,
    record: ShotRecord,
    camera: str | None,
    attribute: CameraKeyed,
    time: float,
    context: EditContext,
) -> FocusSettings:
    """Remove a key of a camera, and read the settings at that time. Raises `NotFoundError`."""
    with opened.edit(record, context) as shot:
        context.check_tag(camera_tag(shot, camera), "the camera")
        shot.camera.remove_key(camera, setting_of(attribute), time)
        return _settings(shot, camera, time)


@stage_function
def make_rack(
    opened: OpenedShots, record: ShotRecord, camera: str | None, rack: RackCreate, context: EditContext
) -> Rack:
    """Rack from one focus point to another. Raises `NotFoundError` or `SettingsError`."""
    asked = WeightRack(**rack.model_dump())
    with opened.edit(record, context) as shot:
        context.check_tag(points_tag(shot, camera), "the list of focus points")
        made, lens = shot.focus.rack(camera, asked)
        return Rack.model_validate(
            {
                **vars(made),
                "stretched": lens.is_stretched,
                "start_distance_m": 1 / lens.start_w if lens.start_w > 0 else math.inf,
                "end_distance_m": 1 / lens.end_w if lens.end_w > 0 else math.inf,
                "etag": points_tag(shot, camera),
            }
        )


def setting_of(attribute: CameraKeyed) -> str:
    """The shot's name of what is keyed.

    Args:
        attribute: its name over REST.
    """
    fields = {info.alias: field for field, info in FocusSettings.model_fields.items()}
    lens = {"focusDistanceM": "focus_distance_m", "fStop": "f_stop", "focalLengthMm": "focal_length_mm"}
    field = lens.get(attribute) or fields[attribute]
    return FOCUS_OF_FIELD.get(field, field)


def _settings(shot: Shot, camera: str | None, time: float) -> FocusSettings:
    focus, tilt_shift = shot.focus.settings(camera, time)
    said = vars(focus) | vars(tilt_shift)
    fields = set(FocusSettings.model_fields) - {"camera", "time", "keys", "etag"}
    names: tuple[CameraKeyed, ...] = get_args(CameraKeyed)
    keys = {name: shot.camera.keys(camera, setting_of(name)) for name in names}
    return told_of_camera(
        FocusSettings,
        {field: said[FOCUS_OF_FIELD.get(field, field)] for field in fields}
        | {
            "camera": camera or shot.default_camera().path,
            "time": time,
            "keys": {name: [as_key(key) for key in found] for name, found in keys.items() if found},
            "etag": camera_tag(shot, camera),
        },
    )
