"""Accumulated light of a long exposure, interval by interval: a running mean, valid at any time."""

from __future__ import annotations

import math

import numpy as np

from render.errors import SettingsError
from render.model.arrays import DoubleArray, FloatArray


class LightAccumulator:
    """The mean light of all the time that a shutter was open.

    Each interval is weighted by its length relative to the whole: 1/n for the nth of equal ones (Kyaw 2013, section 7.4). So the
    picture is exposed like one interval, whatever their number, and it is valid after each of them.

    Attributes:
        frames: accumulated time in frames.
        intervals: number of accumulated intervals.
    """

    def __init__(self) -> None:
        self.frames = 0.0
        self.intervals = 0
        self._mean: DoubleArray | None = None  # in double precision: thousands of intervals must not round a trail away

    def add(self, light: FloatArray, frames: float) -> None:
        """Add the light of one interval.

        Args:
            light: ``(height, width, channels)`` scene-linear, as bright as a picture of that interval alone.
            frames: length of the interval in frames.

        Raises:
            SettingsError: the interval has no length, or its picture has another size than those before.
        """
        if not (math.isfinite(frames) and frames > 0):
            raise SettingsError(f"an interval of a long exposure must be longer than 0 frames, got {frames:g}")
        if self._mean is None:
            self._mean = np.zeros(light.shape)
        if light.shape != self._mean.shape:
            raise SettingsError(
                f"all pictures of a long exposure have one size, got {light.shape} after {self._mean.shape}"
            )
        self.frames += frames
        self.intervals += 1
        self._mean += (light - self._mean) * (frames / self.frames)

    @property
    def light(self) -> FloatArray:
        """Mean ``(height, width, channels)`` float32.

        Raises:
            SettingsError: the shutter was never open.
        """
        if self._mean is None:
            raise SettingsError("nothing is exposed yet: the shutter was never open")
        return self._mean.astype(np.float32)
