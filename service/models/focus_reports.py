"""Focus reports of renders: the lens and the sharpness of each focus point, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Distance, Model, shown_as

ReportFormat = Literal["json", "csv", "html"]

MAX_REPORT_ROWS = 200_000
"""Frames times focus points of one report."""


@dataclass(frozen=True)
class ReportedRender:
    """A render as its focus report needs it.

    Attributes:
        id: of the render.
        shot: id of its shot.
        revision: of its edits.
        camera: prim path; None for the shot's default camera.
        width: of the pictures, px.
        height: of the pictures, px; None for that of the film gate.
        frames: of the report, in rising order; at least one.
        range: the same as a range.
    """

    id: str
    shot: str
    revision: str
    camera: str | None
    width: int
    height: int | None
    frames: tuple[int, ...]
    range: str


POINT_EXAMPLE: JsonDict = {
    "name": "pip",
    "enabled": True,
    "weight": 1.0,
    "kind": "sharp",
    "state": "used",
    "depthM": 3.42,
    "focusDistanceM": 3.4,
    "signedCocMm": 0.0021,
    "signedCocPx": 0.04,
    "sharp": True,
    "visibleInFrame": True,
    "judged": True,
}
SOFTEST_EXAMPLE: JsonDict = {
    "frame": 31,
    "point": "pip",
    "signedCocMm": -0.0312,
    "signedCocPx": -0.6,
    "sharp": False,
}
REPORT_EXAMPLE: JsonDict = {
    "render": "r-5f0c1d2e3a4b",
    "shot": "demo",
    "revision": "5a302e56c1d04f7b",
    "camera": "/World/main_cam",
    "lensName": "Planar 50 mm f/1.4",
    "width": 480,
    "frames": "24-96",
    "count": 73,
    "summary": {
        "softest": SOFTEST_EXAMPLE,
        "softFrames": [30, 31, 32],
        "points": [
            {
                "name": "pip",
                "judgedCount": 73,
                "softFrames": [30, 31, 32],
                "softest": SOFTEST_EXAMPLE,
            }
        ],
    },
    "samples": [
        {
            "frame": 24,
            "focusDistanceM": 3.42,
            "fStop": 2.0,
            "tStop": 2.1,
            "focalLengthMm": 50.0,
            "nearM": 3.28,
            "farM": 3.58,
            "hyperfocalM": 65.7,
            "cocLimitMm": 0.019,
            "tiltDeg": 0.0,
            "swingDeg": 0.0,
            "focusMode": "points",
            "source": "points",
            "note": "",
            "points": [POINT_EXAMPLE],
        }
    ],
}

_SIGNED_MM: Distance = Field(
    description="Diameter of its circle of confusion on the film, negative in front of the focus; null behind the camera."
)
_SIGNED_PX: Distance = Field(description="The same in pixels of the render's pictures.")


class ReportPoint(Model):
    """A focus point in one frame of a render."""

    name: str
    enabled: bool = Field(description="Whether it is on.")
    weight: float
    kind: str = Field(description="Whether it is to be `sharp` or `soft`.")
    state: str = Field(description="`used` for the focus, or why it did not count.")
    depth_m: Distance = Field(description="Along the view axis, negative behind the camera; null without a place.")
    focus_distance_m: Distance = Field(
        description="Depth of the focal surface where it stands in the picture; null is infinity or, where `signedCocMm` is null "
        "too, no place there."
    )
    signed_coc_mm: Distance = _SIGNED_MM
    signed_coc_px: Distance = _SIGNED_PX
    sharp: bool = Field(description="Whether its circle of confusion is within `cocLimitMm` of the frame.")
    visible_in_frame: bool = Field(description="Whether it lies in the picture (something may still hide it).")
    judged: bool = Field(
        description="Whether it has to be sharp: it is on, with a weight above 0, of the kind `sharp`, and in the picture. It is "
        "soft where it has to be sharp and is not."
    )


class ReportSample(Model):
    """The lens and the focus points in one frame of a render."""

    frame: int
    focus_distance_m: Distance = Field(description="null is infinity.")
    f_stop: float = Field(description="f-number; 0 is a pinhole.")
    t_stop: Distance = Field(
        description="f-number with the light that the glass absorbs; null where nothing comes through."
    )
    focal_length_mm: float
    near_m: Distance = Field(description="Nearest depth that is sharp on the view axis; null is infinity.")
    far_m: Distance = Field(description="Farthest depth that is sharp on the view axis; null is infinity.")
    hyperfocal_m: Distance
    coc_limit_mm: float = Field(description="Largest circle of confusion, as a diameter on the film, that is sharp.")
    tilt_deg: float = Field(description="Tilt of the lens; positive is up.")
    swing_deg: float = Field(description="Swing of the lens, applied before the tilt; positive is left.")
    focus_mode: str = Field(description="Whether the camera is focused by hand or by its focus points.")
    source: str = Field(description="Whether focus points set the focus, or the camera's own focus distance was kept.")
    note: str = Field(description="Sentence about a setting that the lens cannot follow; or empty.")
    points: list[ReportPoint]


class SoftestPoint(Model):
    """The focus point with the largest circle of confusion of those that have to be sharp, and its frame."""

    frame: int
    point: str = Field(description="Name of the focus point.")
    signed_coc_mm: Distance = _SIGNED_MM
    signed_coc_px: Distance = _SIGNED_PX
    sharp: bool


class PointSummary(Model):
    """A focus point over the frames of a render."""

    name: str
    judged_count: int = Field(description="Number of frames in which it has to be sharp.")
    soft_frames: list[int] = Field(description="Frames in which it has to be sharp and is not.")
    softest: SoftestPoint | None = Field(description="Its softest frame; null where it never has to be sharp.")


class ReportSummary(Model):
    """Summary of a focus report."""

    softest: SoftestPoint | None = Field(description="null where no point ever has to be sharp.")
    soft_frames: list[int] = Field(description="Frames in which a point has to be sharp and is not.")
    points: list[PointSummary]


class FocusReport(Model):
    """Focus report of a render."""

    model_config = shown_as(REPORT_EXAMPLE)

    render: str = Field(description="Id of the render.")
    shot: str = Field(description="Id of the shot.")
    revision: str = Field(description="Revision of the edits that are rendered.")
    camera: str | None = Field(description="Prim path; null for the camera that frames a shot which has none.")
    lens_name: str = Field(description="Engraving of the lens; may be empty.")
    width: int = Field(description="Width of the pictures, px.")
    frames: str = Field(description="All frames of the report, as a range.")
    count: int = Field(description="Number of frames.")
    summary: ReportSummary
    samples: list[ReportSample] = Field(description="The frames in rising order.")
