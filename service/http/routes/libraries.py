"""Routes of the libraries of film stocks and camera bodies."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query, Response
from pydantic import Field

from service.http.access import READS
from service.http.routes.parameters import SHEET, problems, sheet_response
from service.http.service import ServiceDep
from service.models.libraries import Body, BodyList, Film, FilmList
from service.stage.calls import libraries

router = APIRouter(tags=["libraries"], dependencies=READS)

USUAL_LENSES_MM = (18.0, 25.0, 35.0, 50.0, 75.0, 100.0)

FilmName = Annotated[str, Path(alias="name", description="A stock's name.", examples=["velvia_50"], max_length=80)]
BodyName = Annotated[str, Path(alias="name", description="A body's name.", examples=["alexa_35"], max_length=80)]


@router.get("/films", operation_id="listFilms", responses=problems(503))
async def list_films(service: ServiceDep) -> FilmList:
    """List the film library. The names of its camera stocks are the values of `stock` in an edit of a camera's film."""
    return await service.call_stage(libraries.list_films)


@router.get("/films/{name}", operation_id="getFilm", responses=problems(404, 503))
async def get_film(service: ServiceDep, name: FilmName) -> Film:
    """Read a stock of the library with its data. An unambiguous part of the name is enough."""
    return await service.call_stage(libraries.read_film, name)


@router.get(
    "/films/{name}/sheet.png",
    operation_id="getFilmSheet",
    response_class=Response,
    responses=problems(404, 503) | SHEET,
)
async def get_film_sheet(service: ServiceDep, name: FilmName) -> Response:
    """Draw the data sheet of a stock: its curves, a grey ramp, a colour chart, its grain and a scene."""
    return sheet_response(await service.call_stage(libraries.draw_film_sheet, name))


@router.get("/bodies", operation_id="listBodies", responses=problems(503))
async def list_bodies(service: ServiceDep) -> BodyList:
    """List camera bodies and film formats, whose names are the values of `body` in an edit of a camera, and aspect ratios."""
    return await service.call_stage(libraries.list_bodies)


@router.get("/bodies/{name}", operation_id="getBody", responses=problems(404, 503))
async def get_body(
    service: ServiceDep,
    name: BodyName,
    focal_length_mm: Annotated[
        list[Annotated[float, Field(gt=0, le=100_000, allow_inf_nan=False)]] | None,
        Query(
            alias="focalLengthMm",
            max_length=50,
            description="Focal lengths of the fields of view; usual ones when left out.",
            examples=[[35]],
        ),
    ] = None,
) -> Body:
    """Read a camera body with its fields of view, and framing guides for the usual aspect ratios."""
    return await service.call_stage(libraries.read_body, name, tuple(focal_length_mm or USUAL_LENSES_MM))
