"""Requests of frames as the picture process takes them, and their entity tags; for the route and for live connections."""

from __future__ import annotations

from collections.abc import Sequence

from render.model.edit_history import revision_of
from service.http.frame_cache import frame_tag
from service.http.service import Service
from service.models.frames import FrameQuery, PictureQuery
from service.models.picture_limits import PictureLimits
from service.picture.requests import FrameRequest
from service.storage.store import ShotRecord

FINISH = {"film", "display", "view", "look"}


def tag_of_frame(service: Service, record: ShotRecord, edits: str, query: FrameQuery) -> str:
    """Return the entity tag of a picture, its key in the cache: a hash of everything that the picture depends on.

    The files of a shot never change, but a shot of the same id may be uploaded again.
    """
    parameters = query.model_dump(mode="json", exclude={"client"})
    return frame_tag(parameters | _inputs(service, record, edits))


def focus_tag(service: Service, record: ShotRecord, edits: str, query: PictureQuery) -> str:
    """Return the entity tag of the focus map of a picture; see `tag_of_frame`. Rays, film and grade do not matter to it."""
    parameters = query.model_dump(mode="json", include={"camera", "time", "width", "height", "engine"})
    return frame_tag(parameters | _inputs(service, record, edits) | {"map": "focus"})


def exposure_tag(service: Service, record: ShotRecord, edits: str, query: PictureQuery) -> str:
    """Return the entity tag of the exposure map of a picture; see `tag_of_frame`."""
    parameters = query.model_dump(mode="json", include={"camera", "time", "width", "height"})
    return frame_tag(parameters | _inputs(service, record, edits) | {"map": "exposure"})


def _inputs(service: Service, record: ShotRecord, edits: str) -> dict[str, str]:
    """Return what all answers about a shot depend on."""
    created = record.created_at.isoformat()
    return {"shot": record.id, "created": created, "edits": revision_of(edits), "run": service.run_id}


def frame_request(
    record: ShotRecord, edits: str, query: PictureQuery, limits: PictureLimits, aovs: Sequence[str] = ()
) -> FrameRequest:
    """Return a query as the picture process takes it.

    Args:
        record: the shot.
        edits: text of its edit layer.
        query: what is asked for.
        limits: what the picture may have.
        aovs: measured beside the colour, for EXR files.
    """
    settings = query.model_dump(include=set(PictureQuery.model_fields) - {"camera", "time", "height", *FINISH})
    return FrameRequest(
        record=record,
        edits=edits,
        camera=query.camera,
        time=query.time,
        height=query.height,
        limits=limits,
        settings=settings | {"aovs": ("color", *aovs)},
        finish=query.model_dump(include=FINISH),
    )
