"""Models of cameras, read from the opened shot. Runs in the stage process."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel, ValidationError

from render.errors import CameraError
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.shot import Readout as LensReadout
from render.shot import Shot
from render.shot.focus.place_readout import PlaceReadout as LensPlaceReadout
from render.stage import read_camera
from service.edit_context import tag_of
from service.models.base import Finding, Vector3
from service.models.cameras import CameraList, CameraPlace, CameraState, PlaceKey, PlaceReadout, Readout
from service.models.shots import CameraChoice

Settings = TypeVar("Settings", bound=BaseModel)

CAMERA_FIELDS = set(CameraState.model_fields) - {"path", "time", "focus_mode", "lens_name", "lens_model", "etag"}

_FRAMING_TAG = tag_of("framing")
"""Entity tag of a framing camera, which has no edits."""


def default_camera_model(shot: Shot) -> CameraChoice:
    """Return the camera used where a request names none."""
    choice = shot.default_camera()
    return CameraChoice(path=choice.path, reason=choice.reason)


def read_cameras(shot: Shot, time: float) -> CameraList:
    """Read the cameras of a shot at one time; those whose numbers make no picture are listed apart."""
    usable, unusable = [], []
    for path in shot.cameras():
        try:
            usable.append(read_camera_state(shot, path, time))
        except CameraError as error:
            unusable.append(Finding(path=path, detail=error.detail))
    framing = shot.default_camera().framing
    if framing is not None:
        usable.append(_camera_state(framing, None, time, "manual", _FRAMING_TAG))
    return CameraList(default=default_camera_model(shot), cameras=usable, unusable=unusable)


def read_camera_state(shot: Shot, path: str | None, time: float) -> CameraState:
    """Read a camera with its own film gate, its focus solved, and its stop where focus points set it.

    Raises:
        CameraError: it is no camera, or has impossible values.
    """
    readout = shot.focus.read(path, time)
    authored = read_camera(shot.stage, readout.camera, time)
    distance_m = readout.focus_distance_m + authored.set_back_m
    camera = replace(authored, focus_distance_m=distance_m, f_stop=readout.f_stop)
    return _camera_state(camera, readout.camera, time, readout.focus_mode, camera_tag(shot, path))


def _camera_state(camera: Camera, path: str | None, time: float, focus_mode: str, etag: str) -> CameraState:
    values = {name: getattr(camera, name) for name in CAMERA_FIELDS}
    values |= {"focus_distance_m": camera.stated_focus_m, "focal_length_mm": camera.stated_focal_length_mm}
    lens = {"lens_name": camera.lens.name, "lens_model": camera.lens.model}
    return CameraState.model_validate(
        values | lens | {"path": path, "time": time, "focus_mode": focus_mode, "etag": etag}
    )


def read_place_of_camera(shot: Shot, path: str | None, time: float) -> CameraPlace:
    """Read where a camera is at one time, and the keys of its place. Raises `CameraError`."""
    framing = shot.default_camera().framing if path is None else None
    edited = set() if framing else shot.camera.edited_place_keys(path)
    keys = [] if framing else [PlaceKey(time=key, edited=key in edited) for key in shot.camera.place_keys(path)]
    camera = framing or read_camera(shot.stage, path or shot.default_camera().path or "", time)
    _, up, back, pupil = np.asarray(camera.world_from_camera, np.float64)[:3].T
    return CameraPlace(
        camera=camera.path or None,
        time=time,
        position_m=_vector(pupil - camera.set_back_m * back),
        ahead=_vector(-back),
        up=_vector(up),
        keys=keys,
        edited=framing is None and shot.camera.is_placed(path),
        in_shot=framing is None and shot.camera.has_own_place(path),
        etag=view_tag(shot, path),
    )


def _vector(values: DoubleArray) -> Vector3:
    x, y, z = values.tolist()
    return x, y, z


def readout_model(readout: LensReadout, time: float) -> Readout:
    """Return a lens readout as a model."""
    angles = {"tilt_deg": math.degrees(readout.tilt_rad), "swing_deg": math.degrees(readout.swing_rad)}
    values = {name: getattr(readout, name) for name in set(Readout.model_fields) - {"time", *angles}}
    return Readout.model_validate(values | angles | {"time": time})


def place_readout_model(readout: LensPlaceReadout, camera: str | None, time: float, point: str | None) -> PlaceReadout:
    """Return a lens readout at a point of the picture as a model."""
    return PlaceReadout.model_validate(
        {**vars(readout), "sharp": readout.is_sharp, "camera": camera, "time": time, "point": point}
    )


def settings_model(model: type[Settings], values: Mapping[str, Any]) -> Settings:
    """Validate the settings of a camera, which a file may have authored with impossible values.

    Args:
        model: it has the fields ``camera`` and ``time``.
        values: values by the names of its fields.

    Raises:
        CameraError: a value is impossible.
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


def camera_tag(shot: Shot, camera: str | None) -> str:
    """Return the entity tag of the edits of a camera, its focus points aside. Raises `CameraError`."""
    return tag_of("camera", *shot.camera.edited_properties(camera))


def is_framed(shot: Shot, camera: str | None) -> bool:
    """Whether a shot is shown by a framing camera, which is no prim, where this camera is asked for."""
    return camera is None and shot.default_camera().framing is not None


def view_tag(shot: Shot, camera: str | None) -> str:
    """Return the entity tag as `camera_tag` does, or that of the framing camera. Raises `CameraError`."""
    return _FRAMING_TAG if is_framed(shot, camera) else camera_tag(shot, camera)
