"""Routes of long exposures: one picture over many frames, whose shutter can be closed and reopened."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Depends, Query, Request, Response

from service.http.access import RENDERS, unauthorized
from service.http.bodies import BodyRoute
from service.http.clients import present_client
from service.http.identity import IdentityDep
from service.http.long_exposures import SenderCheck
from service.http.routes.frames import BINARY, MEDIA_TYPES
from service.http.routes.parameters import ShotId, problems
from service.http.service import ServiceDep
from service.models.long_exposure import LongExposureBegin, LongExposureEdit, LongExposureState

router = APIRouter(tags=["long exposures"], route_class=BodyRoute, dependencies=RENDERS)

Format = Annotated[
    Literal["png", "jpeg", "exr"],
    Query(description="`exr` is scene-linear light, the others the graded picture.", examples=["png"]),
]


def _sender_check(service: ServiceDep, identity: IdentityDep, request: Request) -> SenderCheck:
    """Return a function that raises `ServiceError` once the sender of this request may no longer use the service."""

    client = present_client()

    def check() -> None:
        if not identity.is_valid(request.scope):
            raise unauthorized("The key, token or session has ended: sign in again, and open the shutter to go on.")
        service.quotas.check_work(client)

    return check


CheckDep = Annotated[SenderCheck, Depends(_sender_check)]


@router.post(
    "/shots/{shot}/long-exposure", operation_id="beginLongExposure", status_code=201, responses=problems(404, 423, 503)
)
async def begin_long_exposure(
    service: ServiceDep, check: CheckDep, shot: ShotId, begin: LongExposureBegin
) -> LongExposureState:
    """Begin a long exposure with the shutter open, in place of the one that the shot had. It uses the edits as they are now. Its
    intervals are exposed between the pictures of other requests, and it is kept while the service runs. It fails once the key,
    token or session that opened the shutter has ended, or its owner has used up the processor time of a day."""
    record = service.store.get(shot)
    admitted = service.admission.check(record.id, begin)
    return await service.long_exposures.begin(record, begin, admitted.limits, check)


@router.get("/shots/{shot}/long-exposure", operation_id="getLongExposure", responses=problems(404))
async def get_long_exposure(service: ServiceDep, shot: ShotId) -> LongExposureState:
    """Read the progress of a long exposure."""
    return service.long_exposures.state(service.store.get(shot).id)


@router.patch("/shots/{shot}/long-exposure", operation_id="editLongExposure", responses=problems(404))
async def edit_long_exposure(
    service: ServiceDep, check: CheckDep, shot: ShotId, edit: LongExposureEdit
) -> LongExposureState:
    """Close the shutter, or reopen it and continue. The picture is the same as without the pause."""
    return service.long_exposures.set_shutter(service.store.get(shot).id, check, is_open=edit.shutter == "open")


@router.get(
    "/shots/{shot}/long-exposure/picture",
    operation_id="getLongExposurePicture",
    response_class=Response,
    responses=problems(404, 423, 503)
    | {200: {"content": dict.fromkeys(MEDIA_TYPES.values(), BINARY), "description": "The picture so far."}},
)
async def get_long_exposure_picture(service: ServiceDep, shot: ShotId, format: Format = "png") -> Response:
    """Develop the exposure so far, as bright as a single frame. The exposure continues."""
    picture = await service.long_exposures.picture(service.store.get(shot).id, format)
    return Response(picture, media_type=MEDIA_TYPES[format], headers={"Cache-Control": "no-store"})


@router.delete(
    "/shots/{shot}/long-exposure", operation_id="deleteLongExposure", status_code=204, responses=problems(404)
)
async def delete_long_exposure(service: ServiceDep, shot: ShotId) -> None:
    """Discard a long exposure. It is no error if there is none."""
    await service.long_exposures.discard(service.store.get(shot).id)
