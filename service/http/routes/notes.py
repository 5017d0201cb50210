"""Route of the notes of a shot; notes are written as changes of an edit."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Response

from service.http.access import READS
from service.http.routes.parameters import ShotId, problems, set_etag
from service.http.service import ServiceDep
from service.models.base import PrimPath, TimeCode
from service.models.notes import NoteList
from service.stage.calls import notes

router = APIRouter(tags=["notes"], responses=problems(404, 423, 503), dependencies=READS)

_Camera = Annotated[
    PrimPath | None,
    Query(description="Prim path: notes of other cameras are left out.", examples=["/World/main_cam"]),
]
_First = Annotated[
    TimeCode | None, Query(allow_inf_nan=False, description="First USD time code, left out for no limit.", examples=[1])
]
_Last = Annotated[
    TimeCode | None, Query(allow_inf_nan=False, description="Last USD time code, left out for no limit.", examples=[96])
]


@router.get("/shots/{shot}/notes", operation_id="listNotes")
async def list_notes(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    camera: _Camera = None,
    first: _First = None,
    last: _Last = None,
) -> NoteList:
    """List the notes of a shot: texts and drawings at frames, kept in its edits.

    The changes `addNote`, `editNote` and `deleteNote` of an edit write them, and its `changed` names them as `notes/{id}`.
    """
    found = await service.call_stage(notes.read_notes, service.store.get(shot), camera, (first, last))
    set_etag(response, found.etag)
    return found
