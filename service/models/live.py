"""Live pictures: what travels over the WebSocket beside the pictures themselves."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, Field
from pydantic.config import JsonDict

from service.models.base import Model, Problem, shown_as
from service.models.cameras import Readout

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


class LiveAck(Model):
    """Says that a picture has arrived, and with it all before it."""

    model_config = shown_as({"ack": 7})

    ack: Annotated[int, Field(ge=0)] = Field(description="The `picture` of its head.")


class LiveStop(Model):
    """Says that nothing of what was asked for is wanted any more."""

    model_config = shown_as({"stop": True})

    stop: Literal[True]


class LiveTiming(Model):
    """What a picture took, in milliseconds, and what went into it."""

    model_config = shown_as(TIMING_EXAMPLE)

    read_ms: Milliseconds = Field(description="To read the scene and focus the camera.")
    peel_ms: Milliseconds = Field(description="To peel the layers; 0 where those of a picture before still held.")
    blur_ms: Milliseconds = Field(description="To blur them, or to trace rays through them.")
    finish_ms: Milliseconds = Field(description="To expose, develop and grade.")
    total_ms: Milliseconds = Field(description="From when the work was begun to when this picture was there.")
    encode_ms: Milliseconds = Field(description="To make a file of it.")
    answered_ms: Milliseconds = Field(
        description="From when the service had the request to when it had this picture to send."
    )
    rays: int = Field(description="Lens rays for each pixel so far; 0 where a picture was blurred instead.")
    scale: float = Field(description="Pixels of this picture for each that was asked for, along a side.")
    share: float = Field(description="Of the final picture's work that is done.")


class LivePictureHead(Model):
    """What stands before a picture."""

    model_config = shown_as(
        {
            "id": 3,
            "picture": 7,
            "stage": "preview",
            "final": False,
            "format": "jpeg",
            "width": 480,
            "height": 270,
            "timing": TIMING_EXAMPLE,
        }
    )

    id: int = Field(description="Of the request.")
    picture: int = Field(description="Counts the pictures of this connection, for `ack`.")
    stage: Stage = Field(
        description="`preview`: the best that could be had in time. `refining`: more rays than before. `final`: the whole of it."
    )
    final: bool = Field(description="Whether it is the last of its request: the one that `getFrame` and `record` give.")
    format: Literal["jpeg", "png"] = Field(description="What follows; a final picture is lossless.")
    width: int = Field(description="px; less than was asked for in a preview.")
    height: int = Field(description="px")
    timing: LiveTiming


class LiveReadout(Model):
    """What the lens does in the picture of a request that had an edit with it."""

    id: int = Field(description="Of the request.")
    readout: Readout


class LiveProblem(Model):
    """Why a request has no picture, or no further one."""

    id: int | None = Field(description="Of the request; null where what was sent is none.")
    status: int = Field(description="The HTTP status that the same problem has elsewhere.")
    problem: Problem
