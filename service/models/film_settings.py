"""Film and grade of a camera, and their keys."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from service.models.base import KEYS_AT, Model, TimeCode, shown_as
from service.models.focus import KEY_EXAMPLE, Key
from service.models.settings import example_of, keyed_names, with_edits, with_settings

FILM_EXAMPLE = example_of(
    "film",
    {
        "camera": "/World/main_cam",
        "time": 24.0,
        "body": "Super 35 4-perf",
        "gateMm": [24.89, 18.66],
        "process": "negative",
        "stock": "vision3_500t_5219",
        "printStock": "vision_2383",
        "push": 1.0,
        "whiteBalanceK": 3200.0,
        "grainAmount": 1.0,
        "halationAmount": 0.01,
        "display": "sRGB - Display",
        "view": "ACES 2.0 - SDR 100 nits (Rec.709)",
        "keys": {"push": [KEY_EXAMPLE]},
        "etag": '"92c4bf18a0860070"',
    },
)

if TYPE_CHECKING:
    FilmKeyed = str
else:
    FilmKeyed = Literal[keyed_names("film")]


@with_settings("film")
class FilmSettings(Model):
    """Film, sensor and grade of a camera at one time."""

    model_config = shown_as(FILM_EXAMPLE)

    camera: str = Field(description="Prim path.")
    time: float = Field(description="USD time code.")
    gate_mm: tuple[float, float] = Field(description="USD's apertures: the gate as wide as it looks through the lens.")
    keys: dict[FilmKeyed, list[Key]] = Field(description="Keys in order of time, of each setting that has any.")
    etag: str = Field(description="The camera's `ETag`: for `If-Match`.")


@with_edits("film")
class FilmSettingsEdit(Model):
    """Film, sensor and grade settings to change; a setting left out stays as it is."""

    model_config = shown_as({"stock": "5219", "push": 1, "whiteBalanceK": 3200})

    stock: Annotated[str, Field(max_length=80)] | None = Field(
        default=None,
        description="Puts a stock of the library in the camera, by its name or a part of it that no other has, null none: for "
        "all time. It brings its process and its curves, and where there was no film its print and its grain; what is sent "
        "beside it is set after that. Left out, the film stays.",
    )
    time: TimeCode | None = Field(default=None, description=KEYS_AT)


class DisplayChoice(Model):
    """A display of an OpenColorIO configuration."""

    model_config = shown_as(
        {"name": "sRGB - Display", "views": ["ACES 2.0 - SDR 100 nits (Rec.709)", "Raw"], "defaultView": "Raw"}
    )

    name: str
    views: list[str]
    default_view: str


class GradeChoices(Model):
    """Displays, views and looks that a camera's picture can be graded by."""

    model_config = shown_as(
        {
            "displays": [{"name": "sRGB - Display", "views": ["Raw", "Un-tone-mapped"], "defaultView": "Raw"}],
            "defaultDisplay": "sRGB - Display",
            "looks": ["ACES 1.3 Reference Gamut Compression"],
        }
    )

    displays: list[DisplayChoice]
    default_display: str
    looks: list[str]
