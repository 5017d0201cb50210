"""Apply functions of the edit language: one for each model of `service.models.changes`.

They run in two processes: in the stage process, where the edit is saved, and in the picture process, where unsaved changes are
shown in a live picture. They raise the errors of the shot's own edits: `CameraError`, `NotFoundError`, `SettingsError` and
`InputError`.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import singledispatch
from typing import Any, Literal

from render.errors import NotFoundError, PullfocusError, SettingsError
from render.shot.focus.curve_import import read_for_shot
from render.shot.lens.lens_choice import file_choice
from service.models.changes import (
    AddPoint,
    AlterPoint,
    Change,
    ChooseVariant,
    FollowPart,
    ImportCurve,
    KeyExposure,
    KeyPoint,
    KeySetting,
    MakeRack,
    MountLensFile,
    MovePoint,
    RemovePoint,
    RenamePoint,
    SetCamera,
    SetExposure,
    SetFilm,
    SetFocus,
    SetPointTangents,
    SetSettingTangents,
    ShowPayload,
    SimplifySetting,
    UnkeyPoint,
    UnkeySetting,
)
from service.models.curve import CurveFinding, ImportedCurve
from service.models.edits import SimplifiedSetting
from service.models.exposure import ExposureSettingsEdit
from service.models.film_settings import FilmSettingsEdit
from service.models.focus import FocusPointEdit, KeyEdit, TangentsEdit
from service.models.notes import AddNote, DeleteNote, EditNote
from service.models.solving import FocusSettingsEdit, Rack
from service.stage.camera_changes import CAMERA_CHANGES, CreatedCamera, EditedCamera
from service.stage.field_names import setting_name
from service.stage.lenses import lens_to_mount
from service.stage.libraries import body_to_mount, film_to_mount
from service.stage.notes import AddedNote, note_fields, note_to_add
from service.stage.read_cameras import read_camera_state
from service.stage.read_photography import shutter_closes
from service.stage.read_points import authored_point, free_name, point_fields, points_tag
from usd_schemas import Key, Tangents
from usd_schemas.racks import WeightRack
from usd_schemas.settings.tables import SETTINGS

SWITCHES = ("enabled", "solveStop", "drivenByPoints")
"""Attributes that are true or false, and keyed as 1 or 0."""
_DRIVES: tuple[tuple[str, Literal["focusDistance", "fStop", "focalLength", "tilt", "swing"]], ...] = (
    ("focus_distance_m", "focusDistance"),
    ("f_stop", "fStop"),
    ("focal_length_mm", "focalLength"),
    ("tilt_rad", "tilt"),
    ("swing_rad", "swing"),
)
"""Columns of a focus curve, with the names over REST of the attributes that they drive."""


Outcome = Rack | ImportedCurve | SimplifiedSetting | CreatedCamera | AddedNote | str | None
"""Result of a change: the rack, the report of an import or simplification, the camera, the note, the name of a focus point, or
None."""


@dataclass(frozen=True)
class MeteredFrame:
    """A reading of a light meter, as the shot keys it.

    Attributes:
        time: USD time code.
        compensation_stops: exposure compensation to key, stops; NaN for a black frame.
    """

    time: float
    compensation_stops: float


def apply_changes(camera: EditedCamera, changes: Sequence[Change]) -> list[Outcome]:
    """Apply changes in order, within the edit that the caller has begun. Those after the creation of a camera are applied to it.

    Args:
        camera: the edited camera and its shot.
        changes: changes whose picture positions were replaced by anchors (`service.models.changes.anchor_spots`).

    Raises:
        PullfocusError: a change cannot be applied; among several, the message begins with its number. Or a setting is simplified
            more than once.
    """
    simplified = Counter(change.setting for change in changes if isinstance(change, SimplifySetting))
    if simplified and max(simplified.values()) > 1:  # each takes a while
        raise SettingsError("an edit simplifies a setting once at most", path="changes")
    outcomes: list[Outcome] = []
    for number, change in enumerate(changes, 1):
        outcome = _apply_numbered(change, camera, number, len(changes))
        if isinstance(outcome, CreatedCamera):
            camera = replace(camera, path=outcome.path)
        outcomes.append(outcome)
    return outcomes


def _apply_numbered(change: Change, camera: EditedCamera, number: int, count: int) -> Outcome:
    try:
        return apply_change(change, camera)
    except PullfocusError as error:
        if count == 1:
            raise
        detail = f"change {number} of {count}, {change.type}: {error.detail}"
        raise type(error)(detail, code=error.code, path=error.path) from error


@singledispatch
def apply_change(change: Change, camera: EditedCamera) -> Outcome:
    """Apply one change.

    Args:
        change: of any type of the edit language.
        camera: the edited camera and its shot.
    """
    raise TypeError(f"no apply function is registered for {type(change).__name__}")


@apply_change.register
def _add_point(change: AddPoint, camera: EditedCamera) -> Outcome:
    shot = camera.shot
    name = change.point.name or free_name(shot, camera.path, shot.frame_range.start)
    shot.focus.add_point(camera.path, name, authored_point(name, change.point))
    return name


@apply_change.register
def _choose_variant(change: ChooseVariant, camera: EditedCamera) -> Outcome:
    camera.shot.choices.choose_variant(change.prim, change.variant_set, change.variant)
    return None


@apply_change.register
def _show_payload(change: ShowPayload, camera: EditedCamera) -> Outcome:
    camera.shot.choices.show_payload(change.prim, change.shown)
    return None


@apply_change.register
def _move_point(change: MovePoint, camera: EditedCamera) -> Outcome:
    if change.position_m is not None:
        camera.shot.plan.move_point(camera.path, change.name, change.time, change.position_m)
        return None
    if change.anchor is None:
        raise SettingsError(f"focus point {change.name!r} moves to a place that has no anchor yet", path=change.name)
    fields = point_fields(FocusPointEdit(**change.anchor.model_dump()))
    camera.shot.focus.move_point(camera.path, change.name, change.time, **fields)
    return None


@apply_change.register
def _follow_part(change: FollowPart, camera: EditedCamera) -> Outcome:
    camera.shot.focus.follow_part(camera.path, change.name, change.part, change.time)
    return None


@apply_change.register
def _alter_point(change: AlterPoint, camera: EditedCamera) -> Outcome:
    camera.shot.focus.update_point(camera.path, change.name, time=change.time, **point_fields(change.values))
    return None


@apply_change.register
def _rename_point(change: RenamePoint, camera: EditedCamera) -> Outcome:
    camera.shot.focus.rename_point(camera.path, change.name, change.new_name)
    return None


@apply_change.register
def _remove_point(change: RemovePoint, camera: EditedCamera) -> Outcome:
    camera.shot.focus.remove_point(camera.path, change.name)
    return None


@apply_change.register
def _key_point(change: KeyPoint, camera: EditedCamera) -> Outcome:
    key = schema_key(change.key, change.attribute)
    camera.shot.focus.set_key(
        camera.path, change.name, change.attribute, key.time, key.value, key.interpolation, key.tangents
    )
    return None


@apply_change.register
def _unkey_point(change: UnkeyPoint, camera: EditedCamera) -> Outcome:
    camera.shot.focus.remove_key(camera.path, change.name, change.attribute, change.time)
    return None


@apply_change.register
def _set_point_tangents(change: SetPointTangents, camera: EditedCamera) -> Outcome:
    keys = camera.shot.focus.keys(camera.path, change.name, change.attribute)
    what = f"{change.attribute} of focus point {change.name!r}"
    key = _with_tangents(keys, change.time, change.tangents, what)
    camera.shot.focus.set_key(
        camera.path, change.name, change.attribute, key.time, key.value, key.interpolation, key.tangents
    )
    return None


for _apply_to_camera in CAMERA_CHANGES:
    apply_change.register(_apply_to_camera)


@apply_change.register
def _set_camera(change: SetCamera, camera: EditedCamera) -> Outcome:
    shot, values = camera.shot, change.values
    if "lens" in values.model_fields_set:
        shot.camera.mount_lens(camera.path, lens_to_mount(values.lens))
    if values.body is not None:
        shot.camera.mount_body(camera.path, body_to_mount(values.body))
    settings = values.model_dump(exclude={"lens", "body", "time"}, exclude_none=True)
    if settings.get("focus_distance_m") == 0:
        settings["focus_distance_m"] = math.inf
    if settings:
        shot.camera.set(camera.path, time=values.time, **settings)
    return None


@apply_change.register
def _set_focus(change: SetFocus, camera: EditedCamera) -> Outcome:
    camera.shot.focus.set(camera.path, time=change.values.time, **_sent_values(change.values))
    return None


@apply_change.register
def _set_exposure(change: SetExposure, camera: EditedCamera) -> Outcome:
    shot, values = camera.shot, _sent_values(change.values)
    angle_deg = values.pop("shutter_angle_deg", None)
    if angle_deg is not None and "shutter_close" in values:
        raise SettingsError(
            "shutterAngleDeg sets when the shutter closes: send no shutterClose beside it", path="shutterAngleDeg"
        )
    if angle_deg is not None:
        time = shot.frame_range.start if change.values.time is None else change.values.time
        values["shutter_close"] = shutter_closes(shot, camera.path, time, angle_deg, values.get("shutter_open"))
    shot.exposure.set(camera.path, time=change.values.time, **values)
    return None


@apply_change.register
def _set_film(change: SetFilm, camera: EditedCamera) -> Outcome:
    values = _sent_values(change.values)
    stock = values.pop("stock", None)
    if "stock" in change.values.model_fields_set:
        camera.shot.film.mount_stock(camera.path, film_to_mount(stock))
    if values:
        camera.shot.film.set(camera.path, time=change.values.time, **values)
    return None


@apply_change.register
def _key_setting(change: KeySetting, camera: EditedCamera) -> Outcome:
    name = setting_name(change.setting)
    camera.shot.camera.set_key(camera.path, name, schema_key(change.key, change.setting))
    _check_limits(name, change)  # last: the shot's own message says more
    return None


@apply_change.register
def _unkey_setting(change: UnkeySetting, camera: EditedCamera) -> Outcome:
    camera.shot.camera.remove_key(camera.path, setting_name(change.setting), change.time)
    return None


@apply_change.register
def _set_setting_tangents(change: SetSettingTangents, camera: EditedCamera) -> Outcome:
    name = setting_name(change.setting)
    keys = camera.shot.camera.keys(camera.path, name)
    camera.shot.camera.set_key(camera.path, name, _with_tangents(keys, change.time, change.tangents, change.setting))
    return None


@apply_change.register
def _simplify_setting(change: SimplifySetting, camera: EditedCamera) -> Outcome:
    found = camera.shot.camera.simplify(camera.path, setting_name(change.setting), change.tolerance)
    return SimplifiedSetting(setting=change.setting, before=found.before, after=found.after, off=found.off)


@apply_change.register
def _key_exposure(change: KeyExposure, camera: EditedCamera) -> Outcome:
    readings = [MeteredFrame(reading.time, _stops_or_nan(reading.compensation_stops)) for reading in change.readings]
    camera.shot.exposure.key(camera.path, readings, held=change.held)
    return None


@apply_change.register
def _rack(change: MakeRack, camera: EditedCamera) -> Outcome:
    shot = camera.shot
    rack, lens = shot.focus.rack(camera.path, WeightRack(**change.rack.model_dump()))
    return Rack.model_validate(
        {
            **vars(rack),
            "stretched": lens.is_stretched,
            "start_distance_m": 1 / lens.start_w if lens.start_w > 0 else math.inf,
            "end_distance_m": 1 / lens.end_w if lens.end_w > 0 else math.inf,
            "etag": points_tag(shot, camera.path),
        }
    )


@apply_change.register
def _import_curve(change: ImportCurve, camera: EditedCamera) -> Outcome:
    shot, most = camera.shot, camera.max_curve_frames
    read = read_for_shot(shot.stage, change.content, gaps=change.gaps, first_frame=change.first_frame)
    times = read.curve.time_codes
    if len(times) > most:
        raise SettingsError(f"the file has {len(times):,} frames; at most {most:,} are taken", code="bad_frames")
    shot.focus.import_curve(camera.path, read, baked=change.baked)
    return ImportedCurve(
        camera=read_camera_state(shot, camera.path, float(times[0])),
        first_time=float(times[0]),
        last_time=float(times[-1]),
        frames=len(times),
        drives=[name for column, name in _DRIVES if column in read.given],
        findings=[CurveFinding.model_validate(finding) for finding in read.findings],
    )


@apply_change.register
def _mount_lens_file(change: MountLensFile, camera: EditedCamera) -> Outcome:
    camera.shot.camera.mount_lens(camera.path, file_choice(change.content, change.file_name))
    return None


@apply_change.register
def _add_note(change: AddNote, camera: EditedCamera) -> Outcome:
    return AddedNote(camera.shot.notes.add(note_to_add(change.note, camera.author)))


@apply_change.register
def _edit_note(change: EditNote, camera: EditedCamera) -> Outcome:
    camera.shot.notes.edit(change.id, **note_fields(change.values))
    return None


@apply_change.register
def _delete_note(change: DeleteNote, camera: EditedCamera) -> Outcome:
    camera.shot.notes.delete(change.id)
    return None


def schema_key(key: KeyEdit, attribute: str) -> Key:
    """Make the schemas' key from a key over REST.

    Args:
        key: the key that was sent.
        attribute: name over REST of the keyed attribute; one of `SWITCHES` takes 0 or 1, and is held.

    Raises:
        SettingsError: the value of a switch is not 0 or 1, or tangents were sent with a key that is not bezier.
    """
    if key.tangents is not None and key.interpolation != "bezier":
        raise SettingsError(
            f"only a bezier key has tangents, got some with a {key.interpolation} key", code="bad_key", path="tangents"
        )
    if attribute not in SWITCHES:
        tangents = Tangents(**key.tangents.model_dump()) if key.tangents else None
        return Key(key.time, key.value, key.interpolation, tangents)
    if key.value not in (0, 1):
        raise SettingsError(f"a key of {attribute!r} is 0 or 1, got {key.value:g}", code="bad_key", path="value")
    return Key(key.time, bool(key.value), "held")


def _check_limits(name: str, change: KeySetting) -> None:
    """Check a key's value against the limits of the setting. Raises `SettingsError`."""
    limits, value = SETTINGS[name].sent, change.key.value
    if SETTINGS[name].type not in (float, int):
        return
    if not limits.least <= value <= limits.most or (limits.above and value == limits.least):
        least = f"above {limits.least:g} and at most" if limits.above else f"from {limits.least:g} to"
        detail = f"a key of {change.setting!r} must be {least} {limits.most:g}, got {value!r}"
        raise SettingsError(detail, code="bad_key", path="value")


def _sent_values(edit: FocusSettingsEdit | ExposureSettingsEdit | FilmSettingsEdit) -> dict[str, Any]:
    """Return the values of an edit that were sent and are not null."""
    return edit.model_dump(exclude={"time"}, exclude_none=True)


def _stops_or_nan(stops: float | None) -> float:
    return math.nan if stops is None else stops


def _with_tangents(keys: Sequence[Key], time: float, tangents: TangentsEdit, what: str) -> Key:
    """Return the key at a time as a bezier key with these tangents. Raises `NotFoundError` where there is none."""
    for key in keys:
        if key.time == time:
            return replace(key, interpolation="bezier", tangents=Tangents(**tangents.model_dump()))
    times = ", ".join(f"{key.time:g}" for key in keys) or "none"
    raise NotFoundError(f"{what} has no key at time {time:g}, its keys are: {times}")
