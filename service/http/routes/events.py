"""Routes of events: a stream of what changes, which a reader can take up again where it has left it."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Callable
from contextlib import suppress
from typing import Annotated, NamedTuple, get_args

from fastapi import APIRouter, Depends, Query, WebSocket, WebSocketDisconnect
from fastapi.sse import format_sse_event
from starlette.requests import HTTPConnection, Request
from starlette.responses import StreamingResponse

from service.http.access import READS, PrincipalDep
from service.http.clients import present_client
from service.http.errors import RETRY_AFTER, ServiceError, problem
from service.http.event_feed import PAGE, text_of
from service.http.identity import IdentityDep
from service.http.live_connection import RESTARTS_CODE
from service.http.live_places import LivePlace
from service.http.routes.live import ENDED_CODE, ENDED_REASON, TAKEN_CODE, TAKEN_REASON
from service.http.routes.parameters import problems
from service.http.service import Service, ServiceDep
from service.identity.principal import ALL_PROJECTS
from service.models.events import EVENT_EXAMPLE, Event, EventGap, Topic
from service.storage.events import Wanted

router = APIRouter(tags=["events"], dependencies=READS)

FAILED_CODE = 1011
"""Code of a WebSocket that is closed because events cannot be read; the client may connect again."""
CHECK_PAUSE_S = 1.0
"""Time between two looks at whether the reader is still let in."""
MARK_PAUSE_S = 15.0
"""Time between two marks, which tell a reader that gets no events the number to go on after, and keep the connection open."""
MOST_NUMBER = 2**53 - 1
"""Highest number of an event that JSON tells exactly."""
RETRY_MS = 2000
"""Time after which a browser connects again."""

MEDIA_TYPE = "text/event-stream"
CONTENT = {
    "itemSchema": {
        "type": "object",
        "properties": {
            "event": {"type": "string", "enum": [*get_args(Topic), "gap"]},
            "data": {"type": "string", "description": "An `Event` in JSON; an `EventGap` after `gap`."},
            "id": {"type": "string", "description": "Number to go on after."},
            "retry": {"type": "integer", "description": "Time until a new connection, ms."},
        },
    },
    "example": f"event: tasks\ndata: {json.dumps(EVENT_EXAMPLE)}\nid: {EVENT_EXAMPLE['number']}\n\n",
}
"""Description of the stream (OpenAPI 3.2, section 4.14.4)."""
HEADERS = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}  # proxies pass it on as it comes

DESCRIPTION = """Follow what changes: shots, edits, renders, their tasks, and who looks at a shot (Server-Sent Events).

Events are numbered and kept for some days. A reader that was cut off sends the number of the last event that it has seen, as
`Last-Event-ID` (browsers do that by themselves) or `after`, and misses none. Where events that it has not seen are kept no
longer, the stream begins with the event `gap`, an `EventGap`: read again what you show. Without a number the stream begins now.

Each event has its topic as `event`, its number as `id`, and an `Event` as `data`. There are two `tasks` or more for each frame;
`renders` tells the changes of a render's state alone.

A WebSocket at the same address sends an `Event`, or an `EventGap` first, as each of its messages."""


class _Question(NamedTuple):
    """Question of a reader.

    Attributes:
        wanted: which events.
        after: number of the last event that it knows; None where it begins now.
        follow: whether it waits for new ones.
    """

    wanted: Wanted
    after: int | None
    follow: bool


def _question(
    connection: HTTPConnection,
    principal: PrincipalDep,
    topics: Annotated[
        list[Topic] | None,
        Query(alias="topic", max_length=5, description="Of these topics; all when left out.", examples=[["renders"]]),
    ] = None,
    shot: Annotated[str | None, Query(max_length=80, description="About this shot.", examples=["demo"])] = None,
    render: Annotated[
        str | None, Query(max_length=80, description="About this render.", examples=["r-5f0c1d2e3a4b"])
    ] = None,
    after: Annotated[
        int | None, Query(ge=0, le=MOST_NUMBER, description="Number of the last event that you know.", examples=[1824])
    ] = None,
    follow: Annotated[
        bool, Query(description="false ends the stream after the events that there are now.", examples=[False])
    ] = True,
) -> _Question:
    project = None if principal.project == ALL_PROJECTS else principal.project
    wanted = Wanted(project, topics or (), shot, render)
    last = connection.headers.get("last-event-id")
    if last is None:
        return _Question(wanted, after, follow)
    if not (last.isascii() and last.isdigit() and len(last) < len(str(MOST_NUMBER))):
        detail = f"Last-Event-ID is the number of an event, got {last[:40]!r}."
        raise ServiceError(422, "invalid_request", detail, path="last-event-id")
    return _Question(wanted, int(last), follow)


QuestionDep = Annotated[_Question, Depends(_question)]


async def event_place(service: ServiceDep) -> AsyncIterator[LivePlace]:
    """Hold a place among the readers. Raises `ServiceError` 503: all are taken."""
    with service.event_places.hold(present_client().principal) as place:
        if place is None:
            raise ServiceError(503, "busy", _busy(service), headers=RETRY_AFTER)
        yield place


@router.get(
    "/events",
    operation_id="followEvents",
    response_class=StreamingResponse,
    description=DESCRIPTION,
    responses=problems(503) | {200: {"content": {MEDIA_TYPE: CONTENT}, "description": "The stream."}},
)
async def follow_events(
    request: Request,
    service: ServiceDep,
    identity: IdentityDep,
    place: Annotated[LivePlace, Depends(event_place)],
    question: QuestionDep,
) -> StreamingResponse:
    """Follow what changes."""
    told = _answers(service, question, lambda: place.taken.is_set() or not identity.is_valid(request.scope))
    return StreamingResponse((_sent(one) async for one in told), media_type=MEDIA_TYPE, headers=HEADERS)


def _sent(told: Event | EventGap | int) -> bytes:
    """Return what is told as Server-Sent Events have it."""
    match told:
        case Event():
            return format_sse_event(id=str(told.number), event=told.topic, data_str=text_of(told))
        case EventGap():
            return format_sse_event(event="gap", data_str=text_of(told))
        case _:
            return format_sse_event(id=str(told), retry=RETRY_MS)


@router.websocket("/events")
async def send_events(socket: WebSocket, service: ServiceDep, identity: IdentityDep, question: QuestionDep) -> None:
    """Send events over a WebSocket; see `DESCRIPTION`."""
    with service.event_places.hold(present_client().principal) as place:
        if place is None:
            await socket.send_denial_response(problem(503, "busy", _busy(service), headers=RETRY_AFTER))
            return
        await socket.accept()

        async def send() -> None:
            is_over = lambda: place.taken.is_set() or not identity.is_valid(socket.scope)  # noqa: E731
            async for told in _answers(service, question, is_over):
                if not isinstance(told, int):
                    await socket.send_text(text_of(told))

        tasks = [asyncio.create_task(send()), asyncio.create_task(_wait_for_end(socket))]
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in tasks:
                task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        has_failed = any(not task.cancelled() and task.exception() is not None for task in tasks)
        with suppress(RuntimeError, WebSocketDisconnect):  # the client has closed it already
            if has_failed:  # as where the database cannot be read
                await socket.close(FAILED_CODE)
            elif service.stopping.is_begun:
                await socket.close(RESTARTS_CODE)
            elif place.taken.is_set():
                await socket.close(TAKEN_CODE, TAKEN_REASON)
            elif not identity.is_valid(socket.scope):
                await socket.close(ENDED_CODE, ENDED_REASON)
            else:
                await socket.close()


async def _wait_for_end(socket: WebSocket) -> None:
    """Wait until the client disconnects; what it sends is not looked at."""
    while (await socket.receive())["type"] != "websocket.disconnect":
        pass


async def _answers(
    service: Service, question: _Question, is_over: Callable[[], bool]
) -> AsyncIterator[Event | EventGap | int]:
    """Yield what a reader is told: events, what it has missed, and now and then the number that it may go on after."""
    start, gap = await service.feed.start_of(question.after)
    yield start
    if gap is not None:
        yield gap
    loop = asyncio.get_running_loop()
    marked_s = loop.time()
    async for events, number in service.feed.follow(start, question.wanted, CHECK_PAUSE_S):
        for event in events:
            yield event
        if service.stopping.is_begun or is_over() or (not question.follow and len(events) < PAGE):
            return
        if loop.time() > marked_s + MARK_PAUSE_S:
            yield number
            marked_s = loop.time()


def _busy(service: Service) -> str:
    return f"{len(service.event_places)} readers of events are connected already; try again later."
