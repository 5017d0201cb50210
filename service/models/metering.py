"""What an exposure is worth, and what a light meter says."""

from __future__ import annotations

from typing import Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Distance, Model, shown_as

EQUIVALENT_EXAMPLE: JsonDict = {"fStop": 2.8, "exposureTimeS": 0.02083, "shutterAngleDeg": 180.0}
READOUT_EXAMPLE: JsonDict = {
    "camera": "/World/Camera",
    "time": 24.0,
    "fStop": 2.0,
    "stop": "iris",
    "isTStop": False,
    "tStop": 2.1,
    "effectiveTStop": 2.14,
    "bellowsFactor": 1.04,
    "exposureTimeS": 0.02083,
    "iso": 800.0,
    "compensationStops": 0.0,
    "ndStops": 2.0,
    "shutterAngleDeg": 180.0,
    "shutterTimeS": 0.02083,
    "ev100": 4.6,
    "exposureScale": 0.0417,
    "greyNits": 17.3,
    "greyLux": 2.7,
    "equivalents": [EQUIVALENT_EXAMPLE],
}
METER_EXAMPLE: JsonDict = {
    "camera": "/World/Camera",
    "time": 24.0,
    "mode": "spot",
    "place": [0.43, 0.55],
    "luminanceNits": 34.6,
    "ev100": 8.1,
    "incidentLux": 604.0,
    "filmLux": 5.4,
    "stops": 1.0,
    "compensationStops": -1.0,
    "decides": False,
}

MeterMode = Literal["spot", "center", "average"]


class EquivalentExposure(Model):
    """Stop and time that make the picture as bright."""

    model_config = shown_as(EQUIVALENT_EXAMPLE)

    f_stop: float
    exposure_time_s: float
    shutter_angle_deg: float = Field(description="Of a rotating shutter that is open for as long.")


class ExposureReadout(Model):
    """What a camera's exposure is worth at one time, without a look at the picture."""

    model_config = shown_as(READOUT_EXAMPLE)

    camera: str
    time: float
    f_stop: float = Field(description="The stop that is exposed by.")
    stop: Literal["exposure", "iris"] = Field(description="Whether that is `exposureFStop`, or the iris's `fStop`.")
    is_t_stop: bool
    t_stop: Distance = Field(
        description="It as a T-stop, with what the glass takes; null where no light comes through."
    )
    effective_t_stop: Distance = Field(description="That with the bellows factor: what the lens is worth as focused.")
    bellows_factor: float = Field(description="By how much longer the exposure has to be than at infinity.")
    exposure_time_s: float
    iso: float
    compensation_stops: float
    nd_stops: float = Field(description="What filters take.")
    shutter_angle_deg: float = Field(description="Of the shutter that motion is seen through; 0 for a moment.")
    shutter_time_s: float = Field(description="How long that one is open.")
    ev100: float = Field(description="Exposure value at ISO 100 of stop, time and ISO.")
    exposure_scale: float = Field(description="What the light that came through the lens is multiplied by.")
    grey_nits: Distance = Field(description="Luminance that comes out as middle grey; null where no light passes.")
    grey_lux: Distance = Field(description="Illuminance of the film by that.")
    equivalents: list[EquivalentExposure] = Field(description="Whole stops away, widest first.")


class MeterReading(Model):
    """What a light meter on a camera says at one time."""

    model_config = shown_as(METER_EXAMPLE)

    camera: str
    time: float
    mode: MeterMode
    place: tuple[float, float] | None = Field(
        description="Of the spot in the picture, from its top left corner; null for the other modes, and outside."
    )
    luminance_nits: float = Field(description="Mean of what it looks at; 0 for black.")
    ev100: Distance = Field(description="Exposure value at ISO 100 of that light; null for black.")
    incident_lux: float = Field(description="The light in which a matt grey of 18 % is as bright.")
    film_lux: float = Field(description="Illuminance of the film by it.")
    stops: Distance = Field(
        description="By how much it comes out over (or, negative, under) middle grey as the exposure is set; null for black."
    )
    compensation_stops: Distance = Field(
        description="In place of the camera's: what makes it middle grey, and as much brighter as is asked for, smoothed over "
        "time where the meter decides; null for black."
    )
    decides: bool = Field(description="Whether the camera is exposed by its meter, so that `stops` is made up for.")
