"""From how a camera exposes, and on what, to models. Runs in the stage process, the one that imports USD."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, get_args

from pxr import UsdGeom

from render.colour import working_config
from render.film import Grade, list_displays, list_looks
from render.film.shot_files import config_file
from render.shot import Shot
from render.stage.opening import confinement
from service.models.exposure import ExposureKeyed, ExposureSettings
from service.models.film_settings import DisplayChoice, FilmKeyed, FilmSettings, GradeChoices
from service.stage.field_names import setting_name
from service.stage.read_cameras import Settings, camera_tag, settings_model
from service.stage.read_points import key_model
from usd_schemas.settings import Asset
from usd_schemas.units import mm_from_tenths


def read_exposure_settings(shot: Shot, camera: str | None, time: float) -> ExposureSettings:
    """How a camera exposes at one time.

    Raises:
        CameraError: it is no camera, or a number of it is none.
    """
    said = dict(shot.exposure.settings(camera, time))
    open_for = said["shutter_close"] - said["shutter_open"]
    said["shutter_angle_deg"] = 360 * max(open_for, 0.0) / _time_codes_in_a_frame(shot)
    return _told(ExposureSettings, shot, camera, time, said, get_args(ExposureKeyed))


def read_film_settings(shot: Shot, camera: str | None, time: float) -> FilmSettings:
    """What a camera's light falls on at one time.

    Raises:
        CameraError: it is no camera, or a number of it is none.
    """
    said = dict(shot.film.settings(camera, time))
    usd = UsdGeom.Camera.Get(shot.stage, _path(shot, camera))
    sides = usd.GetHorizontalApertureAttr(), usd.GetVerticalApertureAttr()
    said["gate_mm"] = tuple(mm_from_tenths(float(side.Get(time)), shot.stage) for side in sides)
    return _told(FilmSettings, shot, camera, time, said, get_args(FilmKeyed))


def read_grade_choices(shot: Shot, camera: str | None, time: float) -> GradeChoices:
    """What a camera's picture can be graded by.

    Raises:
        CameraError: it is no camera.
        SettingsError: the shot's own configuration cannot be read.
        InputError: it is missing.
    """
    config = config_file(shot.film.settings(camera, time)["ocio_config"], confinement(shot.stage))
    displays = [
        DisplayChoice(name=name, views=list(views), default_view=working_config(config).getDefaultView(name))
        for name, views in list_displays(config).items()
    ]
    return GradeChoices(displays=displays, default_display=Grade(config).display_name, looks=list(list_looks(config)))


def shutter_closes(shot: Shot, camera: str | None, time: float, angle_deg: float, opens: float | None) -> float:
    """When a shutter of an opening closes, in time codes from the frame's own.

    Args:
        shot: of the camera.
        camera: of the shutter.
        time: USD time code.
        angle_deg: its opening; 360 is a whole frame.
        opens: when it opens; None leaves that as it is.
    """
    if opens is None:
        opens = float(shot.exposure.settings(camera, time)["shutter_open"])
    return opens + angle_deg / 360 * _time_codes_in_a_frame(shot)


def _time_codes_in_a_frame(shot: Shot) -> float:
    return float(shot.stage.GetTimeCodesPerSecond() / shot.stage.GetFramesPerSecond())


def _path(shot: Shot, camera: str | None) -> str:
    return camera or shot.default_camera().path or ""


def _told(
    model: type[Settings], shot: Shot, camera: str | None, time: float, said: Mapping[str, Any], keyed: tuple[Any, ...]
) -> Settings:
    """A model of settings, with the keys of those that take any."""
    fields = set(model.model_fields) - {"camera", "time", "keys", "etag"}
    keys = {name: shot.camera.keys(camera, setting_name(name)) for name in keyed}
    values = {field: said[field] for field in fields}
    path = _path(shot, camera)
    return settings_model(
        model,
        {field: value.path if isinstance(value, Asset) else value for field, value in values.items()}
        | {
            "camera": path,
            "time": time,
            "keys": {name: [key_model(key) for key in found] for name, found in keys.items() if found},
            "etag": camera_tag(shot, camera),
        },
    )
