"""Requests for frames."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from render.model.frame_settings import MAX_MOTION, MOST_NOISE, FrameSettings
from service.models.base import Model, PrimPath, TimeCode, shown_as
from service.models.engines import ENGINE_HELP, EngineName


class SizedFrame(Model):
    """A frame seen by a camera, and the size of its picture."""

    is_text = True

    camera: PrimPath | None = Field(
        default=None, description="Prim path; the shot's default camera when left out.", examples=["/World/main_cam"]
    )
    time: TimeCode = Field(description="USD time code.", examples=[24])
    width: int = Field(default=960, ge=1, le=8192, description="px", examples=[960])
    height: int | None = Field(
        default=None, ge=1, le=8192, description="px; from the camera's film gate when left out.", examples=[540]
    )


class PictureOptions(Model):
    """Settings of a picture: the engine, its rays, and film and grade."""

    engine: EngineName = Field(default=FrameSettings.engine, description=ENGINE_HELP, examples=[FrameSettings.engine])
    rays: int = Field(default=100, ge=1, description="Lens rays for each pixel.", examples=[100])
    adaptive: bool = Field(
        default=FrameSettings.adaptive,
        description="More rays where the picture has more noise, so that `rays` is their mean.",
        examples=[True],
    )
    noise: float = Field(
        default=FrameSettings.noise,
        ge=0,
        le=MOST_NOISE,
        description="Wanted standard error in values of the displayed picture from 0 to 1, in place of `rays`; 0 for none.",
        examples=[0.01],
    )
    connections: bool = Field(
        default=FrameSettings.connections,
        description="Carries small bright things to the pixels of their blurred images, which leaves less noise.",
        examples=[True],
    )
    layers: int = Field(default=4, ge=1, description="Layers peeled at most.", examples=[4])
    supersample: float = Field(
        default=FrameSettings.supersample,
        ge=0,
        description="Layer pixels for each picture pixel along each axis; 0 for as many as suit the engine and its rays.",
        examples=[2],
    )
    wavelengths: int = Field(
        default=3,
        ge=1,
        le=64,
        description="Wavelengths traced through a lens that has colour errors: 3 is one a channel, more a smoother spectrum, 1 "
        "leaves colour errors out.",
        examples=[3],
    )
    motion: int = Field(
        default=1,
        ge=1,
        le=MAX_MOTION,
        description="Moments of the shutter's opening that the rays are spread over; 1 freezes motion.",
        examples=[1],
    )
    motion_by: Literal["moments", "velocities"] = Field(
        default="moments",
        description="`moments` draws the scene at each moment, which is exact; `velocities` draws it once and moves it along "
        "straight lines, which is much quicker.",
        examples=["velocities"],
    )
    shading: Literal["lit", "unlit"] = Field(
        default="lit", description="`unlit`: base colour as radiance.", examples=["lit"]
    )
    seed: int = Field(default=0, ge=0, description="Seed of the sampling pattern.", examples=[0])
    film: str | None = Field(
        default=None,
        max_length=80,
        description="Stock of the film library; the shot's own when left out.",
        examples=["velvia_50"],
    )
    display: str | None = Field(
        default=None,
        max_length=200,
        description="Display of the OpenColorIO configuration, in place of the shot's.",
        examples=["sRGB - Display"],
    )
    view: str | None = Field(
        default=None, max_length=200, description="View of the display, in place of the shot's.", examples=["Raw"]
    )
    look: str | None = Field(
        default=None,
        max_length=200,
        description="Looks of the configuration, separated by commas, in place of the shot's; empty for none.",
        examples=[""],
    )


class PictureQuery(PictureOptions, SizedFrame):
    """A frame and how it is rendered."""


MAX_STATES = 1000
"""Frames whose states are read at once: the focus of each is solved."""


class PictureState(Model):
    """State of the picture of a frame: a digest of all that it depends on."""

    time: TimeCode = Field(description="USD time code.", examples=[24])
    state: str | None = Field(
        description="Digest of the camera, its exposure and film, the solved focus, and all edits of anything else; null where "
        "no picture can be made.",
        examples=["9c2b670164472ae10e72acb941365fc3"],
    )


class PictureStates(Model):
    """States of the pictures of some frames."""

    model_config = shown_as(
        {"revision": "5a302e56c1d04f7b", "states": [{"time": 24.0, "state": "9c2b670164472ae10e72acb941365fc3"}]}
    )

    revision: str = Field(
        description="Revision of the edits that they are of, which pictures have in the header `Pullfocus-Revision`.",
        examples=["5a302e56c1d04f7b"],
    )
    states: list[PictureState]


class FrameQuery(PictureQuery):
    """A frame, how it is rendered, and the file format."""

    format: Literal["png", "jpeg", "exr"] = Field(
        default="png", description="`exr` is scene-linear light, the others the graded picture.", examples=["png"]
    )
    live: bool = Field(
        default=False,
        description="Computes film and grade on the graphics device, which is quicker and may differ by one of 256 levels. "
        "Without it the picture is the one that the command line writes.",
        examples=[False],
    )
    client: str | None = Field(
        default=None,
        max_length=64,
        description="Name of a client. A newer frame request of the same client for the same shot replaces those that still "
        "wait, which are answered 409 `superseded`. Left out: nothing is superseded.",
        examples=["viewer-1"],
    )
