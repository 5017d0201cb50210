"""What the stage process is asked about how a camera's focus is found; see `service.stage.shots`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, get_args

from service.models.focus import KeyEdit
from service.models.solving import CameraKeyed, FocusSettings, FocusSettingsEdit, Rack, RackCreate
from service.stage.applying import FOCUS_OF_FIELD, apply_to_focus
from service.stage.opened import OpenedShots
from service.storage.store import ShotRecord
from service.terms import Terms

if TYPE_CHECKING:
    from render.shot import Shot

SWITCHES = ("solveStop", "drivenByPoints")


@dataclass(frozen=True)
class ReadFocusSettings:
    """How the focus is found at one time."""

    record: ShotRecord
    camera: str | None
    time: float

    def run(self, opened: OpenedShots) -> FocusSettings:
        """Raises `CameraError`."""
        with opened.use(self.record) as shot:
            return _settings(shot, self.camera, self.time)


@dataclass(frozen=True)
class EditFocusSettings:
    """Change how the focus is found."""

    record: ShotRecord
    camera: str | None
    edit: FocusSettingsEdit
    terms: Terms

    def run(self, opened: OpenedShots) -> FocusSettings:
        """The settings as they are then. Raises `CameraError` or `SettingsError`."""
        from service.stage.read_shot import camera_tag

        time = self.edit.time
        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(camera_tag(shot, self.camera), "the camera")
            looked_at = shot.frame_range.start if time is None else time
            with shot.kept_usable(self.camera, looked_at):
                apply_to_focus(shot, self.camera, self.edit)
            return _settings(shot, self.camera, looked_at)


@dataclass(frozen=True)
class SetCameraKey:
    """Set or replace a key of a camera."""

    record: ShotRecord
    camera: str | None
    attribute: CameraKeyed
    key: KeyEdit
    terms: Terms

    def run(self, opened: OpenedShots) -> FocusSettings:
        """The settings at the key's time. Raises `CameraError` or `SettingsError`."""
        from service.stage.authoring import authored_key
        from service.stage.read_shot import camera_tag

        key = authored_key(self.key, self.attribute, is_switch=self.attribute in SWITCHES)
        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(camera_tag(shot, self.camera), "the camera")
            shot.set_camera_key(self.camera, setting_of(self.attribute), key)
            return _settings(shot, self.camera, key.time)


@dataclass(frozen=True)
class RemoveCameraKey:
    """Remove a key of a camera."""

    record: ShotRecord
    camera: str | None
    attribute: CameraKeyed
    time: float
    terms: Terms

    def run(self, opened: OpenedShots) -> FocusSettings:
        """The settings at that time. Raises `NotFoundError`."""
        from service.stage.read_shot import camera_tag

        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(camera_tag(shot, self.camera), "the camera")
            shot.remove_camera_key(self.camera, setting_of(self.attribute), self.time)
            return _settings(shot, self.camera, self.time)


@dataclass(frozen=True)
class MakeRack:
    """Rack from one focus point to another."""

    record: ShotRecord
    camera: str | None
    rack: RackCreate
    terms: Terms

    def run(self, opened: OpenedShots) -> Rack:
        """The rack as it was made. Raises `NotFoundError` or `SettingsError`."""
        from service.stage.read_shot import points_tag
        from usd_schemas.racks import WeightRack

        asked = WeightRack(**self.rack.model_dump())
        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(points_tag(shot, self.camera), "the list of focus points")
            made, lens = shot.rack(self.camera, asked)
            return Rack.model_validate(
                {
                    **vars(made),
                    "stretched": lens.is_stretched,
                    "start_distance_m": 1 / lens.start_w if lens.start_w > 0 else math.inf,
                    "end_distance_m": 1 / lens.end_w if lens.end_w > 0 else math.inf,
                    "etag": points_tag(shot, self.camera),
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
    from service.stage.read_shot import as_key, camera_tag, told_of_camera

    focus, tilt_shift = shot.focus_settings(camera, time)
    said = vars(focus) | vars(tilt_shift)
    fields = set(FocusSettings.model_fields) - {"camera", "time", "keys", "etag"}
    names: tuple[CameraKeyed, ...] = get_args(CameraKeyed)
    keys = {name: shot.camera_keys(camera, setting_of(name)) for name in names}
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
