"""Functions of the stage process that read and change cameras."""

from __future__ import annotations

from service.edit_context import EditContext
from service.models.cameras import CameraList, CameraPlace, CameraState, PlaceReadout, Readout
from service.models.changes import MountLensFile, SetCamera
from service.stage.editing import apply_in_context
from service.stage.opened import OpenedShot, stage_function
from service.stage.read_cameras import (
    place_readout_model,
    read_camera_state,
    read_cameras,
    read_place_of_camera,
    readout_model,
)
from service.storage.store import ShotRecord


@stage_function
def list_cameras(opened: OpenedShot, record: ShotRecord, time: float) -> CameraList:
    """Read the cameras at one time. Those whose numbers make no picture are listed apart."""
    with opened.use(record) as shot:
        return read_cameras(shot, time)


@stage_function
def read_camera(opened: OpenedShot, record: ShotRecord, camera: str | None, time: float) -> CameraState:
    """Read one camera at one time. Raises `CameraError`."""
    with opened.use(record) as shot:
        return read_camera_state(shot, camera, time)


@stage_function
def read_camera_place(opened: OpenedShot, record: ShotRecord, camera: str | None, time: float) -> CameraPlace:
    """Read where a camera is at one time, and the keys of its place. Raises `CameraError`."""
    with opened.use(record) as shot:
        return read_place_of_camera(shot, camera, time)


@stage_function
def change_camera(
    opened: OpenedShot,
    record: ShotRecord,
    camera: str | None,
    change: SetCamera | MountLensFile,
    time: float | None,
    context: EditContext,
) -> CameraState:
    """Change a camera or its lens, and read it at a time; None is the first frame.

    Raises:
        CameraError: there is no such camera.
        SettingsError: a value is not allowed.
        InputError: a lens file is none, or its numbers make no lens.
    """
    with opened.edit(record, context) as shot:
        apply_in_context(shot, camera, [change], context)
        return read_camera_state(shot, camera, shot.frame_range.start if time is None else time)


@stage_function
def read_lens(opened: OpenedShot, record: ShotRecord, camera: str | None, time: float) -> Readout:
    """Compute the readout of the lens at one time. Raises `CameraError`."""
    with opened.use(record) as shot:
        return readout_model(shot.focus.read(camera, time), time)


@stage_function
def read_place(
    opened: OpenedShot,
    record: ShotRecord,
    camera: str | None,
    time: float,
    place: str | tuple[tuple[float, float], float],
    aspect: float | None,
) -> PlaceReadout:
    """Compute the readout of the lens at a point of the picture, or at a focus point.

    Args:
        opened: the open shots.
        record: the shot.
        camera: prim path, or None for the default camera.
        time: USD time code.
        place: name of a focus point, or a position in the picture (0 to 1) and the depth there in metres.
        aspect: width over height of the picture; None takes the film gate's.

    Raises:
        CameraError: it is no camera.
        NotFoundError: the camera has no such focus point.
        InputError: the point cannot be read.
    """
    with opened.use(record) as shot:
        path = camera or shot.default_camera().path
        if isinstance(place, str):
            at = shot.focus.read_at_point(camera, time, place, aspect=aspect)
            return place_readout_model(at, path, time, place)
        screen, depth_m = place
        at = shot.focus.read_at(camera, time, screen, depth_m, aspect=aspect)
        return place_readout_model(at, path, time, None)
