"""A digital sensor: charge in proportion to light, up to a full well, with the noise of photons and of reading."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from render.errors import SettingsError
from render.film.noise import normal_noise
from render.film.stock import MIDDLE_GREY
from render.model.arrays import DoubleArray, FloatArray
from usd_schemas.settings import FilmData, Sensor
from usd_schemas.settings.tables import FILM_SETTINGS

_SPEEDS = FILM_SETTINGS["speed"].accepted
_CLIPS = FILM_SETTINGS["sensor_clip_stops"].accepted


@dataclass(frozen=True)
class SensorSettings:
    """Properties of a sensor.

    Attributes:
        full_well_e: electrons at which a photosite is full, at the base speed.
        read_noise_e: standard deviation of reading one photosite, in electrons, in addition to photon noise.
        clip_stops: stops from middle grey to where it clips, the same at each speed; 0 never
            clips, and the full well then is at scene-linear 1.
        sensitivity: relative sensitivity of red, green and blue photosites: weaker ones get fewer electrons and are noisier.
            All clip together, at the light that fills the strongest, so that highlights stay white.
        base_iso: speed at which the full well is used whole.
        iso: set speed: each doubling halves the electrons behind the same picture.
        photosites: across and up; (0, 0) for one to each pixel. Pixels average what they cover.

    Raises:
        SettingsError: a number is out of range.
    """

    full_well_e: float = Sensor.full_well_e
    read_noise_e: float = Sensor.read_noise_e
    clip_stops: float = Sensor.clip_stops
    sensitivity: tuple[float, float, float] = Sensor.sensitivity
    base_iso: float = 100.0
    iso: float = 100.0
    photosites: tuple[int, int] = FilmData.resolution

    def __post_init__(self) -> None:
        positive = (self.full_well_e, *self.sensitivity)
        if not all(0 < number < math.inf for number in positive):
            raise _bad(f"a full well and sensitivities above 0, got {', '.join(f'{n:g}' for n in positive)}")
        if not all(_SPEEDS.least <= speed <= _SPEEDS.most for speed in (self.base_iso, self.iso)):
            raise _bad(
                f"speeds from ISO {_SPEEDS.least:g} to {_SPEEDS.most:g}, got base {self.base_iso:g} and set to {self.iso:g}"
            )
        if not (0 <= self.read_noise_e < math.inf and min(self.photosites) >= 0):
            raise _bad(
                f"read noise and photosites from 0 up, got {self.read_noise_e:g}, "
                f"{self.photosites[0]} x {self.photosites[1]}"
            )
        if not _CLIPS.holds(self.clip_stops):
            raise _bad(f"a clip from 0 to {_CLIPS.most:g} stops above middle grey, got {self.clip_stops:g}")

    @property
    def clip(self) -> float:
        """Scene-linear light at which it clips; infinite where it does not."""
        return MIDDLE_GREY * 2.0**self.clip_stops if self.clip_stops else math.inf

    @property
    def electrons_per_light(self) -> DoubleArray:
        """Electrons of one photosite of each channel at scene-linear 1, ``(3,)``."""
        full_at = self.clip if self.clip_stops else 1.0
        electrons: DoubleArray = (
            np.array(self.sensitivity)
            / max(self.sensitivity)
            * self.full_well_e
            / full_at
            * min(1.0, self.base_iso / self.iso)
        )
        return electrons

    def photosites_in_a_pixel(self, width: int, height: int) -> float:
        """Number of photosites averaged by a pixel of a picture of that size; at least 1."""
        return max(1.0, math.prod(self.photosites) / (height * width))


def expose_sensor(light: FloatArray, sensor: SensorSettings, *, frame: int, seed: int) -> FloatArray:
    """Expose a sensor to light. Photon noise is normal (the limit of Poisson's law from some ten electrons up).

    Args:
        light: ``(height, width, 3)`` scene-linear, well exposed: middle grey is 0.18.
        sensor: properties of the sensor.
        frame: frame number; each frame has noise of its own.
        seed: seed of the noise.

    Returns:
        The same shape, float32, scene-linear: the mean is the light, up to the clip. Noise may go below 0.
    """
    scale = sensor.electrons_per_light
    height, width = light.shape[:2]
    averaged = sensor.photosites_in_a_pixel(width, height)
    electrons = light * scale.astype(np.float32)
    variance = (np.maximum(electrons, 0) + np.float32(sensor.read_noise_e**2)) / np.float32(averaged)
    electrons += np.sqrt(variance) * normal_noise(range(height), range(width), 3, frame=frame, seed=seed)
    electrons /= scale.astype(np.float32)
    if sensor.clip_stops:
        np.minimum(electrons, np.float32(sensor.clip), out=electrons)
    return electrons


def _bad(expected: str) -> SettingsError:
    return SettingsError(f"a sensor needs {expected}", code="bad_sensor")
