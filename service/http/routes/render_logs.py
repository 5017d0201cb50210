"""Routes of the logs of a render's frames."""

from __future__ import annotations

import asyncio
import re
from collections.abc import AsyncIterator, Callable
from typing import Annotated

from fastapi import APIRouter, Depends, Header, Query, Response
from fastapi.responses import StreamingResponse
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request

from render.errors import NotFoundError, OutputError
from service.http.access import READS
from service.http.errors import ServiceError
from service.http.identity import IdentityDep
from service.http.live_places import LivePlace
from service.http.routes.events import event_place
from service.http.routes.parameters import problems
from service.http.routes.renders import FrameInPath, RenderInPath
from service.http.service import Service, ServiceDep
from service.jobs.frame_logs import KeptLog

router = APIRouter(tags=["renders"], prefix="/renders", dependencies=READS)

MEDIA_TYPE = "text/plain; charset=utf-8"
MOST_TAIL = 10_000
LOOK_PAUSE_S = 0.5
"""Time between two looks for new lines, for one who follows a log."""
EXAMPLE = "2026-11-27T20:14:03.120Z attempt 1 at frame 24 of render r-5f0c1d2e3a4b, by worker camera-pc\n"
PLAIN = {"content": {"text/plain": {"schema": {"type": "string"}, "example": EXAMPLE}}}
_RANGE = re.compile(r"bytes=(\d{1,12})?-(\d{1,12})?")

AttemptInQuery = Annotated[
    int | None,
    Query(ge=1, le=10**6, description="Number of an attempt at the frame; the last one when left out.", examples=[1]),
]


@router.get(
    "/{render}/frames/{frame}/log",
    operation_id="getFrameLog",
    response_class=Response,
    responses=problems(404, 416)
    | {200: PLAIN | {"description": "The log."}, 206: PLAIN | {"description": "The part that `Range` names."}},
)
def get_frame_log(
    service: ServiceDep,
    render: RenderInPath,
    frame: FrameInPath,
    attempt: AttemptInQuery = None,
    tail: Annotated[
        int | None, Query(ge=1, le=MOST_TAIL, description="Lines from the end; all when left out.", examples=[20])
    ] = None,
    part: Annotated[
        str | None,
        Header(
            alias="range", description="A part of the log, such as `bytes=-4096` for its end.", examples=["bytes=0-"]
        ),
    ] = None,
) -> Response:
    """Read the log of an attempt at a frame.

    It has the steps of the work and their times, what USD and the graphics driver have said, the files that were stored, and what
    went wrong. The header `Pullfocus-Attempt` tells the number of the attempt, and `Pullfocus-Ended` whether it has ended.
    """
    found = service.renders.logs.read(render.id, frame, attempt)
    if found is not None:
        return _part(found, tail, part)
    if _is_given_up(service, render.id, frame):
        raise NotFoundError(
            f"frame {frame} of render {render.id!r} was given up before it was begun",
            code="frame_given_up",
            path="frame",
        )
    raise NotFoundError(
        f"frame {frame} of render {render.id!r} was not begun yet, so that it has no log",
        code="frame_not_begun",
        path="frame",
    )


@router.get(
    "/{render}/frames/{frame}/log/stream",
    operation_id="followFrameLog",
    response_class=Response,
    responses=problems(404, 503) | {200: PLAIN | {"description": "The stream."}},
)
async def follow_frame_log(
    request: Request,
    service: ServiceDep,
    identity: IdentityDep,
    render: RenderInPath,
    frame: FrameInPath,
    place: Annotated[LivePlace, Depends(event_place)],
    attempt: AttemptInQuery = None,
) -> Response:
    """Follow the log of an attempt at a frame until it ends: the lines that there are, and others as they come.

    A frame that waits is waited for. The stream counts among those of events.
    """
    await run_in_threadpool(service.renders.logs.read, render.id, frame, attempt)  # refused before the stream begins
    is_over = lambda: service.stopping.is_begun or place.taken.is_set() or not identity.is_valid(request.scope)  # noqa: E731
    lines = _lines(service, render.id, frame, attempt, is_over)
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}  # proxies pass it on as it comes
    return StreamingResponse(lines, media_type=MEDIA_TYPE, headers=headers)


async def _lines(
    service: Service, render: str, frame: int, attempt: int | None, is_over: Callable[[], bool]
) -> AsyncIterator[bytes]:
    """Yield the lines of a log as they come."""
    length, chosen = 0, attempt
    while not is_over():
        try:
            found = await run_in_threadpool(service.renders.logs.read, render, frame, chosen)
        except NotFoundError as error:
            if attempt is not None or error.code != "attempt_not_found":
                return  # it was removed
            length, chosen = 0, None  # it was put off before it was begun
            continue
        except OutputError:  # the database is gone
            return
        if found is not None:
            chosen = found.attempt  # a further one has a log of its own
            if len(found.text) > length:
                yield found.text[length:].encode()
                length = len(found.text)
            if found.has_ended:
                return
        elif await run_in_threadpool(_is_given_up, service, render, frame):
            return
        await asyncio.sleep(LOOK_PAUSE_S)


def _is_given_up(service: Service, render: str, frame: int) -> bool:
    """Return whether a frame will not be begun."""
    return service.renders.task(render, frame).state not in ("ready", "running")


def _part(found: KeptLog, tail: int | None, wanted: str | None) -> Response:
    """Return a log, its last lines, or a range of its bytes (RFC 9110, section 14). Raises `ServiceError` 416."""
    lines = found.text.splitlines(keepends=True)
    content = "".join(lines if tail is None else lines[-tail:]).encode()
    headers = {
        "Cache-Control": "private, no-cache",
        "Accept-Ranges": "bytes",
        "Pullfocus-Attempt": str(found.attempt),
        "Pullfocus-Ended": str(found.has_ended).lower(),
    }
    match = _RANGE.fullmatch(wanted or "")
    if match is None or match.groups() == (None, None):  # what is no such range may be ignored
        return Response(content, media_type=MEDIA_TYPE, headers=headers)
    first, last = match.groups()
    begin = max(0, len(content) - int(last)) if first is None else int(first)
    end = len(content) if first is None or last is None else min(int(last) + 1, len(content))
    if begin >= end:
        detail = f"The log has {len(content)} bytes, and none of them is in the range {wanted}."
        refused = {"Content-Range": f"bytes */{len(content)}"}
        raise ServiceError(416, "no_such_range", detail, path="range", headers=headers | refused)
    headers["Content-Range"] = f"bytes {begin}-{end - 1}/{len(content)}"
    return Response(content[begin:end], 206, media_type=MEDIA_TYPE, headers=headers)
