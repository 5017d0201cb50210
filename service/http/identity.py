"""ASGI middleware that finds out who sends a request, before its body is received."""

from __future__ import annotations

from starlette.types import ASGIApp, Receive, Scope, Send

from service.identity.principal import ANYONE


class IdentityMiddleware:
    """Sets ``connection.state.principal``.

    Args:
        app: the application.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] in ("http", "websocket"):
            scope.setdefault("state", {})["principal"] = ANYONE
        await self.app(scope, receive, send)
