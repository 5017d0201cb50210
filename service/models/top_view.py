"""The set from above: the camera's frame, the cut through what it holds sharp, and the paths of its focus points."""

from __future__ import annotations

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Distance, Model, Pair, Vector3, shown_as

CUT_EXAMPLE: JsonDict = {"slope": 0.0, "nearW": 0.305, "focusW": 0.292, "farW": 0.279}


class CutPlace(Model):
    """Sharpness in one direction of the plan. Inverse depths count from the pupil; lines in the plan are linear in them."""

    model_config = shown_as(CUT_EXAMPLE)

    slope: float = Field(description="Metres to the right for each metre of depth, from the pupil.")
    near_w: Distance = Field(
        description="Of the near limit of sharpness, 1/m; null is infinite, the pupil of a pinhole."
    )
    focus_w: float = Field(
        description="Of the focus, 1/m; 0 is infinity, below 0 there is none in front of the camera."
    )
    far_w: Distance = Field(
        description="Of the far limit, 1/m; 0 or below, it lies at infinity; null is without end, of a pinhole."
    )


class TopView(Model):
    """A camera from above at one time: the plane of its right vector and its optical axis.

    A place in the world is in this plan where its way from `positionM` goes along `right` (to the right) and along `ahead` (its
    depth, as in all readouts).
    """

    model_config = shown_as(
        {
            "camera": "/World/main_cam",
            "time": 24.0,
            "positionM": [0.0, 1.6, 0.5],
            "right": [1.0, 0.0, 0.0],
            "ahead": [0.0, 0.0, -1.0],
            "setBackM": 0.0,
            "gateMm": 24.89,
            "edges": [-0.249, 0.249],
            "axis": CUT_EXAMPLE,
            "cut": [CUT_EXAMPLE | {"slope": -0.249}, CUT_EXAMPLE, CUT_EXAMPLE | {"slope": 0.249}],
        }
    )

    camera: str | None = Field(description="Prim path; null for the camera that frames a shot which has none.")
    time: float = Field(description="USD time code.")
    position_m: Vector3 = Field(description="Origin of the camera in the world: metres, +Y up.")
    right: Vector3 = Field(description="Unit vector to the right of the picture, in the world.")
    ahead: Vector3 = Field(description="Unit vector of the optical axis, in the world.")
    set_back_m: float = Field(
        description="How far the pupil lies behind `positionM`, from where depths count; 0 but for an orthographic camera."
    )
    gate_mm: float = Field(description="Width of the film gate.")
    edges: Pair = Field(description="Slopes of the left and the right edge of the picture, on the level of the axis.")
    axis: CutPlace = Field(description="On the view axis, as `readout` has it.")
    cut: list[CutPlace] = Field(
        description="Over the width of the picture, from left to right, on the level of the axis."
    )


class PointPath(Model):
    """The way of a focus point."""

    name: str
    positions_m: list[Vector3 | None] = Field(description="In the world at each of the times; null without a place.")


class Paths(Model):
    """The ways of a camera and its focus points over a shot."""

    model_config = shown_as(
        {
            "camera": "/World/main_cam",
            "times": [1.0, 2.0],
            "cameraM": [[0.0, 1.6, 0.5], [0.0, 1.6, 0.4]],
            "points": [{"name": "pip", "positionsM": [[0.4, 1.6, -3.1], None]}],
        }
    )

    camera: str | None = Field(description="Prim path; null for the camera that frames a shot which has none.")
    times: list[float] = Field(description="USD time codes, from the shot's first frame to its last.")
    camera_m: list[Vector3] = Field(
        description="Origin of the camera at each of the times, in the world: metres, +Y up."
    )
    points: list[PointPath]
