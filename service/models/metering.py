"""Exposure readouts and light meter readings."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator
from pydantic.config import JsonDict

from service.models.base import Distance, Model, Pair, PointName, PrimPath, TimeCode, shown_as

EQUIVALENT_EXAMPLE: JsonDict = {"fStop": 2.8, "exposureTimeS": 0.02083, "shutterAngleDeg": 180.0}
READOUT_EXAMPLE: JsonDict = {
    "camera": "/World/main_cam",
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
    "camera": "/World/main_cam",
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


class MeterQuery(Model):
    """Area that a light meter measures."""

    is_text = True

    camera: PrimPath | None = Field(
        default=None, description="Prim path; the shot's default camera when left out.", examples=["/World/main_cam"]
    )
    time: TimeCode = Field(description="USD time code.", examples=[24])
    mode: MeterMode | None = Field(
        default=None,
        description="Left out: the mode of the camera's meter, or `center` where it has none.",
        examples=["center"],
    )
    point: PointName | None = Field(default=None, description="Meters a spot on a focus point.", examples=["pip"])
    x: float | None = Field(
        default=None,
        ge=0,
        le=1,
        description="With `y`, meters a spot: from the picture's left edge (0).",
        examples=[0.43],
    )
    y: float | None = Field(default=None, ge=0, le=1, description="From the picture's top edge (0).", examples=[0.55])
    client: str | None = Field(
        default=None,
        max_length=64,
        description="Name of a client, whose newer request to meter the same shot replaces those that still wait.",
        examples=["viewer-1"],
    )

    @model_validator(mode="after")
    def _one_spot(self) -> Self:
        if (self.x is None) != (self.y is None) or (self.point is not None and self.x is not None):
            raise ValueError("a spot is a focus point's name, or x and y")
        if self.mode not in (None, "spot") and (self.point is not None or self.x is not None):
            raise ValueError(f"a spot is metered, and not by the mode {self.mode}")
        return self


class EquivalentExposure(Model):
    """Stop and time with the same exposure."""

    model_config = shown_as(EQUIVALENT_EXAMPLE)

    f_stop: float
    exposure_time_s: float
    shutter_angle_deg: float = Field(description="Angle of a rotating shutter that is open for this time.")


class ExposureReadout(Model):
    """Exposure of a camera at one time, computed from its settings alone."""

    model_config = shown_as(READOUT_EXAMPLE)

    camera: str
    time: float
    f_stop: float = Field(description="Stop that sets the exposure.")
    stop: Literal["exposure", "iris"] = Field(description="Whether the stop is `exposureFStop` or the iris's `fStop`.")
    is_t_stop: bool
    t_stop: Distance = Field(description="The stop with the transmittance of the glass; null where no light passes.")
    effective_t_stop: Distance = Field(description="The T-stop with the bellows factor, as the lens is focused.")
    bellows_factor: float = Field(description="Exposure time needed as the lens is focused, over that at infinity.")
    exposure_time_s: float
    iso: float
    compensation_stops: float
    nd_stops: float = Field(description="Density of the filters.")
    shutter_angle_deg: float = Field(description="Angle of the shutter that blurs motion; 0 is a single moment.")
    shutter_time_s: float = Field(description="Time for which that shutter is open.")
    ev100: float = Field(description="Exposure value of stop, time and ISO, at ISO 100.")
    exposure_scale: float = Field(description="Factor applied to the light that passed the lens.")
    grey_nits: Distance = Field(description="Luminance that is rendered as middle grey; null where no light passes.")
    grey_lux: Distance = Field(description="Illuminance of the film by that luminance.")
    equivalents: list[EquivalentExposure] = Field(description="Equivalents whole stops apart, widest first.")


class MeterReading(Model):
    """Reading of a light meter on a camera at one time."""

    model_config = shown_as(METER_EXAMPLE)

    camera: str
    time: float
    mode: MeterMode
    place: Pair | None = Field(
        description="Position of the spot, from the picture's top left corner; null for the other modes, and outside the picture."
    )
    luminance_nits: float = Field(description="Mean luminance of the metered area; 0 for black.")
    ev100: Distance = Field(description="Exposure value of that luminance at ISO 100; null for black.")
    incident_lux: float = Field(description="Illuminance at which a matt 18 % grey has that luminance.")
    film_lux: float = Field(description="Illuminance of the film by that luminance.")
    stops: Distance = Field(
        description="Stops over middle grey as the exposure is set; negative is under, null is black: where no light is, or "
        "comes through the lens."
    )
    compensation_stops: Distance = Field(
        description="Exposure compensation that renders the metered area as middle grey plus the meter's own compensation, "
        "smoothed over time where the meter decides; null where all is black."
    )
    decides: bool = Field(description="True where the camera is exposed by its meter, which makes up for `stops`.")
