"""Render plans: renders that are tried and not sent."""

from __future__ import annotations

from typing import Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Model, shown_as
from service.models.engines import EngineName
from service.models.lenses import LensModel
from service.models.renders import FrameFormat
from service.models.shots import FrameRange

PICTURE_EXAMPLE: JsonDict = {
    "camera": "/World/main_cam",
    "width": 480,
    "height": 360,
    "lensName": "Planar 50 mm f/1.4",
    "lensModel": "prescription",
    "fStop": 2.0,
    "focalLengthMm": 50.0,
    "film": "vision3_500t_5219",
}
SETTINGS_EXAMPLE: JsonDict = PICTURE_EXAMPLE | {
    "engine": "lens",
    "rays": 16,
    "formats": ["exr", "png"],
    "aovs": ["depth", "coc"],
    "revision": "5a302e56c1d04f7b",
}
FINDING_EXAMPLE: JsonDict = {
    "severity": "warning",
    "code": "frames_outside_shot",
    "path": "frames",
    "message": "Frames 97-120 are outside the shot, which is 1 to 96: its first and last values hold there.",
}


class PlannedPicture(Model):
    """Picture of the first frame of a render, as the camera and the lens have it."""

    camera: str | None = Field(description="Prim path; null for the camera that frames a shot which has none.")
    width: int = Field(description="px")
    height: int = Field(description="px")
    lens_name: str = Field(description="Engraving of the lens; may be empty.")
    lens_model: LensModel
    f_stop: float = Field(description="f-number; 0 is a pinhole.")
    focal_length_mm: float
    film: str | None = Field(description="Stock that the picture is developed on; null for none of the library.")


class PlannedSettings(PlannedPicture):
    """Settings of a render, with what it leaves out filled in from the shot."""

    engine: EngineName
    rays: int = Field(description="Lens rays for each pixel.")
    formats: list[FrameFormat] = Field(description="Files of each frame.")
    aovs: list[str] = Field(description="AOVs in the EXR files.")
    revision: str = Field(description="Revision of the edits that would be rendered.")


class PlanFinding(Model):
    """A finding about a render that is tried."""

    severity: Literal["error", "warning"] = Field(
        description="`error`: it would be refused, or its frames would fail. `warning`: it is not drawn quite as asked for."
    )
    code: str = Field(description="Short stable word for programs.")
    path: str = Field(description="Field of the request, or prim or file of the shot; may be empty.")
    message: str = Field(description="One sentence.")


class RenderPlan(Model):
    """A render as it would be, where it is only tried."""

    model_config = shown_as(
        {
            "frames": "1-95:2",
            "count": 48,
            "secondsOfProcessor": 310.0,
            "settings": SETTINGS_EXAMPLE,
            "findings": [FINDING_EXAMPLE],
        }
    )

    frames: str = Field(description="All frames, as a range; empty where they are no range.")
    count: int = Field(description="Number of frames that would be drawn.")
    seconds_of_processor: float = Field(
        description="Processor time that is expected for all of them, s; 0 where they would be refused."
    )
    settings: PlannedSettings | None = Field(
        default=None, description="Settings of its first frame; null where no picture can be made."
    )
    findings: list[PlanFinding] = Field(
        default=[], description="Errors first: it would be refused, or its frames would fail."
    )


class PlannedShot(Model):
    """Part of a plan that needs the shot.

    Attributes:
        picture: of the first frame; None where none can be made.
        frame_range: of the shot.
        findings: about it and the shot.
    """

    picture: PlannedPicture | None
    frame_range: FrameRange
    findings: list[PlanFinding]
