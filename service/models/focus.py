"""Focus points, their anchors and their keys."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import (
    Amount,
    Distance,
    Index,
    Length,
    Model,
    PointName,
    PrimPath,
    TimeCode,
    Vector3,
    shown_as,
)
from service.models.settings import keyed_names, point_field, with_edits, with_settings, with_values
from usd_schemas.settings.tables import POINT_SETTINGS

ANCHOR_EXAMPLE: JsonDict = {
    "target": ["/World/Cast/Mara/Body/Head/VisorGlow"],
    "face": 696,
    "fanTriangle": 0,
    "barycentric": [0.2, 0.3, 0.5],
    "instance": -1,
}
KEY_EXAMPLE: JsonDict = {"time": 24.0, "value": 1.0, "interpolation": "linear", "tangents": None}
POINT_EXAMPLE: JsonDict = ANCHOR_EXAMPLE | {
    "name": "pip",
    "offset": [0.0, 0.0, 0.0],
    "part": "",
    "boundsPoint": [0.5, 0.5, 0.5],
    "color": "teal",
    "group": "cast",
    "kind": "sharp",
    "blurMm": 0.0,
    "weight": 1.0,
    "falloff": 0.0,
    "enabled": True,
    "surfaceOffset": 0.0,
    "extent": 1.0,
    "positionM": [0.4, 1.6, -3.1],
    "depthM": 3.42,
    "screen": [0.43, 0.55],
    "visibleInFrame": True,
    "state": "used",
    "share": 1.0,
    "cocMm": 0.0,
    "focusDistanceM": 3.42,
    "sharp": True,
    "problem": "",
    "keys": {"weight": [KEY_EXAMPLE]},
    "etag": '"0b64bf18a0860070"',
}

Interpolation = Literal["held", "linear", "bezier", "auto"]


_WEIGHTS = POINT_SETTINGS["barycentric"].sent
_TARGET = POINT_SETTINGS["target"].doc
BarycentricWeight = Annotated[float, Field(ge=_WEIGHTS.least, le=_WEIGHTS.most)]
Barycentric = tuple[BarycentricWeight, BarycentricWeight, BarycentricWeight]

if TYPE_CHECKING:
    KeyedAttribute = str
else:  # weight and enabled, which decide whether a point counts, stand first
    KeyedAttribute = Literal[
        tuple(sorted(keyed_names("focusPoint"), key=lambda name: name not in {"weight", "enabled"}))
    ]


class Anchor(Model):
    """A point on a surface that moves with it."""

    target: tuple[PrimPath, ...] = Field(min_length=1, max_length=2, description=_TARGET)
    face: int = point_field("face")
    fan_triangle: Index = point_field("fan_triangle")  # -1 is refused by the schema, when the point is authored
    barycentric: Barycentric = point_field("barycentric")
    instance: int = point_field("instance")


class Pick(Model):
    """The surface under a pixel."""

    model_config = shown_as(
        {
            "hit": True,
            "anchor": ANCHOR_EXAMPLE,
            "depthM": 3.42,
            "positionM": [0.4, 1.6, -3.1],
        }
    )

    hit: bool = Field(description="Whether there is anything under the pixel; without it the rest is null.")
    anchor: Anchor | None = None
    depth_m: float | None = Field(default=None, description="Along the view axis.")
    position_m: Vector3 | None = Field(default=None, description="In the world: metres, +Y up.")


@with_values("focusPoint")
class FocusPointCreate(Anchor):
    """A new focus point: the anchor of a pick, and the values of the point."""

    model_config = shown_as(ANCHOR_EXAMPLE | {"name": "visor", "weight": 1.0})

    name: PointName | None = Field(default=None, description="Left out: a free name.")


@with_edits("focusPoint")
class FocusPointEdit(Model):
    """Values to change on a focus point; a value left out stays as it is."""

    model_config = shown_as({"weight": 0.5, "enabled": True})

    target: tuple[PrimPath, ...] | None = Field(default=None, min_length=1, max_length=2, description=_TARGET)


class Tangents(Model):
    """The handles of a bezier key."""

    model_config = shown_as({"inSlope": 0.0, "inWidth": 4.0, "outSlope": 0.0, "outWidth": 4.0})

    in_slope: float = Field(default=0.0, description="Of the handle before the key: value for each time code.")
    in_width: float = Field(default=0.0, description="How far it reaches back, time codes; 0: a third of the way.")
    out_slope: float = Field(default=0.0, description="Of the handle after the key.")
    out_width: float = Field(default=0.0, description="How far it reaches on; 0: a third of the way.")


class TangentsEdit(Tangents):
    """The handles of a bezier key to set."""

    in_slope: Length = Field(default=0.0, description="Of the handle before the key: value for each time code.")
    in_width: Amount = Field(default=0.0, description="How far it reaches back, time codes; 0: a third of the way.")
    out_slope: Length = Field(default=0.0, description="Of the handle after the key.")
    out_width: Amount = Field(default=0.0, description="How far it reaches on; 0: a third of the way.")


class Key(Model):
    """A key of one attribute."""

    model_config = shown_as(KEY_EXAMPLE)

    time: float = Field(description="USD time code.")
    value: Distance = Field(description="For `enabled`: 0 or 1. For `blur`: mm. null: the shot has no finite number.")
    interpolation: Interpolation = Field(
        default="linear", description="From this key to the next; `enabled` holds, whatever its value here."
    )
    tangents: Tangents | None = Field(
        default=None, description="Of a `bezier` key; left out, those that an `auto` key would have now."
    )


class KeyEdit(Key):
    """A key to set."""

    time: TimeCode = Field(description="USD time code.")
    value: Length = Field(description="For `enabled`: 0 or 1. For `blur`: mm.")
    tangents: TangentsEdit | None = Field(
        default=None, description="Of a `bezier` key; left out, those that an `auto` key would have now."
    )


_COC_MM: Distance = Field(description="Diameter of its circle of confusion on the film; null behind the camera.")
_FOCUS_DISTANCE: Distance = Field(
    description="Depth of the focal surface where it stands in the picture; null is infinity or, where `cocMm` is null too, no "
    "place there."
)
_SHARP: bool = Field(
    description="Whether its circle of confusion is within the film's limit, the readout's `cocLimitMm`."
)


class PointSharpness(Model):
    """Sharpness of a focus point."""

    model_config = shown_as({"name": "pip", "depthM": 3.42, "cocMm": 0.0, "focusDistanceM": 3.42, "sharp": True})

    name: str
    depth_m: Distance = Field(description="Along the view axis, negative behind the camera; null without a place.")
    coc_mm: Distance = _COC_MM
    focus_distance_m: Distance = _FOCUS_DISTANCE
    sharp: bool = _SHARP


class _NamedPoint(Model):
    name: str


@with_settings("focusPoint")
class _PointSettings(_NamedPoint):
    """The settings of a focus point at one time, after its name."""


class FocusPoint(_PointSettings):
    """A focus point at one time, and where it is in the picture."""

    model_config = shown_as(POINT_EXAMPLE)

    position_m: Vector3 | None = Field(description="In the world: metres, +Y up; null without a place.")
    depth_m: Distance = Field(description="Along the view axis, negative behind the camera; null without a place.")
    screen: tuple[float, float] | None = Field(
        description="In the picture, 0 to 1 from its top left corner; null where it is not in front of the camera."
    )
    visible_in_frame: bool = Field(description="Whether it lies in the picture (something may still hide it).")
    state: str = Field(description="`used` for the focus, or why it does not count.")
    share: float = Field(description="Of the weight that decides the focus, 0 to 1.")
    coc_mm: Distance = _COC_MM
    focus_distance_m: Distance = _FOCUS_DISTANCE
    sharp: bool = _SHARP
    problem: str = Field(description="Why it has no place, or empty.")
    keys: dict[KeyedAttribute, list[Key]] = Field(description="Keys in order of time, for each attribute that has any.")
    etag: str = Field(description="Its `ETag`, which changes when the point is edited: for `If-Match`.")


class FocusPointList(Model):
    """The focus points of a camera at one time."""

    model_config = shown_as({"etag": '"77aebf18a0860070"', "focusPoints": [POINT_EXAMPLE]})

    etag: str = Field(description="Changes when any of the points is edited: for `If-Match` where one is added.")
    focus_points: list[FocusPoint]
