"""What the stage process is asked about an exposure, and the picture process about the light: see `service.stage.shots`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from service.models.metering import EquivalentExposure, ExposureReadout, MeterMode, MeterReading
from service.picture.frames import Darkroom
from service.stage.opened import OpenedShots
from service.storage.store import ShotRecord

AT_ONCE_S = 0.04
"""Smoothing where nobody asks for any: the meter says what this frame wants."""


@dataclass(frozen=True)
class ReadExposure:
    """What a camera's exposure is worth at one time."""

    record: ShotRecord
    camera: str | None
    time: float

    def run(self, opened: OpenedShots) -> ExposureReadout:
        """Raises `CameraError`."""
        with opened.use(self.record) as shot:
            read = shot.exposure(self.camera, self.time)
            rate = shot.stage.GetFramesPerSecond()
            glass = 1.0 if read.is_t_stop else read.glass
            t_stop = read.settings.f_stop / math.sqrt(glass) if glass > 0 else math.inf
            return ExposureReadout(
                camera=read.camera,
                time=self.time,
                f_stop=read.settings.f_stop,
                stop=read.stop,
                is_t_stop=read.is_t_stop,
                t_stop=t_stop,
                effective_t_stop=t_stop * math.sqrt(read.bellows_factor),
                bellows_factor=read.bellows_factor,
                exposure_time_s=read.settings.time_s,
                iso=read.settings.iso,
                compensation_stops=read.settings.compensation_stops,
                nd_stops=read.nd_stops,
                shutter_angle_deg=math.degrees(read.shutter_angle_rad),
                shutter_time_s=read.shutter_time_s,
                ev100=read.ev100,
                exposure_scale=read.exposure_scale,
                grey_nits=read.grey_nits,
                grey_lux=float(read.lux_on_film(read.grey_nits)) if math.isfinite(read.grey_nits) else math.inf,
                equivalents=[
                    EquivalentExposure(
                        f_stop=same.f_stop, exposure_time_s=same.time_s, shutter_angle_deg=360 * same.time_s * rate
                    )
                    for same in read.equivalents()
                ],
            )


@dataclass(frozen=True)
class MeterLight:
    """Meter the light of a shot.

    Attributes:
        record: of which shot.
        edits: its edit layer at the moment of asking.
        camera: prim path, or None for the default camera.
        time: USD time code.
        mode: what the meter looks at; None takes what the camera says, or the middle most where it has no meter.
        spot: name of a focus point, or a place in the picture; None takes what the camera says.
    """

    record: ShotRecord
    edits: str
    camera: str | None
    time: float
    mode: MeterMode | None
    spot: str | tuple[float, float] | None

    def run(self, room: Darkroom) -> MeterReading:
        """What it says. Raises `CameraError` or `SettingsError`."""
        from render.shot.exposure.light_meter import LightMeter

        with room.opened.use(self.record, self.edits) as shot:
            own = LightMeter(room.renderer, shot, self.camera).asked(self.time)
            decides = own.mode != "manual"
            asked: dict[str, Any] = {} if decides else {"mode": "center", "smoothing": AT_ONCE_S}
            if self.mode is not None:
                asked["mode"] = self.mode
            if isinstance(self.spot, str):
                asked |= {"mode": "spot", "focus_point": self.spot}
            elif self.spot is not None:
                asked |= {"mode": "spot", "focus_point": "", "spot": self.spot}
            said = LightMeter(room.renderer, shot, self.camera, **asked).metered(self.time)
        return MeterReading.model_validate(
            {
                "camera": said.exposure.camera,
                "time": self.time,
                "mode": said.mode,
                "place": said.place,
                "luminance_nits": said.reading.luminance_nits,
                "ev100": said.reading.ev100,
                "incident_lux": said.reading.incident_lux,
                "film_lux": said.lux_on_film,
                "stops": said.reading.stops,
                "compensation_stops": said.compensation_stops,
                "decides": decides,
            }
        )
