"""ASGI middleware that refuses foreign hosts, cross-site requests, deliveries of webhooks, and bodies that are too large.

On its own machine the service trusts every client that can reach 127.0.0.1, and elsewhere browsers that are signed in. A page of
another site runs in such a browser, so three kinds of request are refused: those under a host name that is not ours (DNS
rebinding); those that change something, and WebSockets, with the ``Origin`` of another site; and whatever else such a page uses
(``Sec-Fetch-Site``), links aside.
"""

from __future__ import annotations

import re
from contextlib import suppress
from urllib.parse import urlsplit

from fastapi import HTTPException
from starlette.datastructures import Headers
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from service.http.errors import problem
from service.http.settings import MEBIBYTE, Settings
from service.http.webhook_sending import DELIVERY_HEADER

SAFE_METHODS = ("GET", "HEAD", "OPTIONS")
MAX_JSON_BYTES = MEBIBYTE
MAX_CURVE_BYTES = 32 * MEBIBYTE  # ten thousand frames as OpenTrackIO samples with focus points
# Boundaries, headers and small fields of a multipart upload.
MULTIPART_BYTES = 64 * 1024
TOO_LARGE_CODE = 1009  # RFC 6455, section 7.4.1
UPLOAD_PATH = "/v1/shots"
CURVE_PATH = re.compile(r"/v1/shots/[^/]+/(focus-curve|edits)")  # an edit may bring a curve along


class GuardMiddleware:
    """Refuses foreign hosts, cross-site requests and bodies that are too large.

    Args:
        app: the guarded application.
        settings: allowed hosts, and the limit of an upload.
    """

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        self.app = app
        self._hosts = settings.allowed_hosts
        self._max_upload_bytes = settings.max_upload_mb * MEBIBYTE + MULTIPART_BYTES

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request, or refuse it."""
        if scope["type"] == "websocket":
            await self._guard_websocket(scope, receive, send)
            return
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        limit = self._limit(scope["path"])
        refusal = self._refusal(scope, Headers(scope=scope), limit)
        if refusal is not None:
            await refusal(scope, receive, send)
            return
        received = 0

        async def receive_counted() -> Message:
            nonlocal received
            message = await receive()
            received += len(message.get("body", b""))
            if received > limit:  # FastAPI lets an HTTPException pass while it reads the body
                raise HTTPException(413, _too_large(limit))
            return message

        await self.app(scope, receive_counted, send)

    async def _guard_websocket(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Accept one WebSocket, or refuse it during the handshake."""
        headers = Headers(scope=scope)
        refusal = self._foreign_host(scope, headers)
        if refusal is None and _is_foreign_origin(headers):
            refusal = problem(403, "cross_site", "A page of another site may not watch here.", path="origin")
        if refusal is not None:
            await WebSocket(scope, receive, send).send_denial_response(refusal)
            return

        async def receive_bounded() -> Message:
            message = await receive()
            if _bytes_of(message) <= MAX_JSON_BYTES:
                return message
            await send({"type": "websocket.close", "code": TOO_LARGE_CODE, "reason": _too_large(MAX_JSON_BYTES)})
            return {"type": "websocket.disconnect", "code": TOO_LARGE_CODE}

        await self.app(scope, receive_bounded, send)

    def _limit(self, path: str) -> int:
        """Return the limit of a request's body, bytes."""
        if path == UPLOAD_PATH:
            return self._max_upload_bytes
        return MAX_CURVE_BYTES + MULTIPART_BYTES if CURVE_PATH.fullmatch(path) else MAX_JSON_BYTES

    def _refusal(self, scope: Scope, headers: Headers, limit: int) -> JSONResponse | None:
        method = scope["method"]
        foreign = self._foreign_host(scope, headers)
        if foreign is not None:
            return foreign
        if DELIVERY_HEADER in headers:  # it could set off the next one
            return problem(403, "own_delivery", "A service takes no deliveries of webhooks.", path=DELIVERY_HEADER)
        if method not in SAFE_METHODS and _is_foreign_origin(headers):
            return problem(403, "cross_site", "A page of another site may change nothing here.", path="origin")
        if headers.get("sec-fetch-site") == "cross-site" and not _is_navigation(method, headers):
            return problem(
                403, "cross_site", "A page of another site may use nothing of this one.", path="sec-fetch-site"
            )
        length = headers.get("content-length", "0")
        if length.isdecimal() and int(length) > limit:
            return problem(413, "too_large", _too_large(limit), path="content-length")
        return None

    def _foreign_host(self, scope: Scope, headers: Headers) -> JSONResponse | None:
        host = re.sub(r":\d+$", "", headers.get("host", "")).lower()
        if (
            host in self._hosts or host.strip("[]") == (scope.get("server") or ("",))[0]
        ):  # no other site's name is an address
            return None
        detail = f"The service does not answer to the name {host[:80]!r}."
        return problem(421, "unknown_host", detail, path="host")


def _is_foreign_origin(headers: Headers) -> bool:
    """Return whether a page of another site sends a request. Programs send no ``Origin``."""
    origin = headers.get("origin")
    return origin is not None and _host_of(origin) != headers.get("host", "").lower()


def _is_navigation(method: str, headers: Headers) -> bool:
    """Return whether somebody follows a link of another site."""
    return method in SAFE_METHODS and headers.get("sec-fetch-mode") == "navigate"


def _host_of(origin: str) -> str | None:
    """Return the host of an ``Origin`` header; None where it names none, as from a page without an origin."""
    with suppress(ValueError):
        return urlsplit(origin).netloc.lower() or None
    return None


def _bytes_of(message: Message) -> int:
    """Return the size of a WebSocket message as it is sent."""
    text = message.get("text")
    return len(message.get("bytes") or b"") if text is None else len(text.encode())


def _too_large(limit: int) -> str:
    return f"The request is larger than the {limit / MEBIBYTE:.4g} MiB that are taken."
