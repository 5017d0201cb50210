"""Parameters, headers and documented errors that several routes share."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import Depends, Header, Path, Query, Response

from service.edit_context import EditContext
from service.models.base import MAX_POINT_NAME, PrimPath, Problem, TimeCode

ShotId = Annotated[str, Path(alias="shot", description="A shot's id.", examples=["demo"], max_length=80)]
PointNameInPath = Annotated[
    str, Path(alias="name", max_length=MAX_POINT_NAME, description="A focus point's name.", examples=["pip"])
]
Time = Annotated[TimeCode, Query(allow_inf_nan=False, description="USD time code.", examples=[24])]
CameraQuery = Annotated[
    PrimPath | None,
    Query(description="Prim path; the shot's default camera when left out.", examples=["/World/main_cam"]),
]

AspectQuery = Annotated[
    float | None,
    Query(
        ge=0.01,
        le=100,
        allow_inf_nan=False,
        description="Width over height of the picture; the film gate's when left out.",
        examples=[1.7778],
    ),
]


IfMatch = Annotated[
    str | None,
    Header(
        max_length=8000,
        description="The `ETag` of the edited thing, as it was read: the edit is refused with 412 if it has changed since. "
        "Left out: the edit is unconditional.",
        examples=['"e3b0c44298fc1c14"'],
    ),
]


def _edit_context(
    if_match: IfMatch = None,
    gesture: Annotated[
        str,
        Query(
            max_length=64,
            description="Name of one drag; all its edits in succession are one step of undo.",
            examples=["drag-17"],
        ),
    ] = "",
) -> EditContext:
    return EditContext(if_match, gesture)


EditContextDep = Annotated[EditContext, Depends(_edit_context)]

SHEET: dict[int | str, dict[str, Any]] = {
    200: {"content": {"image/png": {"schema": {"type": "string", "format": "binary"}}}, "description": "The sheet."}
}
"""OpenAPI description of an answer by `sheet_response`."""
DRAWING_MAX_AGE_S = 3600


def sheet_response(png: bytes) -> Response:
    """Return a data sheet as an answer that browsers may cache."""
    return Response(png, media_type="image/png", headers={"Cache-Control": f"private, max-age={DRAWING_MAX_AGE_S}"})


def set_etag(response: Response, etag: str) -> None:
    """Set the entity tag of an answer and forbid caching it.

    Solved values may differ under the same tag (`service.edit_context`).

    Args:
        response: the response that FastAPI takes headers from.
        etag: the tag, quotes included.
    """
    response.headers["ETag"] = etag
    response.headers["Cache-Control"] = "no-store"


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI description of the errors of a route, to which 422 is added."""
    return _described(*sorted({422, *statuses}))


def refusals() -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI description of the errors of every route that needs a scope."""
    return _described(401, 403, 429)


def _described(*statuses: int) -> dict[int | str, dict[str, Any]]:
    descriptions = {
        400: "The body is no form of the kind that its `Content-Type` names.",
        401: "A key or token is missing, wrong or expired.",
        403: "The key or token lacks the scope that this needs, or a page of another site sends the request.",
        404: "There is no such shot, camera, lens, film, body, focus point, key, webhook or revision, or nothing of this id in "
        "the trash.",
        409: "`superseded`: a newer request of the same client replaced this one. `nothing_to_undo`, `nothing_to_redo`. "
        "`shot_exists`: there is a shot of this id again. `too_many_webhooks`.",
        412: "It was changed since it was read: its `ETag` is not in `If-Match`.",
        413: "The upload, or what it unpacks to, is too large.",
        415: "The file is of no supported kind.",
        416: "It has no such part; `Content-Range` says how many bytes it has.",
        422: "The request or the stage is invalid, or takes more than a worker has; `detail` says why.",
        423: "The shot is in quarantine, because it has ended worker processes; `releaseShot` lets it be opened again.",
        426: "This address is a WebSocket.",
        429: "Too many requests, or a quota is used up; try again after `Retry-After`.",
        503: "Too many requests wait, or a worker died on this request; try again after `Retry-After`.",
    }
    return {status: {"model": Problem, "description": descriptions[status]} for status in statuses}
