"""Parameters and answers that several routes share."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import Depends, Header, Path, Query, Response

from service.edit_context import EditContext
from service.models.base import MAX_POINT_NAME, PrimPath, Problem, TimeCode

ShotId = Annotated[str, Path(alias="shot", description="A shot's id.", examples=["demo"], max_length=80)]
PointNameInPath = Annotated[
    str, Path(alias="name", max_length=MAX_POINT_NAME, description="A focus point's name.", examples=["driver"])
]
Time = Annotated[TimeCode, Query(allow_inf_nan=False, description="USD time code.", examples=[24])]
CameraQuery = Annotated[
    PrimPath | None,
    Query(description="Prim path; the shot's default camera when left out.", examples=["/World/Camera"]),
]

AspectQuery = Annotated[
    float | None,
    Query(
        gt=0,
        allow_inf_nan=False,
        description="Width over height of the picture; the film gate's when left out.",
        examples=[1.7778],
    ),
]


IfMatch = Annotated[
    str | None,
    Header(
        max_length=8000,
        description="The `ETag` of what is edited, as it was read: the edit is refused with 412 if somebody changed it "
        "since. Left out: whatever is there is edited.",
        examples=['"5f70bf18a0860070"'],
    ),
]


def _edit_context(
    if_match: IfMatch = None,
    gesture: Annotated[
        str,
        Query(
            max_length=64,
            description="Names one drag of a hand: its edits, one after the other, are one step of undo.",
            examples=["drag-17"],
        ),
    ] = "",
) -> EditContext:
    return EditContext(if_match, gesture)


EditContextDep = Annotated[EditContext, Depends(_edit_context)]

SHEET: dict[int | str, dict[str, Any]] = {
    200: {"content": {"image/png": {"schema": {"type": "string", "format": "binary"}}}, "description": "The sheet."}
}
"""OpenAPI's description of an answer by `sheet`."""
DRAWING_KEPT_S = 3600


def sheet(png: bytes) -> Response:
    """A sheet about something of a library as an answer; browsers may keep it for a while."""
    return Response(png, media_type="image/png", headers={"Cache-Control": f"private, max-age={DRAWING_KEPT_S}"})


def tagged(response: Response, etag: str) -> None:
    """Give an answer the entity tag of what it is about.

    What is solved may differ under the same tag (`service.edit_context`), so nobody may keep the answer.

    Args:
        response: FastAPI's, which the answer's headers come from.
        etag: quotes included.
    """
    response.headers["ETag"] = etag
    response.headers["Cache-Control"] = "no-store"


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """OpenAPI's description of the errors that a route answers with, beside 422."""
    said = {
        404: "There is no such shot, camera, lens, film, body, focus point, key or revision.",
        409: "`superseded`: a newer request of the same client took this one's place. `nothing_to_undo`, `nothing_to_redo`.",
        412: "Somebody changed it since it was read: its `ETag` is not what `If-Match` says.",
        413: "More was sent, or unpacked, than is taken.",
        415: "What was sent is no file of the kinds that are taken.",
        422: "The request, or the stage that it is about, cannot be used; says why.",
        426: "Ask for it over a WebSocket.",
        503: "Too many wait, or a worker died on this request; try again after `Retry-After`.",
        504: "It took too long and was ended.",
    }
    return {status: {"model": Problem, "description": said[status]} for status in sorted({422, *statuses})}
