"""All that can be set and keyed on a camera: lens, focus, exposure and film, by name and in this package's units."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, fields, replace
from typing import Any

from pxr import Sdf, Usd

from render.errors import NotFoundError, SettingsError
from render.focus.curve import FAR_AWAY_M
from render.near_names import hint
from render.optics.photometry.exposure import check_positive
from render.shot.edits.edit_layer import schema_errors_as_settings, set_value
from render.shot.times import check_time
from usd_schemas import FilmData, FocusData, Key, LensCamera, TiltShiftData
from usd_schemas.applying import applied
from usd_schemas.binding import property_values
from usd_schemas.keys import keys, remove_key, set_key
from usd_schemas.units import tenths_from_mm, units_from_metres
from usd_schemas.values import read_value

LENS_SETTINGS = {"f_stop": "fStop", "focal_length_mm": "focalLength", "focus_distance_m": "focusDistance"}
"""What every USD camera has."""

FOCUS_SETTINGS = {
    item.name: (schema, item.metadata["usd"])
    for kind, schema in ((FocusData, "FocusAPI"), (TiltShiftData, "TiltShiftAPI"))
    for item in fields(kind)
}
"""What schemas bring, by the names of their fields: schema and property."""


def _film_properties(kind: type = FilmData, group: str = "") -> Iterator[tuple[str, tuple[str, str]]]:
    for item in fields(kind):
        if "group" in item.metadata:
            yield from _film_properties(item.metadata["group"], f"{item.name}_")
        elif "usd" in item.metadata:
            yield f"{group}{item.name}", ("FilmAPI", item.metadata["usd"])


_FILM_API = dict(_film_properties())
_EXPOSING = ("exposure_", "shutter_", "metering_")
"""Prefixes of the settings of FilmAPI that are about exposure."""

EXPOSURE_SETTINGS = {
    "exposure_time_s": ("", "exposure:time"),
    "iso": ("", "exposure:iso"),
    "exposure_f_stop": ("", "exposure:fStop"),
    "compensation_stops": ("", "exposure"),
    "responsivity": ("", "exposure:responsivity"),
    "shutter_open": ("", "shutter:open"),
    "shutter_close": ("", "shutter:close"),
    "transmittance": ("LensAPI", "lens:transmittance"),
    "neutral_density": ("LensAPI", "lens:neutralDensity"),
    "stop_marking": ("LensAPI", "lens:stopMarking"),
    "natural_vignetting": ("LensAPI", "lens:naturalVignetting"),
    "flare_ghosts": ("LensAPI", "lens:flare:ghosts"),
    "flare_star": ("LensAPI", "lens:flare:star"),
    "breathing": ("LensAPI", "lens:breathing"),
} | {name: usd for name, usd in _FILM_API.items() if name.startswith(_EXPOSING)}
"""Light on the film (stray light too), shutter and metering: schema, empty for what every USD camera has, and property."""

FILM_SETTINGS = {name: usd for name, usd in _FILM_API.items() if name not in EXPOSURE_SETTINGS}
"""The rest of FilmAPI by the names of `FilmData`'s fields, those of its groups after the group's: ``push``, ``grain_amount``."""

_SETTINGS = (
    {name: ("", usd) for name, usd in LENS_SETTINGS.items()} | FOCUS_SETTINGS | EXPOSURE_SETTINGS | FILM_SETTINGS
)
_LABELS = {"f_stop": "f-number", "focal_length_mm": "focal length", "focus_distance_m": "focus distance"}
_POSITIVE = ("exposure_time_s", "iso", "exposure_f_stop", "responsivity")


@dataclass(frozen=True)
class CameraAttribute:
    """One of them, on one camera.

    Attributes:
        camera: the camera.
        name: a key of `LENS_SETTINGS`, `FOCUS_SETTINGS`, `EXPOSURE_SETTINGS` or `FILM_SETTINGS`.

    Raises:
        SettingsError: it is none of these.
    """

    camera: LensCamera
    name: str

    def __post_init__(self) -> None:
        """Check the name."""
        if self.name not in _SETTINGS:
            raise SettingsError(
                f"a camera has no setting {self.name!r}: {hint(self.name, list(_SETTINGS))}", code="bad_field"
            )

    @property
    def usd(self) -> Usd.Attribute:
        """The USD attribute; invalid where its schema is not applied."""
        return self.camera.prim.GetAttribute(_SETTINGS[self.name][1])

    def value(self, time: float) -> Any:
        """What it is at a USD time code; None where its schema is not applied, or it has no value of its type."""
        return read_value(self.usd, time) if self.usd else None

    def keys(self) -> list[Key]:
        """Its keys in order of time."""
        return [self._scaled(key, 1 / self._units) for key in keys(self.usd)] if self.usd else []

    def set(self, value: Any, time: float | None) -> None:
        """Set it, in the stage's edit target.

        Args:
            value: what it shall be.
            time: USD time code of a key; None drops the keys there are and holds the value for all time. What cannot change
                over time holds for all time either way.

        Raises:
            SettingsError: the value is out of range.
            SchemaError: the value or the time is not allowed.
        """
        with self._schema():
            uniform = self.usd.GetVariability() == Sdf.VariabilityUniform
            set_value(self.usd, self._in_usd(value), None if uniform else time)

    def set_key(self, key: Key) -> None:
        """Set, or replace, a key, in the stage's edit target.

        Args:
            key: what it shall be.

        Raises:
            SettingsError: the value is out of range.
            SchemaError: it takes no such key.
        """
        with self._schema():
            tangents = self._scaled(key, self._units).tangents
            set_key(self.usd, key.time, self._in_usd(key.value), key.interpolation, tangents)

    def remove_key(self, time: float) -> None:
        """Remove a key, in the stage's edit target; after the last one its value stays for all time.

        Args:
            time: USD time code.

        Raises:
            NotFoundError: it has no key at that time.
        """
        times = [key.time for key in self.keys()]
        if time not in times:
            told = ", ".join(f"{t:g}" for t in times) or "none"
            raise NotFoundError(f"{self.name} of the camera has no key at time {time:g}, its keys are: {told}")
        remove_key(self.usd, time)

    @property
    def _units(self) -> float:
        """USD's units in one of ours."""
        stage = self.camera.prim.GetStage()
        if self.name == "focal_length_mm":
            return tenths_from_mm(1.0, stage)
        return units_from_metres(1.0, stage) if self.name == "focus_distance_m" else 1.0

    def _in_usd(self, value: Any) -> Any:
        if self.name in _POSITIVE:
            check_positive(self.name.replace("_", " "), value)
        if self.name not in LENS_SETTINGS:
            return value
        _check_lens_setting(self.name, value)
        return min(value, FAR_AWAY_M) * self._units if self.name == "focus_distance_m" else value * self._units

    def _scaled(self, key: Key, factor: float) -> Key:
        if factor == 1:
            return key
        t = key.tangents
        scaled = t and replace(t, in_slope=t.in_slope * factor, out_slope=t.out_slope * factor)
        return replace(key, value=key.value * factor, tangents=scaled)

    def _schema(self) -> AbstractContextManager[None]:
        """Where a schema brings it, have that applied."""
        schema = _SETTINGS[self.name][0]
        return applied(self.camera.prim, schema) if schema else nullcontext()


def author_settings(camera: LensCamera, values: Mapping[str, Any], time: float | None) -> None:
    """Set some of a camera's settings, in the stage's edit target.

    Args:
        camera: the camera.
        values: by name.
        time: USD time code of the keys; None drops the keys there are and holds the values for all time.

    Raises:
        SettingsError: there is no such setting, or a value is out of range.
        SchemaError: a value or the time is not allowed.
    """
    for name, value in values.items():
        CameraAttribute(camera, name).set(value, time)


def read_settings(camera: LensCamera, settings: Mapping[str, tuple[str, str]], time: float) -> dict[str, Any]:
    """Read some of a camera's settings; one whose schema is not applied has the schema's default.

    Args:
        camera: the camera.
        settings: by name: schema, and property.
        time: USD time code.

    Raises:
        SettingsError: a value has no meaning, or the time is not finite.
    """
    with schema_errors_as_settings():
        schemas = dict(property_values(camera.film.read(check_time(time)))) | dict(
            property_values(camera.lens.read(time))
        )
    return {
        name: schemas[usd] if schema else CameraAttribute(camera, name).value(time)
        for name, (schema, usd) in settings.items()
    }


def set_focus_mode(camera: LensCamera, mode: str) -> None:
    """Author what decides the focus in the stage's edit target, unless the camera has that mode already.

    Args:
        camera: the camera.
        mode: manual, points, tiltPlane or surface.

    Raises:
        SchemaError: it is none of these.
    """
    focus = camera.focus.read()
    if mode != focus.mode:
        camera.focus.author(replace(focus, mode=mode))  # type: ignore[arg-type]


def setting_label(name: str) -> str:
    """A setting's name as the labels of edits have it."""
    return _LABELS.get(name, name.replace("_", " "))


def _check_lens_setting(name: str, value: float) -> None:
    """Refuse what no lens can be set to."""
    finite = math.isfinite(value)
    said, good, expected = {
        "f_stop": ("f-number", finite and value >= 0, "0 (a pinhole) or more"),
        "focal_length_mm": ("focal length in mm", finite and value > 0, "above 0"),
        "focus_distance_m": ("focus distance in m", value > 0, "above 0, or infinite"),
    }[name]
    if not good:
        raise SettingsError(f"the {said} must be {expected}, but it is {value:g}", code="bad_lens_setting")
