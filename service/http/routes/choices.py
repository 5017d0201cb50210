"""Route of what a shot leaves open; choices are made as changes of an edit."""

from __future__ import annotations

from fastapi import APIRouter

from service.http.access import READS
from service.http.routes.parameters import ShotId, problems
from service.http.service import ServiceDep
from service.models.choices import Choices
from service.stage.calls import choices

router = APIRouter(tags=["shots"], responses=problems(404, 423, 503), dependencies=READS)


@router.get("/shots/{shot}/choices", operation_id="getChoices")
async def get_choices(service: ServiceDep, shot: ShotId) -> Choices:
    """List the variant sets and payloads of a shot. The changes `chooseVariant` and `showPayload` of an edit choose."""
    return await service.call_reader(choices.read_choices, service.store.get(shot))
