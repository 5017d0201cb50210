"""Connections of the HTTP server, none of which waits for ever.

A stranger needs no key to open a connection. One that sends half a request, or does not read its answer, would keep a descriptor
of the process for as long as it likes, and a thousand of them everybody else out.
"""

from __future__ import annotations

import asyncio
from typing import Any, Literal, cast

import h11
import uvicorn
from fastapi import FastAPI
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from service.http.guard import MAX_JSON_BYTES
from service.http.settings import Settings

HEAD_S = 20.0
"""Time that the head of a request may take, from when it could begin, s."""
STALL_S = 60.0
"""Length of a window, s. In each, a body that is not complete has to bring `LEAST_BYTES_PER_S` in the mean, and as much of an
answer has to be read. The rest of a body that was answered early has to come within one."""
LEAST_BYTES_PER_S = 1024

CLOSE_S = 5.0
"""Time in which what is left to send to a WebSocket that does not answer may still be read, s."""

Phase = Literal["head", "body", "rest"]


def server_config(app: FastAPI, settings: Settings, **options: Any) -> uvicorn.Config:
    """Return the configuration of the server.

    Args:
        app: the application.
        settings: of the service.
        **options: of uvicorn, which go before.
    """
    own: dict[str, Any] = {
        "log_config": None,
        "access_log": False,  # `service.http.request_context` logs each answer
        "timeout_graceful_shutdown": 5,
        "http": ImpatientProtocol,
        "ws": ImpatientWebSocket,
        "ws_max_size": MAX_JSON_BYTES,  # a message is held as a whole, in its fragments
        "ws_per_message_deflate": False,  # pictures are compressed already
        "proxy_headers": bool(settings.trusted_proxies),
        "forwarded_allow_ips": list(settings.trusted_proxies),
    }
    return uvicorn.Config(app, **own | options)


class ImpatientProtocol(H11Protocol):
    """A connection that is closed where its client neither sends what it has begun nor reads what it has asked for."""

    _phase: Phase | None = None
    _came_bytes = 0
    _was_paused = False
    _waiting: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Wait for the first request."""
        super().connection_made(transport)
        self._reader = _Reader(transport)
        transport.set_write_buffer_limits(high=0)  # the client has to read until nothing is left to send
        self._wait()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait for nothing any more."""
        self._enter(None)
        self.resume_writing()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take what the client has sent."""
        self._came_bytes += len(data)
        super().data_received(data)
        self._wait()
        self._was_paused |= self._is_paused()

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """Hand the connection over, with the usual limits of what waits to be sent; end it where an answer is not read yet."""
        self._reader.end_wait()
        if self.transport.get_write_buffer_size() > 0:  # the transport would not tell its new owner to pause
            self.transport.abort()
            return
        self.transport.set_write_buffer_limits()
        super().handle_websocket_upgrade(event)

    def on_response_complete(self) -> None:
        """Wait for the next request, or the rest of one that was answered before it was there as a whole."""
        super().on_response_complete()
        self._wait()

    def pause_writing(self) -> None:
        """Wait for the client to read."""
        super().pause_writing()
        self._reader.begin_wait()

    def resume_writing(self) -> None:
        """Go on writing."""
        super().resume_writing()
        self._reader.end_wait()

    def _wait(self) -> None:
        """Wait for what the client has to send next, if it has to."""
        if self.transport.is_closing() or self.transport.get_protocol() is not self:  # a WebSocket has taken over
            self._enter(None)
        elif self.conn.their_state is h11.IDLE:
            self._enter("head")
        elif self.conn.their_state is h11.SEND_BODY:
            self._enter("rest" if self.cycle.response_complete else "body")
        else:
            self._enter(None)

    def _enter(self, phase: Phase | None) -> None:
        """Begin to wait. A body has to go on coming; a head, and the rest of what was answered already, have to end in time."""
        if phase != self._phase:
            self._phase = phase
            self._begin_time()

    def _begin_time(self) -> None:
        """Begin the time of the present phase."""
        if self._waiting is not None:
            self._waiting.cancel()
        time_s = HEAD_S if self._phase == "head" else STALL_S
        self._waiting = self.loop.call_later(time_s, self._end_time) if self._phase else None
        self._came_bytes, self._was_paused = 0, self._is_paused()

    def _end_time(self) -> None:
        """Close the connection, unless a body goes on coming, the service does not read it, or an answer is still being read."""
        may_go_on = self._was_paused or self._came_bytes >= STALL_S * LEAST_BYTES_PER_S
        is_read = self.transport.get_write_buffer_size() > 0  # for as long as `_Reader` allows
        if is_read or (self._phase == "body" and may_go_on):
            self._begin_time()
        else:
            self.transport.abort()

    def _is_paused(self) -> bool:
        return self._phase == "body" and self.flow.read_paused


class ImpatientWebSocket(WebSocketsSansIOProtocol):
    """A WebSocket that is closed where its client does not read what is sent."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Take a connection over."""
        self._reader = _Reader(cast(asyncio.Transport, transport))
        super().connection_made(transport)

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait for nothing any more."""
        self._reader.end_wait()
        super().connection_lost(exc)

    def pause_writing(self) -> None:
        """Wait for the client to read."""
        super().pause_writing()
        self._reader.begin_wait()

    def resume_writing(self) -> None:
        """Go on writing."""
        super().resume_writing()
        self._reader.end_wait()

    def keepalive_timeout(self) -> None:
        """Close the connection, though the client may not read what is left."""
        super().keepalive_timeout()
        self.loop.call_later(CLOSE_S, self.transport.abort)


class _Reader:
    """The client of a connection as it reads: one that reads too little in a window is disconnected.

    Args:
        transport: of the connection.
    """

    def __init__(self, transport: asyncio.Transport) -> None:
        self._transport = transport
        self._timer: asyncio.TimerHandle | None = None

    def begin_wait(self) -> None:
        """Begin to wait for the client, until `end_wait`."""
        self.end_wait()
        left = self._transport.get_write_buffer_size()
        self._timer = asyncio.get_running_loop().call_later(STALL_S, self._end_window, left)

    def end_wait(self) -> None:
        """Wait no longer."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _end_window(self, unread: int) -> None:
        """Disconnect a client that has read too little of what was unread, bytes."""
        if unread - self._transport.get_write_buffer_size() < STALL_S * LEAST_BYTES_PER_S:
            self._transport.abort()
        else:
            self.begin_wait()
