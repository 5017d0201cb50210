"""Focus settings of a camera: solver, hand, tilt, and their keys; and racks."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Distance, Model, PointName, TimeCode, shown_as
from service.models.cameras import FocusMode
from service.models.focus import KEY_EXAMPLE, Key

SETTINGS_EXAMPLE: JsonDict = {
    "camera": "/World/Camera",
    "time": 24.0,
    "mode": "tiltPlane",
    "solveStop": False,
    "circleOfConfusionMm": 0.0,
    "smoothingS": 0.25,
    "lagS": 0.1,
    "deadZoneMm": 0.01,
    "maxSpeedDegS": 180.0,
    "nearPriority": 0.0,
    "offScreen": "ignore",
    "occluded": "fade",
    "surfaceExponent": 3.0,
    "expressive": 1.0,
    "fieldOffsets": [],
    "tiltDeg": 0.0,
    "swingDeg": 0.0,
    "riseMm": 0.0,
    "shiftMm": 0.0,
    "drivenByPoints": True,
    "maxAngleDeg": 15.0,
    "keys": {"focusDistanceM": [KEY_EXAMPLE]},
    "etag": '"92c4bf18a0860070"',
}
RACK_EXAMPLE: JsonDict = {"from": "driver", "to": "sign", "start": 24.0, "end": 36.0, "ease": "smooth"}

CameraKeyed = Literal[
    "focusDistanceM",
    "fStop",
    "focalLengthMm",
    "solveStop",
    "circleOfConfusionMm",
    "smoothingS",
    "lagS",
    "deadZoneMm",
    "maxSpeedDegS",
    "nearPriority",
    "surfaceExponent",
    "expressive",
    "tiltDeg",
    "swingDeg",
    "riseMm",
    "shiftMm",
    "drivenByPoints",
    "maxAngleDeg",
]
OffScreen = Literal["ignore", "keep"]
Occluded = Literal["ignore", "keep", "fade"]
Ease = Literal["linear", "smooth", "in", "out"]

Ratio = Annotated[float, Field(ge=0, le=1)]
Positive = Annotated[float, Field(ge=0, le=1e6)]
Angle = Annotated[float, Field(ge=-89, le=89)]
Offset = Annotated[float, Field(ge=-1e3, le=1e3)]
FieldOffsets = Annotated[tuple[tuple[Ratio, Ratio, Offset], ...], Field(max_length=64)]

_DESCRIPTIONS: dict[str, str] = {
    "mode": "`manual`: by hand. `points`: the distance that serves the focus points best. `tiltPlane`: the plane through them, "
    "by tilting the lens. `surface`: a surface through all of them, which no lens has.",
    "solve_stop": "Whether the points also set the f-number.",
    "circle_of_confusion_mm": "Diameter on the film up to which a thing is sharp; 0: 1/1500 of the gate's diagonal.",
    "smoothing_s": "Time over which the solved focus is smoothed; it is exact at keys.",
    "lag_s": "How late the focus follows.",
    "dead_zone_mm": "Circle of confusion that a followed point may reach before the focus moves.",
    "max_speed_deg_s": "How fast the focus ring may turn, degrees in a second; 0: no bound.",
    "near_priority": "How much nearer points count more: weights times (1/depth)^p.",
    "off_screen": "Whether points outside the frame count.",
    "occluded": "Whether points count that something stands before.",
    "surface_exponent": "How local the focal surface is.",
    "expressive": "From the plane of focus (0) to the focal surface (1).",
    "field_offsets": "Curvature of field: x and y across and down the frame, offset of the image plane toward the lens in mm.",
    "tilt_deg": "Turn of the lens: positive looks up.",
    "swing_deg": "Turn of the lens, before the tilt: positive looks left.",
    "rise_mm": "How far the lens is moved up against the film.",
    "shift_mm": "How far the lens is moved to the right against the film.",
    "driven_by_points": "In the mode `tiltPlane`: whether the focus points tilt the lens, or the angles hold.",
    "max_angle_deg": "How far the points may tilt and swing it together.",
}


class FocusSettings(Model):
    """Focus settings of a camera at one time."""

    model_config = shown_as(SETTINGS_EXAMPLE)

    camera: str = Field(description="Prim path.")
    time: float = Field(description="USD time code.")
    mode: FocusMode = Field(description=_DESCRIPTIONS["mode"])
    solve_stop: bool = Field(description=_DESCRIPTIONS["solve_stop"])
    circle_of_confusion_mm: float = Field(description=_DESCRIPTIONS["circle_of_confusion_mm"])
    smoothing_s: float = Field(description=_DESCRIPTIONS["smoothing_s"])
    lag_s: float = Field(description=_DESCRIPTIONS["lag_s"])
    dead_zone_mm: float = Field(description=_DESCRIPTIONS["dead_zone_mm"])
    max_speed_deg_s: float = Field(description=_DESCRIPTIONS["max_speed_deg_s"])
    near_priority: float = Field(description=_DESCRIPTIONS["near_priority"])
    off_screen: OffScreen = Field(description=_DESCRIPTIONS["off_screen"])
    occluded: Occluded = Field(description=_DESCRIPTIONS["occluded"])
    surface_exponent: float = Field(description=_DESCRIPTIONS["surface_exponent"])
    expressive: float = Field(description=_DESCRIPTIONS["expressive"])
    field_offsets: list[tuple[float, float, float]] = Field(description=_DESCRIPTIONS["field_offsets"])
    tilt_deg: float = Field(description=_DESCRIPTIONS["tilt_deg"])
    swing_deg: float = Field(description=_DESCRIPTIONS["swing_deg"])
    rise_mm: float = Field(description=_DESCRIPTIONS["rise_mm"])
    shift_mm: float = Field(description=_DESCRIPTIONS["shift_mm"])
    driven_by_points: bool = Field(description=_DESCRIPTIONS["driven_by_points"])
    max_angle_deg: float = Field(description=_DESCRIPTIONS["max_angle_deg"])
    keys: dict[CameraKeyed, list[Key]] = Field(
        description="Keys in order of time, for each of these settings and of the lens's that has any; switches as 0 and 1."
    )
    etag: str = Field(description="The camera's `ETag`: for `If-Match`.")


class FocusSettingsEdit(Model):
    """Focus settings to change; a setting left out stays as it is."""

    model_config = shown_as({"mode": "tiltPlane", "smoothingS": 0.25, "maxAngleDeg": 12.0})

    mode: FocusMode | None = Field(default=None, description=_DESCRIPTIONS["mode"])
    solve_stop: bool | None = Field(default=None, description=_DESCRIPTIONS["solve_stop"])
    circle_of_confusion_mm: Positive | None = Field(default=None, description=_DESCRIPTIONS["circle_of_confusion_mm"])
    smoothing_s: Positive | None = Field(default=None, description=_DESCRIPTIONS["smoothing_s"])
    lag_s: Positive | None = Field(default=None, description=_DESCRIPTIONS["lag_s"])
    dead_zone_mm: Positive | None = Field(default=None, description=_DESCRIPTIONS["dead_zone_mm"])
    max_speed_deg_s: Positive | None = Field(default=None, description=_DESCRIPTIONS["max_speed_deg_s"])
    near_priority: Annotated[float, Field(ge=0, le=16)] | None = Field(
        default=None, description=_DESCRIPTIONS["near_priority"]
    )
    off_screen: OffScreen | None = Field(default=None, description=_DESCRIPTIONS["off_screen"])
    occluded: Occluded | None = Field(default=None, description=_DESCRIPTIONS["occluded"])
    surface_exponent: Annotated[float, Field(ge=1, le=16)] | None = Field(
        default=None, description=_DESCRIPTIONS["surface_exponent"]
    )
    expressive: Ratio | None = Field(default=None, description=_DESCRIPTIONS["expressive"])
    field_offsets: FieldOffsets | None = Field(default=None, description=_DESCRIPTIONS["field_offsets"])
    tilt_deg: Angle | None = Field(default=None, description=_DESCRIPTIONS["tilt_deg"])
    swing_deg: Angle | None = Field(default=None, description=_DESCRIPTIONS["swing_deg"])
    rise_mm: Offset | None = Field(default=None, description=_DESCRIPTIONS["rise_mm"])
    shift_mm: Offset | None = Field(default=None, description=_DESCRIPTIONS["shift_mm"])
    driven_by_points: bool | None = Field(default=None, description=_DESCRIPTIONS["driven_by_points"])
    max_angle_deg: Annotated[float, Field(ge=0, le=89)] | None = Field(
        default=None, description=_DESCRIPTIONS["max_angle_deg"]
    )
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
