"""Client of a request, and whether it is still there.

Work that is done for a request takes its turn among the work of other clients, and ends when the client has gone away, unless it
changes something.
"""

from __future__ import annotations

import asyncio
from contextvars import ContextVar

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.http.addresses import counted_address
from service.http.guard import SAFE_METHODS
from service.identity.principal import ANYONE
from service.workers.jobs import NOBODY, Client

_scope: ContextVar[Scope | None] = ContextVar("scope", default=None)
client_of_work: ContextVar[Client | None] = ContextVar("client_of_work", default=None)
"""Set by work in the background: who it is done for."""
ONLY_READING = ("/pick",)
"""Ends of paths whose POST changes nothing."""
MAX_MESSAGES = 256
"""Pieces of a request's body that may wait to be read."""


def present_client() -> Client:
    """Return who the present request or WebSocket comes from: its principal or, without a key, its `counted_address`."""
    worked_for = client_of_work.get()
    if worked_for is not None:
        return worked_for
    scope = _scope.get()
    if scope is None:
        return NOBODY
    principal = scope.get("state", {}).get("principal", ANYONE)
    name = f"{ANYONE.id} at {counted_address(scope)}" if principal == ANYONE else principal.id
    return Client(name, name)


class ClientMiddleware:
    """Notes the client of each request, and ends the work on it once the client has gone."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        _scope.set(scope)
        if scope["type"] == "http" and _only_reads(scope):
            await _answer_while_present(self.app, scope, receive, send)
        else:
            await self.app(scope, receive, send)


def _only_reads(scope: Scope) -> bool:
    return scope["method"] in SAFE_METHODS or scope["path"].endswith(ONLY_READING)


async def _answer_while_present(app: ASGIApp, scope: Scope, receive: Receive, send: Send) -> None:
    """Answer a request, and stop where the client goes away before."""
    messages: asyncio.Queue[Message] = asyncio.Queue(MAX_MESSAGES)
    answering = asyncio.ensure_future(app(scope, messages.get, send))
    has_gone = False

    async def watch() -> None:
        nonlocal has_gone
        while not has_gone:
            message = await receive()
            has_gone = message["type"] == "http.disconnect"
            if not messages.full():  # nobody reads so long a body
                messages.put_nowait(message)
        answering.cancel()

    watching = asyncio.create_task(watch())
    try:
        await answering
    except asyncio.CancelledError:
        if not has_gone:
            raise
    finally:
        watching.cancel()
