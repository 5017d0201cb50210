"""Graceful stop of the service.

From the first signal on no new work is taken, and viewers are told to come back. What was begun may end, for some time. A second
signal ends the service at once, and its workers with it.
"""

from __future__ import annotations

import asyncio
import logging
import signal
import socket
from types import FrameType

import uvicorn
from fastapi import FastAPI
from starlette.concurrency import run_in_threadpool
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket

from service.http.errors import RETRY_AFTER, problem

log = logging.getLogger("pullfocus.service")

ANSWERED_TO_THE_END = frozenset({"/livez", "/metrics", "/version"})
STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)
TICK_S = 0.05


class Stopping:
    """Whether a service is stopping, and how many of its requests are in progress. Only the event loop uses it."""

    def __init__(self) -> None:
        self.in_progress = 0
        self._begun = asyncio.Event()

    @property
    def is_begun(self) -> bool:
        """Whether the service is stopping."""
        return self._begun.is_set()

    def begin(self) -> None:
        """Take no more requests."""
        self._begun.set()

    async def wait(self) -> None:
        """Wait until the service is stopping."""
        await self._begun.wait()


class StoppingMiddleware:
    """Counts the requests in progress, and refuses new ones with 503 while the service is stopping."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] not in ("http", "websocket") or scope["path"] in ANSWERED_TO_THE_END:
            await self.app(scope, receive, send)
            return
        stopping: Stopping = scope["app"].state.service.stopping
        if stopping.is_begun:
            detail = "The service is stopping; try again when it has started again."
            refusal = problem(503, "stopping", detail, headers=RETRY_AFTER | {"Connection": "close"})
            if scope["type"] == "websocket":
                await WebSocket(scope, receive, send).send_denial_response(refusal)
            else:
                await refusal(scope, receive, send)
            return
        stopping.in_progress += 1
        try:
            await self.app(scope, receive, send)
        finally:
            stopping.in_progress -= 1


class GracefulServer(uvicorn.Server):
    """Server that lets the requests in progress end before it closes its port.

    Args:
        app: the application of `service.http.app.create_app`.
        config: of the server.
        grace_s: time for the requests in progress, s.
    """

    def __init__(self, app: FastAPI, config: uvicorn.Config, grace_s: float) -> None:
        super().__init__(config)
        self._app = app
        self._grace_s = grace_s

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Begin to stop; the next signal ends the process."""
        self.should_exit = True
        for later in STOP_SIGNALS:
            signal.signal(later, signal.SIG_DFL)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Wait for the requests in progress, then close the port and the connections."""
        service = self._app.state.service
        service.stopping.begin()
        log.info("The service is stopping; %d requests are in progress.", service.stopping.in_progress)
        end_s = asyncio.get_running_loop().time() + self._grace_s
        while service.stopping.in_progress and asyncio.get_running_loop().time() < end_s:
            await asyncio.sleep(TICK_S)
        if service.stopping.in_progress:
            log.warning("%d requests have not ended within %g s.", service.stopping.in_progress, self._grace_s)
            await run_in_threadpool(service.lanes.close)  # they are answered that the service is stopping
        await super().shutdown(sockets)
