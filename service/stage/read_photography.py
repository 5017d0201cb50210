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
    """Read how a camera exposes at one time.

    Raises:
        CameraError: it is no camera, or has impossible values.
    """
    values = dict(shot.exposure.settings(camera, time))
    open_time_codes = values["shutter_close"] - values["shutter_open"]
    values["shutter_angle_deg"] = 360 * max(open_time_codes, 0.0) / _time_codes_per_frame(shot)
    return _keyed_settings(ExposureSettings, shot, camera, time, values, get_args(ExposureKeyed))


def read_film_settings(shot: Shot, camera: str | None, time: float) -> FilmSettings:
    """Read the film and grade of a camera at one time.

    Raises:
        CameraError: it is no camera, or has impossible values.
    """
    values = dict(shot.film.settings(camera, time))
    usd = UsdGeom.Camera.Get(shot.stage, _path(shot, camera))
    apertures = usd.GetHorizontalApertureAttr(), usd.GetVerticalApertureAttr()
    values["gate_mm"] = tuple(mm_from_tenths(float(aperture.Get(time)), shot.stage) for aperture in apertures)
    return _keyed_settings(FilmSettings, shot, camera, time, values, get_args(FilmKeyed))


def read_grade_choices(shot: Shot, camera: str | None, time: float) -> GradeChoices:
    """List the displays, views and looks that a camera's picture can be graded by.

    Raises:
        CameraError: it is no camera.
        SettingsError: the shot's own configuration cannot be read.
        InputError: the configuration is missing.
    """
    config = config_file(shot.film.settings(camera, time)["ocio_config"], confinement(shot.stage))
    displays = [
        DisplayChoice(name=name, views=list(views), default_view=working_config(config).getDefaultView(name))
        for name, views in list_displays(config).items()
    ]
    return GradeChoices(displays=displays, default_display=Grade(config).display_name, looks=list(list_looks(config)))


def shutter_closes(shot: Shot, camera: str | None, time: float, angle_deg: float, opens: float | None) -> float:
    """Compute when a shutter of an angle closes, in time codes relative to the frame.

    Args:
        shot: the shot.
        camera: prim path, or None for the default camera.
        time: USD time code.
        angle_deg: shutter angle; 360 is a whole frame.
        opens: when the shutter opens; None keeps the camera's own.
    """
    if opens is None:
        opens = float(shot.exposure.settings(camera, time)["shutter_open"])
    return opens + angle_deg / 360 * _time_codes_per_frame(shot)


def _time_codes_per_frame(shot: Shot) -> float:
    return float(shot.stage.GetTimeCodesPerSecond() / shot.stage.GetFramesPerSecond())


def _path(shot: Shot, camera: str | None) -> str:
    return camera or shot.default_camera().path or ""


def _keyed_settings(
    model: type[Settings],
    shot: Shot,
    camera: str | None,
    time: float,
    values: Mapping[str, Any],
    keyed: tuple[Any, ...],
) -> Settings:
    """Return a model of settings with the keys of those that can be keyed."""
    fields = set(model.model_fields) - {"camera", "time", "keys", "etag"}
    keys_by_name = {name: shot.camera.keys(camera, setting_name(name)) for name in keyed}
    plain = {field: _plain(values[field]) for field in fields}
    return settings_model(
        model,
        plain
        | {
            "camera": _path(shot, camera),
            "time": time,
            "keys": {name: [key_model(key) for key in keys] for name, keys in keys_by_name.items() if keys},
            "etag": camera_tag(shot, camera),
        },
    )


def _plain(value: object) -> object:
    return value.path if isinstance(value, Asset) else value
