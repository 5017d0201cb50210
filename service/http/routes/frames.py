"""Routes of frames and picks."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Header, Query, Response

from render.model.edit_history import revision_of
from service.http.access import RENDERS
from service.http.bodies import BodyRoute
from service.http.clients import present_client
from service.http.frame_cache import matches
from service.http.frame_requests import focus_tag, frame_request, tag_of_frame
from service.http.routes.parameters import CameraQuery, ShotId, problems
from service.http.service import Service, ServiceDep
from service.models.focus import Pick
from service.models.frames import FrameQuery, PictureQuery, PictureStates, SizedFrame
from service.models.shots import PickRequest
from service.picture.calls import focus_maps as focus_map_calls
from service.picture.calls import frames as frame_calls
from service.stage.calls import picture_states
from service.storage.store import ShotRecord
from service.workers.calls import call

router = APIRouter(tags=["frames"], route_class=BodyRoute, dependencies=RENDERS)

MEDIA_TYPES = {"png": "image/png", "jpeg": "image/jpeg", "exr": "image/x-exr"}
FOCUS_MAP_TYPE = "application/octet-stream"
BINARY = {"schema": {"type": "string", "format": "binary"}}


@router.get(
    "/shots/{shot}/frame",
    operation_id="getFrame",
    response_class=Response,
    responses=problems(404, 409, 423, 503)
    | {
        200: {"content": dict.fromkeys(MEDIA_TYPES.values(), BINARY), "description": "The picture."},
        304: {"description": "The picture is the one that `If-None-Match` names."},
    },
)
async def get_frame(
    service: ServiceDep,
    shot: ShotId,
    query: Annotated[FrameQuery, Query()],
    if_none_match: Annotated[str | None, Header(examples=['"e3b0c44298fc1c14"'])] = None,
) -> Response:
    """Render one frame. Its `ETag` is a hash of everything that the picture depends on: same tag, same pixels."""
    record = service.store.get(shot)
    edits = record.edit_text()
    tag = tag_of_frame(service, record, edits, query)
    headers = {"ETag": tag, "Cache-Control": "private, no-cache", "Pullfocus-Revision": revision_of(edits)}
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
    client = present_client()
    group = (client, query.client, record.id) if query.client else None
    cost, limits = service.admission.check(record.id, query)
    request = frame_request(record, edits, query, limits)
    picture = await service.lanes.frame_lane(cost.expected_s).result(
        call(frame_calls.render_frame, request, query.format, live),
        service.place_of(record),
        client,
        group=group,
        estimate_s=cost.ordinary_s,
    )
    service.frame_cache.put(tag, picture)
    service.metrics.frames.labels("rendered").inc()
    return picture


@router.get(
    "/shots/{shot}/focus-map",
    operation_id="getFocusMap",
    response_class=Response,
    responses=problems(404, 423, 503)
    | {
        200: {"content": {FOCUS_MAP_TYPE: BINARY}, "description": "The focus map."},
        304: {"description": "The map is the one that `If-None-Match` names."},
    },
)
async def get_focus_map(
    service: ServiceDep,
    shot: ShotId,
    query: Annotated[SizedFrame, Query()],
    if_none_match: Annotated[str | None, Header(examples=['"e3b0c44298fc1c14"'])] = None,
) -> Response:
    """Measure how sharp each pixel of a frame is: its circle of confusion and its depth, as the AOVs `coc` and `depth`.

    The circle of confusion is a radius in pixels of the map, negative in front of the focus. The depth is in metres along the
    view axis, infinite where nothing is.

    The answer is binary: the length of the head as four bytes, big-endian; the head, a `FocusMapHead` as JSON; then, compressed
    by zlib, the circles of confusion and the depths. Of each of these two, the first bytes of all pixels come first, row by row
    from the top, then the second ones, up to the fourth. The four bytes of a pixel, the lowest first, are the difference of the
    bits of its float32 from those of the pixel on its left, modulo 2^32.
    """
    record = service.store.get(shot)
    edits = record.edit_text()
    picture = PictureQuery.model_validate(query.model_dump() | {"rays": 1, "layers": 1})
    cost, limits = service.admission.check(record.id, picture)
    tag = focus_tag(service, record, edits, picture)
    headers = {"ETag": tag, "Cache-Control": "private, no-cache", "Pullfocus-Revision": revision_of(edits)}
    if matches(if_none_match, tag):
        return Response(status_code=304, headers=headers)
    focus = service.frame_cache.get(tag)
    if focus is None:
        request = frame_request(record, edits, picture, limits)
        focus = await service.lanes.frame_lane(cost.expected_s).result(
            call(focus_map_calls.measure_focus_map, request),
            service.place_of(record),
            present_client(),
            estimate_s=cost.ordinary_s,
        )
        service.frame_cache.put(tag, focus)
    return Response(focus, media_type=FOCUS_MAP_TYPE, headers=headers)


@router.get("/shots/{shot}/picture-states", operation_id="getPictureStates", responses=problems(404, 423, 503))
async def get_picture_states(
    service: ServiceDep,
    shot: ShotId,
    camera: CameraQuery = None,
    frames: Annotated[
        str | None,
        Query(max_length=4000, description="Such as 1:96 or 1,5:9x2; the whole shot when left out.", examples=["1:96"]),
    ] = None,
) -> PictureStates:
    """Tell which pictures an edit leaves as they are.

    Pictures of one frame without motion blur, asked for in the same way before and after an edit, are the same where their states
    are. At most 1,000 frames are read at once.
    """
    record = service.store.get(shot)
    return await service.call_reader(picture_states.read_picture_states, record, camera, frames)


@router.post("/shots/{shot}/pick", operation_id="pick", responses=problems(404, 423, 503))
async def pick(service: ServiceDep, shot: ShotId, request: PickRequest) -> Pick:
    """Find the surface under a pixel. Its `anchor` places a focus point on it."""
    record = service.store.get(shot)
    return await service.call_picture(frame_calls.pick_surface, record, record.edit_text(), request)
