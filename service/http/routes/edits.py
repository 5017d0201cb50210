"""The edits of a shot: one USD layer, and the states that it has had."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Header, Response

from render.model.edit_history import revision_of
from service.edit_context import edits_tag
from service.http.frame_cache import matches
from service.http.routes.parameters import EditContextDep, ShotId, problems, tagged
from service.http.service import ServiceDep
from service.models.edits import EditHistory, Restore
from service.models.shots import Shot
from service.stage.calls import edits

router = APIRouter(tags=["edits"])


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
    if_none_match: Annotated[str | None, Header(examples=['"5f70bf18a0860070"'])] = None,
) -> Response:
    """Every edit of a shot as one USD layer, to be sublayered over it. Its `ETag` is the shot's `revision`."""
    record = service.store.get(shot)
    text = record.edit_text()
    headers = {"ETag": edits_tag(revision_of(text)), "Cache-Control": "private, no-cache"}
    if matches(if_none_match, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    headers["Content-Disposition"] = f'attachment; filename="{record.id}-edits.usda"'
    return Response(text or "#usda 1.0\n", media_type="text/plain; charset=utf-8", headers=headers)


@router.put("/shots/{shot}/edits", operation_id="restoreEdits", responses=problems(404, 412, 503, 504))
async def restore_edits(
    service: ServiceDep, response: Response, shot: ShotId, restore: Restore, context: EditContextDep
) -> Shot:
    """Take back every edit since a revision: the edits are then what they were. This can be undone."""
    restored = await service.call_stage(edits.restore_edits, service.store.get(shot), restore.revision, context)
    tagged(response, edits_tag(restored.revision))
    return restored


@router.get("/shots/{shot}/edits/history", operation_id="getEditHistory", responses=problems(404, 503, 504))
async def get_edit_history(service: ServiceDep, response: Response, shot: ShotId) -> EditHistory:
    """The states that the edits have had, and what an undo and a redo would do."""
    history = await service.call_stage(edits.read_history, service.store.get(shot))
    tagged(response, edits_tag(history.revision))
    return history


@router.post("/shots/{shot}/edits/undo", operation_id="undoEdit", responses=problems(404, 409, 412, 503, 504))
async def undo_edit(service: ServiceDep, response: Response, shot: ShotId, context: EditContextDep) -> EditHistory:
    """Take back the last edit, whoever made it: with the revision in `If-Match`, only if nobody edited since."""
    history = await service.call_stage(edits.walk_history, service.store.get(shot), "undo", context)
    tagged(response, edits_tag(history.revision))
    return history


@router.post("/shots/{shot}/edits/redo", operation_id="redoEdit", responses=problems(404, 409, 412, 503, 504))
async def redo_edit(service: ServiceDep, response: Response, shot: ShotId, context: EditContextDep) -> EditHistory:
    """Do the edit again that was undone last; the next edit drops what was undone."""
    history = await service.call_stage(edits.walk_history, service.store.get(shot), "redo", context)
    tagged(response, edits_tag(history.revision))
    return history
