"""Camera bodies and film formats: what the library has, and what a gate shows."""

from __future__ import annotations

from typing import Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Model, shown_as

SUMMARY_EXAMPLE: JsonDict = {
    "name": "super35_4perf",
    "title": "Super 35 4-perf",
    "kind": "film",
    "gateMm": [24.89, 18.66],
    "resolution": None,
    "squeeze": 1.0,
    "aspect": 1.3339,
    "cropFactor": 1.391,
    "description": "The full width of 35 mm film, four perforations high.",
}
SHAPE_EXAMPLE: JsonDict = {"name": "2.39:1", "aspect": 2.39}
FIELD_EXAMPLE: JsonDict = {
    "focalLengthMm": 35.0,
    "horizontalDeg": 39.1,
    "verticalDeg": 29.9,
    "diagonalDeg": 47.9,
    "fullFrameMm": 48.7,
}
GUIDE_EXAMPLE: JsonDict = SHAPE_EXAMPLE | {"shareOfGate": [1.0, 0.558], "gateMm": [24.89, 10.41], "resolution": None}


class BodySummary(Model):
    """A camera body, or the gate of a film format."""

    model_config = shown_as(SUMMARY_EXAMPLE)

    name: str = Field(description="Names the body in addresses, on the command line and in edits of a camera.")
    title: str = Field(description="What people call it.")
    kind: Literal["film", "digital"] = Field(description="What is behind the gate.")
    gate_mm: tuple[float, float] = Field(description="Width and height of what is exposed.")
    resolution: tuple[int, int] | None = Field(description="Photosites across and up; null for film.")
    squeeze: float = Field(description="Of the anamorphic lenses that it is made for; 1 is spherical.")
    aspect: float = Field(description="Width over height of the picture as it is seen.")
    crop_factor: float = Field(
        description="How many times as long a lens shows the same corner to corner on full frame."
    )
    description: str = Field(description="One line.")


class Shape(Model):
    """A shape that pictures are delivered in."""

    model_config = shown_as(SHAPE_EXAMPLE)

    name: str
    aspect: float = Field(description="Width over height.")


class BodyList(Model):
    """The library of bodies, and the shapes that pictures are framed for."""

    model_config = shown_as({"bodies": [SUMMARY_EXAMPLE], "shapes": [SHAPE_EXAMPLE]})

    bodies: list[BodySummary]
    shapes: list[Shape] = Field(description="Widest first.")


class FieldOfView(Model):
    """What is seen through a lens without distortion that is focused at infinity."""

    model_config = shown_as(FIELD_EXAMPLE)

    focal_length_mm: float
    horizontal_deg: float
    vertical_deg: float
    diagonal_deg: float
    full_frame_mm: float = Field(description="The focal length that shows as much on full frame.")


class FramingGuide(Shape):
    """The largest picture of a shape within the gate, in its middle."""

    model_config = shown_as(GUIDE_EXAMPLE)

    share_of_gate: tuple[float, float] = Field(description="Of its width and of its height.")
    gate_mm: tuple[float, float]
    resolution: tuple[int, int] | None = Field(description="Photosites within it; null for film.")


class Body(BodySummary):
    """A camera body, and what it shows."""

    model_config = shown_as(SUMMARY_EXAMPLE | {"fieldsOfView": [FIELD_EXAMPLE], "framingGuides": [GUIDE_EXAMPLE]})

    fields_of_view: list[FieldOfView]
    framing_guides: list[FramingGuide]
