"""How a camera exposes: stop, shutter, sensitivity, filters and meter, and the keys of all that."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import KEYS_AT, Bounded, Model, NotNegative, Positive, Ratio, TimeCode, shown_as
from service.models.focus import KEY_EXAMPLE, Key

EXPOSURE_EXAMPLE: JsonDict = {
    "camera": "/World/Camera",
    "time": 24.0,
    "exposureTimeS": 0.02083,
    "iso": 800.0,
    "exposureFStop": 2.0,
    "exposureStop": "iris",
    "stopMarking": "t",
    "compensationStops": 0.0,
    "responsivity": 1.0,
    "transmittance": 0.9,
    "neutralDensity": 0.6,
    "naturalVignetting": False,
    "flareGhosts": 0.0,
    "flareStar": 1.0,
    "breathing": False,
    "shutterOpen": 0.0,
    "shutterClose": 0.5,
    "shutterAngleDeg": 180.0,
    "shutterType": "global",
    "shutterDirection": "down",
    "shutterTravelS": 0.0,
    "shutterEfficiency": [],
    "meteringMode": "manual",
    "meteringFocusPoint": "",
    "meteringSpot": [0.5, 0.5],
    "meteringCompensationStops": 0.0,
    "meteringSmoothingS": 1.0,
    "keys": {"compensationStops": [KEY_EXAMPLE]},
    "etag": '"92c4bf18a0860070"',
}

ShutterType = Literal["global", "rolling", "focalPlane", "leaf"]
ShutterDirection = Literal["down", "up", "left", "right"]
MeteringMode = Literal["manual", "spot", "center", "average"]
ExposureKeyed = Literal[
    "exposureTimeS",
    "iso",
    "exposureFStop",
    "compensationStops",
    "responsivity",
    "transmittance",
    "neutralDensity",
    "flareGhosts",
    "flareStar",
    "shutterOpen",
    "shutterClose",
    "shutterTravelS",
    "meteringCompensationStops",
]

Stops = Annotated[float, Field(ge=-100, le=100)]

_EXPOSURE: dict[str, str] = {
    "exposure_time_s": "USD's `exposure:time`: what brightness goes by. What moves is blurred by the shutter's own times.",
    "iso": "USD's `exposure:iso`.",
    "exposure_f_stop": "USD's `exposure:fStop`: a number of its own, beside the iris's `fStop`.",
    "exposure_stop": "Which stop exposes: `exposure` is `exposureFStop`; `iris` is the camera's `fStop`, so that stopping down "
    "darkens the picture as it deepens the focus.",
    "stop_marking": "What the stops on the barrel are: f-numbers, or T-stops, which have what the glass takes in them already.",
    "compensation_stops": "USD's `exposure`. Where a meter decides, it does not count.",
    "responsivity": "USD's `exposure:responsivity`.",
    "transmittance": "Share of the light that comes through the glass.",
    "neutral_density": "Of the filter in front; 0.3 takes about one stop.",
    "natural_vignetting": "Whether a lens without surfaces darkens the corners by cos⁴; those with surfaces do.",
    "breathing": "Whether the picture grows with focus as a real lens's does, and the bellows factor darkens it.",
    "flare_ghosts": "Strength of what a lens's surfaces reflect of what is bright: 0 off, 1 as they have it. It takes seconds.",
    "flare_star": "Strength of the star that diffraction at the iris draws: 0 off, 1 as it is.",
    "shutter_open": "USD's `shutter:open`, time codes from the frame's own.",
    "shutter_close": "USD's `shutter:close`.",
    "shutter_angle_deg": "Opening of a rotating shutter that is open for as long; 360 is a whole frame.",
    "shutter_type": "`global` and `leaf` expose all of the picture at once, `rolling` and `focalPlane` line after line.",
    "shutter_direction": "In which the lines are bared, in the picture as it is seen.",
    "shutter_travel_s": "From the first line's opening to the last one's.",
    "shutter_efficiency": "How much light passes over the time that a place is exposed, at even steps; empty for all of it.",
    "metering_mode": "What decides the compensation: the hand, or a meter on a spot, on the middle most, or on all alike.",
    "metering_focus_point": "Which focus point the spot is on; empty takes `meteringSpot`.",
    "metering_spot": "A place in the picture: (0, 0) is its top left corner and (1, 1) the bottom right one.",
    "metering_compensation_stops": "How much brighter than middle grey the metered light shall be.",
    "metering_smoothing_s": "How long metering takes to follow a sudden change.",
}


class ExposureSettings(Model):
    """How a camera exposes at one time."""

    model_config = shown_as(EXPOSURE_EXAMPLE)

    camera: str = Field(description="Prim path.")
    time: float = Field(description="USD time code.")
    exposure_time_s: float = Field(description=_EXPOSURE["exposure_time_s"])
    iso: float = Field(description=_EXPOSURE["iso"])
    exposure_f_stop: float = Field(description=_EXPOSURE["exposure_f_stop"])
    exposure_stop: Literal["exposure", "iris"] = Field(description=_EXPOSURE["exposure_stop"])
    stop_marking: Literal["f", "t"] = Field(description=_EXPOSURE["stop_marking"])
    compensation_stops: float = Field(description=_EXPOSURE["compensation_stops"])
    responsivity: float = Field(description=_EXPOSURE["responsivity"])
    transmittance: float = Field(description=_EXPOSURE["transmittance"])
    neutral_density: float = Field(description=_EXPOSURE["neutral_density"])
    natural_vignetting: bool = Field(description=_EXPOSURE["natural_vignetting"])
    breathing: bool = Field(description=_EXPOSURE["breathing"])
    flare_ghosts: float = Field(description=_EXPOSURE["flare_ghosts"])
    flare_star: float = Field(description=_EXPOSURE["flare_star"])
    shutter_open: float = Field(description=_EXPOSURE["shutter_open"])
    shutter_close: float = Field(description=_EXPOSURE["shutter_close"])
    shutter_angle_deg: float = Field(description=_EXPOSURE["shutter_angle_deg"])
    shutter_type: ShutterType = Field(description=_EXPOSURE["shutter_type"])
    shutter_direction: ShutterDirection = Field(description=_EXPOSURE["shutter_direction"])
    shutter_travel_s: float = Field(description=_EXPOSURE["shutter_travel_s"])
    shutter_efficiency: list[float] = Field(description=_EXPOSURE["shutter_efficiency"])
    metering_mode: MeteringMode = Field(description=_EXPOSURE["metering_mode"])
    metering_focus_point: str = Field(description=_EXPOSURE["metering_focus_point"])
    metering_spot: tuple[float, float] = Field(description=_EXPOSURE["metering_spot"])
    metering_compensation_stops: float = Field(description=_EXPOSURE["metering_compensation_stops"])
    metering_smoothing_s: float = Field(description=_EXPOSURE["metering_smoothing_s"])
    keys: dict[ExposureKeyed, list[Key]] = Field(description="Keys in order of time, of each setting that has any.")
    etag: str = Field(description="The camera's `ETag`: for `If-Match`.")


class ExposureSettingsEdit(Model):
    """What to change of how a camera exposes; what is left out stays as it is."""

    model_config = shown_as({"iso": 800, "shutterAngleDeg": 172.8, "exposureTimeS": 0.02, "exposureStop": "iris"})

    exposure_time_s: Positive | None = Field(default=None, description=_EXPOSURE["exposure_time_s"])
    iso: Positive | None = Field(default=None, description=_EXPOSURE["iso"])
    exposure_f_stop: Positive | None = Field(default=None, description=_EXPOSURE["exposure_f_stop"])
    exposure_stop: Literal["exposure", "iris"] | None = Field(default=None, description=_EXPOSURE["exposure_stop"])
    stop_marking: Literal["f", "t"] | None = Field(default=None, description=_EXPOSURE["stop_marking"])
    compensation_stops: Stops | None = Field(default=None, description=_EXPOSURE["compensation_stops"])
    responsivity: Positive | None = Field(default=None, description=_EXPOSURE["responsivity"])
    transmittance: Ratio | None = Field(default=None, description=_EXPOSURE["transmittance"])
    neutral_density: Annotated[float, Field(ge=0, le=20)] | None = Field(
        default=None, description=_EXPOSURE["neutral_density"]
    )
    natural_vignetting: bool | None = Field(default=None, description=_EXPOSURE["natural_vignetting"])
    breathing: bool | None = Field(default=None, description=_EXPOSURE["breathing"])
    flare_ghosts: NotNegative | None = Field(default=None, description=_EXPOSURE["flare_ghosts"])
    flare_star: NotNegative | None = Field(default=None, description=_EXPOSURE["flare_star"])
    shutter_open: Bounded | None = Field(default=None, description=_EXPOSURE["shutter_open"])
    shutter_close: Bounded | None = Field(default=None, description=_EXPOSURE["shutter_close"])
    shutter_angle_deg: Annotated[float, Field(ge=0, le=360_000)] | None = Field(
        default=None,
        description=_EXPOSURE["shutter_angle_deg"]
        + " It sets when the shutter closes: send no `shutterClose` beside it.",
    )
    shutter_type: ShutterType | None = Field(default=None, description=_EXPOSURE["shutter_type"])
    shutter_direction: ShutterDirection | None = Field(default=None, description=_EXPOSURE["shutter_direction"])
    shutter_travel_s: Annotated[float, Field(ge=0, le=1e6)] | None = Field(
        default=None, description=_EXPOSURE["shutter_travel_s"]
    )
    shutter_efficiency: Annotated[tuple[NotNegative, ...], Field(max_length=256)] | None = Field(
        default=None, description=_EXPOSURE["shutter_efficiency"]
    )
    metering_mode: MeteringMode | None = Field(default=None, description=_EXPOSURE["metering_mode"])
    metering_focus_point: Annotated[str, Field(max_length=100)] | None = Field(
        default=None, description=_EXPOSURE["metering_focus_point"]
    )
    metering_spot: tuple[Ratio, Ratio] | None = Field(default=None, description=_EXPOSURE["metering_spot"])
    metering_compensation_stops: Annotated[float, Field(ge=-20, le=20)] | None = Field(
        default=None, description=_EXPOSURE["metering_compensation_stops"]
    )
    metering_smoothing_s: Annotated[float, Field(ge=0.04, le=60)] | None = Field(
        default=None, description=_EXPOSURE["metering_smoothing_s"]
    )
    time: TimeCode | None = Field(default=None, description=KEYS_AT)
