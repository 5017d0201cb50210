"""Request or frame that a task works on, for logs and for the calls of worker processes; and the log line of each answer."""

from __future__ import annotations

import logging
import re
import time
import uuid
from collections.abc import Mapping
from contextvars import ContextVar

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

log = logging.getLogger("pullfocus.access")

HEADER = "X-Request-ID"
_SANE = re.compile(r"[A-Za-z0-9._-]{1,64}")
_MAX_PATH = 200
_NAMED = ("shot", "render", "frame")
"""Parts of paths that are fields of their own."""

request_id: ContextVar[str] = ContextVar("request_id", default="")
"""Id of the request that the present task answers; empty outside requests."""
trace_id: ContextVar[str] = ContextVar("trace_id", default="")
"""Id of the trace of that request, in hexadecimal digits; empty where nothing is traced."""

work_fields: ContextVar[Mapping[str, object]] = ContextVar("work_fields", default={})  # noqa: B039 - nobody changes it
"""Fields of each record that the present task logs in JSON, such as the render and frame that it draws."""


class RequestContextMiddleware:
    """Gives each request an id, sends it back, and logs each answer.

    The id is that of the header ``X-Request-ID`` where it has up to 64 letters, digits, dots, dashes and underscores, else new.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        sent = Headers(scope=scope).get(HEADER, "")
        own = sent if _SANE.fullmatch(sent) else uuid.uuid4().hex
        status = 500
        began_s = time.perf_counter()

        async def send_with_id(message: Message) -> None:
            nonlocal status
            if message["type"] in ("http.response.start", "websocket.http.response.start", "websocket.accept"):
                MutableHeaders(scope=message)[HEADER] = own
                status = message.get("status", 101)
            await send(message)

        token = request_id.set(own)
        try:
            await self.app(scope, receive, send_with_id)
        finally:
            _log_answer(scope, status, time.perf_counter() - began_s)
            request_id.reset(token)


def _log_answer(scope: Scope, status: int, seconds: float) -> None:
    """Log one answer. The query is left out: it may hold what is nobody else's business."""
    principal = scope.get("state", {}).get("principal")
    client = scope.get("client") or ("-",)
    fields = {
        "client": client[0],
        "method": scope.get("method", "WEBSOCKET"),
        "path": scope["path"][:_MAX_PATH],
        "status": status,
        "seconds": round(seconds, 4),
        "principal": getattr(principal, "id", None),
        **{name: _field(value) for name, value in scope.get("path_params", {}).items() if name in _NAMED},
    }
    log.info("%(client)s %(method)s %(path)r %(status)d in %(seconds).3f s", fields, extra={"fields": fields})


def _field(value: str) -> str | int:
    """Return a part of a path: as a number, where a frame is one, as in the records of the work on it."""
    return int(value) if re.fullmatch(r"-?\d{1,10}", value) else value[:_MAX_PATH]
