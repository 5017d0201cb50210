"""From a shot to the model of how a camera's focus is found."""

from __future__ import annotations

from typing import get_args

from render.shot import Shot
from service.models.solving import CameraKeyed, FocusSettings
from service.stage.field_names import setting_name
from service.stage.read_cameras import camera_tag, settings_model
from service.stage.read_points import key_model


def read_focus_settings(shot: Shot, camera: str | None, time: float) -> FocusSettings:
    """Read the focus settings of a camera at one time.

    Raises:
        CameraError: it is no camera, or a number of it is none.
    """
    focus, tilt_shift = shot.focus.settings(camera, time)
    values = vars(focus) | vars(tilt_shift)
    fields = set(FocusSettings.model_fields) - {"camera", "time", "keys", "etag"}
    names: tuple[CameraKeyed, ...] = get_args(CameraKeyed)
    keys = {name: shot.camera.keys(camera, setting_name(name)) for name in names}
    return settings_model(
        FocusSettings,
        {field: values[field] for field in fields}
        | {
            "camera": camera or shot.default_camera().path,
            "time": time,
            "keys": {name: [key_model(key) for key in of_name] for name, of_name in keys.items() if of_name},
            "etag": camera_tag(shot, camera),
        },
    )
