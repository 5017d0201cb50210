"""Parameters and answers that several routes share."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import Path, Query

from service.models.base import PrimPath, Problem, TimeCode

ShotId = Annotated[str, Path(alias="shot", description="A shot's id.", examples=["demo"], max_length=80)]
PointNameInPath = Annotated[str, Path(alias="name", description="A focus point's name.", examples=["driver"])]
Time = Annotated[TimeCode, Query(allow_inf_nan=False, description="USD time code.", examples=[24])]
CameraQuery = Annotated[
    PrimPath | None,
    Query(description="Prim path; the shot's default camera when left out.", examples=["/World/Camera"]),
]


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """OpenAPI's description of the errors that a route answers with, beside 422."""
    said = {
        404: "There is no such shot, camera, lens, focus point, key or revision.",
        409: "`superseded`: a newer request of the same client took this one's place.",
        413: "More was sent, or unpacked, than is taken.",
        415: "What was sent is no file of the kinds that are taken.",
        422: "The request, or the stage that it is about, cannot be used; says why.",
        503: "Too many wait, or a worker died on this request; try again after `Retry-After`.",
        504: "It took too long and was ended.",
    }
    return {status: {"model": Problem, "description": said[status]} for status in sorted({422, *statuses})}
