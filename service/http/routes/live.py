"""Route of live pictures over a WebSocket, for interactive edits."""

from __future__ import annotations

import asyncio
from contextlib import ExitStack, suppress
from typing import Annotated, Any

from fastapi import APIRouter, FastAPI, Query, WebSocket
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from service.http.access import RENDERS, PrincipalDep
from service.http.clients import present_client
from service.http.errors import RETRY_AFTER, ServiceError, problem
from service.http.identity import Identity, IdentityDep
from service.http.live_connection import LiveConnection
from service.http.live_places import LivePlace
from service.http.routes.parameters import ShotId, problems
from service.http.service import ServiceDep
from service.models.events import Event, EventGap
from service.models.exposure_maps import ExposureMapHead
from service.models.focus_maps import FocusMapHead
from service.models.live import (
    LiveAck,
    LiveHere,
    LivePictureHead,
    LiveProblem,
    LiveReadout,
    LiveRequest,
    LiveStop,
    LiveViewers,
)

ENDED_CODE, ENDED_REASON = 1008, "The key or the session has ended: sign in again."
"""Close of a WebSocket whose sender is no longer let in (RFC 6455, section 7.4.1)."""
TAKEN_CODE, TAKEN_REASON = 1013, "Others need the place of this connection: try again later."
"""Close of a WebSocket whose place another client has taken (1013, try again later, in the registry of IANA)."""
CHECK_PAUSE_S = 1.0
"""Time between two looks at whether the sender of a WebSocket is still let in."""

router = APIRouter(tags=["frames"], dependencies=RENDERS)

PROTOCOL = """Connect a WebSocket to this address for a stream of pictures that get better, up to the exact one.

**The client sends** text. A `LiveRequest` asks for pictures of a frame. It replaces the request before, which sends no further
picture (a request that has not sent any yet still sends one). With `moving` it is answered by one picture, within about
`budgetMs`; without, further pictures follow up to the `final` one, whose bytes are those of `getFrame` and `pullfocus record`.
Its `changes`, as in an edit, apply to these pictures only: send them while a slider is dragged, and send an edit when it is
released. A `LiveAck` acknowledges a picture. At most two pictures are unacknowledged; of those that wait, only the newest is
kept. A `LiveStop` cancels all requests; a picture that is being sent still arrives. A `LiveHere` tells where the client looks
while it asks for nothing.

**The service sends** pictures as binary messages: the length of the head as four bytes, big-endian; the head, a
`LivePictureHead` as JSON; the picture, a JPEG, or a PNG where it is final; its focus map, where the request's `focusMaps` asks
for that. It sends text for a `LiveReadout`, the lens readout of pictures with changes and the sharpness of their focus points,
and a `LiveProblem`, the reason why there is no picture. With `viewers=true` in the address the connection sees, and is seen by,
the others of the shot that have it: the service sends `LiveViewers`, at which frame each of them is, again whenever that changes.
A place is that of the newest request or `LiveHere`. Whoever moves how often, the viewers of a shot get at most 4 such messages a
second each, and 50 all together.

When the key or the session of the client ends, the service closes the connection with the code 1008. The connections that may be
open at a time are shared by keys or, where there are none, by addresses (/64 networks of IPv6): once all are open, a client with
at least two fewer than whoever has the most takes the newest one of those, which is closed with the code 1013.

Browsers may connect only from the service's own page: the `Origin` has to match the `Host`."""


_FROM_CLIENT: tuple[type[BaseModel], ...] = (LiveRequest, LiveAck, LiveStop, LiveHere)
_TO_CLIENT: tuple[type[BaseModel], ...] = (
    LivePictureHead,
    LiveReadout,
    LiveProblem,
    LiveViewers,
    FocusMapHead,
    Event,
    EventGap,
)
_HEADS: tuple[type[BaseModel], ...] = (ExposureMapHead,)
"""Heads of binary answers, which are no messages."""
_REFERENCE = "#/components/schemas/{model}"


def describe_messages(app: FastAPI) -> None:
    """Add the messages of the WebSockets, and events, to the OpenAPI document, which describes only HTTP by itself.

    Args:
        app: the application.
    """
    build = app.openapi
    models = [
        *((model, "validation") for model in _FROM_CLIENT),
        *((model, "serialization") for model in (*_TO_CLIENT, *_HEADS)),
    ]
    _, definitions = models_json_schema(models, ref_template=_REFERENCE)  # type: ignore[arg-type]
    by_sender = {"fromClient": _FROM_CLIENT, "toClient": _TO_CLIENT}
    messages = {
        sender: [{"$ref": _REFERENCE.format(model=model.__name__)} for model in models]
        for sender, models in by_sender.items()
    }

    def described() -> dict[str, Any]:
        document = build()
        document["components"]["schemas"] = definitions["$defs"] | document["components"]["schemas"]
        document["x-websocket-messages"] = messages
        return document

    app.openapi = described  # type: ignore[method-assign]


_Viewers = Annotated[
    bool, Query(description="Whether to see the others who look at the shot, and be seen.", examples=[True])
]


@router.websocket("/shots/{shot}/live")
async def connect_live(
    socket: WebSocket,
    service: ServiceDep,
    principal: PrincipalDep,
    identity: IdentityDep,
    shot: ShotId,
    viewers: _Viewers = False,
) -> None:
    """Stream pictures; see `PROTOCOL`."""
    with service.live_places.hold(present_client().principal) as place:
        if place is None:
            detail = f"{len(service.live_places)} live connections are open already; try again later."
            await socket.send_denial_response(problem(503, "busy", detail, headers=RETRY_AFTER))
            return
        service.metrics.live_viewers.inc()
        try:
            await socket.accept()
            connection = LiveConnection(service, socket, shot)
            with service.presence.enter(shot, principal.label), ExitStack() as stack:
                if viewers:
                    viewer = stack.enter_context(service.viewers.join(shot, principal.label, connection.tell_viewers))
                    connection.on_look = viewer.look
                await _serve_while_valid(connection, socket, identity, place)
        finally:
            service.metrics.live_viewers.dec()


async def _serve_while_valid(
    connection: LiveConnection, socket: WebSocket, identity: Identity, place: LivePlace
) -> None:
    """Serve a connection until its client disconnects, its place is taken, or the key or session that it came with ends."""

    async def watch() -> tuple[int, str]:
        while identity.is_valid(socket.scope):
            with suppress(TimeoutError):
                await asyncio.wait_for(place.taken.wait(), CHECK_PAUSE_S)
                return TAKEN_CODE, TAKEN_REASON
        return ENDED_CODE, ENDED_REASON

    serving, watching = asyncio.create_task(connection.serve()), asyncio.create_task(watch())
    try:
        await asyncio.wait((serving, watching), return_when=asyncio.FIRST_COMPLETED)
        has_ended = not serving.done()
    finally:
        watching.cancel()
        serving.cancel()
    if has_ended:
        await asyncio.wait((serving,))
        with suppress(RuntimeError):  # the client has closed it already
            await socket.close(*watching.result())
    else:
        serving.result()


@router.get(
    "/shots/{shot}/live",
    operation_id="watch",
    status_code=101,
    response_model=None,
    description=PROTOCOL,
    responses=problems(426, 503) | {101: {"description": "The connection becomes a WebSocket."}},
)
async def refuse_without_upgrade(shot: ShotId, viewers: _Viewers = False) -> None:
    """Refuse a plain HTTP request: this address is a WebSocket."""
    raise ServiceError(
        426, "upgrade_required", "Live pictures come over a WebSocket.", path=shot, headers={"Upgrade": "websocket"}
    )
