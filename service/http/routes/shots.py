"""Routes of shots: upload, list, describe, inspect, delete."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, File, Form, Response, UploadFile
from starlette.concurrency import run_in_threadpool

from service.http.errors import ServiceError
from service.http.routes.parameters import ShotId, problems
from service.http.service import ServiceDep
from service.http.upload import store_upload, upload_name
from service.models.inspection import Inspection
from service.models.shots import Shot, ShotList, ShotSummary
from service.stage.calls import shots
from service.workers.errors import WorkerDiedError

router = APIRouter(tags=["shots"])


@router.get("/shots", operation_id="listShots")
async def list_shots(service: ServiceDep) -> ShotList:
    """List all stored shots, newest last."""
    return ShotList(shots=[ShotSummary.model_validate(record) for record in service.store.list()])


@router.post("/shots", operation_id="createShot", status_code=201, responses=problems(413, 415, 503, 504))
async def create_shot(
    service: ServiceDep,
    response: Response,
    file: Annotated[UploadFile, File(description="A .usda, .usdc, .usd or .usdz file, or a .zip with all it needs.")],
    root: Annotated[
        str | None,
        Form(
            max_length=1000,
            description="Root layer within a zip. Left out: the only stage in its topmost folder that has any.",
            examples=["shots/night.usda"],
        ),
    ] = None,
) -> Shot:
    """Upload a shot. It may not refer to files outside the upload; a refused upload leaves nothing behind."""
    name = upload_name(file.filename)
    begun = service.store.begin(name)
    try:
        root_path = await run_in_threadpool(store_upload, file.file, name, root, begun.files, service.settings)
        described = await service.call_stage(shots.describe_shot, begun.with_root(root_path))
        record = await run_in_threadpool(service.store.accept, begun, root_path)
    except BaseException as error:
        service.store.discard(begun)
        service.close_shot(begun.id)
        if isinstance(error, WorkerDiedError):
            detail = f"{name} is damaged in a way that ended the process which tried to read it."
            raise ServiceError(422, "stage_unreadable", detail, path=name) from error
        raise
    response.headers["Location"] = f"/v1/shots/{record.id}"
    return described.model_copy(update=ShotSummary.model_validate(record).model_dump())


@router.get("/shots/{shot}", operation_id="getShot", responses=problems(404, 503, 504))
async def get_shot(service: ServiceDep, shot: ShotId) -> Shot:
    """Read a shot with its frame range and cameras."""
    return await service.call_stage(shots.describe_shot, service.store.get(shot))


@router.get("/shots/{shot}/inspect", operation_id="inspectShot", responses=problems(404, 503, 504))
async def inspect_shot(service: ServiceDep, shot: ShotId) -> Inspection:
    """Inspect a shot: its contents, features that are not honoured, and what the validators find in its cameras."""
    return await service.call_stage(shots.inspect_shot, service.store.get(shot))


@router.delete("/shots/{shot}", operation_id="deleteShot", status_code=204, responses=problems(404))
async def delete_shot(service: ServiceDep, shot: ShotId) -> None:
    """Delete a shot and its edits. The demo shot is written again when the service next starts."""
    record = service.store.get(shot)
    service.long_exposures.discard(record.id)
    await run_in_threadpool(service.store.remove, record)
    service.close_shot(record.id)
