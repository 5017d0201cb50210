"""Metering settings of a camera, and what a light meter returns (`render.shot.light_meter` takes the readings)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import get_args

from pxr import Usd

from render.errors import CameraError, SettingsError
from render.optics.photometry.exposure import MAX_COMPENSATION_STOPS
from render.optics.photometry.metering import MeterMode, Reading
from render.shot.exposure.readout import ExposureReadout
from render.stage import quiet_diagnostics
from usd_schemas import LensCamera, Metering, SchemaError

Place = tuple[float, float]


@dataclass(frozen=True)
class Metered:
    """Reading of a light meter at a time, and the compensation that it sets.

    Attributes:
        time: USD time code.
        mode: metering mode.
        place: position of the spot in the picture: (0, 0) is the top left corner and (1, 1) the bottom right one; None where the
            spot lies outside, and for the other modes.
        reading: of that time alone, with the exposure as it is set.
        exposure: as it is set.
        compensation_stops: replaces the present compensation: exposes the metered light to middle grey, plus the metering
            compensation, smoothed over time. NaN where all is black, and where no light comes through the lens.
    """

    time: float
    mode: MeterMode
    place: Place | None
    reading: Reading
    exposure: ExposureReadout
    compensation_stops: float

    @property
    def lux_on_film(self) -> float:
        """Illuminance of the film from the metered luminance."""
        return float(self.exposure.lux_on_film(self.reading.luminance_nits))

    @property
    def exposed(self) -> ExposureReadout:
        """The exposure with the meter's compensation; as it is set where that is NaN."""
        if math.isnan(self.compensation_stops):
            return self.exposure
        settings = replace(self.exposure.settings, compensation_stops=self.compensation_stops)
        return replace(self.exposure, settings=settings)


def read_metering(stage: Usd.Stage, camera_path: str, time: float) -> Metering:
    """Read the metering settings of a camera.

    Args:
        stage: the shot.
        camera_path: of the camera.
        time: USD time code.

    Raises:
        CameraError: it is no camera, or a setting has no meaning.
    """
    prim = stage.GetPrimAtPath(camera_path)
    try:
        with quiet_diagnostics():
            metering = LensCamera(prim).film.read(time).metering
    except SchemaError as error:
        raise CameraError(str(error), path=camera_path) from error
    try:
        check_metering(metering)
    except SettingsError as error:  # the numbers are the shot's, not the caller's
        raise CameraError(f"camera {camera_path}: {error.detail}", code=error.code, path=camera_path) from error
    return metering


def check_metering(metering: Metering) -> None:
    """Check metering settings.

    Raises:
        SettingsError: a value has no meaning.
    """
    if metering.mode not in ("manual", *get_args(MeterMode)):
        raise SettingsError(
            f"metering must be one of manual, {', '.join(get_args(MeterMode))}, got {metering.mode}", code="bad_meter"
        )
    if not (metering.smoothing_s > 0 and math.isfinite(metering.smoothing_s)):
        raise SettingsError(
            f"the smoothing of metering must be above 0 s, got {metering.smoothing_s:g}", code="bad_meter"
        )
    if not abs(metering.compensation_stops) <= MAX_COMPENSATION_STOPS:
        limits = f"from -{MAX_COMPENSATION_STOPS} to {MAX_COMPENSATION_STOPS} stops"
        raise SettingsError(
            f"the compensation of metering must be {limits}, got {metering.compensation_stops:g}", code="bad_meter"
        )
    if not all(map(math.isfinite, metering.spot)):
        raise SettingsError(f"the spot to meter must be two finite numbers, got {metering.spot}", code="bad_meter")
