"""ASGI middleware that writes the audit log: what changed something, and what was refused."""

from __future__ import annotations

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.http.guard import SAFE_METHODS
from service.http.identity import REFUSALS, Identity

STARTS = ("http.response.start", "websocket.http.response.start")


class AuditMiddleware:
    """Writes one line for each request that is not of a safe method, and for each that is refused.

    Args:
        app: the application.
        identity: whose audit log it is.
    """

    def __init__(self, app: ASGIApp, identity: Identity) -> None:
        self.app = app
        self._identity = identity

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request and note its status."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        status = 500 if scope["type"] == "http" else 101

        async def send_and_note(message: Message) -> None:
            nonlocal status
            if message["type"] in STARTS:
                status = message["status"]
            await send(message)

        try:
            await self.app(scope, receive, send_and_note)
        finally:
            if scope.get("method", "GET") not in SAFE_METHODS or status in REFUSALS:
                self._identity.audit(scope, status)
