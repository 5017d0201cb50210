"""Routes of the lens library, and the upload of a lens file for a camera."""

from __future__ import annotations

import math
from typing import Annotated

from fastapi import APIRouter, File, Path, Query, Response, UploadFile

from service.http.access import EDITS, READS
from service.http.bodies import BodyRoute
from service.http.routes.parameters import (
    DRAWING_MAX_AGE_S,
    SHEET,
    CameraQuery,
    EditContextDep,
    ShotId,
    problems,
    set_etag,
    sheet_response,
)
from service.http.service import ServiceDep
from service.http.upload import lens_file_name
from service.models.cameras import CameraState
from service.models.changes import MountLensFile
from service.models.lenses import Lens, LensList
from service.stage.calls import cameras, lenses

router = APIRouter(tags=["lenses"], route_class=BodyRoute, dependencies=READS)

SVG = "image/svg+xml"

LensName = Annotated[str, Path(alias="name", description="A lens's name.", examples=["planar_50"], max_length=80)]


FocalLength = Annotated[float | None, Query(gt=0, le=1e5, allow_inf_nan=False, examples=[50])]
Year = Annotated[int | None, Query(ge=0, le=9999, examples=[1954])]


@router.get("/lenses", operation_id="listLenses", responses=problems(503))
async def list_lenses(
    service: ServiceDep,
    focal_length_min: Annotated[FocalLength, Query(alias="focalLengthMin", description="Shortest, mm.")] = None,
    focal_length_max: Annotated[FocalLength, Query(alias="focalLengthMax", description="Longest, mm.")] = None,
    faster_than: Annotated[
        float | None,
        Query(
            alias="fasterThan",
            gt=0,
            le=1e3,
            allow_inf_nan=False,
            description="Largest f-number wide open.",
            examples=[2],
        ),
    ] = None,
    family: Annotated[
        str,
        Query(max_length=40, description="One of the words of `families`; others are refused.", examples=["petzval"]),
    ] = "",
    year_min: Annotated[Year, Query(alias="yearMin", description="First year of the patent or publication.")] = None,
    year_max: Annotated[Year, Query(alias="yearMax", description="Last year of the patent or publication.")] = None,
    search: Annotated[
        str,
        Query(
            max_length=200,
            description="Words that all occur in its name, title, maker, description, source or families.",
            examples=["zeiss"],
        ),
    ] = "",
) -> LensList:
    """List the lens library, or what a search finds in it. Its names are the values of `lens` in an edit of a camera."""
    return await service.call_stage(
        lenses.list_lenses,
        (focal_length_min or 0.0, focal_length_max or math.inf),
        faster_than or math.inf,
        family,
        (-math.inf if year_min is None else year_min, math.inf if year_max is None else year_max),
        search,
    )


@router.get("/lenses/{name}", operation_id="getLens", responses=problems(404, 503))
async def get_lens(service: ServiceDep, name: LensName) -> Lens:
    """Read a lens of the library with its optical data."""
    return await service.call_stage(lenses.read_library_lens, name)


@router.get(
    "/lenses/{name}/section.svg",
    operation_id="getLensSection",
    response_class=Response,
    responses=problems(404, 503)
    | {200: {"content": {SVG: {"schema": {"type": "string", "format": "binary"}}}, "description": "The picture."}},
)
async def get_lens_section(service: ServiceDep, name: LensName) -> Response:
    """Draw the section of a lens of the library with its rays, wide open and focused at infinity."""
    section = await service.call_stage(lenses.draw_lens_section, name)
    return Response(section, media_type=SVG, headers={"Cache-Control": f"private, max-age={DRAWING_MAX_AGE_S}"})


@router.get(
    "/lenses/{name}/sheet.png",
    operation_id="getLensSheet",
    response_class=Response,
    responses=problems(404, 503) | SHEET,
)
async def get_lens_sheet(service: ServiceDep, name: LensName) -> Response:
    """Draw the data sheet of a lens: its section, its numbers, its errors over the field, and its bokeh."""
    return sheet_response(await service.call_stage(lenses.draw_lens_sheet, name))


@router.put(
    "/shots/{shot}/camera/lens",
    operation_id="mountLensFile",
    responses=problems(404, 412, 413, 415, 423, 503),
    tags=["cameras"],
    dependencies=EDITS,
)
async def mount_lens_file(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    file: Annotated[
        UploadFile,
        File(description="A lens file: .dat, .zmx, .seq, .txt, .roa, .json or .lens."),
    ],
    context: EditContextDep,
    camera: CameraQuery = None,
) -> CameraState:
    """Mount the lens of a lens file: its glass and its focal length, with the f-number limited to the lens's own."""
    name = lens_file_name(file.filename)
    change = MountLensFile(file_name=name, content=await file.read())
    state = await service.call_stage(cameras.change_camera, service.store.get(shot), camera, change, None, context)
    set_etag(response, state.etag)
    return state
