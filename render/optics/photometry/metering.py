"""Metering: mean luminance of a picture, its distance from middle grey in stops, and the compensation that corrects it.

A meter is a photocell behind a mask: it reads the mean luminance of a region, and exposes as if that were a grey of 18 %
(`MIDDLE_GREY`). Each frame of a shot gets a compensation of its own. Keyed frame by frame they would flicker, so they are reduced
to one (`one_key`), or to a curve that is too slow to flicker (`smoothed_keys`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from render.errors import InputError, SettingsError
from render.model.arrays import DoubleArray, FloatArray
from render.optics.photometry.exposure import MIDDLE_GREY, ExposureSettings

METER_CONSTANT = 12.5
"""K of reflected-light meters (ISO 2720:1974) in cd·s/m² at ISO 1: EV 0 at ISO 100 is right for a luminance of K/100 nits."""
SPOT_ANGLE_RAD = math.radians(1)
"""Field of a hand-held spot meter."""
LUMINANCE_OF_ACESCG = (0.27222872, 0.67408177, 0.05368952)
"""Luminance of red, green and blue with AP1 primaries (SMPTE ST 2065-1's white), the working space by default."""

MeterMode = Literal["spot", "center", "average"]
_CENTRE_SIGMA_WIDTHS = 1 / 6 / math.sqrt(2 * math.log(4))  # three quarters within a circle of a third of the width
_BRIGHTEST = 65504.0  # as a half float holds it: one broken pixel must not blind the meter
_ROWS_AT_ONCE = 256


@dataclass(frozen=True)
class Reading:
    """Reading of a light meter.

    Attributes:
        luminance_nits: mean luminance of the metered pixels; 0 where they are black.
        settings: exposure settings.
        transmittance: share of the light that reaches the film; 0 where none does.
    """

    luminance_nits: float
    settings: ExposureSettings
    transmittance: float = 1.0

    @property
    def ev100(self) -> float:
        """Exposure value at ISO 100, ``log2(100 · L / K)``; minus infinity for black."""
        return _log2(100 * self.luminance_nits / METER_CONSTANT)

    @property
    def incident_lux(self) -> float:
        """Illuminance at which a matt grey of 18 % has this luminance."""
        return math.pi * self.luminance_nits / MIDDLE_GREY

    @property
    def stops(self) -> float:
        """Stops above middle grey; negative below it, minus infinity where the picture is black."""
        return _log2(self.luminance_nits * self.settings.scale * self.transmittance / MIDDLE_GREY)

    @property
    def compensation_stops(self) -> float:
        """Compensation that would make the metered luminance middle grey; NaN where the picture is black."""
        return self.settings.compensation_stops - self.stops if math.isfinite(self.stops) else math.nan


def meter(
    radiance: FloatArray,
    settings: ExposureSettings,
    mode: MeterMode,
    *,
    spot_px: tuple[float, float] | None = None,
    spot_radius_px: float = 0.0,
    luminance_of_rgb: tuple[float, float, float] = LUMINANCE_OF_ACESCG,
) -> Reading:
    """Meter a picture.

    Args:
        radiance: ``(height, width, 3 or more)`` scene-linear, not exposed. NaN counts as black.
        settings: of the exposure.
        mode: metering mode; see `meter_weights`.
        spot_px: as `meter_weights`.
        spot_radius_px: radius of the spot in pixels.
        luminance_of_rgb: of the working space's primaries; they sum to 1.

    Raises:
        SettingsError: the mode is not known, or the spot is missing or outside.
    """
    if radiance.ndim != 3 or radiance.shape[2] < 3:
        raise SettingsError(f"radiance must be (height, width, 3) or (height, width, 4), got {radiance.shape}")
    height, width = radiance.shape[:2]
    weights = meter_weights(mode, width, height, spot_px=spot_px, spot_radius_px=spot_radius_px)
    rows, columns = (slice(at.min(), at.max() + 1) for at in np.nonzero(weights))
    with np.errstate(invalid="ignore", over="ignore"):
        luminance = radiance[rows, columns, :3] @ np.asarray(luminance_of_rgb, np.float32)
    luminance = np.clip(np.nan_to_num(luminance, copy=False, posinf=_BRIGHTEST), 0, _BRIGHTEST)
    return Reading(float((luminance * weights[rows, columns]).sum()), settings)


def meter_weights(
    mode: MeterMode,
    width: int,
    height: int,
    *,
    spot_px: tuple[float, float] | None = None,
    spot_radius_px: float = 0.0,
) -> DoubleArray:
    """Weights of the pixels in a metering mode.

    - ``spot``: a disc, such as around a focus point; no smaller than a pixel.
    - ``center``: a bell in the middle of the picture, three quarters of it within a circle of a third of the picture's width, as
      centre-weighted cameras have it.
    - ``average``: all of the picture alike.

    Args:
        mode: metering mode.
        width: picture width in pixels.
        height: picture height in pixels.
        spot_px: middle of the spot, right and down from the top left corner.
        spot_radius_px: see `spot_radius_px`.

    Returns:
        ``(height, width)``, summing to 1.

    Raises:
        SettingsError: the mode is not known, or the spot is missing or outside.
    """
    if mode not in get_args(MeterMode):
        raise SettingsError(f"metering must be one of {', '.join(get_args(MeterMode))}, got {mode}", code="bad_meter")
    x, y = np.arange(width) + 0.5, (np.arange(height) + 0.5)[:, None]
    if mode == "average":
        weights = np.ones((height, width))
    elif mode == "center":
        sigma = _CENTRE_SIGMA_WIDTHS * width
        weights = np.exp(-((x - width / 2) ** 2 + (y - height / 2) ** 2) / (2 * sigma**2))
    else:
        if spot_px is None or not (0 <= spot_px[0] <= width and 0 <= spot_px[1] <= height):
            where = "nowhere" if spot_px is None else f"{spot_px[0]:g}, {spot_px[1]:g}"
            raise SettingsError(
                f"the spot to meter must be in the picture of {width} x {height} pixels, and is at {where}",
                code="bad_meter",
            )
        # A pixel counts by how much of it the disc covers, nearly: a spot that moves does so without jumps.
        weights = np.clip(max(spot_radius_px, 0.5) + 0.5 - np.hypot(x - spot_px[0], y - spot_px[1]), 0, 1)
    return np.asarray(weights / weights.sum())


def spot_radius_px(f_px: float, angle_rad: float = SPOT_ANGLE_RAD) -> float:
    """Radius of a spot meter's field in the middle of the picture.

    Args:
        f_px: focal length in pixels.
        angle_rad: full angle of its field.
    """
    return f_px * math.tan(angle_rad / 2)


def one_key(compensations: ArrayLike) -> float:
    """One compensation for a shot: the mean over its frames.

    Args:
        compensations: ``(n,)`` stops; NaN for frames that are black, which want nothing.

    Raises:
        InputError: all frames are black.
    """
    targets = _lit(compensations)
    return float(targets[np.isfinite(targets)].mean())


def smoothed_keys(
    times_s: ArrayLike, compensations: ArrayLike, smoothing_s: float, *, at_s: ArrayLike | None = None
) -> DoubleArray:
    """Smoothed compensation for each frame, without flicker.

    The mean weighted by a bell (Gauss) around each frame, whose standard deviation σ is a quarter of the smoothing time: looking
    ahead as far as back, so that nothing comes late. A sudden change is taken in ``smoothing_s`` but for 5 %. A flicker of
    period T is damped to ``exp(-2 · (π·σ/T)²)`` of it, and nothing changes faster than ``range / (σ·√(2π))``.

    Args:
        times_s: ``(n,)`` rising.
        compensations: ``(n,)`` stops; NaN for frames that are black, which are bridged.
        smoothing_s: duration of the transition at a sudden change; above 0.
        at_s: ``(k,)`` times of the result; by default those of the frames.

    Returns:
        ``(n,)`` or ``(k,)`` stops, between the least and the greatest of those given.

    Raises:
        SettingsError: times do not rise, there are not as many, or the smoothing time is not positive.
        InputError: all frames are black.
    """
    times, targets = np.asarray(times_s, np.float64), _lit(compensations)
    if times.shape != targets.shape or not (np.isfinite(times).all() and (np.diff(times) > 0).all()):
        raise SettingsError(
            f"metered frames must be at rising times, one for each, got {times.shape} for {targets.shape}"
        )
    if not (smoothing_s > 0 and math.isfinite(smoothing_s)):
        raise SettingsError(f"the smoothing time of metering must be above 0 s, got {smoothing_s:g}")
    lit = np.isfinite(targets)
    values = np.interp(times, times[lit], targets[lit])
    spans = np.gradient(times) if len(times) > 1 else np.ones(1)  # frames far apart stand for more time
    query_times = times if at_s is None else np.atleast_1d(np.asarray(at_s, np.float64))
    keys = np.empty_like(query_times)
    for start in range(0, len(query_times), _ROWS_AT_ONCE):
        rows = slice(start, start + _ROWS_AT_ONCE)
        bell = spans * np.exp(-0.5 * ((times - query_times[rows, None]) * (4 / smoothing_s)) ** 2)
        keys[rows] = bell @ values / bell.sum(axis=1)
    return keys


def _lit(compensations: ArrayLike) -> DoubleArray:
    targets = np.atleast_1d(np.asarray(compensations, np.float64))
    if targets.ndim != 1 or not np.isfinite(targets).any():
        raise InputError(
            "there is nothing to meter: every frame is black where the meter looks", code="nothing_to_meter"
        )
    return targets


def _log2(value: float) -> float:
    return math.log2(value) if value > 0 else -math.inf
