"""Exposure: its time, speed and f-number, and the picture's values that follow from them.

The law is UsdGeomCamera's: with ``exposure:time`` t, ``:iso`` S, ``:fStop`` N, ``:responsivity`` R and the compensation
``exposure`` c, a radiance L is multiplied by

    t · S · R · 2^c / (100 · N²)                                                         (`ExposureSettings.scale`)

It is that of the light on the film too (`render.optics.photometry.illuminance`): ``π · L · t / (4 · N²)`` lux-seconds become
``L · scale``,
so a lux-second becomes ``4 · S · R · 2^c / (100 · π)`` (`ExposureSettings.value`). With R = 1 the value 1 is at 78.5 / S
lux-seconds, which is where ISO 12232 has a sensor of saturation-based speed S clip (78 / S).

USD's ``exposure:fStop`` is a number of its own and need not be the iris's ``fStop``. Luminances are nits where the lights are, as
UsdLux has it since OpenUSD 25.05; otherwise they are relative, and so is all that is measured of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from render.errors import SettingsError
from render.model.arrays import DoubleArray

MIDDLE_GREY = 0.18
"""Value of the picture, scene-linear, that a metered grey becomes."""
MAX_COMPENSATION_STOPS = 100
"""Far beyond what any picture has, and far from where numbers end."""

Variable = Literal["time", "iso", "f_stop", "compensation"]


@dataclass(frozen=True)
class ExposureSettings:
    """UsdGeomCamera's ``exposure`` and ``exposure:*``, with its fallbacks.

    Attributes:
        time_s: ``exposure:time``.
        iso: ``exposure:iso``.
        f_stop: ``exposure:fStop``.
        compensation_stops: ``exposure``.
        responsivity: ``exposure:responsivity``.

    Raises:
        SettingsError: f-number, time, ISO or responsivity is not a positive number, or the compensation out of range.
    """

    time_s: float = 1.0
    iso: float = 100.0
    f_stop: float = 1.0
    compensation_stops: float = 0.0
    responsivity: float = 1.0

    def __post_init__(self) -> None:
        check_positive("the exposure time in seconds", self.time_s)
        check_positive("ISO", self.iso)
        check_positive("the f-number of the exposure", self.f_stop)
        check_positive("responsivity", self.responsivity)
        if not abs(self.compensation_stops) <= MAX_COMPENSATION_STOPS:
            raise SettingsError(
                f"exposure compensation must be from -{MAX_COMPENSATION_STOPS} to {MAX_COMPENSATION_STOPS} stops, "
                f"got {self.compensation_stops:g}"
            )

    @property
    def scale(self) -> float:
        """Factor on radiance; UsdGeomCamera's ``ComputeLinearExposureScale``."""
        return self.time_s * self._gain / (100 * self.f_stop**2)

    @property
    def ev100(self) -> float:
        """Exposure value at ISO 100 of the luminance for which time, f-number and ISO are right: ``log2(100·N² / (t·S))``."""
        return math.log2(100 * self.f_stop**2 / (self.time_s * self.iso))

    def value(self, lux_seconds: ArrayLike) -> DoubleArray:
        """Scene-linear picture value of an exposure of the film.

        Args:
            lux_seconds: any shape; `illuminance_lux` times the exposure time.
        """
        return np.asarray(lux_seconds, np.float64) * (4 * self._gain / (100 * math.pi))

    @property
    def _gain(self) -> float:
        return self.iso * self.responsivity * math.exp2(self.compensation_stops)


def equivalent(settings: ExposureSettings, solve: Variable, **changes: Any) -> ExposureSettings:
    """Settings changed in some numbers, and in one more that makes up for it, so that the picture is as bright as before.

    Args:
        settings: as they are.
        solve: what makes up for the changes.
        **changes: fields of `ExposureSettings`, other than the one to solve for.

    Raises:
        SettingsError: a number is out of range, or the one to solve for is changed too.
    """
    field = {"time": "time_s", "iso": "iso", "f_stop": "f_stop", "compensation": "compensation_stops"}.get(solve)
    if field is None:
        raise SettingsError(f"an equivalent exposure is solved for time, iso, f_stop or compensation, got {solve}")
    if field in changes:
        raise SettingsError(
            f"an equivalent exposure is solved for {solve}, so it cannot be set to {changes[field]} too"
        )
    changed = replace(settings, **changes)
    lost = settings.scale / changed.scale
    before = getattr(changed, field)
    made_up = {"time": before * lost, "iso": before * lost, "f_stop": before / math.sqrt(lost)}
    return replace(changed, **{field: made_up.get(solve, before + math.log2(lost))})


def nd_transmittance(density: float) -> float:
    """Share of the light that a neutral density filter lets through: ``10^-D``.

    Raises:
        SettingsError: the density is negative or no number.
    """
    if not density >= 0:
        raise SettingsError(f"the density of a filter must be 0 or more, got {density:g}")
    return float(10.0**-density)


def stops_of_density(density: float) -> float:
    """Stops of a neutral density filter; a density of 0.3 is nearly one stop."""
    return density * math.log2(10)


def shutter_time_s(angle_rad: float, frames_per_second: float) -> float:
    """Exposure time of each frame under a rotating shutter.

    Raises:
        SettingsError: the opening is not above 0 and up to a full turn, or the frame rate is not positive.
    """
    check_positive("the frame rate", frames_per_second)
    if not 0 < angle_rad <= 2 * math.pi:
        raise SettingsError(f"a shutter angle must be above 0° and up to 360°, got {math.degrees(angle_rad):g}°")
    return angle_rad / (2 * math.pi * frames_per_second)


def shutter_angle_rad(time_s: float, frames_per_second: float) -> float:
    """Opening angle of a rotating shutter for an exposure time; above a full turn where a frame is too short.

    Raises:
        SettingsError: a number is not positive.
    """
    check_positive("the frame rate", frames_per_second)
    check_positive("the exposure time in seconds", time_s)
    return 2 * math.pi * frames_per_second * time_s


def check_positive(name: str, value: float) -> None:
    """Raise `SettingsError` unless a number is positive and finite."""
    if not (value > 0 and math.isfinite(value)):
        raise SettingsError(f"{name} must be a positive number, got {value:g}", code="bad_exposure")
