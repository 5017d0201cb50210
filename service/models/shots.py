"""Shots, their frame range and cameras, and picks."""

from __future__ import annotations

from datetime import datetime

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Model, PrimPath, TimeCode, shown_as

SUMMARY_EXAMPLE: JsonDict = {
    "id": "demo",
    "name": "Night tram",
    "root": "shot.usda",
    "createdAt": "2026-11-21T08:00:00Z",
    "sizeBytes": 48_112_640,
    "fileCount": 14,
    "project": "default",
    "quarantine": None,
}
RANGE_EXAMPLE: JsonDict = {"start": 1.0, "end": 96.0, "framesPerSecond": 24.0}
SHOT_EXAMPLE: JsonDict = SUMMARY_EXAMPLE | {
    "revision": "e3b0c44298fc1c14",
    "frameRange": RANGE_EXAMPLE,
    "cameras": ["/World/main_cam"],
    "defaultCamera": {"path": "/World/main_cam", "reason": "the only camera"},
}


class ShotSummary(Model):
    """A stored shot."""

    model_config = shown_as(SUMMARY_EXAMPLE)

    id: str = Field(description="Name of the shot in URLs.")
    name: str = Field(description="Name of the uploaded file.")
    root: str = Field(description="The root layer, relative to the shot's folder.")
    created_at: datetime
    size_bytes: int = Field(description="Size of all files of the shot, unpacked.")
    file_count: int
    project: str = Field(description="Project of the shot: only its members see it.")
    quarantine: str | None = Field(
        default=None,
        description="Reason for which the shot is not opened any more; null where it is. See `releaseShot`.",
    )


class ShotList(Model):
    """The stored shots of the projects that the sender may see, newest last."""

    model_config = shown_as({"shots": [SUMMARY_EXAMPLE]})

    shots: list[ShotSummary]


class FrameRange(Model):
    """Frame range of a shot, in USD time codes; `start` and `end` are both in it."""

    start: float
    end: float
    frames_per_second: float


class CameraChoice(Model):
    """The camera used where a request names none."""

    path: str | None = Field(description="Prim path; null where the shot has no camera and one is made to frame it.")
    reason: str = Field(description="Reason for the choice.")


class Shot(ShotSummary):
    """A stored shot with its frame range and cameras."""

    model_config = shown_as(SHOT_EXAMPLE)

    revision: str = Field(description="Revision of the edits; changes with every edit.")
    frame_range: FrameRange
    cameras: list[str] = Field(description="Prim paths.")
    default_camera: CameraChoice


class PickRequest(Model):
    """A pixel of a picture."""

    model_config = shown_as(
        {"camera": "/World/main_cam", "time": 24, "width": 960, "height": 540, "x": 412.5, "y": 300.5}
    )

    camera: PrimPath | None = Field(default=None, description="Prim path; the shot's default camera when left out.")
    time: TimeCode = Field(description="USD time code.")
    width: int = Field(ge=1, le=8192, description="Width of the picture, px.")
    height: int = Field(ge=1, le=8192, description="Height of the picture, px.")
    x: float = Field(ge=0, description="From the picture's left edge, px; a pixel's centre is at .5.")
    y: float = Field(ge=0, description="From the picture's top edge, px; a pixel's centre is at .5.")
