"""Route of the focus report of a render, which needs the shot and none of the pictures."""

from __future__ import annotations

from contextlib import ExitStack
from typing import Annotated

from fastapi import APIRouter, Query, Response
from starlette.concurrency import run_in_threadpool

from render.errors import InputError, NotFoundError
from service.http.access import READS
from service.http.errors import ServiceError
from service.http.render_shots import shot_of
from service.http.routes.parameters import problems
from service.http.routes.renders import RenderAtHand
from service.http.service import Service, ServiceDep
from service.jobs.frame_ranges import format_frames, parse_frames
from service.models.focus_reports import FocusReport, ReportedRender, ReportFormat
from service.stage.calls import focus_reports
from service.storage.database.tables import RenderRow
from service.storage.store import ShotRecord

router = APIRouter(tags=["renders"], prefix="/renders", dependencies=READS)

REPORT_TYPES: dict[ReportFormat, str] = {"json": "application/json", "csv": "text/csv; charset=utf-8"}


@router.get(
    "/{render}/focus-report",
    operation_id="getRenderFocusReport",
    response_class=Response,
    responses=problems(404, 409, 423, 503)
    | {
        200: {
            "model": FocusReport,
            "content": {
                "text/csv": {
                    "schema": {"type": "string"},
                    "example": "frame,focus_distance_m,f_stop,t_stop,focal_length_mm\r\n",
                }
            },
        }
    },
)
async def get_focus_report(
    service: ServiceDep,
    render: RenderAtHand,
    format: Annotated[
        ReportFormat,
        Query(
            description="`json`, or `csv` for spreadsheets, with a row for each focus point of each frame and no summary.",
            examples=["json"],
        ),
    ] = "json",
    frames: Annotated[
        str | None,
        Query(
            max_length=4000,
            description="Frames of the render, as a range such as `1-10:2,15`; all of them when left out.",
            examples=["24-30"],
        ),
    ] = None,
) -> Response:
    """Report the lens and the sharpness of each focus point in each frame of a render, with the edits that the render keeps.

    It needs no picture, so that it is there before the first frame is drawn.
    """
    wanted = _reported(render, frames)
    edits = await run_in_threadpool(service.renders.lookups.edits, render.id)
    with ExitStack() as stack:
        record = await _shot_of(service, render, stack)
        text = await service.call_reader_at(focus_reports.report_focus, record, edits, wanted, format)
    headers = {"Content-Disposition": f'inline; filename="{render.id}-focus.{format}"'}
    return Response(text, media_type=REPORT_TYPES[format], headers=headers)


def _reported(render: RenderRow, frames: str | None) -> ReportedRender:
    """Return what a report is about.

    Raises:
        SettingsError: the frames are no range.
        NotFoundError: they are not all of the render.
    """
    chosen = parse_frames(render.frames)
    if frames is not None:
        own, chosen = set(chosen), parse_frames(frames)
        other = next((frame for frame in chosen if frame not in own), None)
        if other is not None:
            detail = f"render {render.id!r} has no frame {other}, it has {render.frames[:200]}"
            raise NotFoundError(detail, code="frame_not_found", path="frames")
    return ReportedRender(
        id=render.id,
        shot=render.shot,
        revision=render.revision,
        camera=render.request["camera"],
        width=render.request["width"],
        height=render.request["height"],
        frames=tuple(chosen),
        range=format_frames(chosen),
    )


async def _shot_of(service: Service, render: RenderRow, stack: ExitStack) -> ShotRecord:
    """Return the shot of a render, of which only frames may be left. Raises `ServiceError` 404: it was deleted, or replaced."""
    try:
        return await shot_of(service, render, stack)
    except InputError as error:
        detail = f"The focus report of render {render.id!r} needs the shot that it was sent with, which is gone: {error.detail}"
        raise ServiceError(404, error.code, detail, path="render") from error
