"""The focus curve as JSON."""

from __future__ import annotations

from typing import Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Distance, Model, shown_as

CURVE_EXAMPLE: JsonDict = {
    "format": "pullfocus.focusCurve",
    "version": 1,
    "camera": "/World/Camera",
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
            "source": "points",
            "reason": "focused by driver",
            "sharp": ["driver"],
            "points": [{"name": "driver", "state": "used", "depthM": 3.42, "weight": 1.0, "share": 1.0, "cocMm": 0.0}],
        }
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
    frames_per_second: float
    time_codes_per_second: float
    samples: list[CurveSample]
