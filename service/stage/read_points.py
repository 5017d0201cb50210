"""Models of focus points and their keys, read from the opened shot. Runs in the stage process."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, get_args

from render.errors import NotFoundError
from render.shot import PlacedPoint, Shot
from service.edit_context import tag_of
from service.models.base import Vector3
from service.models.focus import (
    FocusPoint,
    FocusPointCreate,
    FocusPointEdit,
    FocusPointList,
    Key,
    KeyedAttribute,
    PointSharpness,
    Tangents,
)
from service.stage.read_cameras import camera_tag, is_framed
from usd_schemas import FocusPoint as AuthoredPoint
from usd_schemas import Key as AuthoredKey
from usd_schemas import LensCamera
from usd_schemas.settings.focus_point import FocusPointColor
from usd_schemas.settings.tables import rest_settings

_NAMES = {item.field_name: item.name for item in rest_settings("focusPoint")}
"""Names of the schema by those of REST's models."""


def read_points(shot: Shot, camera: str | None, time: float, aspect: float | None = None) -> list[FocusPoint]:
    """Read the focus points of a camera and their positions in its picture."""
    return [_point(shot, camera, placed) for placed in shot.focus.points(camera, time, aspect=aspect)]


def point_list(shot: Shot, camera: str | None, time: float, aspect: float | None = None) -> FocusPointList:
    """Read the focus points of a camera and their positions in its picture, with the tag of the list."""
    points = read_points(shot, camera, time, aspect)
    return FocusPointList(etag=points_tag(shot, camera), focus_points=points)


def read_point(shot: Shot, camera: str | None, time: float, name: str) -> FocusPoint:
    """Read one focus point.

    Raises:
        NotFoundError: the camera has no such point.
    """
    for placed in shot.focus.points(camera, time):
        if placed.point.name == name:
            return _point(shot, camera, placed)
    raise NotFoundError(f"the camera has no focus point named {name!r}", code="point_not_found", path=name)


def _point(shot: Shot, camera: str | None, placed: PlacedPoint) -> FocusPoint:
    point = placed.point
    authored = {field: getattr(point, name) for field, name in _NAMES.items()}
    if point.color not in get_args(FocusPointColor):  # it harms no picture; `inspect` reports it
        authored["color"] = "none"
    return FocusPoint(
        **authored,
        name=point.name,
        position_m=_finite_position(placed.position_m),
        depth_m=placed.depth_m,
        screen=placed.screen,
        visible_in_frame=placed.visible_in_frame,
        state=placed.state,
        share=placed.share,
        **_sharpness_fields(placed),
        problem=placed.problem,
        keys=_keys(shot, camera, point.name),
        etag=point_tag(shot, camera, point.name),
    )


def point_sharpness(placed: PlacedPoint) -> PointSharpness:
    """Return how sharp a focus point is."""
    return PointSharpness(name=placed.point.name, depth_m=placed.depth_m, **_sharpness_fields(placed))


def _sharpness_fields(placed: PlacedPoint) -> dict[str, Any]:
    return {"coc_mm": placed.coc_mm, "focus_distance_m": placed.focus_distance_m, "sharp": placed.is_sharp}


def point_names(shot: Shot, camera: str | None) -> list[str]:
    """Return the names of all focus points of a camera; a framing camera has none. Raises `CameraError`."""
    if is_framed(shot, camera):
        return []
    camera_tag(shot, camera)
    path = camera or shot.default_camera().path
    return [view.name for view in LensCamera(shot.stage.GetPrimAtPath(path)).focus_points()]


def points_tag(shot: Shot, camera: str | None) -> str:
    """Return the entity tag of the edits of all focus points of a camera. Raises `CameraError`."""
    return tag_of("points", *(() if is_framed(shot, camera) else shot.focus.edited_properties(camera)))


def point_tag(shot: Shot, camera: str | None, name: str) -> str:
    """Return the entity tag of the edits of a focus point. Raises `NotFoundError`."""
    return tag_of("point", *shot.focus.edited_properties(camera, name))


def _finite_position(position: Sequence[float] | None) -> Vector3 | None:
    if position is None or not all(map(math.isfinite, position)):
        return None
    x, y, z = position
    return x, y, z


def _keys(shot: Shot, camera: str | None, name: str) -> dict[KeyedAttribute, list[Key]]:
    attributes: tuple[KeyedAttribute, ...] = get_args(KeyedAttribute)
    keys = {attribute: shot.focus.keys(camera, name, attribute) for attribute in attributes}
    return {attribute: [key_model(key) for key in keyed] for attribute, keyed in keys.items() if keyed}


def key_model(key: AuthoredKey) -> Key:
    """Return a key as a model; switches are 0 and 1."""
    finite = key.tangents is not None and all(map(math.isfinite, vars(key.tangents).values()))
    tangents = Tangents.model_validate(key.tangents) if finite else None
    return Key(time=key.time, value=float(key.value), interpolation=key.interpolation, tangents=tangents)


def authored_point(name: str, point: FocusPointCreate) -> AuthoredPoint:
    """Return a focus point as the schema has it."""
    return AuthoredPoint(name=name, **_schema_fields(point.model_dump(exclude={"name"})))


def point_fields(edit: FocusPointEdit) -> dict[str, Any]:
    """Return the values of an edit by the schema's names, without those that were left out."""
    return _schema_fields(edit.model_dump(exclude_none=True))


def _schema_fields(values: dict[str, Any]) -> dict[str, Any]:
    return {_NAMES[field]: value for field, value in values.items()}


def free_name(shot: Shot, camera: str | None, time: float) -> str:
    """Return a name that no focus point of the camera has."""
    taken = {placed.point.name for placed in shot.focus.points(camera, time)}
    return next(name for name in (f"point{n}" for n in range(1, len(taken) + 2)) if name not in taken)
