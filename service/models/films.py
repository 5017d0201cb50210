"""Films: what the library has, and what is known of a stock."""

from __future__ import annotations

from typing import Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Model, shown_as

SUMMARY_EXAMPLE: JsonDict = {
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

FilmProcess = Literal["none", "negative", "reversal", "monochrome", "digital"]
Knots = list[tuple[float, float]]


class FilmSummary(Model):
    """A stock of the library."""

    model_config = shown_as(SUMMARY_EXAMPLE)

    name: str = Field(description="Names the stock in addresses, on the command line and in edits of a camera.")
    title: str = Field(description="What stands on the box.")
    kind: Literal["camera", "print"] = Field(description="Whether it goes in a camera, or negatives are printed on it.")
    process: FilmProcess
    speed: float | None = Field(description="ISO; null for a print stock.")
    balance_k: float | None = Field(description="Colour temperature of the light it is made for; null where none is.")
    year: int = Field(description="Of the data sheet.")
    description: str = Field(description="One line.")


class FilmList(Model):
    """The film library."""

    model_config = shown_as({"films": [SUMMARY_EXAMPLE]})

    films: list[FilmSummary]


class FilmCurves(Model):
    """Knots (log10 exposure, density) of each record; of black and white the green one alone."""

    model_config = shown_as(CURVE_EXAMPLE)

    red: Knots
    green: Knots
    blue: Knots


class Film(FilmSummary):
    """A stock of the library, and what is known of it."""

    model_config = shown_as(
        SUMMARY_EXAMPLE
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

    print_stock: str | None = Field(description="What it is printed on unless a shot says otherwise; null for none.")
    densitometry: str = Field(description="How density was measured.")
    relative_exposure: bool = Field(description="Whether log exposures are relative; else they are of lux-seconds.")
    middle_gray: float | None = Field(
        description="Log exposure where a metered 18 % grey lands; null for print stocks."
    )
    curves: FilmCurves
    granularity: dict[str, Knots] = Field(
        description="By channel: density, and its standard deviation through a round 48 µm aperture; empty where unknown."
    )
    granularity_from_base: bool = Field(description="Whether the densities of `granularity` count from the base.")
