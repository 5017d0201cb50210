"""Routes of what is made of the frames of a render: movies, contact sheets and small pictures."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import FileResponse

from service.http.access import READS, RENDERS
from service.http.product_making import find_product
from service.http.render_products import Product
from service.http.routes.frames import BINARY
from service.http.routes.parameters import SHEET, problems
from service.http.routes.renders import FrameInPath, RenderAtHand, file_of
from service.http.service import Service, ServiceDep
from service.models.base import plain_file_name
from service.models.render_products import ProductName
from service.models.renders import MovieFormat
from service.picture.requests import THUMBNAIL
from service.storage.database.tables import RenderRow, TaskRow

router = APIRouter(tags=["renders"], prefix="/renders", dependencies=RENDERS)
thumbnails = APIRouter(tags=["renders"], prefix="/renders", dependencies=READS)

MOVIE_TYPES: dict[MovieFormat, str] = {"mp4": "video/mp4", "mov": "video/quicktime", "webm": "video/webm"}


@router.get(
    "/{render}/movie",
    operation_id="getRenderMovie",
    response_class=FileResponse,
    responses=problems(404, 409, 503)
    | {200: {"content": dict.fromkeys(MOVIE_TYPES.values(), BINARY), "description": "The movie."}},
)
async def get_movie(
    service: ServiceDep,
    render: RenderAtHand,
    format: Annotated[
        MovieFormat,
        Query(description="`mp4` is H.264, `mov` ProRes 422 HQ, `webm` VP9.", examples=["mp4"]),
    ] = "mp4",
) -> FileResponse:
    """Make a movie of the frames of a render that has ended, or take the one that was made before."""
    names: dict[MovieFormat, ProductName] = {"mp4": "movie.mp4", "mov": "movie.mov", "webm": "movie.webm"}
    return _answer(render, await find_product(service, render, names[format]), MOVIE_TYPES[format])


@router.get(
    "/{render}/contact-sheet",
    operation_id="getRenderContactSheet",
    response_class=FileResponse,
    responses=problems(404, 409, 503) | SHEET,
)
async def get_contact_sheet(service: ServiceDep, render: RenderAtHand) -> FileResponse:
    """Draw the frames of a render that has ended on one PNG, with their numbers; of more than 96 some at even distances."""
    return _answer(render, await find_product(service, render, "contact-sheet.png"), "image/png")


@thumbnails.get(
    "/{render}/frames/{frame}/thumbnail",
    operation_id="getRenderedThumbnail",
    response_class=FileResponse,
    responses=problems(404, 409) | {200: {"content": {"image/jpeg": BINARY}, "description": "The small picture."}},
)
def get_thumbnail(service: ServiceDep, render: RenderAtHand, frame: FrameInPath) -> FileResponse:
    """Take a small picture, 240 px wide at most, of a frame that a render has drawn, in whatever formats it is."""
    return _thumbnail(service, render, service.renders.task(render.id, frame))


@thumbnails.get(
    "/{render}/thumbnail",
    operation_id="getLastThumbnail",
    response_class=FileResponse,
    responses=problems(404, 409) | {200: {"content": {"image/jpeg": BINARY}, "description": "The small picture."}},
)
def get_last_thumbnail(service: ServiceDep, render: RenderAtHand) -> FileResponse:
    """Take a small picture of the frame that a render has drawn last."""
    return _thumbnail(service, render, service.renders.lookups.last_task(render.id))


def _thumbnail(service: Service, render: RenderRow, task: TaskRow) -> FileResponse:
    path, headers = file_of(service, render, task, THUMBNAIL)
    return FileResponse(path, media_type="image/jpeg", filename=f"{task.frame:04d}.jpeg", headers=headers)


def _answer(render: RenderRow, product: Product, media_type: str) -> FileResponse:
    headers = {"ETag": product.etag, "Cache-Control": "private, no-cache"}
    name = f"{plain_file_name(render.name) or 'render'}{product.path.suffix}"
    return FileResponse(product.path, media_type=media_type, filename=name, headers=headers)
