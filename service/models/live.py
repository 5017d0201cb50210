"""Messages of live pictures on a WebSocket, other than the pictures themselves."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, FailFast, Field
from pydantic.config import JsonDict

from service.models.base import Model, PrimPath, Problem, TimeCode, shown_as
from service.models.cameras import Readout
from service.models.changes import MAX_CHANGES, Change
from service.models.focus import PointSharpness
from service.models.frames import PictureQuery

TIMING_EXAMPLE: JsonDict = {
    "readMs": 9.1,
    "peelMs": 31.0,
    "blurMs": 24.2,
    "finishMs": 6.3,
    "totalMs": 74.0,
    "encodeMs": 3.1,
    "answeredMs": 84.5,
    "rays": 0,
    "scale": 0.5,
    "share": 0.0,
}

Milliseconds = Annotated[float, AfterValidator(lambda ms: round(ms, 1))]
Stage = Literal["preview", "refining", "final"]


class LiveRequest(PictureQuery):
    """Requests pictures of a frame, in place of the request before."""

    is_text = False

    id: int = Field(
        ge=0, le=2**53 - 1, description="Number of the request, which is repeated in its answers.", examples=[3]
    )
    moving: bool = Field(
        default=False,
        description="True while a pointer moves: one picture, the best in that time. Otherwise pictures get better up "
        "to the final one.",
        examples=[True],
    )
    budget_ms: float = Field(
        default=100, ge=1, le=60_000, description="Time for the first picture, milliseconds.", examples=[100]
    )
    focus_maps: bool = Field(
        default=False,
        description="Whether the first picture, except while others wait, and the final one come with a focus map. "
        "That takes about as long as a layer. A picture that is kept comes with the map that is kept, if any; `getFocusMap` has "
        "it in any case.",
        examples=[True],
    )
    changes: Annotated[tuple[Change, ...], Field(max_length=MAX_CHANGES), FailFast()] = Field(
        default=(), description="Changes that are tried in these pictures and not kept: those that an edit takes."
    )


class LiveAck(Model):
    """Acknowledges a picture and all before it."""

    model_config = shown_as({"ack": 7})

    ack: Annotated[int, Field(ge=0)] = Field(description="The `picture` in the head of the picture.")


class LiveStop(Model):
    """Cancels all requests."""

    model_config = shown_as({"stop": True})

    stop: Literal[True]


class LivePlace(Model):
    """A place of a shot that somebody looks at."""

    camera: PrimPath | None = Field(default=None, description="Prim path; null for the default camera.")
    time: TimeCode = Field(description="USD time code.")


class LiveHere(Model):
    """Tells where the client looks while it asks for no picture, such as where it plays pictures that it has kept."""

    model_config = shown_as({"here": {"camera": "/World/main_cam", "time": 40}})

    here: LivePlace


class LiveTiming(Model):
    """Times of a picture in milliseconds, and its quality."""

    model_config = shown_as(TIMING_EXAMPLE)

    read_ms: Milliseconds = Field(description="Time to read the scene and focus the camera.")
    peel_ms: Milliseconds = Field(
        description="Time to peel the layers; 0 where those of an earlier picture were reused."
    )
    blur_ms: Milliseconds = Field(description="Time to blur the layers, or to trace rays through them.")
    finish_ms: Milliseconds = Field(description="Time to expose, develop and grade.")
    total_ms: Milliseconds = Field(description="Time from the begin of the work to this picture.")
    encode_ms: Milliseconds = Field(description="Time to encode the picture.")
    answered_ms: Milliseconds = Field(
        description="Time from the arrival of the request to the moment when this picture could be sent."
    )
    rays: int = Field(description="Lens rays per pixel so far; 0 where the picture was blurred instead.")
    scale: float = Field(description="Pixels of this picture per requested pixel, along one side.")
    share: float = Field(description="Share of the final picture's work that is done.")


class LivePictureHead(Model):
    """Head of a picture message."""

    model_config = shown_as(
        {
            "id": 3,
            "picture": 7,
            "stage": "preview",
            "final": False,
            "format": "jpeg",
            "width": 480,
            "height": 270,
            "focusMapBytes": 0,
            "timing": TIMING_EXAMPLE,
        }
    )

    id: int = Field(description="Number of the request.")
    picture: int = Field(description="Number of the picture on this connection, for `ack`.")
    stage: Stage = Field(
        description="`preview`: the best within the time. `refining`: more rays than before. `final`: the exact picture."
    )
    final: bool = Field(
        description="True for the last picture of its request, which is the one of `getFrame` and `record`."
    )
    format: Literal["jpeg", "png"] = Field(description="Format of the picture; a final one is lossless.")
    width: int = Field(description="px; a preview may be smaller than requested.")
    height: int = Field(description="px")
    focus_map_bytes: int = Field(
        description="Bytes of the focus map that follows the picture in the message: that of `getFocusMap`, which may have fewer "
        "pixels than the picture. 0 where there is none."
    )
    timing: LiveTiming


class LiveReadout(Model):
    """Lens readout of a request with changes, and the sharpness of its focus points."""

    id: int = Field(description="Number of the request.")
    readout: Readout
    points: list[PointSharpness] = Field(description="Sharpness of the focus points.")


class LiveProblem(Model):
    """Reason why a request has no picture, or no further one."""

    id: int | None = Field(description="Number of the request; null where the message was no request.")
    status: int = Field(description="HTTP status of the same problem.")
    problem: Problem


class LiveViewer(Model):
    """A live connection of the shot that sees the others, and is seen."""

    id: str = Field(description="Of the connection, as long as it is open: a person may have several.")
    name: str = Field(description="Name for people; `anyone` where senders are not known by name.")
    number: int = Field(
        description="From 1, another one for each viewer of the shot; free again once the viewer is gone."
    )
    camera: str | None = Field(
        description="Prim path; null for the default camera, or where no picture was asked for yet."
    )
    time: float | None = Field(description="USD time code; null where no picture was asked for yet.")


class LiveViewers(Model):
    """Those who look at the shot, and where. It is sent where `viewers` asks for it, when it has changed."""

    model_config = shown_as(
        {
            "you": "5f0c1d2e3a4b",
            "viewers": [
                {"id": "5f0c1d2e3a4b", "name": "Ines", "number": 1, "camera": "/World/main_cam", "time": 40.0},
                {"id": "77aebf18a086", "name": "Jon", "number": 2, "camera": "/World/main_cam", "time": 64.0},
            ],
        }
    )

    you: str = Field(description="Id of this connection.")
    viewers: list[LiveViewer] = Field(description="In the order in which they came, this connection among them.")
