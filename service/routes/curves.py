"""Focus curves: what the lens does over time, for other tools."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Response

from service.curve_work import ComputeCurve
from service.hub import HubDep
from service.models.curve import FocusCurve
from service.routes.parameters import CameraQuery, ShotId, problems

router = APIRouter(tags=["focus"], responses=problems(404, 503, 504))

CURVE_TYPES = {"json": "application/json", "csv": "text/csv; charset=utf-8", "usda": "text/plain; charset=utf-8"}


@router.get(
    "/shots/{shot}/focus-curve",
    operation_id="getFocusCurve",
    response_class=Response,
    responses={
        200: {
            "model": FocusCurve,
            "content": {
                "text/csv": {"schema": {"type": "string"}, "example": "frame,time_code,seconds,focus_distance_m\r\n"},
                "text/plain": {"schema": {"type": "string"}, "example": "#usda 1.0\n"},
            },
        }
    },
)
async def get_focus_curve(
    hub: HubDep,
    shot: ShotId,
    camera: CameraQuery = None,
    format: Annotated[Literal["json", "csv", "usda"], Query(description="What to write.", examples=["json"])] = "json",
    frames: Annotated[
        str | None,
        Query(max_length=200, description="Such as 1:96 or 1,5:9x2; the whole shot when left out.", examples=["1:96"]),
    ] = None,
    baked: Annotated[bool, Query(description="usda: time samples in place of a spline.", examples=[False])] = False,
) -> Response:
    """Focus distance, f-number and depth of field frame by frame; `usda` is a layer to sublayer over the shot."""
    record = hub.store.get(shot)
    work = ComputeCurve(record, camera, frames, format, baked, hub.settings.max_curve_frames)
    text = await hub.ask_stage(work)
    headers = {"Content-Disposition": f'inline; filename="{record.id}-focus.{format}"'}
    return Response(text, media_type=CURVE_TYPES[format], headers=headers)
