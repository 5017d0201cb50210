"""Edits of a shot: changes to be applied, the USD layer that they make, and the states that it has had."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Header, Response

from render.model.edit_history import revision_of
from service.edit_context import EditContext, edits_tag
from service.http.access import EDITS, READS, PrincipalDep
from service.http.bodies import BodyRoute
from service.http.errors import ServiceError
from service.http.frame_cache import matches
from service.http.links import edit_links
from service.http.routes.parameters import EditContextDep, IfMatch, ShotId, problems, set_etag
from service.http.service import Service, ServiceDep
from service.identity.principal import ANYONE
from service.models.changes import PictureSpot, anchor_spots, picture_spots
from service.models.edits import EditHistory, EditRequest, EditResult, Restore
from service.models.focus import Anchor
from service.models.shots import Shot
from service.picture.calls import frames
from service.stage.calls import edits
from service.storage.store import ShotRecord

router = APIRouter(tags=["edits"], route_class=BodyRoute, dependencies=READS)


@router.get(
    "/shots/{shot}/edits",
    operation_id="getEdits",
    response_class=Response,
    responses=problems(404)
    | {
        200: {"content": {"text/plain": {"schema": {"type": "string"}, "example": "#usda 1.0\n"}}},
        304: {"description": "The edits are those that `If-None-Match` names."},
    },
)
async def get_edits(
    service: ServiceDep,
    shot: ShotId,
    if_none_match: Annotated[str | None, Header(examples=['"e3b0c44298fc1c14"'])] = None,
) -> Response:
    """Every edit of a shot as one USD layer, to be sublayered over it. Its `ETag` is the shot's `revision`."""
    record = service.store.get(shot)
    text = record.edit_text()
    headers = {"ETag": edits_tag(revision_of(text)), "Cache-Control": "private, no-cache"}
    if matches(if_none_match, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    headers["Content-Disposition"] = f'attachment; filename="{record.id}-edits.usda"'
    return Response(text or "#usda 1.0\n", media_type="text/plain; charset=utf-8", headers=headers)


@router.post(
    "/shots/{shot}/edits",
    operation_id="edit",
    responses=problems(404, 412, 413, 423, 503) | edit_links(),
    dependencies=EDITS,
)
async def edit(
    service: ServiceDep,
    response: Response,
    principal: PrincipalDep,
    shot: ShotId,
    request: EditRequest,
    if_match: IfMatch = None,
) -> EditResult:
    """Apply changes to a camera: all of them or none, as one entry of the history.

    `If-Match` takes the tag of all edits, or the tags, with commas between, of each resource that is changed: the camera, the
    list of focus points (to add one, or to rack), each focus point, the list of notes (to add one) and each note. The answer has
    their new tags, and where `answer` asks for it the state of the camera, so that nothing has to be read again. Its own `ETag`
    is that of all edits.
    """
    record = service.store.get(shot)
    anchored = await _with_anchors(service, record, request)
    context = EditContext(if_match, request.gesture, "" if principal is ANYONE else principal.label)
    result = await service.call_stage(edits.apply_edit, record, anchored, context, service.settings.max_curve_frames)
    set_etag(response, edits_tag(result.history.revision))
    return result


async def _with_anchors(service: Service, record: ShotRecord, request: EditRequest) -> EditRequest:
    """Look up the places of the picture that changes name. Raises `ServiceError` 422: nothing is seen at one of them."""
    anchors: dict[PictureSpot, Anchor | None] = {}
    for spot in picture_spots(request.changes):
        (x, y), time = spot
        anchors[spot] = await service.call_picture(
            frames.find_anchor, record, record.edit_text(), request.camera, time, (x, y)
        )
        if anchors[spot] is None:
            detail = f"There is no surface at ({x:g}, {y:g}) of the picture at {time:g} to move a focus point to."
            raise ServiceError(422, "nothing_there", detail, path="changes")
    return request.model_copy(update={"changes": anchor_spots(request.changes, anchors)})


@router.put(
    "/shots/{shot}/edits", operation_id="restoreEdits", responses=problems(404, 412, 423, 503), dependencies=EDITS
)
async def restore_edits(
    service: ServiceDep, response: Response, shot: ShotId, restore: Restore, context: EditContextDep
) -> Shot:
    """Take back every edit since a revision: the edits are then what they were. This can be undone."""
    restored = await service.call_stage(edits.restore_edits, service.store.get(shot), restore.revision, context)
    set_etag(response, edits_tag(restored.revision))
    return restored


@router.get("/shots/{shot}/edits/history", operation_id="getEditHistory", responses=problems(404, 423, 503))
async def get_edit_history(service: ServiceDep, response: Response, shot: ShotId) -> EditHistory:
    """The states that the edits have had, and what an undo and a redo would do."""
    history = await service.call_stage(edits.read_history, service.store.get(shot))
    set_etag(response, edits_tag(history.revision))
    return history


@router.post(
    "/shots/{shot}/edits/undo", operation_id="undoEdit", responses=problems(404, 409, 412, 423, 503), dependencies=EDITS
)
async def undo_edit(service: ServiceDep, response: Response, shot: ShotId, context: EditContextDep) -> EditHistory:
    """Take back the last edit, whoever made it: with the revision in `If-Match`, only if nobody edited since."""
    history = await service.call_stage(edits.walk_history, service.store.get(shot), "undo", context)
    set_etag(response, edits_tag(history.revision))
    return history


@router.post(
    "/shots/{shot}/edits/redo", operation_id="redoEdit", responses=problems(404, 409, 412, 423, 503), dependencies=EDITS
)
async def redo_edit(service: ServiceDep, response: Response, shot: ShotId, context: EditContextDep) -> EditHistory:
    """Do the edit again that was undone last; the next edit drops what was undone."""
    history = await service.call_stage(edits.walk_history, service.store.get(shot), "redo", context)
    set_etag(response, edits_tag(history.revision))
    return history
