"""Fetching of a small document over HTTP within a time that holds for all of it, however slowly it comes."""

from __future__ import annotations

import http.client
import socket
import threading
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any


def fetch(address: str, max_bytes: int, within_s: float) -> bytes:
    """Fetch a document. Redirects are not followed: they could lead anywhere.

    Args:
        address: http or https.
        max_bytes: that it may have.
        within_s: time for connection, headers and content together, s; the look-up of the host's name is not counted.

    Raises:
        OSError: it cannot be reached, or did not come in time.
        ValueError: it is too large, or what answers does not talk HTTP.
    """
    request = urllib.request.Request(address, headers={"Accept": "application/json"})
    with _Deadline(within_s).begun() as deadline:
        handlers = _NoRedirects, _Plain(deadline), _Secure(deadline)
        try:
            with urllib.request.build_opener(*handlers).open(request, timeout=within_s) as answer:
                content: bytes = answer.read(max_bytes + 1)
        except (OSError, http.client.HTTPException) as error:
            if deadline.is_over:
                raise TimeoutError(f"{address} did not answer within {within_s:g} s") from error
            if isinstance(error, OSError):
                raise
            raise ValueError(f"{address} does not answer in HTTP: {error!r}") from error
        if deadline.is_over:  # a document without a length ends where its connection does
            raise TimeoutError(f"{address} did not answer within {within_s:g} s")
    if len(content) > max_bytes:
        raise ValueError(f"{address} has more than {max_bytes:,} bytes")
    return content


class _Deadline:
    """Shuts down the connections that it watches when a time is over: time limits of sockets hold for each read alone."""

    def __init__(self, within_s: float) -> None:
        self.is_over = False
        self._watched: list[socket.socket] = []
        self._lock = threading.Lock()
        self._timer = threading.Timer(within_s, self._end)
        self._timer.daemon = True

    @contextmanager
    def begun(self) -> Iterator[_Deadline]:
        """Let the time run until the end of the context."""
        self._timer.start()
        try:
            yield self
        finally:
            self._timer.cancel()
            with self._lock:
                for connection in self._watched:
                    connection.close()
                self._watched.clear()

    def watch(self, connection: socket.socket) -> None:
        """Watch a connection by a descriptor of its own: TLS takes over the first one."""
        with self._lock:
            self._watched.append(connection.dup())
            if self.is_over:
                self._shut_down()

    def _end(self) -> None:
        with self._lock:
            self.is_over = True
            self._shut_down()

    def _shut_down(self) -> None:
        for connection in self._watched:
            with suppress(OSError):  # the other side has closed it
                connection.shutdown(socket.SHUT_RDWR)


def _watched(kind: Callable[..., http.client.HTTPConnection], deadline: _Deadline) -> Callable[..., Any]:
    """Return a maker of connections that a deadline watches."""

    def create(*address: Any) -> socket.socket:
        connection = socket.create_connection(*address)
        deadline.watch(connection)
        return connection

    def make(*args: Any, **kwargs: Any) -> http.client.HTTPConnection:
        made = kind(*args, **kwargs)
        made._create_connection = create  # type: ignore[attr-defined]  # the one place before the handshake of TLS
        return made

    return make


class _Plain(urllib.request.HTTPHandler):
    def __init__(self, deadline: _Deadline) -> None:
        super().__init__()
        self._deadline = deadline

    def http_open(self, req: urllib.request.Request) -> http.client.HTTPResponse:
        """Open a connection that is watched."""
        return self.do_open(_watched(http.client.HTTPConnection, self._deadline), req)


class _Secure(urllib.request.HTTPSHandler):
    def __init__(self, deadline: _Deadline) -> None:
        super().__init__()
        self._deadline = deadline

    def https_open(self, req: urllib.request.Request) -> http.client.HTTPResponse:
        """Open a connection that is watched from before its handshake."""
        return self.do_open(_watched(http.client.HTTPSConnection, self._deadline), req)


class _NoRedirects(urllib.request.HTTPRedirectHandler):
    def redirect_request(self, *_: Any) -> None:
        """Follow no redirect."""
