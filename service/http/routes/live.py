"""Route of live pictures over a WebSocket, for interactive edits."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, FastAPI, WebSocket
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from service.http.errors import RETRY_AFTER, ServiceError, problem
from service.http.live_connection import LiveConnection
from service.http.routes.parameters import ShotId, problems
from service.http.service import ServiceDep
from service.models.live import LiveAck, LivePictureHead, LiveProblem, LiveReadout, LiveRequest, LiveStop

router = APIRouter(tags=["frames"])

PROTOCOL = """A WebSocket at this address streams pictures that get better and better, until the exact one.

**You send** text. A `LiveRequest` asks for a picture; it takes the place of the request before, whose further pictures are not
made (one that has shown nothing yet shows one). With `moving` there is one picture for it, within `budgetMs` or nearly;
without, further ones follow until the `final` one, whose bytes are those of `getFrame` and of `pullfocus record`. The
`changes`, those that an edit takes, are tried in these pictures and not kept: while a slider is dragged send them along, and
edit once it is let go. A `LiveAck` says that a picture has arrived: at most two are on their way, and of those that wait for an
ack the newest alone is kept. A `LiveStop` says that nothing of what was asked for is wanted any more, say since a picture from
before is shown again; a picture that is on its way then still comes.

**You get**, as binary messages, pictures: the length of a head as four bytes, big end first; the head, a `LivePictureHead` as
JSON; the picture, a JPEG or, where it is final, a PNG. And as text `LiveReadout`, what the lens does in pictures that try
changes, and `LiveProblem`, why there is no picture.

Browsers may open it from the service's own page alone: an `Origin` has to agree with the `Host`."""


_FROM_CLIENT: tuple[type[BaseModel], ...] = (LiveRequest, LiveAck, LiveStop)
_TO_CLIENT: tuple[type[BaseModel], ...] = (LivePictureHead, LiveReadout, LiveProblem)


def describe_messages(app: FastAPI) -> None:
    """Add the messages of the WebSocket to the OpenAPI document, which describes only HTTP by itself.

    Args:
        app: the application.
    """
    build = app.openapi
    models = [*((model, "validation") for model in _FROM_CLIENT), *((model, "serialization") for model in _TO_CLIENT)]
    _, definitions = models_json_schema(models, ref_template="#/components/schemas/{model}")  # type: ignore[arg-type]

    def described() -> dict[str, Any]:
        document = build()
        document["components"]["schemas"] = definitions["$defs"] | document["components"]["schemas"]
        return document

    app.openapi = described  # type: ignore[method-assign]


@router.websocket("/shots/{shot}/live")
async def connect_live(socket: WebSocket, service: ServiceDep, shot: ShotId) -> None:
    """Stream pictures; see `PROTOCOL`."""
    if len(service.live_sockets) >= service.settings.max_viewers:
        detail = f"{len(service.live_sockets)} live connections are open already; try again later."
        await socket.send_denial_response(problem(503, "busy", detail, headers=RETRY_AFTER))
        return
    service.live_sockets.add(socket)
    service.metrics.live_viewers.inc()
    try:
        await socket.accept()
        await LiveConnection(service, socket, shot).serve()
    finally:
        service.live_sockets.discard(socket)
        service.metrics.live_viewers.dec()


@router.get(
    "/shots/{shot}/live",
    operation_id="watch",
    status_code=101,
    response_model=None,
    description=PROTOCOL,
    responses=problems(426, 503) | {101: {"description": "The connection becomes a WebSocket."}},
)
async def refuse_without_upgrade(shot: ShotId) -> None:
    """Refuse a plain HTTP request: this address is a WebSocket."""
    raise ServiceError(
        426, "upgrade_required", "Live pictures come over a WebSocket.", path=shot, headers={"Upgrade": "websocket"}
    )
