"""Routes of shots: upload, list, describe, inspect, delete."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, File, Form, Response, UploadFile
from fastapi.concurrency import contextmanager_in_threadpool
from starlette.concurrency import run_in_threadpool

from service.edit_context import EditContext, edits_tag
from service.http.access import EDITS, READS, PrincipalDep
from service.http.bodies import BodyRoute
from service.http.change_notes import note_shot
from service.http.errors import ServiceError
from service.http.links import shot_links
from service.http.quarantine import REASONS
from service.http.quotas import Reception
from service.http.routes.parameters import IfMatch, ShotId, problems, set_etag
from service.http.service import Service, ServiceDep
from service.http.upload import SIGNATURE_BYTES, store_upload, upload_name
from service.identity.principal import ALL_PROJECTS, DEFAULT_PROJECT, PROJECT_PATTERN, Principal
from service.models.inspection import Inspection
from service.models.shots import Shot, ShotList, ShotSummary
from service.stage.calls import shots
from service.storage.store import ShotRecord, size_of
from service.workers.errors import BLAMED, WorkerDiedError

router = APIRouter(tags=["shots"], route_class=BodyRoute, dependencies=READS)


@router.get("/shots", operation_id="listShots")
async def list_shots(service: ServiceDep, principal: PrincipalDep) -> ShotList:
    """List the stored shots of your project, newest last."""

    def seen() -> ShotList:
        records = (record for record in service.store.list() if principal.sees(record.project))
        return ShotList(shots=[_summary(service, record) for record in records])

    return await run_in_threadpool(seen)


def _summary(service: Service, record: ShotRecord) -> ShotSummary:
    reason = service.quarantine.reason(record)
    return ShotSummary.model_validate(record).model_copy(update={"quarantine": reason})


@router.post(
    "/shots",
    operation_id="createShot",
    status_code=201,
    responses=problems(400, 413, 415, 503) | shot_links(201),
    dependencies=EDITS,
)
async def create_shot(
    service: ServiceDep,
    principal: PrincipalDep,
    response: Response,
    file: Annotated[UploadFile, File(description="A .usda, .usdc, .usd or .usdz file, or a .zip with all it needs.")],
    root: Annotated[
        str | None,
        Form(
            max_length=1000,
            description="Root layer within a zip: the path of one of its USD files. Left out: the only stage in its topmost "
            "folder that has any; where there are several, the refusal (`ambiguous_root`) lists them in `errors`.",
            examples=["shots/night.usda"],
        ),
    ] = None,
    project: Annotated[
        str | None,
        Form(
            pattern=PROJECT_PATTERN,
            description="Project of the shot, for those who may see several. Left out: your own, or `default`.",
            examples=["night-tram"],
        ),
    ] = None,
) -> Shot:
    """Upload a shot. It may not refer to files outside the upload; a refused upload leaves nothing behind."""
    begin = await file.read(SIGNATURE_BYTES)
    await file.seek(0)
    name = upload_name(file.filename, begin)
    reserved = service.quotas.receiving(_project_of_upload(principal, project))
    async with contextmanager_in_threadpool(reserved) as reception:
        record, described = await _receive(service, reception, file, name, root)
    await note_shot(service, record, "shot-added")
    response.headers["Location"] = f"/v1/shots/{record.id}"
    return described.model_copy(update=ShotSummary.model_validate(record).model_dump())


async def _receive(
    service: Service, reception: Reception, file: UploadFile, name: str, root: str | None
) -> tuple[ShotRecord, Shot]:
    """Store an upload as a shot, or leave nothing of it."""
    begun = await run_in_threadpool(service.store.begin, name, project=reception.project)
    try:
        root_path = await run_in_threadpool(store_upload, file.file, name, root, begun.files, service.settings)
        await run_in_threadpool(lambda: reception.reserve(size_of(begun)))
        described = await service.check_upload(begun.with_root(root_path))
        return await run_in_threadpool(service.store.accept, begun, root_path), described
    except BaseException as error:
        await run_in_threadpool(service.store.discard, begun)
        if isinstance(error, WorkerDiedError) and error.end in BLAMED:
            detail = f"{name} was not accepted: {REASONS[error.end]}."
            raise ServiceError(422, "stage_unreadable", detail, path=name) from error
        raise


@router.get("/shots/{shot}", operation_id="getShot", responses=problems(404, 423, 503))
async def get_shot(service: ServiceDep, response: Response, shot: ShotId) -> Shot:
    """Read a shot with its frame range and cameras. The `ETag` is that of all its edits."""
    described = await service.call_stage(shots.describe_shot, service.store.get(shot))
    set_etag(response, edits_tag(described.revision))
    return described


@router.get("/shots/{shot}/inspect", operation_id="inspectShot", responses=problems(404, 423, 503))
async def inspect_shot(service: ServiceDep, shot: ShotId) -> Inspection:
    """Inspect a shot: its contents, features that are not honoured, and what the validators find in its cameras."""
    return await service.call_reader(shots.inspect_shot, service.store.get(shot))


@router.delete(
    "/shots/{shot}", operation_id="deleteShot", status_code=204, responses=problems(404, 412), dependencies=EDITS
)
async def delete_shot(service: ServiceDep, shot: ShotId, if_match: IfMatch = None) -> None:
    """Move a shot with its edits to the trash. `If-Match` takes the tag of all edits.

    The demo shot is written again when the service next starts.
    """
    record = service.store.get(shot)
    await run_in_threadpool(service.trash.put, record, EditContext(if_match))
    await note_shot(service, record, "shot-deleted")
    await service.long_exposures.discard(record.id)
    await service.close_shot(record.id)


def _project_of_upload(principal: Principal, named: str | None) -> str:
    """Return the project of a new shot. Raises `ServiceError` 403: the sender names one that they may not see."""
    own = DEFAULT_PROJECT if principal.project == ALL_PROJECTS else principal.project
    if named is not None and not principal.sees(named):
        detail = f"{principal.label} may store shots in the project {own!r}, and names {named!r}."
        raise ServiceError(403, "foreign_project", detail, path="project")
    return named or own
