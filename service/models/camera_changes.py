"""Changes of an edit that create, copy and place cameras, and of the keys of their place."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import FailFast, Field

from service.models.base import Length, Model, PointName, TimeCode, shown_as


class CreateCamera(Model):
    """Create a camera from the view that a shot without one is shown through; the changes after it are made to that camera.

    It has the position, direction and focus distance of that view, a Super 35 body, and a thin lens that has all of the view in
    its picture. It is refused where the shot is shown through a camera of its own.
    """

    model_config = shown_as({"type": "createCamera", "time": 24})

    type: Literal["createCamera"] = "createCamera"
    name: PointName | None = Field(
        default=None, description="Of its prim, at the root of the stage. Left out: `main_cam`, or a free name like it."
    )
    time: TimeCode | None = Field(
        default=None, description="USD time code of the view, which holds for all time. Left out: the shot's first."
    )


class DuplicateCamera(Model):
    """Copy the camera beside itself, with its lens, body, focus points, film and keys; the changes after it are made to the copy.

    Lights and other prims below the camera are not copied.
    """

    model_config = shown_as({"type": "duplicateCamera"})

    type: Literal["duplicateCamera"] = "duplicateCamera"
    name: PointName | None = Field(
        default=None, description="Of its prim. Left out: the camera's own, with the next free number behind it."
    )


class MoveCamera(Model):
    """Place the camera in the world. It goes on to move with what it is below.

    A key leaves the keys at other times as they are; the first one of a camera that stands still holds for all time. A camera
    that turns between its keys gets a key at each frame first, so that it goes on to turn as it did.
    """

    model_config = shown_as(
        {
            "type": "moveCamera",
            "positionM": [0.0, 1.6, 0.5],
            "ahead": [0.0, 0.0, -1.0],
            "up": [0.0, 1.0, 0.0],
            "time": 24,
            "keyed": True,
        }
    )

    type: Literal["moveCamera"] = "moveCamera"
    position_m: tuple[Length, Length, Length] = Field(
        description="Of its origin in the world, metres, +Y up, as in `top-view`."
    )
    ahead: tuple[Length, Length, Length] = Field(
        description="Direction of the optical axis in the world, of any length above 0."
    )
    up: tuple[Length, Length, Length] = Field(
        default=(0.0, 1.0, 0.0),
        description="Direction that is up in the picture, of any length above 0; what of it lies along the axis does not count.",
    )
    time: TimeCode = Field(description="USD time code at which it is there.")
    keyed: bool = Field(
        default=False,
        description="Whether it gets a key at the time. Else all of its way is moved along with it, and keeps its shape.",
    )


class FrameSubject(Model):
    """Place the camera so that the subject of a focus point fills a share of the picture; it keeps its direction.

    The subject is the bounds of what the point follows: of its part, or of the prim that it is on; of a ball these are framed
    exactly. Where there are none, the picture is 0.6 m high at the point. An orthographic camera keeps its depth.
    """

    model_config = shown_as({"type": "frameSubject", "point": "pip", "time": 24, "keyed": True})

    type: Literal["frameSubject"] = "frameSubject"
    point: PointName = Field(description="Name of the focus point.")
    time: TimeCode = Field(description="USD time code at which it is framed.")
    keyed: bool = Field(
        default=False,
        description="Whether the camera gets a key at the time. Else all of its way is moved along, and keeps its shape.",
    )
    share: float = Field(
        default=2 / 3,
        gt=0,
        lt=1,
        description="Of the picture's width or height that the subject fills, whichever is filled first.",
    )
    aspect: float | None = Field(
        default=None, ge=0.01, le=100, description="Width over height of the picture; the film gate's when left out."
    )


class UnkeyCamera(Model):
    """Remove a key of the camera's place, of the edits or of the shot; after the last one its place there stays for all time."""

    model_config = shown_as({"type": "unkeyCamera", "time": 24})

    type: Literal["unkeyCamera"] = "unkeyCamera"
    time: TimeCode = Field(description="USD time code of the key.")


class CameraKeyMove(Model):
    """A key of the camera's place, and where it moves to in time."""

    model_config = shown_as({"time": 24, "newTime": 30})

    time: TimeCode = Field(description="USD time code of the key.")
    new_time: TimeCode = Field(description="USD time code that it comes to.")


class MoveCameraKeys(Model):
    """Move keys of the camera's place in time, all at once. Other keys that stand where one arrives are replaced."""

    model_config = shown_as({"type": "moveCameraKeys", "moves": [{"time": 24, "newTime": 30}]})

    type: Literal["moveCameraKeys"] = "moveCameraKeys"
    moves: Annotated[tuple[CameraKeyMove, ...], FailFast()] = Field(
        min_length=1, max_length=20_000, description="A key moves once, and no two of them come to one time."
    )


class ResetCameraPlace(Model):
    """Take the camera back to where the shot itself has it over all of its time; the edits of its place go, with their keys."""

    model_config = shown_as({"type": "resetCameraPlace"})

    type: Literal["resetCameraPlace"] = "resetCameraPlace"
