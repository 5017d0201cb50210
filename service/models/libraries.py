"""Libraries of film stocks and camera bodies."""

from __future__ import annotations

from typing import Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Model, shown_as

FILM_EXAMPLE: JsonDict = {
    "name": "vision3_500t_5219",
    "title": "Kodak VISION3 500T 5219/7219",
    "kind": "camera",
    "process": "negative",
    "speed": 500.0,
    "balanceK": 3200.0,
    "year": 2007,
    "description": "Colour negative for tungsten light, for low light and night.",
}
CURVE_EXAMPLE: JsonDict = {"red": [[-3.0, 0.19], [0.5, 1.9]], "green": [[-3.0, 0.62], [0.5, 2.4]], "blue": []}
BODY_EXAMPLE: JsonDict = {
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

FilmProcess = Literal["none", "negative", "reversal", "monochrome", "digital"]
Knots = list[tuple[float, float]]


class FilmSummary(Model):
    """A stock of the library."""

    model_config = shown_as(FILM_EXAMPLE)

    name: str = Field(description="Name of the stock in URLs, on the command line and in edits of a camera.")
    title: str = Field(description="Name on the box.")
    kind: Literal["camera", "print"] = Field(description="Exposed in a camera, or a print stock for negatives.")
    process: FilmProcess
    speed: float | None = Field(description="ISO; null for a print stock.")
    balance_k: float | None = Field(
        description="Colour temperature of the light that it is balanced for; null for none."
    )
    year: int = Field(description="Year of the data sheet.")
    description: str = Field(description="One line.")


class FilmList(Model):
    """The film library."""

    model_config = shown_as({"films": [FILM_EXAMPLE]})

    films: list[FilmSummary]


class FilmCurves(Model):
    """Knots (log10 exposure, density) of each record. A black-and-white stock has the green record only."""

    model_config = shown_as(CURVE_EXAMPLE)

    red: Knots
    green: Knots
    blue: Knots


class Film(FilmSummary):
    """A stock of the library with its data."""

    model_config = shown_as(
        FILM_EXAMPLE
        | {
            "printStock": "vision_2383",
            "densitometry": "Status M",
            "relativeExposure": True,
            "middleGray": -1.16,
            "curves": CURVE_EXAMPLE,
            "granularity": {"green": [[0.7, 0.011]]},
            "granularityFromBase": False,
        }
    )

    print_stock: str | None = Field(description="Print stock used unless a shot sets another; null for none.")
    densitometry: str = Field(description="Densitometry of the measured densities.")
    relative_exposure: bool = Field(
        description="True where log exposures are relative; false where they are of lux-seconds."
    )
    middle_gray: float | None = Field(description="Log exposure of a metered 18 % grey; null for print stocks.")
    curves: FilmCurves
    granularity: dict[str, Knots] = Field(
        description="Density and its standard deviation through a round 48 µm aperture, by channel; empty where unknown."
    )
    granularity_from_base: bool = Field(
        description="True where the densities of `granularity` are relative to the base."
    )


class BodySummary(Model):
    """A camera body, or the gate of a film format."""

    model_config = shown_as(BODY_EXAMPLE)

    name: str = Field(description="Name of the body in URLs, on the command line and in edits of a camera.")
    title: str = Field(description="Usual name.")
    kind: Literal["film", "digital"] = Field(description="Whether film or a sensor is behind the gate.")
    gate_mm: tuple[float, float] = Field(description="Width and height of the exposed area.")
    resolution: tuple[int, int] | None = Field(description="Photosites across and up; null for film.")
    squeeze: float = Field(description="Squeeze of the anamorphic lenses that it is made for; 1 is spherical.")
    aspect: float = Field(description="Width over height of the desqueezed picture.")
    crop_factor: float = Field(
        description="Focal length that has the same diagonal field of view on full frame, over the lens's own."
    )
    description: str = Field(description="One line.")


class Shape(Model):
    """An aspect ratio that pictures are delivered in."""

    model_config = shown_as(SHAPE_EXAMPLE)

    name: str
    aspect: float = Field(description="Width over height.")


class BodyList(Model):
    """The library of bodies, and the aspect ratios that pictures are framed for."""

    model_config = shown_as({"bodies": [BODY_EXAMPLE], "shapes": [SHAPE_EXAMPLE]})

    bodies: list[BodySummary]
    shapes: list[Shape] = Field(description="Widest first.")


class FieldOfView(Model):
    """Field of view of a lens without distortion, focused at infinity."""

    model_config = shown_as(FIELD_EXAMPLE)

    focal_length_mm: float
    horizontal_deg: float
    vertical_deg: float
    diagonal_deg: float
    full_frame_mm: float = Field(description="Focal length with the same diagonal field of view on full frame.")


class FramingGuide(Shape):
    """The largest centred picture of an aspect ratio within the gate."""

    model_config = shown_as(GUIDE_EXAMPLE)

    share_of_gate: tuple[float, float] = Field(description="Shares of the gate's width and height.")
    gate_mm: tuple[float, float]
    resolution: tuple[int, int] | None = Field(description="Photosites of the picture; null for film.")


class Body(BodySummary):
    """A camera body with its fields of view and framing guides."""

    model_config = shown_as(BODY_EXAMPLE | {"fieldsOfView": [FIELD_EXAMPLE], "framingGuides": [GUIDE_EXAMPLE]})

    fields_of_view: list[FieldOfView]
    framing_guides: list[FramingGuide]
