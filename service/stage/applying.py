"""Edits as they are sent, made on an opened shot: for good in the stage process, for one picture in the other.

Raises of all of them: `CameraError`, `NotFoundError`, `SettingsError`, as the shot's own edits do.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from render.errors import SettingsError
from render.shot import Shot
from service.models.cameras import CameraEdit
from service.models.exposure import ExposureSettingsEdit
from service.models.film_settings import FilmSettingsEdit
from service.models.focus import FocusPointEdit, KeyedAttribute, KeyEdit
from service.models.solving import FocusSettingsEdit
from service.stage.authoring import authored_key
from service.stage.field_names import FOCUS_OF_FIELD
from service.stage.lenses import lens_to_mount
from service.stage.libraries import body_to_mount, film_to_mount
from service.stage.read_photography import shutter_closes
from service.stage.read_shot import point_fields


def apply_to_camera(shot: Shot, camera: str | None, edit: CameraEdit) -> None:
    """Set the lens, or put another one or another body on."""
    if "lens" in edit.model_fields_set:
        shot.camera.mount_lens(camera, lens_to_mount(edit.lens))
    if edit.body is not None:
        shot.camera.mount_body(camera, body_to_mount(edit.body))
    shot.camera.set(
        camera,
        f_stop=edit.f_stop,
        focal_length_mm=edit.focal_length_mm,
        focus_distance_m=math.inf if edit.focus_distance_m == 0 else edit.focus_distance_m,
        focus_mode=edit.focus_mode,
        time=edit.time,
    )


def apply_to_focus(shot: Shot, camera: str | None, edit: FocusSettingsEdit) -> None:
    """Change how the focus is found."""
    shot.focus.set(camera, time=edit.time, **_said(edit, FOCUS_OF_FIELD))


def apply_to_exposure(shot: Shot, camera: str | None, edit: ExposureSettingsEdit) -> None:
    """Change how the camera exposes."""
    said = _said(edit, {})
    angle_deg = said.pop("shutter_angle_deg", None)
    if angle_deg is not None and "shutter_close" in said:
        raise SettingsError(
            "shutterAngleDeg says when the shutter closes: send no shutterClose beside it", path="shutterAngleDeg"
        )
    if angle_deg is not None:
        time = shot.frame_range.start if edit.time is None else edit.time
        said["shutter_close"] = shutter_closes(shot, camera, time, angle_deg, said.get("shutter_open"))
    shot.exposure.set(camera, time=edit.time, **said)


def apply_to_film(shot: Shot, camera: str | None, edit: FilmSettingsEdit) -> None:
    """Change film and grade."""
    said = _said(edit, {})
    name = said.pop("stock", None)
    if "stock" in edit.model_fields_set:
        shot.film.mount_stock(camera, film_to_mount(name))
    if said:
        shot.film.set(camera, time=edit.time, **said)


def apply_to_point(shot: Shot, camera: str | None, time: float, name: str, edit: FocusPointEdit) -> None:
    """Change a focus point: a value that has keys gets one at the time."""
    shot.focus.update_point(camera, name, time=time, **point_fields(edit))


def apply_key(shot: Shot, camera: str | None, name: str, attribute: KeyedAttribute, key: KeyEdit) -> None:
    """Set a key of a focus point."""
    made = authored_key(key, attribute, is_switch=attribute == "enabled")
    shot.focus.set_key(camera, name, attribute, made.time, made.value, made.interpolation, made.tangents)


def _said(
    edit: FocusSettingsEdit | ExposureSettingsEdit | FilmSettingsEdit, names: Mapping[str, str]
) -> dict[str, Any]:
    said = edit.model_dump(exclude={"time"}, exclude_none=True)
    return {names.get(field, field): value for field, value in said.items()}
