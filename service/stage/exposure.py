"""Function of the stage process that computes what a camera's exposure is worth."""

from __future__ import annotations

import math

from render.shot import Shot
from service.models.metering import EquivalentExposure, ExposureReadout
from service.stage.opened import OpenedShot, stage_function
from service.storage.store import ShotRecord


@stage_function
def read_exposure(opened: OpenedShot, record: ShotRecord, camera: str | None, time: float) -> ExposureReadout:
    """Compute EV, T-stop, bellows factor and equivalents of a camera's exposure at one time. Raises `CameraError`."""
    with opened.use(record) as shot:
        return exposure_readout(shot, camera, time)


def exposure_readout(shot: Shot, camera: str | None, time: float) -> ExposureReadout:
    """Compute the readout of an exposure. Raises `CameraError`."""
    exposure = shot.exposure.read(camera, time)
    frames_per_second = shot.stage.GetFramesPerSecond()
    transmittance = 1.0 if exposure.is_t_stop else exposure.glass
    t_stop = exposure.settings.f_stop / math.sqrt(transmittance) if transmittance > 0 else math.inf
    grey_nits = exposure.grey_nits
    return ExposureReadout(
        camera=exposure.camera,
        time=time,
        f_stop=exposure.settings.f_stop,
        stop=exposure.stop,
        is_t_stop=exposure.is_t_stop,
        t_stop=t_stop,
        effective_t_stop=t_stop * math.sqrt(exposure.bellows_factor),
        bellows_factor=exposure.bellows_factor,
        exposure_time_s=exposure.settings.time_s,
        iso=exposure.settings.iso,
        compensation_stops=exposure.settings.compensation_stops,
        nd_stops=exposure.nd_stops,
        shutter_angle_deg=math.degrees(exposure.shutter_angle_rad),
        shutter_time_s=exposure.shutter_time_s,
        ev100=exposure.ev100,
        exposure_scale=exposure.exposure_scale,
        grey_nits=grey_nits,
        grey_lux=float(exposure.lux_on_film(grey_nits)) if math.isfinite(grey_nits) else math.inf,
        equivalents=[
            EquivalentExposure(
                f_stop=same.f_stop,
                exposure_time_s=same.time_s,
                shutter_angle_deg=360 * same.time_s * frames_per_second,
            )
            for same in exposure.equivalents()
        ],
    )
