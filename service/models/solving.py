"""Focus settings of a camera: solver, hand, tilt, and their keys; and racks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Distance, Model, PointName, TimeCode, shown_as
from service.models.focus import KEY_EXAMPLE, Key
from service.models.settings import example_of, keyed_names, with_edits, with_settings
from usd_schemas.settings.tables import SETTINGS

SETTINGS_EXAMPLE = example_of(
    "focus",
    {
        "camera": "/World/main_cam",
        "time": 24.0,
        "mode": "tiltPlane",
        "smoothingS": 0.25,
        "lagS": 0.1,
        "deadZoneMm": 0.01,
        "maxSpeedDegS": 180.0,
        "occluded": "fade",
        "keys": {"focusDistanceM": [KEY_EXAMPLE]},
        "etag": '"92c4bf18a0860070"',
    },
)
RACK_EXAMPLE: JsonDict = {"from": "pip", "to": "mara", "start": 24.0, "end": 36.0, "ease": "smooth"}

if TYPE_CHECKING:
    CameraKeyed = str
else:
    CameraKeyed = Literal[keyed_names("camera", "focus")]
Ease = Literal["linear", "smooth", "in", "out"]

Ratio = Annotated[float, Field(ge=0, le=1)]
Offset = Annotated[float, Field(ge=-1e3, le=1e3)]
FieldOffsets = Annotated[tuple[tuple[Ratio, Ratio, Offset], ...], Field(max_length=64)]


@with_settings("focus")
class FocusSettings(Model):
    """Focus settings of a camera at one time."""

    model_config = shown_as(SETTINGS_EXAMPLE)

    camera: str = Field(description="Prim path.")
    time: float = Field(description="USD time code.")
    keys: dict[CameraKeyed, list[Key]] = Field(
        description="Keys in order of time, for each of these settings and of the lens's that has any; switches as 0 and 1."
    )
    etag: str = Field(description="The camera's `ETag`: for `If-Match`.")


@with_edits("focus")
class FocusSettingsEdit(Model):
    """Focus settings to change; a setting left out stays as it is."""

    model_config = shown_as({"mode": "tiltPlane", "smoothingS": 0.25, "maxAngleDeg": 12.0})

    field_offsets: FieldOffsets | None = Field(default=None, description=SETTINGS["field_offsets"].doc)
    time: TimeCode | None = Field(
        default=None,
        description="USD time code of keys; without it, keys go and the values hold for all time. Words and lists hold for "
        "all time either way.",
    )


class RackCreate(Model):
    """A rack from one focus point to another."""

    model_config = shown_as(RACK_EXAMPLE)

    from_point: PointName = Field(alias="from", description="The focus point that is in focus until the start.")
    to_point: PointName = Field(alias="to", description="The one that is in focus from the end on.")
    start: TimeCode = Field(description="USD time code.")
    end: TimeCode = Field(description="USD time code.")
    ease: Ease = Field(default="smooth", description="`in` starts softly, `out` ends softly, `smooth` does both.")


class Rack(Model):
    """A rack as authored: keys of the two points' weights."""

    model_config = shown_as(
        RACK_EXAMPLE
        | {
            "end": 41.5,
            "stretched": True,
            "startDistanceM": 3.42,
            "endDistanceM": 12.0,
            "etag": '"77aebf18a0860070"',
        }
    )

    from_point: str = Field(alias="from")
    to_point: str = Field(alias="to")
    start: float = Field(description="USD time code.")
    end: float = Field(description="USD time code.")
    ease: Ease
    stretched: bool = Field(description="Whether it ends later than asked, as the hand cannot turn the ring that fast.")
    start_distance_m: Distance = Field(description="Focus before it; null is infinity.")
    end_distance_m: Distance = Field(description="Focus after it; null is infinity.")
    etag: str = Field(description="Of the camera's list of focus points.")
