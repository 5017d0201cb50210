"""Plain requests of several kinds, repeated while something else goes on: how long others have to wait."""

from __future__ import annotations

import errno
import http.client
import itertools
import json
import select
import socket
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from time import monotonic, sleep
from typing import Any
from urllib.parse import urlencode

from service.bench.viewers import address_of

PAUSE_S = 0.2
"""Time between the answer to a repeated request and the next one."""
ANSWER_S = 300.0
FIRST_CLIENT = 10_000
"""Number of the first client of these requests; viewers have those before."""


@dataclass
class Repeated:
    """A request that is repeated.

    Attributes:
        seconds: time from each request to its answer, s.
        failures: answers that are errors.
    """

    seconds: list[float] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)


def ask(
    port: int,
    client: int,
    method: str,
    path: str,
    body: bytes | None = None,
    headers: Mapping[str, str] | None = None,
) -> tuple[int, bytes]:
    """Send one request and wait for its answer.

    Args:
        port: of the service.
        client: number of the client, for `address_of`.
        method: of HTTP.
        path: with its query.
        body: what is sent.
        headers: sent with it.

    Returns:
        The status and the answer.

    Raises:
        OSError: the service cannot be reached, or does not answer.
        HTTPException: its answer breaks off, or is none of HTTP.
    """
    connection = http.client.HTTPConnection("127.0.0.1", port, ANSWER_S, (address_of(client), 0))
    try:
        connection.request(method, path, body, dict(headers or {}))
        answer = connection.getresponse()
        return answer.status, answer.read()
    finally:
        connection.close()


def frame_path(shot: str, **query: Any) -> str:
    """Return the path of a frame of a shot; the keywords are its query."""
    return f"/v1/shots/{shot}/frame?{urlencode(query)}"


def usual_requests(port: int, shot: str, other_shot: str) -> dict[str, Callable[[], str]]:
    """Return the requests that are repeated, by name. Each returns what was wrong with the answer, or nothing.

    Args:
        port: of the service.
        shot: id of the shot that viewers drag.
        other_shot: id of another one.
    """
    numbers = itertools.count(1)  # in each request, so that no answer comes from a cache

    def get(client: int, path: Callable[[int], str]) -> Callable[[], str]:
        return lambda: _wrong(*ask(port, client, "GET", path(next(numbers))))

    def edit() -> str:
        change = {"type": "setCamera", "values": {"fStop": 2.0 + next(numbers) % 50 / 10}}
        body = json.dumps({"label": "Stop", "changes": [change]}).encode()
        headers = {"Content-Type": "application/json"}
        return _wrong(*ask(port, FIRST_CLIENT + 3, "POST", f"/v1/shots/{shot}/edits", body, headers))

    small = {"width": 64, "rays": 4, "time": 1}
    return {
        "small frame of the same shot": get(FIRST_CLIENT, lambda n: frame_path(shot, seed=n, **small)),
        "small frame of another shot": get(FIRST_CLIENT + 1, lambda n: frame_path(other_shot, seed=n, **small)),
        "readout": get(FIRST_CLIENT + 2, lambda n: f"/v1/shots/{shot}/readout?time={1 + n % 90}"),
        "edit": edit,
    }


@contextmanager
def repeating(requests: Mapping[str, Callable[[], str]]) -> Iterator[dict[str, Repeated]]:
    """Repeat requests, each in a thread of its own, until the end of the context, and wait for the last answers.

    Args:
        requests: by name, as `usual_requests` returns them.
    """
    stop = threading.Event()
    found = {name: Repeated() for name in requests}

    def repeat(name: str) -> None:
        while not stop.is_set():
            began_s = monotonic()
            try:
                wrong = requests[name]()
            except (OSError, http.client.HTTPException) as error:
                wrong = f"{type(error).__name__}: {error}"
            found[name].seconds.append(monotonic() - began_s)
            if wrong:
                found[name].failures.append(wrong)
            stop.wait(PAUSE_S)

    with ExitStack() as stack:
        for name in requests:
            thread = threading.Thread(target=repeat, args=(name,), name=name)
            thread.start()
            stack.callback(thread.join)
        stack.callback(stop.set)
        yield found


class Abandoned:
    """A GET whose answer nobody reads.

    Args:
        port: of the service.
        client: number of the client, for `address_of`.
        path: with its query.
    """

    def __init__(self, port: int, client: int, path: str) -> None:
        self._socket = socket.create_connection(("127.0.0.1", port), ANSWER_S, (address_of(client), 0))
        self._socket.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())

    def status_within(self, seconds: float) -> int | None:
        """Return the status of the answer, or None where it does not come within a time, s.

        Raises:
            OSError: the service closes the connection without an answer.
        """
        if not self.has_answer(seconds):
            return None
        begin = self._socket.recv(64)
        if not begin:
            raise ConnectionResetError(errno.ECONNRESET, "the service closes the connection without an answer")
        return int(begin.split()[1])

    def has_answer(self, seconds: float = 0.0) -> bool:
        """Whether the answer begins, or the connection ends, within a time, s."""
        return bool(select.select([self._socket], [], [], seconds)[0])

    def leave(self) -> None:
        """Close the connection."""
        self._socket.close()


def leave_after(seconds: float, request: Abandoned) -> None:
    """Leave a request after a time, s."""
    sleep(seconds)
    request.leave()


def _wrong(status: int, answer: bytes) -> str:
    return "" if status < 400 else f"{status}: {answer.decode(errors='replace')[:200]}"
