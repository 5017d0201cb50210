"""Renders: jobs of many frames, their tasks and the attempts at these."""

from __future__ import annotations

import re
from datetime import datetime
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, ValidationInfo, field_validator, model_validator
from pydantic.config import JsonDict

from render.engines import check_settings
from render.errors import SettingsError
from render.model.aovs import AOVS, PRIMVAR_PREFIX
from render.model.burn_in import Fact
from render.model.frame_settings import FrameSettings
from service.models.base import Model, PrimPath, shown_as
from service.models.frames import FrameQuery, PictureOptions
from service.models.render_products import PRODUCTS, ProductName, RenderProduct, needs_pictures

RenderState = Literal[
    "queued", "running", "pause-requested", "paused", "cancel-requested", "canceled", "failed", "done"
]
FrameFormat = Literal["exr", "png", "jpeg"]
MovieFormat = Literal["mp4", "mov", "webm"]
TaskState = Literal["ready", "running", "done", "failed", "canceled"]

AOV_PATTERN = rf"^({'|'.join(aov.name for aov in AOVS)}|{PRIMVAR_PREFIX}[^\s,\x00-\x1f\x7f]+)$"
MOST_AOVS = 32
"""AOVs of one render."""


def _check_aov_name(name: str) -> str:
    if not re.fullmatch(AOV_PATTERN, name):
        known = ", ".join(aov.name for aov in AOVS)
        raise ValueError(f"an AOV is one of {known}, {PRIMVAR_PREFIX}NAME")
    return name


AovName = Annotated[
    str, AfterValidator(_check_aov_name), Field(max_length=200, json_schema_extra={"pattern": AOV_PATTERN})
]

RENDER_EXAMPLE: JsonDict = {
    "id": "r-5f0c1d2e3a4b",
    "name": "night tram, dailies",
    "shot": "demo",
    "revision": "5a302e56c1d04f7b",
    "project": "default",
    "owner": "Mara's laptop",
    "state": "running",
    "priority": 50,
    "frames": "1-96",
    "width": 480,
    "rays": 16,
    "formats": ["exr", "png"],
    "aovs": ["depth", "coc"],
    "burnIn": [],
    "lens": None,
    "products": [{"name": "movie.mp4", "state": "waiting", "sizeBytes": None, "error": None}],
    "count": 96,
    "ready": 70,
    "running": 1,
    "done": 25,
    "failed": 0,
    "canceled": 0,
    "accepted": False,
    "waitsFor": [],
    "createdAt": "2026-11-27T08:00:00Z",
    "startedAt": "2026-11-27T08:00:01Z",
    "finishedAt": None,
    "secondsLeft": 142.0,
}
REQUEST_EXAMPLE: JsonDict = {
    "shot": "demo",
    "name": "night tram, dailies",
    "frames": "1-96:2",
    "width": 480,
    "rays": 16,
    "formats": ["exr", "png"],
    "aovs": ["depth", "coc"],
    "products": ["movie.mp4"],
}
TASK_EXAMPLE: JsonDict = {
    "frame": 25,
    "state": "done",
    "files": [
        {
            "format": "exr",
            "sizeBytes": 1_482_112,
            "sha256": "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
        }
    ],
    "attempts": [
        {
            "number": 1,
            "worker": "camera-pc",
            "startedAt": "2026-11-27T08:00:40Z",
            "endedAt": "2026-11-27T08:00:42Z",
            "outcome": "done",
            "error": None,
        }
    ],
}


class RenderRequest(PictureOptions):
    """A render: which frames of a shot, how, and into what files. It keeps the edits that the shot has when it is sent."""

    model_config = shown_as(REQUEST_EXAMPLE)

    shot: str = Field(max_length=80, description="Id of the shot.")
    name: str = Field(default="", max_length=200, description="For people and files; that of the shot when left out.")
    camera: PrimPath | None = Field(default=None, description="Prim path; the shot's default camera when left out.")
    frames: str | None = Field(
        default=None,
        max_length=4000,
        description="In the grammar of Open Job Description, such as `1-10:2,15`; the whole shot when left out.",
    )
    width: int = Field(default=960, ge=1, le=8192, description="px")
    height: int | None = Field(
        default=None, ge=1, le=8192, description="px; from the camera's film gate when left out."
    )
    formats: list[FrameFormat] = Field(
        default=["exr"],
        max_length=3,
        description="Files of each frame, all of one drawing: `exr` is scene-linear light, the others the graded picture. None "
        "where every product needs no picture: then no frame is drawn.",
        json_schema_extra={"uniqueItems": True},
    )
    aovs: list[AovName] = Field(
        default=[],
        max_length=MOST_AOVS,
        description="AOVs in the EXR files beside the colour, each a part of its own, such as `depth`, `coc` or `primvars:st`.",
        json_schema_extra={"uniqueItems": True},
    )
    burn_in: list[Fact] = Field(
        default=[],
        max_length=12,
        description="Facts written into the corners of the graded pictures, and so of movies; EXR files have them as metadata.",
        json_schema_extra={"uniqueItems": True},
    )
    lens: str | None = Field(
        default=None,
        max_length=80,
        description="Lens of the library, in place of the camera's; the camera's own when left out.",
    )
    products: list[ProductName] = Field(
        default=[],
        max_length=len(PRODUCTS),
        description="What is made as the last part of the job. Movies and contact sheets are made of the stored graded pictures.",
        json_schema_extra={"uniqueItems": True},
    )
    priority: int = Field(default=50, ge=0, le=100, description="Renders of a higher one come first.")
    after: list[Annotated[str, Field(max_length=80)]] = Field(
        default=[],
        max_length=16,
        description="Ids of renders that have to be done before its frames are drawn.",
    )

    @field_validator("formats")
    @classmethod
    def check_formats(cls, formats: list[FrameFormat]) -> list[FrameFormat]:
        """Refuse a format that comes twice."""
        if len(set(formats)) < len(formats):
            raise ValueError("each format may come once")
        return formats

    @field_validator("aovs")
    @classmethod
    def check_aovs(cls, aovs: list[str], info: ValidationInfo) -> list[str]:
        """Refuse AOVs that come twice, that no file holds, or that the engine does not draw."""
        if len(set(aovs)) < len(aovs):
            raise ValueError("each AOV may come once")
        if aovs and "exr" not in info.data.get("formats", ["exr"]):
            raise ValueError("AOVs are parts of EXR files: add exr to the formats, or leave them out")
        chosen = info.data.get("engine")
        if chosen:  # else it was refused itself
            try:
                check_settings(FrameSettings(engine=chosen, aovs=tuple(aovs)))
            except SettingsError as error:
                raise ValueError(error.detail) from error
        return aovs

    @field_validator("burn_in")
    @classmethod
    def check_burn_in(cls, facts: list[Fact], info: ValidationInfo) -> list[Fact]:
        """Refuse facts that come twice, or that no file shows."""
        if len(set(facts)) < len(facts):
            raise ValueError("each fact may come once")
        if facts and not {"png", "jpeg"} & set(info.data.get("formats", ["exr"])):
            raise ValueError("facts are burnt into graded pictures: add png or jpeg to the formats, or leave them out")
        return facts

    @field_validator("products")
    @classmethod
    def check_products(cls, products: list[ProductName], info: ValidationInfo) -> list[ProductName]:
        """Refuse products that come twice, or that the files of the frames do not allow."""
        if len(set(products)) < len(products):
            raise ValueError("each product may come once")
        formats = info.data.get("formats", ["exr"])
        pictured = [name for name in products if needs_pictures(name)]
        if pictured and not {"png", "jpeg"} & set(formats):
            raise ValueError(
                f"{pictured[0]} is made of graded pictures: add png or jpeg to the formats, or leave it out"
            )
        return products

    @model_validator(mode="after")
    def check_use(self) -> RenderRequest:
        """Refuse a render that would make nothing."""
        if not self.formats and not self.products:
            raise ValueError("a render without formats draws no frame: name formats, or products")
        return self

    def picture(self, frame: float) -> FrameQuery:
        """Return the request of one of its frames."""
        own = {"shot", "name", "frames", "formats", "aovs", "burn_in", "lens", "products", "priority", "after"}
        return FrameQuery.model_validate(self.model_dump(exclude=own) | {"time": frame})


class Render(Model):
    """A render and how far it is."""

    model_config = shown_as(RENDER_EXAMPLE)

    id: str = Field(description="Its name in URLs.")
    name: str
    shot: str = Field(description="Id of the shot.")
    revision: str = Field(description="Revision of the edits that are rendered.")
    project: str = Field(description="Project of the shot.")
    owner: str = Field(description="Who sent it.")
    state: RenderState = Field(
        description="`pause-requested` and `cancel-requested` last until the frames that are drawn have ended."
    )
    priority: int
    frames: str = Field(description="All frames, as a range.")
    width: int = Field(description="Width of the pictures, px.")
    rays: int = Field(description="Lens rays for each pixel.")
    formats: list[FrameFormat] = Field(description="Files of each frame.")
    aovs: list[str] = Field(description="AOVs in the EXR files.")
    burn_in: list[Fact] = Field(default_factory=list, description="Facts in the corners of the graded pictures.")
    lens: str | None = Field(default=None, description="Lens in place of the camera's; null for the camera's own.")
    products: list[RenderProduct] = Field(default_factory=list, description="What is made beside the frames.")
    count: int = Field(description="Number of frames that are drawn; 0 for a render without formats.")
    ready: int = Field(description="Frames that wait.")
    running: int = Field(description="Frames that are drawn.")
    done: int = Field(description="Frames that are stored.")
    failed: int = Field(description="Frames that could not be drawn.")
    canceled: int = Field(description="Frames that were given up.")
    accepted: bool = Field(description="Whether frames that failed or were given up are not wanted any more.")
    waits_for: list[str] = Field(description="Ids of renders that have to be done before, and are not yet.")
    created_at: datetime
    started_at: datetime | None = Field(description="Time at which the first frame or product was begun.")
    finished_at: datetime | None
    seconds_left: float | None = Field(
        description="Expected time until its frames are drawn, s, if no other render is; null before the first frame and after "
        "the last one."
    )


class RenderList(Model):
    """Renders, the newest first."""

    model_config = shown_as({"renders": [RENDER_EXAMPLE], "next": None})

    renders: list[Render]
    next: str | None = Field(description="What `before` continues the list with; null at its end.")


class Attempt(Model):
    """An attempt at a frame."""

    number: int = Field(description="From 1 on.")
    worker: str = Field(description="Who drew it.")
    started_at: datetime
    ended_at: datetime | None
    outcome: Literal["done", "failed", "lost", "given-back"] | None = Field(
        description="null while it goes on; `lost`: its worker is gone; `given-back`: it was not finished, and nothing was wrong."
    )
    error: str | None = Field(description="What went wrong.")


class RenderedFile(Model):
    """A stored file of a frame."""

    format: FrameFormat
    size_bytes: int = Field(description="Size, bytes.")
    sha256: str = Field(description="Hash of its content, in hexadecimal digits.")


class RenderTask(Model):
    """A frame of a render."""

    model_config = shown_as(TASK_EXAMPLE)

    frame: int
    state: TaskState
    files: list[RenderedFile] = Field(description="Its files; none before it is stored.")
    attempts: list[Attempt] = Field(description="The first one first.")


class RenderTaskList(Model):
    """The frames of a render in rising order."""

    model_config = shown_as({"tasks": [TASK_EXAMPLE]})

    tasks: list[RenderTask]
