"""Focus points, their anchors and their keys."""

from __future__ import annotations

from typing import Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import (
    Amount,
    BarycentricWeight,
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

ANCHOR_EXAMPLE: JsonDict = {
    "target": ["/World/Tram/Driver"],
    "face": 1042,
    "fanTriangle": 0,
    "barycentric": [0.2, 0.3, 0.5],
    "instance": -1,
}
KEY_EXAMPLE: JsonDict = {"time": 24.0, "value": 1.0, "interpolation": "linear", "tangents": None}
POINT_EXAMPLE: JsonDict = ANCHOR_EXAMPLE | {
    "name": "driver",
    "offset": [0.0, 0.0, 0.0],
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
    "problem": "",
    "keys": {"weight": [KEY_EXAMPLE]},
    "etag": '"0b64bf18a0860070"',
}

Kind = Literal["sharp", "soft"]
Interpolation = Literal["held", "linear", "bezier", "auto"]


Barycentric = tuple[BarycentricWeight, BarycentricWeight, BarycentricWeight]
Offset = tuple[Length, Length, Length]


class Anchor(Model):
    """A point on a surface that moves with it."""

    target: tuple[PrimPath, ...] = Field(
        min_length=1, max_length=2, description="The mesh; or a PointInstancer, then the prototype's mesh."
    )
    face: Index = Field(default=-1, description="Index of the authored face; -1 for the origin of the target's space.")
    fan_triangle: Index = Field(default=0, ge=0, description="Triangle i of the face has its corners 0, i+1 and i+2.")
    barycentric: Barycentric = Field(default=(1.0, 0.0, 0.0), description="Weights of those three corners.")
    instance: Index = Field(default=-1, description="Of a PointInstancer, else -1.")


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


class FocusPointCreate(Anchor):
    """A new focus point: the anchor of a pick, and the values of the point."""

    model_config = shown_as(ANCHOR_EXAMPLE | {"name": "driver", "weight": 1.0})

    name: PointName | None = Field(default=None, description="Left out: a free name.")
    offset: Offset = Field(default=(0.0, 0.0, 0.0), description="From the anchor; scene units, the target's own space.")
    kind: Kind = "sharp"
    blur_mm: Amount = Field(
        default=0.0, description="Circle of confusion that a soft point asks for: diameter on the film."
    )
    weight: Amount = 1.0
    falloff: Amount = Field(default=0.0, description="Distance in frame widths where its influence ends; 0: nowhere.")
    enabled: bool = True
    surface_offset: Length = Field(
        default=0.0, description="For a soft point without blur: how far behind the target the focus lies; scene units."
    )
    extent: Amount = Field(default=1.0, description="Depth of field around it in surface mode, relative to the lens's.")


class FocusPointEdit(Model):
    """Values to change on a focus point; a value left out stays as it is."""

    model_config = shown_as({"weight": 0.5, "enabled": True})

    target: tuple[PrimPath, ...] | None = Field(default=None, min_length=1, max_length=2)
    face: Index | None = None
    fan_triangle: Index | None = Field(default=None, ge=0)
    barycentric: Barycentric | None = None
    instance: Index | None = None
    offset: Offset | None = None
    kind: Kind | None = None
    blur_mm: Amount | None = None
    weight: Amount | None = None
    falloff: Amount | None = None
    enabled: bool | None = None
    surface_offset: Length | None = None
    extent: Amount | None = None


KeyedAttribute = Literal["weight", "enabled", "blur", "falloff", "surfaceOffset", "extent"]


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


class FocusPoint(Model):
    """A focus point at one time, and where it is in the picture."""

    model_config = shown_as(POINT_EXAMPLE)

    name: str
    target: tuple[str, ...]
    face: int
    fan_triangle: int
    barycentric: Vector3
    instance: int
    offset: Vector3
    kind: Kind
    blur_mm: float
    weight: float
    falloff: float
    enabled: bool
    surface_offset: float
    extent: float
    position_m: Vector3 | None = Field(description="In the world: metres, +Y up; null without a place.")
    depth_m: Distance = Field(description="Along the view axis, negative behind the camera; null without a place.")
    screen: tuple[float, float] | None = Field(
        description="In the picture, 0 to 1 from its top left corner; null where it is not in front of the camera."
    )
    visible_in_frame: bool = Field(description="Whether it lies in the picture (something may still hide it).")
    state: str = Field(description="`used` for the focus, or why it does not count.")
    share: float = Field(description="Of the weight that decides the focus, 0 to 1.")
    coc_mm: Distance = Field(description="Diameter of its circle of confusion on the film; null behind the camera.")
    problem: str = Field(description="Why it has no place, or empty.")
    keys: dict[KeyedAttribute, list[Key]] = Field(description="Keys in order of time, for each attribute that has any.")
    etag: str = Field(description="Its `ETag`, which changes when the point is edited: for `If-Match`.")


class FocusPointList(Model):
    """The focus points of a camera at one time."""

    model_config = shown_as({"etag": '"77aebf18a0860070"', "focusPoints": [POINT_EXAMPLE]})

    etag: str = Field(description="Changes when any of the points is edited: for `If-Match` where one is added.")
    focus_points: list[FocusPoint]
