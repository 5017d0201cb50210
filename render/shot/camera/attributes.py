"""Settings of a camera that can be set and keyed: lens, focus, exposure and film, by name and in this package's units."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from pxr import Sdf, Usd

from render.errors import NotFoundError, SettingsError
from render.focus.curve import FAR_AWAY_M
from render.model.arrays import DoubleArray
from render.near_names import hint
from render.optics.photometry.exposure import check_positive
from render.shot.edits.edit_layer import schema_errors_as_settings, set_value
from render.shot.times import check_reading_time
from usd_schemas import Key, LensCamera
from usd_schemas.applying import applied
from usd_schemas.binding import property_values
from usd_schemas.curve_fit import fit_knots
from usd_schemas.curves import spline_from_knots
from usd_schemas.keys import author_spline, keys, remove_key, set_key, takes_spline
from usd_schemas.settings.setting import Setting
from usd_schemas.settings.tables import LENS_SETTINGS, SETTINGS
from usd_schemas.units import tenths_from_mm, units_from_metres
from usd_schemas.values import read_value

FLT_MIN = 1.17549435e-38
"""The smallest normal 32-bit float, USD's type of these settings."""
_LABELS = {"f_stop": "f-number"}
MIN_TOLERANCE = 1e-4
"""Least tolerance of a simplified curve: values have some seven digits."""
MAX_SAMPLES = 20_000
"""Most frames and keys together of a curve that may be simplified."""


@dataclass(frozen=True)
class Simplified:
    """Result of a simplification.

    Attributes:
        before: keys that there were.
        after: keys that there are.
        off: largest error of the curve at whole frames and at the former keys, as a share like the tolerance.
    """

    before: int
    after: int
    off: float


@dataclass(frozen=True)
class CameraAttribute:
    """A setting of one camera.

    Attributes:
        camera: the camera.
        name: a key of `usd_schemas.settings.tables.SETTINGS`.

    Raises:
        SettingsError: there is no such setting.
    """

    camera: LensCamera
    name: str

    def __post_init__(self) -> None:
        """Check the name."""
        if self.name not in SETTINGS:
            raise SettingsError(
                f"a camera has no setting {self.name!r}: {hint(self.name, list(SETTINGS))}", code="bad_field"
            )

    @property
    def setting(self) -> Setting:
        """The declaration."""
        return SETTINGS[self.name]

    @property
    def usd(self) -> Usd.Attribute:
        """The USD attribute; invalid where its schema is not applied."""
        return self.camera.prim.GetAttribute(self.setting.usd)

    def value(self, time: float) -> Any:
        """Value at a USD time code; None where its schema is not applied, or it has no value of its type."""
        return read_value(self.usd, time) if self.usd else None

    def keys(self) -> list[Key]:
        """Its keys in order of time."""
        return [self._scaled(key, 1 / self._units) for key in keys(self.usd)] if self.usd else []

    def set(self, value: Any, time: float | None) -> None:
        """Set it, in the stage's edit target.

        Args:
            value: in this package's unit.
            time: USD time code of a key; None drops the keys there are and holds the value for all time. A uniform attribute
                holds it for all time either way.

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
            key: in this package's unit.

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
            known = ", ".join(f"{t:g}" for t in times) or "none"
            raise NotFoundError(f"{self.name} of the camera has no key at time {time:g}, its keys are: {known}")
        remove_key(self.usd, time)

    def simplify(self, tolerance: float) -> Simplified:
        """Replace its keys by fewer that make nearly the same curve, in the stage's edit target; without fewer, they stay.

        Args:
            tolerance: how far the curve may be off, as a share: of the value where the setting is measured by ratios, as
                distances and f-numbers are, else of the span of the values.

        Raises:
            SettingsError: the tolerance is not from `MIN_TOLERANCE` to below 1, there are fewer than three keys, or they make no
                curve.
        """
        old, name = self.keys(), setting_label(self.name)
        if not MIN_TOLERANCE <= tolerance < 1:
            detail = f"the tolerance must be a share from {MIN_TOLERANCE:g} to below 1, got {tolerance:g}"
            raise SettingsError(detail, path="tolerance")
        if len(old) < 3:
            raise SettingsError(f"the {name} has {len(old)} keys, which are few already", code="no_curve")
        if not takes_spline(self.usd) or any(key.interpolation == "held" for key in old[:-1]):
            raise SettingsError(
                f"the {name} holds its value from key to key, which is no curve to simplify", code="no_curve"
            )
        former = self.usd.GetSpline() if self.usd.HasSpline() else None
        if former is not None and former.HasLoops():
            raise SettingsError(f"the curve of the {name} has loops, which would be lost", code="no_curve")
        times = _sampled_times([key.time for key in old], name)
        values = np.array([self.usd.Get(float(time)) for time in times], np.float64)
        if not np.isfinite(values).all():
            raise SettingsError(
                f"the {name} has times without a value, which make no curve to simplify", code="no_curve"
            )
        size = self._size_of(values)
        value_type: Literal["float", "double"] = "double" if str(self.usd.GetTypeName()) == "double" else "float"
        spline = spline_from_knots(fit_knots(times, values, tolerance * size), value_type)
        if len(spline.GetKnots()) >= len(old):
            return Simplified(len(old), len(old), 0.0)
        if former is not None:
            spline.SetPreExtrapolation(former.GetPreExtrapolation())
            spline.SetPostExtrapolation(former.GetPostExtrapolation())
        with self._schema():
            author_spline(self.usd, spline)
        off = max(abs(spline.Eval(time) - value) / most for time, value, most in zip(times, values, size, strict=True))
        return Simplified(len(old), len(spline.GetKnots()), off)

    def _size_of(self, values: DoubleArray) -> DoubleArray:
        """Return what an error of each value is a share of."""
        slider = self.setting.slider
        if slider is not None and slider.scale != "linear" and (values > 0).all():
            return values
        return np.full(len(values), max(float(np.ptp(values)), float(np.finfo(np.float32).tiny)))

    @property
    def _units(self) -> float:
        """USD units in one unit of this package."""
        stage = self.camera.prim.GetStage()
        if self.setting.length == "tenths":
            return tenths_from_mm(1.0, stage)
        return units_from_metres(1.0, stage) if self.setting.length == "units" else 1.0

    def _in_usd(self, value: Any) -> Any:
        if self.setting.rest == "exposure" and self.setting.sent.above:
            check_positive(self.name.replace("_", " "), value)
        if self.name not in LENS_SETTINGS:
            return value
        _check_lens_setting(self.setting, value)
        in_usd = (min(value, FAR_AWAY_M) if self.name == "focus_distance_m" else value) * self._units
        if value > 0 and in_usd < FLT_MIN:  # 0 would be a pinhole, or infinity
            raise SettingsError(f"the {setting_label(self.name)} {value:g} is too small", code="bad_lens_setting")
        return in_usd

    def _scaled(self, key: Key, factor: float) -> Key:
        if factor == 1:
            return key
        t = key.tangents
        scaled = t and replace(t, in_slope=t.in_slope * factor, out_slope=t.out_slope * factor)
        return replace(key, value=key.value * factor, tangents=scaled)

    def _schema(self) -> AbstractContextManager[None]:
        """Apply the setting's schema, where it has one."""
        schema = self.setting.schema
        return applied(self.camera.prim, schema) if schema else nullcontext()


def _sampled_times(key_times: Sequence[float], name: str) -> DoubleArray:
    """Return the times of keys and the whole frames between them. Raises `SettingsError` where they are too many."""
    first, last = key_times[0], key_times[-1]
    if last - first + len(key_times) > MAX_SAMPLES:
        raise SettingsError(f"the curve of the {name} has more than {MAX_SAMPLES:,} frames", code="bad_frames")
    return np.union1d(np.asarray(key_times, np.float64), np.arange(math.ceil(first), math.floor(last) + 1.0))


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


def read_settings(camera: LensCamera, settings: Mapping[str, Setting], time: float) -> dict[str, Any]:
    """Read some of a camera's settings; one whose schema is not applied has the schema's default.

    Args:
        camera: the camera.
        settings: by name.
        time: USD time code.

    Raises:
        SettingsError: a value has no meaning, or the time is not finite.
    """
    with schema_errors_as_settings():
        schemas = dict(property_values(camera.film.read(check_reading_time(time)))) | dict(
            property_values(camera.lens.read(time))
        )
    return {
        name: schemas[setting.usd] if setting.schema else CameraAttribute(camera, name).value(time)
        for name, setting in settings.items()
    }


def set_focus_mode(camera: LensCamera, mode: str) -> None:
    """Author the focus mode in the stage's edit target, unless the camera has it already.

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
    return _LABELS.get(name, SETTINGS[name].words if name in SETTINGS else name.replace("_", " "))


def _check_lens_setting(setting: Setting, value: float) -> None:
    """Raise `SettingsError` for a value that no lens can be set to."""
    limits = setting.settable
    if limits is None or limits.holds(value):
        return
    expected = f"above {limits.least:g}" if limits.above else f"{limits.least:g} ({limits.zero}) or more"
    infinite = ", or infinite" if limits.most == math.inf else ""
    unit = setting.name.removeprefix(setting.words.replace(" ", "_")).replace("_", " in ")
    label = f"{setting_label(setting.name)}{unit}"
    raise SettingsError(f"the {label} must be {expected}{infinite}, but it is {value:g}", code="bad_lens_setting")
