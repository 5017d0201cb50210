"""The edits of a shot: one USD layer, and the states that it has had."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Header, Response

from render.model.edit_history import revision_of
from service.http.frame_cache import matches
from service.http.hub import HubDep
from service.http.routes.parameters import ShotId, TermsDep, problems, tagged
from service.models.edits import EditHistory, Restore
from service.models.shots import Shot
from service.stage.calls import edits
from service.terms import edits_tag

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
    hub: HubDep,
    shot: ShotId,
    if_none_match: Annotated[str | None, Header(examples=['"5f70bf18a0860070"'])] = None,
) -> Response:
    """Every edit of a shot as one USD layer, to be sublayered over it. Its `ETag` is the shot's `revision`."""
    record = hub.store.get(shot)
    text = record.edit_text()
    headers = {"ETag": edits_tag(revision_of(text)), "Cache-Control": "private, no-cache"}
    if matches(if_none_match, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    headers["Content-Disposition"] = f'attachment; filename="{record.id}-edits.usda"'
    return Response(text or "#usda 1.0\n", media_type="text/plain; charset=utf-8", headers=headers)


@router.put("/shots/{shot}/edits", operation_id="restoreEdits", responses=problems(404, 412, 503, 504))
async def restore_edits(hub: HubDep, response: Response, shot: ShotId, restore: Restore, terms: TermsDep) -> Shot:
    """Take back every edit since a revision: the edits are then what they were. This can be undone."""
    restored = await hub.ask_stage(edits.restore_edits, hub.store.get(shot), restore.revision, terms)
    tagged(response, edits_tag(restored.revision))
    return restored


@router.get("/shots/{shot}/edits/history", operation_id="getEditHistory", responses=problems(404, 503, 504))
async def get_edit_history(hub: HubDep, response: Response, shot: ShotId) -> EditHistory:
    """The states that the edits have had, and what an undo and a redo would do."""
    history = await hub.ask_stage(edits.read_history, hub.store.get(shot))
    tagged(response, edits_tag(history.revision))
    return history


@router.post("/shots/{shot}/edits/undo", operation_id="undoEdit", responses=problems(404, 409, 412, 503, 504))
async def undo_edit(hub: HubDep, response: Response, shot: ShotId, terms: TermsDep) -> EditHistory:
    """Take back the last edit, whoever made it: with the revision in `If-Match`, only if nobody edited since."""
    history = await hub.ask_stage(edits.walk_history, hub.store.get(shot), "undo", terms)
    tagged(response, edits_tag(history.revision))
    return history


@router.post("/shots/{shot}/edits/redo", operation_id="redoEdit", responses=problems(404, 409, 412, 503, 504))
async def redo_edit(hub: HubDep, response: Response, shot: ShotId, terms: TermsDep) -> EditHistory:
    """Do the edit again that was undone last; the next edit drops what was undone."""
    history = await hub.ask_stage(edits.walk_history, hub.store.get(shot), "redo", terms)
    tagged(response, edits_tag(history.revision))
    return history
