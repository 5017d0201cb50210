"""Routes of the quarantine of shots."""

from __future__ import annotations

from fastapi import APIRouter
from starlette.concurrency import run_in_threadpool

from service.http.access import EDITS
from service.http.routes.parameters import ShotId, problems
from service.http.service import ServiceDep

router = APIRouter(tags=["shots"], dependencies=EDITS)


@router.delete("/shots/{shot}/quarantine", operation_id="releaseShot", status_code=204, responses=problems(404))
async def release_shot(service: ServiceDep, shot: ShotId) -> None:
    """Release a shot from quarantine, where one is that has ended worker processes, so that it is opened again."""
    await run_in_threadpool(service.quarantine.release, service.store.get(shot))
