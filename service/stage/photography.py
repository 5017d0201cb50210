"""Functions of the stage process that read and change how a camera exposes, and its film and grade."""

from __future__ import annotations

from service.edit_context import EditContext
from service.models.changes import KeySetting, SetExposure, SetFilm, UnkeySetting
from service.models.exposure import ExposureSettings
from service.models.film_settings import FilmSettings, GradeChoices
from service.stage import read_photography
from service.stage.editing import apply_in_context
from service.stage.opened import OpenedShot, stage_function
from service.storage.store import ShotRecord


@stage_function
def read_exposure_settings(opened: OpenedShot, record: ShotRecord, camera: str | None, time: float) -> ExposureSettings:
    """Read how a camera exposes at one time. Raises `CameraError`."""
    with opened.use(record) as shot:
        return read_photography.read_exposure_settings(shot, camera, time)


@stage_function
def read_film_settings(opened: OpenedShot, record: ShotRecord, camera: str | None, time: float) -> FilmSettings:
    """Read the film and grade of a camera at one time. Raises `CameraError`."""
    with opened.use(record) as shot:
        return read_photography.read_film_settings(shot, camera, time)


@stage_function
def read_grade_choices(opened: OpenedShot, record: ShotRecord, camera: str | None, time: float) -> GradeChoices:
    """Read the displays, views and looks that a camera's picture can be graded by.

    Raises:
        CameraError: it is no camera.
        SettingsError: the shot's own configuration cannot be read.
    """
    with opened.use(record) as shot:
        return read_photography.read_grade_choices(shot, camera, time)


@stage_function
def change_exposure_settings(
    opened: OpenedShot,
    record: ShotRecord,
    camera: str | None,
    change: SetExposure | KeySetting | UnkeySetting,
    time: float | None,
    context: EditContext,
) -> ExposureSettings:
    """Change how a camera exposes, and read that at a time; None is the first frame.

    Raises:
        CameraError: there is no such camera.
        SettingsError: a value is not allowed, or no picture can be made with it.
        NotFoundError: there is no such key.
    """
    with opened.edit(record, context) as shot:
        apply_in_context(shot, camera, [change], context)
        start = shot.frame_range.start
        return read_photography.read_exposure_settings(shot, camera, start if time is None else time)


@stage_function
def change_film_settings(
    opened: OpenedShot,
    record: ShotRecord,
    camera: str | None,
    change: SetFilm | KeySetting | UnkeySetting,
    time: float | None,
    context: EditContext,
) -> FilmSettings:
    """Change film and grade, and read them at a time; None is the first frame. Raises as `change_exposure_settings`."""
    with opened.edit(record, context) as shot:
        apply_in_context(shot, camera, [change], context)
        start = shot.frame_range.start
        return read_photography.read_film_settings(shot, camera, start if time is None else time)
