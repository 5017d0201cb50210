"""Inspection of a shot: its contents, unsupported features, and findings of the validators."""

from __future__ import annotations

from typing import Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Model, shown_as
from service.models.cameras import READOUT_EXAMPLE, Readout
from service.models.shots import RANGE_EXAMPLE, SHOT_EXAMPLE, CameraChoice, FrameRange

NOTE_EXAMPLE: JsonDict = {
    "code": "not_honoured",
    "path": "/World/Statue.creaseIndices",
    "message": "creaseIndices of /World/Statue and 11 other prims is not honoured: subdivision surfaces are drawn as their cage",
    "count": 12,
}
FINDING_EXAMPLE: JsonDict = {
    "rule": "focusPointTarget",
    "severity": "error",
    "path": "/World/main_cam",
    "message": "focus point driver has no target",
    "fix": "",
}


class Note(Model):
    """A feature of the shot that is not honoured."""

    code: str = Field(description="Short stable word for programs.")
    path: str = Field(description="Prim, property or file; the first one where there are several.")
    message: str = Field(description="One sentence.")
    count: int = Field(description="Number of prims that the note stands for.")


class ValidationFinding(Model):
    """A finding of a validator of the camera schemas."""

    rule: str = Field(description="Name of the rule.")
    severity: Literal["error", "warning"]
    path: str = Field(description="The prim or property.")
    message: str = Field(description="One sentence.")
    fix: str = Field(description="Safe fix, or empty.")


class Inspection(Model):
    """Contents of a shot at its first frame."""

    model_config = shown_as(
        {
            "frameRange": RANGE_EXAMPLE,
            "cameras": ["/World/main_cam"],
            "defaultCamera": SHOT_EXAMPLE["defaultCamera"],
            "readouts": [READOUT_EXAMPLE],
            "triangleCount": 243_118,
            "primCount": 214,
            "lightCount": 9,
            "metersPerUnit": 0.01,
            "upAxis": "Y",
            "notes": [NOTE_EXAMPLE],
            "validation": [FINDING_EXAMPLE],
        }
    )

    frame_range: FrameRange
    up_axis: Literal["Y", "Z"]
    meters_per_unit: float = Field(description="Length of a scene unit.")
    cameras: list[str] = Field(description="Prim paths.")
    default_camera: CameraChoice
    readouts: list[Readout] = Field(description="Lens readout of each camera whose numbers make a picture.")
    prim_count: int = Field(description="Number of drawn prims with geometry.")
    triangle_count: int = Field(description="Number of drawn triangles, instances included.")
    light_count: int
    notes: list[Note] = Field(description="Features that are not honoured.")
    validation: list[ValidationFinding] = Field(description="Findings of the validators.")
