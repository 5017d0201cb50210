"""Route of exposure maps."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Header, Query, Response

from render.model.edit_history import revision_of
from service.http.access import RENDERS
from service.http.bodies import BodyRoute
from service.http.clients import present_client
from service.http.frame_cache import matches
from service.http.frame_requests import exposure_tag, frame_request
from service.http.routes.parameters import ShotId, problems
from service.http.service import ServiceDep
from service.models.frames import PictureQuery, SizedFrame
from service.picture.calls import exposure_maps as exposure_map_calls
from service.workers.calls import call

router = APIRouter(tags=["frames"], route_class=BodyRoute, dependencies=RENDERS)

EXPOSURE_MAP_TYPE = "application/octet-stream"


@router.get(
    "/shots/{shot}/exposure-map",
    operation_id="getExposureMap",
    response_class=Response,
    responses=problems(404, 423, 503)
    | {
        200: {
            "content": {EXPOSURE_MAP_TYPE: {"schema": {"type": "string", "format": "binary"}}},
            "description": "The exposure map.",
        },
        304: {"description": "The map is the one that `If-None-Match` names."},
    },
)
async def get_exposure_map(
    service: ServiceDep,
    shot: ShotId,
    query: Annotated[SizedFrame, Query()],
    if_none_match: Annotated[str | None, Header(examples=['"e3b0c44298fc1c14"'])] = None,
) -> Response:
    """Measure how bright each pixel of a frame is: in stops from a grey of 18 %, on the film and before film and grade.

    It is the luminance of the scene-linear light of `getFrame` with `format=exr`, times the exposure of the camera.

    The answer is binary: the length of the head as four bytes, big-endian; the head, an `ExposureMapHead` as JSON; then,
    compressed by zlib, a number for each pixel: its stops times `stepsPerStop`, to the nearest whole number of 16 bits; -32768
    where there is no light. The low bytes of all pixels come first, row by row from the top, then the high ones. The two bytes
    of a pixel are the difference from those of the pixel on its left, modulo 2^16.
    """
    record = service.store.get(shot)
    edits = record.edit_text()
    picture = PictureQuery.model_validate(query.model_dump())
    cost, limits = service.admission.check(record.id, picture)
    tag = exposure_tag(service, record, edits, picture)
    headers = {"ETag": tag, "Cache-Control": "private, no-cache", "Pullfocus-Revision": revision_of(edits)}
    if matches(if_none_match, tag):
        return Response(status_code=304, headers=headers)
    exposure = service.frame_cache.get(tag)
    if exposure is None:
        exposure = await service.lanes.frame_lane(cost.expected_s).result(
            call(exposure_map_calls.measure_exposure_map, frame_request(record, edits, picture, limits)),
            service.place_of(record),
            present_client(),
            estimate_s=cost.ordinary_s,
        )
        service.frame_cache.put(tag, exposure)
    return Response(exposure, media_type=EXPOSURE_MAP_TYPE, headers=headers)
