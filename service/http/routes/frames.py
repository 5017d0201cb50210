"""Frames and picks: what the process that owns GL is asked for."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Header, Query, Response
from pydantic import Field

from render.model.edit_history import revision_of
from render.model.frame_settings import MAX_MOTION, FrameSettings
from service.http.frame_cache import frame_tag, matches
from service.http.routes.parameters import ShotId, problems
from service.http.service import Service, ServiceDep
from service.models.base import Model, PrimPath, TimeCode
from service.models.engines import ENGINE_HELP, EngineName
from service.models.focus import Pick
from service.models.picture_size import check_pixels
from service.models.shots import PickRequest
from service.picture.calls import frames
from service.picture.requests import FrameRequest
from service.storage.store import ShotRecord
from service.workers.calls import call

router = APIRouter(tags=["frames"])

MEDIA_TYPES = {"png": "image/png", "jpeg": "image/jpeg", "exr": "image/x-exr"}
BINARY = {"schema": {"type": "string", "format": "binary"}}
FINISH = {"film", "display", "view", "look"}


class PictureQuery(Model):
    """Which frame, and how it is rendered."""

    camera: PrimPath | None = Field(
        default=None, description="Prim path; the shot's default camera when left out.", examples=["/World/Camera"]
    )
    time: TimeCode = Field(description="USD time code.", examples=[24])
    width: int = Field(default=960, ge=1, le=8192, description="px", examples=[960])
    height: int | None = Field(
        default=None, ge=1, le=8192, description="px; from the camera's film gate when left out.", examples=[540]
    )
    engine: EngineName = Field(default=FrameSettings.engine, description=ENGINE_HELP, examples=[FrameSettings.engine])
    rays: int = Field(default=100, ge=1, description="Lens rays for each pixel.", examples=[100])
    layers: int = Field(default=4, ge=1, description="Layers peeled at most.", examples=[4])
    supersample: float = Field(default=2, ge=1, description="Layer pixels for each picture pixel.", examples=[2])
    wavelengths: int = Field(
        default=3,
        ge=1,
        le=64,
        description="Of light, traced through a lens that has colour errors: 3 is one for each channel, more a smoother "
        "spectrum, 1 leaves colour errors out.",
        examples=[3],
    )
    motion: int = Field(
        default=1,
        ge=1,
        le=MAX_MOTION,
        description="Moments of the shutter's opening to look at, over which the rays are spread; 1 stops all motion.",
        examples=[1],
    )
    motion_by: Literal["moments", "velocities"] = Field(
        default="moments",
        description="`moments` draws the scene at each of them, which is exact; `velocities` draws it once, and things move "
        "straight on over the opening: much quicker.",
        examples=["velocities"],
    )
    shading: Literal["lit", "unlit"] = Field(
        default="lit", description="`unlit`: base colour as radiance.", examples=["lit"]
    )
    seed: int = Field(default=0, ge=0, description="Of the sampling pattern.", examples=[0])
    film: str | None = Field(
        default=None,
        max_length=80,
        description="Shoots it on this stock of the film library; what the shot says when left out.",
        examples=["velvia_50"],
    )
    display: str | None = Field(
        default=None,
        max_length=200,
        description="Of the OpenColorIO configuration, in place of the shot's.",
        examples=["sRGB - Display"],
    )
    view: str | None = Field(
        default=None, max_length=200, description="Of the display, in place of the shot's.", examples=["Raw"]
    )
    look: str | None = Field(
        default=None,
        max_length=200,
        description="Looks of the configuration with commas between, in place of the shot's; empty for none.",
        examples=[""],
    )


class FrameQuery(PictureQuery):
    """Which frame, how it is rendered, and what comes of it."""

    format: Literal["png", "jpeg", "exr"] = Field(
        default="png", description="`exr` is scene-linear light, the others the graded picture.", examples=["png"]
    )
    live: bool = Field(
        default=False,
        description="Film and grade on the graphics device: quicker, for somebody who waits for the picture. It may be one of "
        "256 levels away from the file's; without it a picture is the one that the command line writes.",
        examples=[False],
    )
    client: str | None = Field(
        default=None,
        max_length=64,
        description="Names one viewer. A newer frame request of the same viewer for the same shot takes the place of "
        "those that still wait, which are answered 409 `superseded`. Left out: nothing is superseded.",
        examples=["viewer-1"],
    )


@router.get(
    "/shots/{shot}/frame",
    operation_id="getFrame",
    response_class=Response,
    responses=problems(404, 409, 503, 504)
    | {
        200: {"content": dict.fromkeys(MEDIA_TYPES.values(), BINARY), "description": "The picture."},
        304: {"description": "The picture is the one that `If-None-Match` names."},
    },
)
async def get_frame(
    service: ServiceDep,
    shot: ShotId,
    query: Annotated[FrameQuery, Query()],
    if_none_match: Annotated[str | None, Header(examples=['"5f70bf18a0860070"'])] = None,
) -> Response:
    """One frame. Its `ETag` is made of everything that it depends on: same tag, same pixels."""
    check_pixels(query.width, query.height, service.settings.max_picture_px)
    record = service.store.get(shot)
    edits = record.edit_text()
    tag = tag_of_frame(service, record, edits, query)
    headers = {"ETag": tag, "Cache-Control": "private, no-cache"}
    if matches(if_none_match, tag):
        service.metrics.frames.labels("not_modified").inc()
        return Response(status_code=304, headers=headers)
    picture = await _picture(service, record, edits, query, tag)
    return Response(picture, media_type=MEDIA_TYPES[query.format], headers=headers)


async def _picture(service: Service, record: ShotRecord, edits: str, query: FrameQuery, tag: str) -> bytes:
    cached = service.frame_cache.get(tag)
    if cached is not None:
        service.metrics.frames.labels("cache").inc()
        return cached
    live = query.live and query.format != "exr"  # an EXR holds scene-linear light, which has no film or grade
    request = frame_request(service, record, edits, query)
    group = (query.client, record.id) if query.client else None
    picture = await service.picture_queue.result(call(frames.render_frame, request, query.format, live), group)
    service.frame_cache.put(tag, picture)
    service.metrics.frames.labels("rendered").inc()
    return picture


def tag_of_frame(service: Service, record: ShotRecord, edits: str, query: FrameQuery) -> str:
    """The entity tag of a picture, made of all that it depends on: by it a picture lies in the cache.

    A shot's files never change under its id, but a shot may be sent again.
    """
    asked = query.model_dump(mode="json", exclude={"client"})
    shot = {"shot": record.id, "created": record.created_at.isoformat(), "edits": revision_of(edits)}
    return frame_tag(asked | shot | {"run": service.run_id})


def frame_request(service: Service, record: ShotRecord, edits: str, query: PictureQuery) -> FrameRequest:
    """Return a query as the picture process takes it."""
    return FrameRequest(
        record=record,
        edits=edits,
        camera=query.camera,
        time=query.time,
        height=query.height,
        max_px=service.settings.max_picture_px,
        settings=query.model_dump(include=set(PictureQuery.model_fields) - {"camera", "time", "height", *FINISH}),
        finish=query.model_dump(include=FINISH),
    )


@router.post("/shots/{shot}/pick", operation_id="pick", responses=problems(404, 503, 504))
async def pick(service: ServiceDep, shot: ShotId, asked: PickRequest) -> Pick:
    """The surface under a pixel. Its `anchor` is what a focus point is made of."""
    record = service.store.get(shot)
    return await service.call_picture(frames.pick_surface, record, record.edit_text(), asked)
