"""The focus curve as JSON, and the result of an import."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field
from pydantic.config import JsonDict

from service.models.base import Distance, Model, shown_as
from service.models.cameras import CAMERA_EXAMPLE, CameraState

CurveFileFormat = Literal["json", "csv", "usda", "otio", "opentrackio"]

MAX_CURVE_FRAMES = 20_000
"""Frames of one focus curve, unless the service is set up otherwise."""

CURVE_EXAMPLE: JsonDict = {
    "format": "pullfocus.focusCurve",
    "version": 2,
    "camera": "/World/main_cam",
    "lens": "Planar 50 mm f/1.4",
    "gateMm": [24.89, 14.0],
    "framesPerSecond": 24.0,
    "timeCodesPerSecond": 24.0,
    "samples": [
        {
            "frame": 24.0,
            "timeCode": 24.0,
            "seconds": 1.0,
            "focusDistanceM": 3.42,
            "fStop": 2.0,
            "focalLengthMm": 50.0,
            "nearM": 3.28,
            "farM": 3.58,
            "hyperfocalM": 65.7,
            "cocLimitMm": 0.019,
            "tiltDeg": 0.0,
            "swingDeg": 0.0,
            "limited": False,
            "source": "points",
            "reason": "focused by driver",
            "sharp": ["pip"],
            "points": [{"name": "pip", "state": "used", "depthM": 3.42, "weight": 1.0, "share": 1.0, "cocMm": 0.0}],
        }
    ],
}

IMPORTED_EXAMPLE: JsonDict = {
    "camera": CAMERA_EXAMPLE,
    "firstTime": 1.0,
    "lastTime": 96.0,
    "frames": 96,
    "drives": ["focusDistance", "fStop"],
    "findings": [
        {"code": "gap", "place": "frames 40 to 41", "message": "the CSV has no row for frames 40 to 41; interpolated"}
    ],
}


class CurvePoint(Model):
    """A focus point in one sample of a focus curve."""

    name: str
    state: str = Field(description="`used`, or why it did not count.")
    depth_m: Distance
    weight: float
    share: float = Field(description="Of the weight that decided the focus, 0 to 1.")
    coc_mm: Distance = Field(description="Diameter of its circle of confusion on the film.")


class CurveSample(Model):
    """The lens at one frame."""

    frame: float
    time_code: float
    seconds: float
    focus_distance_m: Distance = Field(description="null is infinity.")
    f_stop: float
    focal_length_mm: float
    near_m: float
    far_m: Distance = Field(description="null is infinity.")
    hyperfocal_m: Distance
    coc_limit_mm: float
    tilt_deg: float = Field(description="Turn of the lens about the axis to the right; positive looks up.")
    swing_deg: float = Field(description="Turn of the lens about the axis up, before the tilt; positive looks left.")
    limited: bool = Field(
        description="Whether the lens could not follow: its close focus, infinity, speed or largest angle."
    )
    source: Literal["points", "camera"]
    reason: str
    sharp: list[str] = Field(description="Names of the focus points that are sharp.")
    points: list[CurvePoint]


class FocusCurve(Model):
    """The lens, frame by frame; the command line writes the same."""

    model_config = shown_as(CURVE_EXAMPLE)

    format: Literal["pullfocus.focusCurve"]
    version: int
    camera: str
    lens: str = Field(description="Engraving of the lens; empty where it has no name.")
    gate_mm: tuple[float, float] | None = Field(description="Width and height of the film gate.")
    frames_per_second: float
    time_codes_per_second: float
    samples: list[CurveSample]


class Timeline(BaseModel):
    """The focus curve as OpenTimelineIO: a clip with markers where something is sharp, and with the curve as metadata."""

    model_config = ConfigDict(extra="allow")

    name: str
    tracks: dict[str, Any]


class TrackingProtocol(Model):
    """Protocol of a tracking sample."""

    name: Literal["OpenTrackIO"]
    version: list[int]


class TrackingSample(BaseModel):
    """The lens at one frame, as a sample of OpenTrackIO."""

    model_config = ConfigDict(extra="allow")

    protocol: TrackingProtocol
    lens: dict[str, Any]
    timing: dict[str, Any]


CurveFile = FocusCurve | Timeline | list[TrackingSample]
"""Focus curve in the formats of JSON: `json`, `otio` and `opentrackio`."""


class CurveFinding(Model):
    """A finding about an imported file."""

    code: str = Field(description="`bad_row`, `gap`, `odd_units`, `not_used`, `other_rate` or `other_clock`.")
    place: str = Field(description="Which row, sample or frames; empty for the file.")
    message: str = Field(description="One sentence, with the remedy.")


class ImportedCurve(Model):
    """Result of the import of a focus curve."""

    model_config = shown_as(IMPORTED_EXAMPLE)

    camera: CameraState = Field(description="The camera at the curve's first frame.")
    first_time: float = Field(description="USD time code of the curve's first frame.")
    last_time: float
    frames: int
    drives: list[Literal["focusDistance", "fStop", "focalLength", "tilt", "swing"]] = Field(
        description="Attributes of the camera that the file has."
    )
    findings: list[CurveFinding] = Field(description="Findings about the file, with their remedies.")
