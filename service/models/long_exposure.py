"""Long exposures: their request and their progress."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator
from pydantic.config import JsonDict

from render.model.frame_settings import MAX_MOTION, MOST_NOISE, FrameSettings
from render.model.shutter_intervals import MAX_ND_STOPS
from service.models.base import Model, PrimPath, TimeCode, shown_as
from service.models.engines import EngineName

BEGIN_EXAMPLE: JsonDict = {"first": 40.0, "last": 88.0, "step": 2.0, "width": 480, "rays": 16}
STATE_EXAMPLE: JsonDict = {
    "shutter": "open",
    "camera": "/World/main_cam",
    "first": 40.0,
    "last": 88.0,
    "time": 52.0,
    "intervals": 6,
    "intervalCount": 24,
    "openFrames": 12.0,
    "openSeconds": 0.5,
    "ndStops": 4.585,
    "problem": None,
}


class LongExposureBegin(Model):
    """Interval and quality of a long exposure."""

    model_config = shown_as(BEGIN_EXAMPLE)

    camera: PrimPath | None = Field(default=None, description="Prim path; the shot's default camera when left out.")
    first: TimeCode = Field(description="USD time code at which the shutter opens.")
    last: TimeCode = Field(description="USD time code at which the shutter closes, unless it is closed earlier.")
    step: float = Field(default=1.0, gt=0, le=1e6, description="Length of one interval, frames.")
    nd_stops: float | None = Field(
        default=None,
        ge=0,
        le=MAX_ND_STOPS,
        description="Density of a neutral density filter; when left out, one that keeps the exposure of a single frame.",
    )
    width: int = Field(default=480, ge=1, le=8192, description="px")
    height: int | None = Field(
        default=None, ge=1, le=8192, description="px; from the camera's film gate when left out."
    )
    engine: EngineName = Field(default=FrameSettings.engine, description="As for a frame.")
    rays: int = Field(default=16, ge=1, description="Lens rays per pixel and interval.")
    adaptive: bool = Field(default=FrameSettings.adaptive, description="Adaptive rays, as for a frame.")
    noise: float = Field(default=FrameSettings.noise, ge=0, le=MOST_NOISE, description="Wanted error, as for a frame.")
    connections: bool = Field(default=FrameSettings.connections, description="Carried highlights, as for a frame.")
    layers: int = Field(default=4, ge=1, description="Layers peeled at most.")
    supersample: float = Field(
        default=FrameSettings.supersample,
        ge=0,
        description="Layer pixels for each picture pixel along each axis; 0 for as many as suit the engine and its rays.",
    )
    wavelengths: int = Field(default=3, ge=1, le=64, description="Wavelengths, as for a frame.")
    motion: int = Field(
        default=1,
        ge=1,
        le=MAX_MOTION,
        description="Moments of each interval; 1 takes as many as trails without gaps need.",
    )
    motion_by: Literal["moments", "velocities"] = Field(
        default="moments",
        description="`moments` peels the scene at each moment, which is exact; `velocities` once an interval, which is quick.",
    )
    shading: Literal["lit", "unlit"] = Field(default="lit", description="`unlit`: base colour as radiance.")
    seed: int = Field(default=0, ge=0, description="Seed of the sampling pattern.")
    film: str | None = Field(
        default=None, max_length=80, description="Stock of the film library; the shot's own when left out."
    )

    @model_validator(mode="after")
    def _some_time(self) -> Self:
        if not self.last > self.first:
            raise ValueError(
                f"a shutter cannot close before it opens: it opens at {self.first:g} and closes at {self.last:g}"
            )
        return self


class LongExposureEdit(Model):
    """Opens or closes the shutter."""

    model_config = shown_as({"shutter": "closed"})

    shutter: Literal["open", "closed"] = Field(
        description="`closed` ends the exposure after the current interval; `open` continues where it was closed."
    )


class LongExposureState(Model):
    """Progress of a long exposure."""

    model_config = shown_as(STATE_EXAMPLE)

    shutter: Literal["open", "closed", "done", "failed"] = Field(
        description="`done` when the last frame is reached; `failed` says why in `problem`."
    )
    camera: PrimPath | None = Field(description="Prim path; null for the shot's default camera.")
    first: float = Field(description="USD time code at which the shutter opened.")
    last: float = Field(description="USD time code at which it closes by itself.")
    time: float = Field(description="USD time code up to which the picture is exposed.")
    intervals: int = Field(description="Number of exposed intervals.")
    interval_count: int = Field(description="Number of intervals up to the last frame.")
    open_frames: float = Field(description="Time for which the shutter was open, frames.")
    open_seconds: float = Field(description="Time for which the shutter was open, seconds.")
    nd_stops: float = Field(description="Density of the neutral density filter.")
    problem: str | None = Field(default=None, description="Reason of the failure, one sentence.")
