"""What the stage process is asked about how a camera exposes, and on what; see `service.stage.shots`."""

from __future__ import annotations

from dataclasses import dataclass

from service.models.exposure import ExposureKeyed, ExposureSettings, ExposureSettingsEdit
from service.models.film_settings import FilmKeyed, FilmSettings, FilmSettingsEdit, GradeChoices
from service.models.focus import KeyEdit
from service.stage.applying import PHOTOGRAPHY_OF_FIELD, apply_to_exposure, apply_to_film
from service.stage.opened import OpenedShots
from service.storage.store import ShotRecord
from service.terms import Terms


def setting_of(attribute: ExposureKeyed | FilmKeyed) -> str:
    """The shot's name of what is keyed.

    Args:
        attribute: its name over REST.
    """
    fields = {
        info.alias: field for model in (ExposureSettings, FilmSettings) for field, info in model.model_fields.items()
    }
    return PHOTOGRAPHY_OF_FIELD.get(fields[attribute], fields[attribute])


@dataclass(frozen=True)
class ReadExposureSettings:
    """How a camera exposes at one time."""

    record: ShotRecord
    camera: str | None
    time: float

    def run(self, opened: OpenedShots) -> ExposureSettings:
        """Raises `CameraError`."""
        from service.stage.read_photography import read_exposure_settings

        with opened.use(self.record) as shot:
            return read_exposure_settings(shot, self.camera, self.time)


@dataclass(frozen=True)
class ReadFilmSettings:
    """What a camera's light falls on at one time."""

    record: ShotRecord
    camera: str | None
    time: float

    def run(self, opened: OpenedShots) -> FilmSettings:
        """Raises `CameraError`."""
        from service.stage.read_photography import read_film_settings

        with opened.use(self.record) as shot:
            return read_film_settings(shot, self.camera, self.time)


@dataclass(frozen=True)
class ReadGradeChoices:
    """What a camera's picture can be graded by."""

    record: ShotRecord
    camera: str | None
    time: float

    def run(self, opened: OpenedShots) -> GradeChoices:
        """Raises `CameraError`, or `SettingsError`: the shot's own configuration cannot be read."""
        from service.stage.read_photography import read_grade_choices

        with opened.use(self.record) as shot:
            return read_grade_choices(shot, self.camera, self.time)


@dataclass(frozen=True)
class EditExposureSettings:
    """Change how a camera exposes."""

    record: ShotRecord
    camera: str | None
    edit: ExposureSettingsEdit
    terms: Terms

    def run(self, opened: OpenedShots) -> ExposureSettings:
        """The settings as they are then. Raises `CameraError` or `SettingsError`."""
        from service.stage.read_photography import read_exposure_settings
        from service.stage.read_shot import camera_tag

        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(camera_tag(shot, self.camera), "the camera")
            time = shot.frame_range.start if self.edit.time is None else self.edit.time
            with shot.kept_usable(self.camera, time):
                apply_to_exposure(shot, self.camera, self.edit)
            return read_exposure_settings(shot, self.camera, time)


@dataclass(frozen=True)
class EditFilmSettings:
    """Change film and grade."""

    record: ShotRecord
    camera: str | None
    edit: FilmSettingsEdit
    terms: Terms

    def run(self, opened: OpenedShots) -> FilmSettings:
        """The settings as they are then. Raises `CameraError` or `SettingsError`."""
        from service.stage.read_photography import read_film_settings
        from service.stage.read_shot import camera_tag

        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(camera_tag(shot, self.camera), "the camera")
            time = shot.frame_range.start if self.edit.time is None else self.edit.time
            with shot.kept_usable(self.camera, time):
                apply_to_film(shot, self.camera, self.edit)
            return read_film_settings(shot, self.camera, time)


@dataclass(frozen=True)
class _KeyWork:
    record: ShotRecord
    camera: str | None
    terms: Terms

    def _set(self, opened: OpenedShots, attribute: ExposureKeyed | FilmKeyed, key: KeyEdit) -> None:
        from service.stage.authoring import authored_key
        from service.stage.read_shot import camera_tag

        authored = authored_key(key, attribute, is_switch=False)
        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(camera_tag(shot, self.camera), "the camera")
            with shot.kept_usable(self.camera, key.time):
                shot.set_camera_key(self.camera, setting_of(attribute), authored)

    def _remove(self, opened: OpenedShots, attribute: ExposureKeyed | FilmKeyed, time: float) -> None:
        from service.stage.read_shot import camera_tag

        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(camera_tag(shot, self.camera), "the camera")
            shot.remove_camera_key(self.camera, setting_of(attribute), time)


@dataclass(frozen=True)
class KeyExposure(_KeyWork):
    """Set or replace a key of how a camera exposes, or with no key remove the one at a time."""

    attribute: ExposureKeyed
    time: float
    key: KeyEdit | None = None

    def run(self, opened: OpenedShots) -> ExposureSettings:
        """The settings at that time. Raises `CameraError`, `SettingsError` or `NotFoundError`."""
        if self.key is None:
            self._remove(opened, self.attribute, self.time)
        else:
            self._set(opened, self.attribute, self.key)
        return ReadExposureSettings(self.record, self.camera, self.time).run(opened)


@dataclass(frozen=True)
class KeyFilm(_KeyWork):
    """Set or replace a key of film or grade, or with no key remove the one at a time."""

    attribute: FilmKeyed
    time: float
    key: KeyEdit | None = None

    def run(self, opened: OpenedShots) -> FilmSettings:
        """The settings at that time. Raises `CameraError`, `SettingsError` or `NotFoundError`."""
        if self.key is None:
            self._remove(opened, self.attribute, self.time)
        else:
            self._set(opened, self.attribute, self.key)
        return ReadFilmSettings(self.record, self.camera, self.time).run(opened)
