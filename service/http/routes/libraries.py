"""The libraries of films and of camera bodies."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query, Response
from pydantic import Field

from service.http.routes.parameters import SHEET, problems, sheet
from service.http.service import ServiceDep
from service.models.bodies import Body, BodyList
from service.models.films import Film, FilmList
from service.stage.calls import libraries

router = APIRouter(tags=["libraries"])

USUAL_LENSES_MM = (18.0, 25.0, 35.0, 50.0, 75.0, 100.0)

FilmName = Annotated[str, Path(alias="name", description="A stock's name.", examples=["velvia_50"], max_length=80)]
BodyName = Annotated[str, Path(alias="name", description="A body's name.", examples=["alexa_35"], max_length=80)]


@router.get("/films", operation_id="listFilms", responses=problems(503, 504))
async def list_films(service: ServiceDep) -> FilmList:
    """The film library; the names of its camera stocks are what an edit of a camera's film takes as `stock`."""
    return await service.call_stage(libraries.list_films)


@router.get("/films/{name}", operation_id="getFilm", responses=problems(404, 503, 504))
async def get_film(service: ServiceDep, name: FilmName) -> Film:
    """A stock of the library, and what is known of it. A part of the name that no other has is enough."""
    return await service.call_stage(libraries.read_film, name)


@router.get(
    "/films/{name}/sheet.png",
    operation_id="getFilmSheet",
    response_class=Response,
    responses=problems(404, 503, 504) | SHEET,
)
async def get_film_sheet(service: ServiceDep, name: FilmName) -> Response:
    """All about a stock on one sheet: its curves, a ramp of greys, a colour chart, its grain, and a scene on it."""
    return sheet(await service.call_stage(libraries.draw_film_sheet, name))


@router.get("/bodies", operation_id="listBodies", responses=problems(503, 504))
async def list_bodies(service: ServiceDep) -> BodyList:
    """Camera bodies and film formats, whose names are what an edit of a camera takes as `body`; and shapes of pictures."""
    return await service.call_stage(libraries.list_bodies)


@router.get("/bodies/{name}", operation_id="getBody", responses=problems(404, 503, 504))
async def get_body(
    service: ServiceDep,
    name: BodyName,
    focal_length_mm: Annotated[
        list[Annotated[float, Field(gt=0, le=100_000, allow_inf_nan=False)]] | None,
        Query(
            alias="focalLengthMm",
            max_length=50,
            description="To tell fields of view for; usual ones when left out.",
            examples=[[35]],
        ),
    ] = None,
) -> Body:
    """A camera body, and what it shows: fields of view, and framing guides for usual shapes of pictures."""
    return await service.call_stage(libraries.read_body, name, tuple(focal_length_mm or USUAL_LENSES_MM))
