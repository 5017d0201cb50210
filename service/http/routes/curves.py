"""Focus curves: what the lens does over time, for other tools."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, File, Query, Response, UploadFile

from service.http.access import EDITS, READS
from service.http.bodies import BodyRoute
from service.http.routes.parameters import CameraQuery, EditContextDep, ShotId, problems, set_etag
from service.http.service import ServiceDep
from service.models.changes import GapPolicy, ImportCurve
from service.models.curve import CURVE_EXAMPLE, CurveFile, CurveFileFormat, ImportedCurve
from service.stage.calls import curves

router = APIRouter(tags=["focus"], route_class=BodyRoute, responses=problems(404, 423, 503), dependencies=READS)

CURVE_TYPES: dict[CurveFileFormat, str] = {
    "json": "application/json",
    "csv": "text/csv; charset=utf-8",
    "usda": "text/plain; charset=utf-8",
    "otio": "application/json",
    "opentrackio": "application/json",
}
FILE_NAMES: dict[CurveFileFormat, str] = {
    "json": "focus.json",
    "csv": "focus.csv",
    "usda": "focus.usda",
    "otio": "focus.otio",
    "opentrackio": "focus.opentrackio.json",
}
CURVE: dict[int | str, dict[str, Any]] = {
    200: {
        "model": CurveFile,
        "content": {
            "application/json": {"example": CURVE_EXAMPLE},
            "text/csv": {"schema": {"type": "string"}, "example": "frame,time_code,seconds,focus_distance_m\r\n"},
            "text/plain": {"schema": {"type": "string"}, "example": "#usda 1.0\n"},
        },
    }
}
"""Answer with a focus curve."""


@router.get(
    "/shots/{shot}/focus-curve",
    operation_id="getFocusCurve",
    response_class=Response,
    responses=CURVE,
)
async def get_focus_curve(
    service: ServiceDep,
    shot: ShotId,
    camera: CameraQuery = None,
    format: Annotated[
        CurveFileFormat,
        Query(
            description="What to write: `json` (a `FocusCurve`), `csv` for spreadsheets, `usda` to sublayer over the shot, "
            "`otio` for editorial (an OpenTimelineIO `Timeline`), `opentrackio` for the set (a list of OpenTrackIO samples).",
            examples=["json"],
        ),
    ] = "json",
    frames: Annotated[
        str | None,
        Query(max_length=200, description="Such as 1:96 or 1,5:9x2; the whole shot when left out.", examples=["1:96"]),
    ] = None,
    baked: Annotated[bool, Query(description="usda: time samples in place of a spline.", examples=[False])] = False,
) -> Response:
    """Focus distance, f-number, tilt and depth of field frame by frame, and who is sharp."""
    record = service.store.get(shot)
    max_frames = service.settings.max_curve_frames
    text = await service.call_reader(curves.compute_curve, record, camera, frames, format, baked, max_frames)
    headers = {"Content-Disposition": f'inline; filename="{record.id}-{FILE_NAMES[format]}"'}
    return Response(text, media_type=CURVE_TYPES[format], headers=headers)


@router.put(
    "/shots/{shot}/focus-curve", operation_id="importFocusCurve", responses=problems(412, 413), dependencies=EDITS
)
async def import_focus_curve(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    context: EditContextDep,
    file: Annotated[
        UploadFile, File(description="A csv, json, OpenTrackIO or OpenTimelineIO file with a focus curve.")
    ],
    camera: CameraQuery = None,
    gaps: Annotated[
        GapPolicy,
        Query(description="What becomes of rows that are missing or cannot be used.", examples=["interpolate"]),
    ] = "refuse",
    first_frame: Annotated[
        float | None,
        Query(
            alias="firstFrame",
            ge=-1e9,
            le=1e9,
            allow_inf_nan=False,
            description="Time code where the file's first frame comes to lie. Left out: frame numbers are kept, and what ran "
            "by timecode begins where the shot does.",
            examples=[1001],
        ),
    ] = None,
    baked: Annotated[bool, Query(description="Time samples in place of splines.", examples=[False])] = False,
) -> ImportedCurve:
    """Put a focus curve that another tool made onto a camera, which is then focused by hand. `If-Match` is the camera's."""
    change = ImportCurve(content=await file.read(), gaps=gaps, first_frame=first_frame, baked=baked)
    imported = await service.call_stage(
        curves.import_curve, service.store.get(shot), camera, change, service.settings.max_curve_frames, context
    )
    set_etag(response, imported.camera.etag)
    return imported
