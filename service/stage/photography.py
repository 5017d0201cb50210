"""Functions of the stage process that read and edit how a camera exposes, and its film and grade."""

from __future__ import annotations

from service.edit_context import EditContext
from service.models.exposure import ExposureKeyed, ExposureSettings, ExposureSettingsEdit
from service.models.film_settings import FilmKeyed, FilmSettings, FilmSettingsEdit, GradeChoices
from service.models.focus import KeyEdit
from service.stage import read_photography
from service.stage.applying import apply_to_exposure, apply_to_film
from service.stage.authoring import authored_key
from service.stage.field_names import photography_setting
from service.stage.opened import OpenedShots, stage_function
from service.stage.read_shot import camera_tag
from service.storage.store import ShotRecord


@stage_function
def read_exposure_settings(
    opened: OpenedShots, record: ShotRecord, camera: str | None, time: float
) -> ExposureSettings:
    """Read how a camera exposes at one time. Raises `CameraError`."""
    with opened.use(record) as shot:
        return read_photography.read_exposure_settings(shot, camera, time)


@stage_function
def read_film_settings(opened: OpenedShots, record: ShotRecord, camera: str | None, time: float) -> FilmSettings:
    """Read the film and grade of a camera at one time. Raises `CameraError`."""
    with opened.use(record) as shot:
        return read_photography.read_film_settings(shot, camera, time)


@stage_function
def read_grade_choices(opened: OpenedShots, record: ShotRecord, camera: str | None, time: float) -> GradeChoices:
    """Read the displays, views and looks that a camera's picture can be graded by.

    Raises:
        CameraError: it is no camera.
        SettingsError: the shot's own configuration cannot be read.
    """
    with opened.use(record) as shot:
        return read_photography.read_grade_choices(shot, camera, time)


@stage_function
def edit_exposure_settings(
    opened: OpenedShots, record: ShotRecord, camera: str | None, edit: ExposureSettingsEdit, context: EditContext
) -> ExposureSettings:
    """Change how a camera exposes. Raises `CameraError` or `SettingsError`."""
    with opened.edit(record, context) as shot:
        context.check_tag(camera_tag(shot, camera), "the camera")
        time = shot.frame_range.start if edit.time is None else edit.time
        with shot.keep_usable(camera, time):
            apply_to_exposure(shot, camera, edit)
        return read_photography.read_exposure_settings(shot, camera, time)


@stage_function
def edit_film_settings(
    opened: OpenedShots, record: ShotRecord, camera: str | None, edit: FilmSettingsEdit, context: EditContext
) -> FilmSettings:
    """Change film and grade. Raises `CameraError` or `SettingsError`."""
    with opened.edit(record, context) as shot:
        context.check_tag(camera_tag(shot, camera), "the camera")
        time = shot.frame_range.start if edit.time is None else edit.time
        with shot.keep_usable(camera, time):
            apply_to_film(shot, camera, edit)
        return read_photography.read_film_settings(shot, camera, time)


@stage_function
def set_exposure_key(
    opened: OpenedShots,
    record: ShotRecord,
    camera: str | None,
    attribute: ExposureKeyed,
    key: KeyEdit,
    context: EditContext,
) -> ExposureSettings:
    """Set or replace a key of how a camera exposes. Raises `CameraError` or `SettingsError`."""
    _set_key(opened, record, camera, attribute, key, context)
    return read_exposure_settings(opened, record, camera, key.time)


@stage_function
def remove_exposure_key(
    opened: OpenedShots,
    record: ShotRecord,
    camera: str | None,
    attribute: ExposureKeyed,
    time: float,
    context: EditContext,
) -> ExposureSettings:
    """Remove a key of how a camera exposes. Raises `CameraError` or `NotFoundError`."""
    _remove_key(opened, record, camera, attribute, time, context)
    return read_exposure_settings(opened, record, camera, time)


@stage_function
def set_film_key(
    opened: OpenedShots,
    record: ShotRecord,
    camera: str | None,
    attribute: FilmKeyed,
    key: KeyEdit,
    context: EditContext,
) -> FilmSettings:
    """Set or replace a key of film or grade. Raises `CameraError` or `SettingsError`."""
    _set_key(opened, record, camera, attribute, key, context)
    return read_film_settings(opened, record, camera, key.time)


@stage_function
def remove_film_key(
    opened: OpenedShots, record: ShotRecord, camera: str | None, attribute: FilmKeyed, time: float, context: EditContext
) -> FilmSettings:
    """Remove a key of film or grade. Raises `CameraError` or `NotFoundError`."""
    _remove_key(opened, record, camera, attribute, time, context)
    return read_film_settings(opened, record, camera, time)


def _set_key(
    opened: OpenedShots,
    record: ShotRecord,
    camera: str | None,
    attribute: ExposureKeyed | FilmKeyed,
    key: KeyEdit,
    context: EditContext,
) -> None:
    authored = authored_key(key, attribute, is_switch=False)
    with opened.edit(record, context) as shot:
        context.check_tag(camera_tag(shot, camera), "the camera")
        with shot.keep_usable(camera, key.time):
            shot.camera.set_key(camera, photography_setting(attribute), authored)


def _remove_key(
    opened: OpenedShots,
    record: ShotRecord,
    camera: str | None,
    attribute: ExposureKeyed | FilmKeyed,
    time: float,
    context: EditContext,
) -> None:
    with opened.edit(record, context) as shot:
        context.check_tag(camera_tag(shot, camera), "the camera")
        shot.camera.remove_key(camera, photography_setting(attribute), time)
