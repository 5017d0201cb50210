"""Connections: nobody keeps one by sending half a request, or by not reading an answer."""

from __future__ import annotations

import asyncio
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import pytest
import uvicorn
from starlette.responses import Response
from uvicorn.server import ServerState

from service.http import connections
from service.http.settings import MEBIBYTE, Settings
from tests.service.conftest import Running, running

HEAD = b"GET /livez HTTP/1.1\r\nHost: localhost\r\n"
BODY = b"POST /v1/session HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 100\r\n\r\n"
REFUSED = BODY.replace(b"/v1/session", b"/v1/shots")


@pytest.fixture(scope="module")
def impatient(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    """A service that needs keys, and waits for half a second."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(connections, "HEAD_S", 0.5)
        patch.setattr(connections, "STALL_S", 1.0)
        patch.setattr(connections, "LEAST_BYTES_PER_S", 5)
        static: Path = tmp_path_factory.mktemp("static")
        (static / "index.html").write_bytes(b"x" * (64 * MEBIBYTE))  # more than the buffers of a connection
        data = tmp_path_factory.mktemp("data")
        with running(Settings(data=data, static=static, demo=False, access="keys", requests_per_s=0)) as service:
            yield service


def connect(service: Running) -> socket.socket:
    """Connect to a service."""
    connection = socket.create_connection((service.client.base_url.host, service.client.base_url.port or 80))
    connection.settimeout(10)
    return connection


def is_closed(connection: socket.socket) -> bool:
    """Whether the other side closes a connection within four seconds; uvicorn itself closes idle ones after five."""
    connection.settimeout(4)
    try:
        while connection.recv(65536):
            pass
    except ConnectionResetError:
        return True
    except TimeoutError:
        return False
    return True


@pytest.mark.parametrize(
    "sent", [b"", b"G", HEAD, HEAD + b"\r\n" + HEAD, BODY, BODY + b"{", REFUSED], ids=lambda sent: sent[-20:].decode()
)
def test_whoever_sends_half_a_request_is_disconnected(impatient: Running, sent: bytes) -> None:
    with connect(impatient) as connection:
        connection.sendall(sent)
        assert is_closed(connection)


@pytest.mark.parametrize(
    ("begin", "pause_s"), [(HEAD + b"X: ", 0.1), (REFUSED, 0.1), (BODY, 0.4)], ids=["head", "refused body", "body"]
)
def test_whoever_drips_without_a_key_is_disconnected(impatient: Running, begin: bytes, pause_s: float) -> None:
    began_s = time.monotonic()
    with connect(impatient) as connection, suppress(ConnectionError):
        connection.sendall(begin)
        while time.monotonic() - began_s < 10:
            connection.sendall(b"x")
            time.sleep(pause_s)
    assert time.monotonic() - began_s < 8


def test_a_body_may_come_slowly(impatient: Running) -> None:
    with connect(impatient) as connection:
        connection.sendall(BODY)
        for part in range(8):
            time.sleep(0.2)  # 1.6 s for all of them
            connection.sendall(b'{"key": "wrong"}'[2 * part : 2 * part + 2])
        connection.sendall(b" " * (100 - 16))
        assert connection.recv(65536).startswith(b"HTTP/1.1 401")


def test_whoever_does_not_read_an_answer_is_disconnected(impatient: Running) -> None:
    with connect(impatient) as connection:
        connection.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
        time.sleep(3)
        received = 0
        try:
            while content := connection.recv(MEBIBYTE):
                received += len(content)
        except ConnectionResetError:
            pass
        assert received < 64 * MEBIBYTE


def test_the_end_of_an_answer_has_to_be_read_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connections, "STALL_S", 0.3)
    size, unread = 100 << 10, 20 << 10  # some of it in the buffer of the socket, some in that of the transport

    async def read_most() -> int:
        loop, received = asyncio.get_running_loop(), 0
        ours, theirs = socket.socketpair()
        ours.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 8192)
        theirs.setblocking(False)
        config = uvicorn.Config(Response(b"x" * size), log_config=None, lifespan="off")
        config.load()
        await loop.create_connection(lambda: connections.ImpatientProtocol(config, ServerState(), {}), sock=ours)
        await loop.sock_sendall(theirs, HEAD + b"\r\n")
        while received < size - unread:
            received += len(await loop.sock_recv(theirs, size - unread - received))
        await asyncio.sleep(1)
        with theirs, suppress(ConnectionResetError):
            while content := await asyncio.wait_for(loop.sock_recv(theirs, size), 10):
                received += len(content)
        return received

    assert asyncio.run(read_most()) < size


def test_an_answer_may_be_read_slowly_on_a_kept_connection(monkeypatch: pytest.MonkeyPatch) -> None:
    """Though all of it is given to the connection at once, and the next request could begin then."""
    monkeypatch.setattr(connections, "HEAD_S", 0.3)
    size = 1 << 20

    async def read_slowly() -> int:
        loop, received = asyncio.get_running_loop(), 0
        ours, theirs = socket.socketpair()
        theirs.setblocking(False)
        config = uvicorn.Config(Response(b"x" * size), log_config=None, lifespan="off")
        config.load()
        await loop.create_connection(lambda: connections.ImpatientProtocol(config, ServerState(), {}), sock=ours)
        await loop.sock_sendall(theirs, HEAD + b"\r\n")
        with theirs, suppress(ConnectionResetError):
            while received < size and (content := await loop.sock_recv(theirs, 32 << 10)):
                received += len(content)
                await asyncio.sleep(0.03)
        return received

    assert asyncio.run(read_slowly()) >= size


UPGRADE = (
    b"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
)


async def send_for_ever(scope: dict, receive: Callable, send: Callable) -> None:
    """Application whose answers are large, and whose WebSockets send until nobody is there any more."""
    if scope["type"] == "http":
        await Response(b"x" * MEBIBYTE)(scope, receive, send)
        return
    await send({"type": "websocket.accept"})
    while True:
        await send({"type": "websocket.send", "bytes": b"x" * 65536})


async def ends(sent: bytes, within_s: float) -> bool:
    """Whether a client that sends this and never reads is disconnected."""
    loop = asyncio.get_running_loop()
    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    options = {"log_config": None, "lifespan": "off", "ws": connections.ImpatientWebSocket, "ws_ping_interval": None}
    config = uvicorn.Config(send_for_ever, **options)
    config.load()
    transport, _ = await loop.create_connection(
        lambda: connections.ImpatientProtocol(config, ServerState(), {}), sock=ours
    )
    with theirs:
        await loop.sock_sendall(theirs, sent)
        with suppress(TimeoutError):
            async with asyncio.timeout(within_s):
                while not transport.is_closing():
                    await asyncio.sleep(0.05)
        return transport.is_closing()


@pytest.mark.parametrize("sent", [UPGRADE, HEAD + b"\r\n" + UPGRADE], ids=["alone", "after a request"])
def test_a_websocket_whose_client_never_reads_is_ended(monkeypatch: pytest.MonkeyPatch, sent: bytes) -> None:
    monkeypatch.setattr(connections, "STALL_S", 0.5)
    assert asyncio.run(ends(sent, 4))


def test_whoever_reads_slowly_gets_the_whole_answer(impatient: Running) -> None:
    with connect(impatient) as connection:
        connection.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
        received = 0
        while content := connection.recv(2 * MEBIBYTE):
            received += len(content)
            time.sleep(0.05)
        assert received > 64 * MEBIBYTE
