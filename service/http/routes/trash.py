"""Routes of the trash: shots that were deleted can be listed, restored and removed for good."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Response
from starlette.concurrency import run_in_threadpool

from service.http.access import EDITS, PrincipalDep
from service.http.change_notes import note_shot
from service.http.errors import ServiceError
from service.http.routes.parameters import problems
from service.http.service import Service, ServiceDep
from service.identity.principal import Principal
from service.models.shots import ShotSummary
from service.models.trash import TRASHED_EXAMPLE, TrashedShot, TrashList
from service.storage import trash

router = APIRouter(tags=["trash"], prefix="/trash", dependencies=EDITS)

TrashedId = Annotated[
    str,
    Path(alias="trashed", max_length=100, description="Id of an entry of the trash.", examples=[TRASHED_EXAMPLE["id"]]),
]


@router.get("", operation_id="listTrash")
async def list_trash(service: ServiceDep, principal: PrincipalDep) -> TrashList:
    """List the deleted shots of your project, the last one first."""
    entries = await run_in_threadpool(service.trash.entries)
    return TrashList(shots=[_shown(entry) for entry in entries if principal.sees(entry.record.project)])


@router.post(
    "/{trashed}/restore",
    operation_id="restoreShot",
    responses=problems(404, 409),
)
async def restore_shot(
    service: ServiceDep, principal: PrincipalDep, response: Response, trashed: TrashedId
) -> ShotSummary:
    """Restore a deleted shot with its edits and their history, at the address that it had."""
    entry = _seen(service, principal, trashed)
    shot_id = entry.record.id
    try:
        await run_in_threadpool(service.trash.restore, entry)
    except FileExistsError as error:
        detail = f"There is a shot {shot_id!r} again; delete it before you restore the one in the trash."
        raise ServiceError(409, "shot_exists", detail, path=shot_id) from error
    await service.close_shot(shot_id)  # workers that were started for a request of before see an empty folder
    response.headers["Location"] = f"/v1/shots/{shot_id}"
    record = service.store.get(shot_id)
    await note_shot(service, record, "shot-restored")
    reason = service.quarantine.reason(record)
    return ShotSummary.model_validate(record).model_copy(update={"quarantine": reason})


@router.delete("/{trashed}", operation_id="removeShot", status_code=204, responses=problems(404))
async def remove_shot(service: ServiceDep, principal: PrincipalDep, trashed: TrashedId) -> None:
    """Remove a deleted shot for good."""
    await run_in_threadpool(service.trash.remove, _seen(service, principal, trashed))


def _seen(service: Service, principal: Principal, entry_id: str) -> trash.TrashedShot:
    """Return an entry of the trash. Raises `NotFoundError`: there is none, as far as the sender may know."""
    entry = service.trash.get(entry_id)
    if not principal.sees(entry.record.project):
        raise trash.not_in_trash(entry_id)
    return entry


def _shown(entry: trash.TrashedShot) -> TrashedShot:
    record = entry.record
    return TrashedShot(
        id=entry.id,
        shot=record.id,
        name=record.name,
        project=record.project,
        size_bytes=record.size_bytes,
        deleted_at=entry.deleted_at,
        removed_at=entry.removed_at,
    )
