"""From an opened shot to models. Runs in the stage process, the one that imports USD."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError

from render.errors import CameraError, NotFoundError, SettingsError, StageError
from render.model.camera import Camera
from render.model.edit_history import revision_of
from render.model.frame_spec import parse_frames
from render.shot import PlacedPoint
from render.shot import Readout as OpenReadout
from render.shot import Shot as OpenShot
from render.shot.focus.place_readout import PlaceReadout as OpenPlaceReadout
from render.shot.inspection import inspect_shot
from render.stage import read_camera
from service.edit_context import tag_of
from service.models.base import Finding, Vector3
from service.models.cameras import CameraList, CameraState, PlaceReadout, Readout
from service.models.focus import (
    FocusPoint,
    FocusPointCreate,
    FocusPointEdit,
    FocusPointList,
    Key,
    KeyedAttribute,
    Tangents,
)
from service.models.inspection import Inspection, Note, ValidationFinding
from service.models.shots import CameraChoice, FrameRange, Shot, ShotSummary
from service.stage.opened import as_sent
from service.storage.store import ShotRecord
from usd_schemas import FocusPoint as AuthoredPoint
from usd_schemas import Key as AuthoredKey
from usd_schemas import LensCamera

Told = TypeVar("Told", bound=BaseModel)

# The one name that differs between REST and the schema: it carries its unit.
FIELD_OF_NAME = {"blur_mm": "blur"}
CAMERA_NAMES = set(CameraState.model_fields) - {"path", "time", "focus_mode", "lens_name", "lens_model", "etag"}
AUTHORED_NAMES = tuple(FocusPointEdit.model_fields)


def describe(record: ShotRecord, shot: OpenShot) -> Shot:
    """A shot and what does not change while it is looked at."""
    return Shot(
        **ShotSummary.model_validate(record).model_dump(),
        revision=revision_of(record.edit_text()),
        frame_range=_frame_range(shot),
        cameras=shot.cameras(),
        default_camera=_default_camera(shot),
    )


def inspect(record: ShotRecord, shot: OpenShot) -> Inspection:
    """What a shot holds at its first frame, what of it is not honoured, and what is wrong with its cameras."""
    frame_range = _frame_range(shot)
    found = inspect_shot(shot)
    return Inspection(
        frame_range=frame_range,
        up_axis=found.up_axis,
        meters_per_unit=found.metres_per_unit,
        cameras=list(found.cameras),
        default_camera=_default_camera(shot),
        readouts=[as_readout(lens, frame_range.start) for lens in found.readouts],
        prim_count=found.prim_count,
        triangle_count=found.triangle_count,
        light_count=found.light_count,
        notes=[
            Note(code=note.code, path=as_sent(note.path, record), message=as_sent(note.message, record))
            for note in found.notes
        ],
        validation=[ValidationFinding.model_validate(problem) for problem in found.validation],
    )


def as_readout(lens: OpenReadout, time: float) -> Readout:
    """The lens in numbers."""
    angles = {"tilt_deg": math.degrees(lens.tilt_rad), "swing_deg": math.degrees(lens.swing_rad)}
    said = {name: getattr(lens, name) for name in set(Readout.model_fields) - {"time", *angles}}
    return Readout.model_validate(said | angles | {"time": time})


def as_place_readout(read: OpenPlaceReadout, camera: str | None, time: float, point: str | None) -> PlaceReadout:
    """The lens at one place, in numbers."""
    return PlaceReadout.model_validate(
        {**vars(read), "sharp": read.is_sharp, "camera": camera, "time": time, "point": point}
    )


def _frame_range(shot: OpenShot) -> FrameRange:
    found = shot.frame_range
    if not all(map(math.isfinite, (found.start, found.end, found.frames_per_second))):
        raise StageError(f"the frame range of the stage is not finite: {found}", code="bad_frame_range")
    return FrameRange.model_validate(found)


def _default_camera(shot: OpenShot) -> CameraChoice:
    choice = shot.default_camera()
    return CameraChoice(path=choice.path, reason=choice.reason)


def told_of_camera(model: type[Told], values: Mapping[str, Any]) -> Told:
    """A model of what a camera says, where all of that can be told.

    Args:
        model: it has the fields ``camera`` and ``time``.
        values: by the names of its fields.

    Raises:
        CameraError: a number is none, as somebody's file may have it.
    """
    try:
        return model.model_validate(values)
    except ValidationError as error:
        first = error.errors()[0]
        field, path = str(first["loc"][0]), values["camera"]
        raise CameraError(
            f"{field} of camera {path} at {values['time']:g} is {first['input']!r}: {first['msg'].lower()}",
            code="bad_number",
            path=path,
        ) from error


def read_cameras(shot: OpenShot, time: float) -> CameraList:
    """The cameras of a shot at one time; those whose numbers make no picture are told apart."""
    usable, unusable = [], []
    for path in shot.cameras():
        try:
            usable.append(read_camera_state(shot, path, time))
        except CameraError as error:
            unusable.append(Finding(path=path, detail=error.detail))
    choice = shot.default_camera()
    if choice.framing is not None:
        usable.append(_camera_state(choice.framing, None, time, "manual", tag_of("framing")))
    return CameraList(default=_default_camera(shot), cameras=usable, unusable=unusable)


def read_camera_state(shot: OpenShot, path: str | None, time: float) -> CameraState:
    """A camera with its own film gate, its focus solved, and its stop where the points set it.

    Raises:
        CameraError: it is no camera, or has impossible numbers.
    """
    lens = shot.focus.read(path, time)
    own = read_camera(shot.stage, lens.camera, time)
    camera = replace(own, focus_distance_m=lens.focus_distance_m, f_stop=lens.f_stop)
    return _camera_state(camera, lens.camera, time, lens.focus_mode, camera_tag(shot, path))


def _camera_state(camera: Camera, path: str | None, time: float, focus_mode: str, etag: str) -> CameraState:
    values = {name: getattr(camera, name) for name in CAMERA_NAMES}
    values["focus_distance_m"] = camera.focus_distance_m or math.inf  # a scene's camera may say 0 for infinity
    lens = {"lens_name": camera.lens.name, "lens_model": camera.lens.model}
    return CameraState.model_validate(
        values | lens | {"path": path, "time": time, "focus_mode": focus_mode, "etag": etag}
    )


def read_points(shot: OpenShot, camera: str | None, time: float, aspect: float | None = None) -> list[FocusPoint]:
    """The focus points of a camera as they stand in its picture."""
    return [_point(shot, camera, placed) for placed in shot.focus.points(camera, time, aspect=aspect)]


def point_list(shot: OpenShot, camera: str | None, time: float, aspect: float | None = None) -> FocusPointList:
    """The focus points of a camera as they stand in its picture, with the tag of the list."""
    points = read_points(shot, camera, time, aspect)
    return FocusPointList(etag=points_tag(shot, camera), focus_points=points)


def read_point(shot: OpenShot, camera: str | None, time: float, name: str) -> FocusPoint:
    """One of them.

    Raises:
        NotFoundError: the camera has no such point.
    """
    for placed in shot.focus.points(camera, time):
        if placed.point.name == name:
            return _point(shot, camera, placed)
    raise NotFoundError(f"the camera has no focus point named {name!r}", code="point_not_found", path=name)


def _point(shot: OpenShot, camera: str | None, placed: PlacedPoint) -> FocusPoint:
    point = placed.point
    authored = {name: getattr(point, FIELD_OF_NAME.get(name, name)) for name in AUTHORED_NAMES}
    return FocusPoint(
        **authored,
        name=point.name,
        position_m=_place(placed.position_m),
        depth_m=placed.depth_m,
        screen=placed.screen,
        visible_in_frame=placed.visible_in_frame,
        state=placed.state,
        share=placed.share,
        coc_mm=placed.coc_mm,
        problem=placed.problem,
        keys=_keys(shot, camera, point.name),
        etag=point_tag(shot, camera, point.name),
    )


def point_names(shot: OpenShot, camera: str | None) -> list[str]:
    """Names of the focus points of a camera, wherever they are. Raises `CameraError`."""
    camera_tag(shot, camera)
    path = camera or shot.default_camera().path
    return [view.name for view in LensCamera(shot.stage.GetPrimAtPath(path)).focus_points()]


def camera_tag(shot: OpenShot, camera: str | None) -> str:
    """Tag of what is edited on a camera, its focus points aside. Raises `CameraError`."""
    return tag_of("camera", *shot.camera.edited_properties(camera))


def points_tag(shot: OpenShot, camera: str | None) -> str:
    """Tag of what is edited on all focus points of a camera. Raises `CameraError`."""
    framed = camera is None and shot.default_camera().framing is not None
    return tag_of("points", *(() if framed else shot.focus.edited_properties(camera)))


def point_tag(shot: OpenShot, camera: str | None, name: str) -> str:
    """Tag of what is edited on one of them. Raises `NotFoundError`."""
    return tag_of("point", *shot.focus.edited_properties(camera, name))


def _place(position: Sequence[float] | None) -> Vector3 | None:
    if position is None or not all(map(math.isfinite, position)):
        return None
    x, y, z = position
    return x, y, z


def _keys(shot: OpenShot, camera: str | None, name: str) -> dict[KeyedAttribute, list[Key]]:
    attributes: tuple[KeyedAttribute, ...] = get_args(KeyedAttribute)
    found = {attribute: shot.focus.keys(camera, name, attribute) for attribute in attributes}
    return {attribute: [as_key(key) for key in keys] for attribute, keys in found.items() if keys}


def as_key(key: AuthoredKey) -> Key:
    """A key; switches are 0 and 1."""
    finite = key.tangents is not None and all(map(math.isfinite, vars(key.tangents).values()))
    tangents = Tangents.model_validate(key.tangents) if finite else None
    return Key(time=key.time, value=float(key.value), interpolation=key.interpolation, tangents=tangents)


def new_point(name: str, wanted: FocusPointCreate) -> AuthoredPoint:
    """A focus point as the schema has it."""
    return AuthoredPoint(name=name, **_schema_fields(wanted.model_dump(exclude={"name"})))


def point_fields(edit: FocusPointEdit) -> dict[str, Any]:
    """What to change, by the schema's names: what was sent, and null means what was left out."""
    return _schema_fields(edit.model_dump(exclude_none=True))


def _schema_fields(values: dict[str, Any]) -> dict[str, Any]:
    return {FIELD_OF_NAME.get(name, name): value for name, value in values.items()}


def free_name(shot: OpenShot, camera: str | None, time: float) -> str:
    """A name that no focus point of the camera has."""
    taken = {placed.point.name for placed in shot.focus.points(camera, time)}
    return next(name for name in (f"point{n}" for n in range(1, len(taken) + 2)) if name not in taken)


def curve_frames(shot: OpenShot, spec: str | None, most: int) -> list[float]:
    """The frames of a curve: those that were asked for, or the whole shot.

    Raises:
        SettingsError: the specification cannot be read, or they are too many.
    """
    if spec is not None:
        frames = parse_frames(spec)
        count = len(frames)
    else:
        whole = _frame_range(shot)
        count = max(1, math.floor(whole.end - whole.start) + 1)
    if count > most:
        raise SettingsError(f"a focus curve of {count:,} frames was asked for; at most {most:,} come at once")
    return frames if spec is not None else [whole.start + n for n in range(count)]
