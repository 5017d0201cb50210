"""Routes of the focus report and the focus curve of a render, which need the shot and none of the pictures."""

from __future__ import annotations

from contextlib import suppress
from typing import Annotated, cast

from fastapi import APIRouter, Query, Response
from starlette.concurrency import run_in_threadpool

from render.errors import NotFoundError
from service.http.access import READS
from service.http.product_making import reported, write_curve, write_report
from service.http.routes.curves import CURVE, CURVE_TYPES, FILE_NAMES
from service.http.routes.parameters import problems
from service.http.routes.renders import RenderAtHand
from service.http.service import Service, ServiceDep
from service.jobs.frame_ranges import parse_frames
from service.models.curve import CurveFileFormat
from service.models.focus_reports import FocusReport, ReportFormat
from service.models.render_products import ProductName
from service.storage.database.tables import RenderRow

router = APIRouter(tags=["renders"], prefix="/renders", dependencies=READS)

REPORT_TYPES: dict[ReportFormat, str] = {
    "json": "application/json",
    "csv": "text/csv; charset=utf-8",
    "html": "text/html; charset=utf-8",
}


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
                },
                "text/html": {"schema": {"type": "string"}, "example": "<!doctype html>"},
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
            description="`json`; `csv` for spreadsheets, with a row for each focus point of each frame and no summary; or "
            "`html`, a page to read and print, with a chart, who is sharp when, and the keys.",
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
    name = cast(ProductName, f"focus-report.{format}")
    text = None if frames is not None else await _stored(service, render, name)
    if text is None:
        wanted = reported(render, _chosen(render, frames))
        text = await write_report(service, render, wanted, format)
    return _answer(render, text, f"focus.{format}", REPORT_TYPES[format])


@router.get(
    "/{render}/focus-curve",
    operation_id="getRenderFocusCurve",
    response_class=Response,
    responses=problems(404, 409, 423, 503) | CURVE,
)
async def get_render_focus_curve(
    service: ServiceDep,
    render: RenderAtHand,
    format: Annotated[
        CurveFileFormat, Query(description="As of `getFocusCurve`, without `baked`.", examples=["csv"])
    ] = "json",
) -> Response:
    """Focus curve of the frames of a render, with the edits that the render keeps. It needs no picture."""
    name = cast(ProductName, f"focus-curve.{format}")
    text = await _stored(service, render, name)
    if text is None:
        text = await write_curve(service, render, format)
    return _answer(render, text, FILE_NAMES[format], CURVE_TYPES[format])


async def _stored(service: Service, render: RenderRow, name: ProductName) -> bytes | str | None:
    """Return what the job of a render has made; None where it has not."""
    product = await run_in_threadpool(service.render_products.stored, render, name)
    if product is None:
        return None
    with suppress(FileNotFoundError):  # it was removed meanwhile
        return await run_in_threadpool(product.path.read_bytes)
    return None


def _answer(render: RenderRow, text: bytes | str, name: str, media_type: str) -> Response:
    kind = (
        "attachment" if name.endswith("html") else "inline"
    )  # a page with the names of a shot is not shown at this address
    headers = {"Content-Disposition": f'{kind}; filename="{render.id}-{name}"'}
    return Response(text, media_type=media_type, headers=headers)


def _chosen(render: RenderRow, frames: str | None) -> list[int]:
    """Return the frames that a report is about.

    Raises:
        SettingsError: the frames are no range.
        NotFoundError: they are not all of the render.
    """
    chosen = parse_frames(render.frames)
    if frames is None:
        return chosen
    own, chosen = set(chosen), parse_frames(frames)
    other = next((frame for frame in chosen if frame not in own), None)
    if other is not None:
        detail = f"render {render.id!r} has no frame {other}, it has {render.frames[:200]}"
        raise NotFoundError(detail, code="frame_not_found", path="frames")
    return chosen
