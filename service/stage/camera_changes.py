"""Apply functions of the changes that create, copy and place cameras; `service.stage.changes` registers them with the others."""

from __future__ import annotations

from dataclasses import dataclass

from render.errors import SettingsError
from render.shot import Shot
from render.shot.camera.placing import CameraPlace
from service.models.camera_changes import (
    CreateCamera,
    DuplicateCamera,
    FrameSubject,
    MoveCamera,
    MoveCameraKeys,
    ResetCameraPlace,
    UnkeyCamera,
)
from service.models.curve import MAX_CURVE_FRAMES


@dataclass(frozen=True)
class CreatedCamera:
    """A camera that a change created.

    Attributes:
        path: its prim path.
    """

    path: str


@dataclass(frozen=True)
class EditedCamera:
    """The camera that changes are applied to.

    Attributes:
        shot: the opened shot, inside a transaction of its edits.
        path: prim path of the camera; None for the default camera.
        max_curve_frames: largest number of frames of an imported curve.
        author: of added notes; empty where senders are not known by name.
    """

    shot: Shot
    path: str | None
    max_curve_frames: int = MAX_CURVE_FRAMES
    author: str = ""


def _create_camera(change: CreateCamera, camera: EditedCamera) -> CreatedCamera:
    return CreatedCamera(camera.shot.camera.create(change.name, change.time))


def _duplicate_camera(change: DuplicateCamera, camera: EditedCamera) -> CreatedCamera:
    return CreatedCamera(camera.shot.camera.duplicate(camera.path, change.name))


def _move_camera(change: MoveCamera, camera: EditedCamera) -> None:
    place = CameraPlace(change.position_m, change.ahead, change.up)
    camera.shot.camera.move(camera.path, place, change.time, is_keyed=change.keyed)


def _frame_subject(change: FrameSubject, camera: EditedCamera) -> None:
    camera.shot.plan.frame_subject(
        camera.path, change.point, change.time, is_keyed=change.keyed, share=change.share, aspect=change.aspect
    )


def _unkey_camera(change: UnkeyCamera, camera: EditedCamera) -> None:
    camera.shot.camera.remove_place_key(camera.path, change.time)


def _move_camera_keys(change: MoveCameraKeys, camera: EditedCamera) -> None:
    moves = {move.time: move.new_time for move in change.moves}
    if len(moves) < len(change.moves):
        raise SettingsError("a key of the camera's place moves once", code="bad_key", path="moves")
    camera.shot.camera.move_place_keys(camera.path, moves)


def _reset_place(change: ResetCameraPlace, camera: EditedCamera) -> None:
    camera.shot.camera.give_back_place(camera.path)


CAMERA_CHANGES = (
    _create_camera,
    _duplicate_camera,
    _move_camera,
    _frame_subject,
    _unkey_camera,
    _move_camera_keys,
    _reset_place,
)
"""Each is for the type of change that its first argument names."""
