"""The edit language: one model for each change that an edit of a shot is made of.

REST, the live pictures and the page speak it, and the resource routes make one change each. A change is made by its apply
function in `service.stage.changes`; a new one is a model here, in `Change`, and a function there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, Self

from pydantic import FailFast, Field, model_validator

from service.models.base import (
    MAX_POINT_NAME,
    FileContent,
    FileName,
    Length,
    Model,
    PointName,
    PrimPath,
    Ratio,
    TimeCode,
    shown_as,
)
from service.models.camera_changes import (
    CreateCamera,
    DuplicateCamera,
    FrameSubject,
    MoveCamera,
    MoveCameraKeys,
    ResetCameraPlace,
    UnkeyCamera,
)
from service.models.cameras import CameraEdit
from service.models.curve import MAX_CURVE_FRAMES
from service.models.exposure import ExposureKeyed, ExposureSettingsEdit
from service.models.film_settings import FilmKeyed, FilmSettingsEdit
from service.models.focus import (
    ANCHOR_EXAMPLE,
    KEY_EXAMPLE,
    Anchor,
    FocusPointCreate,
    FocusPointEdit,
    KeyedAttribute,
    KeyEdit,
    TangentsEdit,
)
from service.models.notes import AddNote, DeleteNote, EditNote
from service.models.solving import RACK_EXAMPLE, CameraKeyed, FocusSettingsEdit, RackCreate

MAX_CHANGES = 1024
"""Changes in one edit, which takes about a second: each move of a key is a removal and a new key."""

KeyedSetting = CameraKeyed | ExposureKeyed | FilmKeyed

Stops = Annotated[float, Field(ge=-100, le=100)]
GapPolicy = Literal["refuse", "hold", "interpolate"]

UsdName = Annotated[str, Field(min_length=1, max_length=MAX_POINT_NAME)]
PointNameInShot = Annotated[str, Field(min_length=1, max_length=MAX_POINT_NAME)]
_KEY_TIME = "USD time code of the key."
_POINT = "Name of the focus point."


class AddPoint(Model):
    """Add a focus point. Where the camera is focused by hand, its points focus it from then on."""

    model_config = shown_as({"type": "addPoint", "point": ANCHOR_EXAMPLE | {"name": "visor"}})

    type: Literal["addPoint"] = "addPoint"
    point: FocusPointCreate


class MovePoint(Model):
    """Move a focus point to an anchor, to the surface that is seen at a place of the picture, or to a position in the world.

    A point that follows the bounds of a part goes on to follow them where the new target is at or below the part, and follows the
    new surface elsewhere. A point that is moved to a position stays with what it is on, at another `offset` from it.
    """

    model_config = shown_as({"type": "movePoint", "name": "pip", "place": [0.43, 0.55], "time": 24})

    type: Literal["movePoint"] = "movePoint"
    name: PointNameInShot = Field(description=_POINT)
    anchor: Anchor | None = Field(default=None, description="Where to, as a pick gives it.")
    place: tuple[Ratio, Ratio] | None = Field(
        default=None,
        description="In place of an anchor: from (0, 0) in the picture's top left corner to (1, 1) in the bottom right one, "
        "in the picture before the edit. Where nothing is seen, an edit is refused, and a live picture leaves the point.",
    )
    position_m: tuple[Length, Length, Length] | None = Field(
        default=None, description="In place of an anchor: where to in the world at the time, metres, +Y up."
    )
    time: TimeCode = Field(description="USD time code of the picture, and of the key of what has keys.")

    @model_validator(mode="after")
    def _has_one_target(self) -> Self:
        if [self.anchor, self.place, self.position_m].count(None) != 2:
            raise ValueError("a focus point moves to an anchor, a place or a position, expected one of the three")
        return self


class FollowPart(Model):
    """Let a focus point follow the bounds of a part, such as a whole character, in place of its surface.

    The point stays where it is at the time: `boundsPoint` becomes its place in the bounds there.
    """

    model_config = shown_as({"type": "followPart", "name": "visor", "part": "/World/Cast/Mara", "time": 24})

    type: Literal["followPart"] = "followPart"
    name: PointNameInShot = Field(description=_POINT)
    part: PrimPath | None = Field(
        description="Prim path: usually of a prim above the point's target. null: back to the place on the target's surface."
    )
    time: TimeCode = Field(description="USD time code at which the point stays where it is.")


class AlterPoint(Model):
    """Alter values of a focus point."""

    model_config = shown_as({"type": "alterPoint", "name": "pip", "values": {"weight": 0.5}, "time": 24})

    type: Literal["alterPoint"] = "alterPoint"
    name: PointNameInShot = Field(description=_POINT)
    values: FocusPointEdit
    time: TimeCode = Field(description="USD time code: a value that has keys gets one there, others hold for all time.")


class RenamePoint(Model):
    """Rename a focus point, which keeps its values and keys."""

    model_config = shown_as({"type": "renamePoint", "name": "pip", "newName": "robot"})

    type: Literal["renamePoint"] = "renamePoint"
    name: PointNameInShot = Field(description=_POINT)
    new_name: PointName = Field(description="A name that no other focus point of the camera has.")


class RemovePoint(Model):
    """Remove a focus point and its keys."""

    model_config = shown_as({"type": "removePoint", "name": "pip"})

    type: Literal["removePoint"] = "removePoint"
    name: PointNameInShot = Field(description=_POINT)


class KeyPoint(Model):
    """Set a key of a focus point's attribute; one at the same time is replaced."""

    model_config = shown_as({"type": "keyPoint", "name": "pip", "attribute": "weight", "key": KEY_EXAMPLE})

    type: Literal["keyPoint"] = "keyPoint"
    name: PointNameInShot = Field(description=_POINT)
    attribute: KeyedAttribute
    key: KeyEdit


class UnkeyPoint(Model):
    """Remove a key of a focus point's attribute; after the last one its value stays for all time."""

    model_config = shown_as({"type": "unkeyPoint", "name": "pip", "attribute": "weight", "time": 24})

    type: Literal["unkeyPoint"] = "unkeyPoint"
    name: PointNameInShot = Field(description=_POINT)
    attribute: KeyedAttribute
    time: TimeCode = Field(description=_KEY_TIME)


class SetPointTangents(Model):
    """Set the tangents of a key of a focus point's attribute, which makes it a bezier key. Its value stays."""

    model_config = shown_as(
        {
            "type": "setPointTangents",
            "name": "pip",
            "attribute": "weight",
            "time": 24,
            "tangents": {"inSlope": 0.0, "inWidth": 4.0, "outSlope": 0.0, "outWidth": 4.0},
        }
    )

    type: Literal["setPointTangents"] = "setPointTangents"
    name: PointNameInShot = Field(description=_POINT)
    attribute: KeyedAttribute
    time: TimeCode = Field(description=_KEY_TIME)
    tangents: TangentsEdit


class ChooseVariant(Model):
    """Choose a variant of a prim's variant set."""

    model_config = shown_as({"type": "chooseVariant", "prim": "/World/Tram", "variantSet": "livery", "variant": "day"})

    type: Literal["chooseVariant"] = "chooseVariant"
    prim: PrimPath
    variant_set: UsdName = Field(description="Name of the variant set.")
    variant: UsdName | Literal[""] | None = Field(
        description="Name of the variant; empty for none of them; null takes the edit back, for what the shot itself chooses."
    )


class ShowPayload(Model):
    """Make a prim with a payload part of the shot or not, by its activation."""

    model_config = shown_as({"type": "showPayload", "prim": "/World/Tram", "shown": False})

    type: Literal["showPayload"] = "showPayload"
    prim: PrimPath
    shown: bool | None = Field(description="null takes the edit back, for what the shot itself says.")


class SetCamera(Model):
    """Set f-number, focal length, focus distance or focus mode, or mount a lens or a body of the library."""

    model_config = shown_as({"type": "setCamera", "values": {"fStop": 2.8, "lens": "planar_50"}})

    type: Literal["setCamera"] = "setCamera"
    values: CameraEdit


class SetFocus(Model):
    """Set how the focus is found: the mode, the solver, the hand on the ring, tilt and shift."""

    model_config = shown_as({"type": "setFocus", "values": {"mode": "tiltPlane", "maxAngleDeg": 12.0}})

    type: Literal["setFocus"] = "setFocus"
    values: FocusSettingsEdit


class SetExposure(Model):
    """Set how the camera exposes: stop, shutter, sensitivity, filters and meter."""

    model_config = shown_as({"type": "setExposure", "values": {"iso": 800, "shutterAngleDeg": 172.8}})

    type: Literal["setExposure"] = "setExposure"
    values: ExposureSettingsEdit


class SetFilm(Model):
    """Put a film stock in the camera, or set film, sensor and grade."""

    model_config = shown_as({"type": "setFilm", "values": {"stock": "5219", "push": 1}})

    type: Literal["setFilm"] = "setFilm"
    values: FilmSettingsEdit


class KeySetting(Model):
    """Set a key of a camera's setting; one at the same time is replaced. `focusDistanceM` is focused by hand from then on."""

    model_config = shown_as({"type": "keySetting", "setting": "focusDistanceM", "key": KEY_EXAMPLE | {"value": 3.5}})

    type: Literal["keySetting"] = "keySetting"
    setting: KeyedSetting
    key: KeyEdit


class UnkeySetting(Model):
    """Remove a key of a camera's setting; after the last one its value stays for all time."""

    model_config = shown_as({"type": "unkeySetting", "setting": "focusDistanceM", "time": 24})

    type: Literal["unkeySetting"] = "unkeySetting"
    setting: KeyedSetting
    time: TimeCode = Field(description=_KEY_TIME)


class SetSettingTangents(Model):
    """Set the tangents of a key of a camera's setting, which makes it a bezier key. Its value stays."""

    model_config = shown_as(
        {
            "type": "setSettingTangents",
            "setting": "focusDistanceM",
            "time": 24,
            "tangents": {"inSlope": 0.0, "inWidth": 4.0, "outSlope": 0.0, "outWidth": 4.0},
        }
    )

    type: Literal["setSettingTangents"] = "setSettingTangents"
    setting: KeyedSetting
    time: TimeCode = Field(description=_KEY_TIME)
    tangents: TangentsEdit


class SimplifySetting(Model):
    """Replace the keys of a camera's setting, such as those of an imported curve, by fewer that make nearly the same curve.

    An edit has at most one for each setting. Where there are no fewer, the keys stay.
    """

    model_config = shown_as({"type": "simplifySetting", "setting": "focusDistanceM", "tolerance": 0.02})

    type: Literal["simplifySetting"] = "simplifySetting"
    setting: KeyedSetting
    tolerance: float = Field(
        default=0.02,
        ge=1e-4,
        lt=1,
        description="How far the curve may be off: a share of the value for distances, f-numbers and the like, else of the span "
        "of the values.",
    )


class MeteredStops(Model):
    """Reading of a light meter at one frame."""

    time: TimeCode = Field(description="USD time code.")
    compensation_stops: Stops | None = Field(
        description="As `meter` gives it; null for a black frame, which is bridged."
    )


class KeyExposure(Model):
    """Expose as a light meter says, by keys of `compensationStops`; the meter itself decides nothing from then on."""

    model_config = shown_as({"type": "keyExposure", "readings": [{"time": 24, "compensationStops": -1.0}]})

    type: Literal["keyExposure"] = "keyExposure"
    readings: Annotated[tuple[MeteredStops, ...], FailFast()] = Field(
        min_length=1, max_length=MAX_CURVE_FRAMES, description="In order of time."
    )
    held: bool = Field(default=False, description="One exposure for all of them, in place of keys.")


class MakeRack(Model):
    """Rack the focus from one focus point to another, by keys of their weights."""

    model_config = shown_as({"type": "rack", "rack": RACK_EXAMPLE})

    type: Literal["rack"] = "rack"
    rack: RackCreate


class ImportCurve(Model):
    """Put a focus curve that another tool made onto the camera, which is focused by hand from then on."""

    model_config = shown_as({"type": "importCurve", "content": "ZnJhbWUsZm9jdXNfZGlzdGFuY2VfbQoxLDMuNQo="})

    type: Literal["importCurve"] = "importCurve"
    content: FileContent = Field(description="A csv, json, OpenTrackIO or OpenTimelineIO file, in base64.")
    gaps: GapPolicy = Field(default="refuse", description="Treatment of rows that are missing or cannot be used.")
    first_frame: TimeCode | None = Field(
        default=None,
        description="Time code where the file's first frame comes to lie. Left out: frame numbers are kept, and what ran by "
        "timecode begins where the shot does.",
    )
    baked: bool = Field(default=False, description="Time samples in place of splines.")


class MountLensFile(Model):
    """Mount the lens of a lens file: its glass, its focal length, and no wider an f-number than it has."""

    model_config = shown_as(
        {"type": "mountLensFile", "fileName": "plano-convex.dat", "content": "MzAgNCAxLjUxNjggMjAK"}
    )

    type: Literal["mountLensFile"] = "mountLensFile"
    file_name: FileName = Field(description="Its extension names the format.")
    content: FileContent = Field(description="A lens file: .dat, .zmx, .seq, .txt, .roa, .json or .lens, in base64.")


Change = Annotated[
    AddPoint
    | MovePoint
    | FollowPart
    | AlterPoint
    | RenamePoint
    | RemovePoint
    | KeyPoint
    | UnkeyPoint
    | SetPointTangents
    | CreateCamera
    | DuplicateCamera
    | MoveCamera
    | FrameSubject
    | UnkeyCamera
    | MoveCameraKeys
    | ResetCameraPlace
    | ChooseVariant
    | ShowPayload
    | SetCamera
    | SetFocus
    | SetExposure
    | SetFilm
    | KeySetting
    | UnkeySetting
    | SetSettingTangents
    | SimplifySetting
    | KeyExposure
    | MakeRack
    | ImportCurve
    | MountLensFile
    | AddNote
    | EditNote
    | DeleteNote,
    Field(discriminator="type"),
]


PictureSpot = tuple[tuple[float, float], float]
"""A place of the picture, 0 to 1 from its top left corner, and the USD time code of the picture."""


def picture_spots(changes: Sequence[Change]) -> list[PictureSpot]:
    """Places of the picture that changes name in place of anchors."""
    places = [(change.place, change.time) for change in changes if isinstance(change, MovePoint)]
    return list(dict.fromkeys((place, time) for place, time in places if place is not None))


def anchor_spots(changes: Sequence[Change], anchors: Mapping[PictureSpot, Anchor | None]) -> tuple[Change, ...]:
    """Changes with anchors in place of places of the picture.

    Args:
        changes: of an edit.
        anchors: of the surfaces seen at `picture_spots`; None for no surface, which leaves the change out.
    """
    anchored: list[Change] = []
    for change in changes:
        if not isinstance(change, MovePoint) or change.place is None:
            anchored.append(change)
        elif (anchor := anchors[change.place, change.time]) is not None:
            anchored.append(change.model_copy(update={"anchor": anchor, "place": None}))
    return tuple(anchored)
