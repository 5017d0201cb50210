"""Requests about a queue of many renders, none of which is drawn: how long each takes over HTTP."""

from __future__ import annotations

import http.client
import json
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from math import ceil
from time import perf_counter
from typing import Any, NamedTuple, TypeVar

from render.errors import PullfocusError
from service.bench.jobs.plan import CLIENTS, JobsPlan
from service.bench.jobs.results import GrowthRow, RequestRow, growth_of, times_of
from service.bench.requests import ANSWER_S, FIRST_CLIENT
from service.bench.viewers import address_of

Found = TypeVar("Found")

PAGE = 50
REPEATS = 200
"""Requests of each kind that is not sent once for each render."""
NO_WORKERS = "tcp://127.0.0.1:1"
"""Address of a Dask scheduler that is none: a service that looks for it has no workers for renders."""


class Request(NamedTuple):
    """A request.

    Attributes:
        method: of HTTP.
        path: with its query.
        body: what is sent, as JSON; None for nothing.
    """

    method: str
    path: str
    body: dict[str, Any] | None = None


class Sender:
    """A client that keeps its connection.

    Args:
        port: of the service.
        number: of the client, from 0 on.
    """

    def __init__(self, port: int, number: int) -> None:
        address = address_of(FIRST_CLIENT + number), 0
        self._connection = http.client.HTTPConnection("127.0.0.1", port, ANSWER_S, address)
        self._connection.connect()

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()

    def send(self, request: Request) -> tuple[float, Any]:
        """Send a request and wait for its answer.

        Returns:
            The time that it took, s, and the answer; None where it is empty.

        Raises:
            PullfocusError: the answer is an error.
            OSError: the service does not answer.
            HTTPException: its answer breaks off, or is none of HTTP.
        """
        body = None if request.body is None else json.dumps(request.body).encode()
        began_s = perf_counter()
        self._connection.request(request.method, request.path, body, {"Content-Type": "application/json"})
        answer = self._connection.getresponse()
        content = answer.read()
        took_s = perf_counter() - began_s
        if answer.status >= 400:
            said = content.decode(errors="replace")[:300]
            raise PullfocusError(f"{request.method} {request.path} is answered {answer.status}: {said}")
        return took_s, json.loads(content) if content else None


def send_render(plan: JobsPlan) -> Request:
    """Return the request that sends a render."""
    body = {"shot": "demo", "frames": f"1-{plan.frames}", "width": 480, "rays": 16, "formats": ["exr"]}
    return Request("POST", "/v1/renders", body)


def measure_requests(port: int, plan: JobsPlan) -> tuple[list[RequestRow], list[GrowthRow]]:
    """Fill the queue, ask for what is in it, and empty it, by one client and by several.

    Args:
        port: of a service that draws no renders and has none.
        plan: of the measurements.

    Raises:
        PullfocusError: an answer is an error.
        OSError: the service does not answer.
        HTTPException: an answer breaks off, or is none of HTTP.
    """
    rows, growth = [], []
    with closing(Sender(port, 0)) as sender:
        if sender.send(Request("GET", "/v1/renders"))[1]["renders"]:
            raise PullfocusError("the database has renders; the bench needs one without")
    for clients in CLIENTS:
        for name, seconds in _requests(port, plan, clients):
            rows.append(RequestRow(name, clients, times_of(seconds)))
            if name == "submit":
                growth.append(growth_of(clients, seconds))
    return rows, growth


def _requests(port: int, plan: JobsPlan, clients: int) -> Iterator[tuple[str, list[float]]]:
    """Yield kinds of requests, with the time of each request, s, in their order."""
    seconds, sent = _send(port, clients, [send_render(plan)] * plan.renders)
    yield "submit", seconds
    ids = [each["id"] for each in sent]
    some = [ids[number * len(ids) // REPEATS] for number in range(REPEATS)]
    yield f"list the newest {PAGE}", _send(port, clients, [Request("GET", f"/v1/renders?most={PAGE}")] * REPEATS)[0]
    yield f"list a page of {PAGE}", _pages(port, clients, plan.renders)
    yield "get", _send(port, clients, [Request("GET", f"/v1/renders/{each}") for each in some])[0]
    yield "tasks of a render", _send(port, clients, [Request("GET", f"/v1/renders/{each}/tasks") for each in some])[0]
    for verb in ("pause", "resume", "cancel"):
        yield verb, _send(port, clients, [Request("POST", f"/v1/renders/{each}/{verb}") for each in ids])[0]
    yield "remove", _send(port, clients, [Request("DELETE", f"/v1/renders/{each}") for each in ids])[0]


def _send(port: int, clients: int, requests: Sequence[Request]) -> tuple[list[float], list[Any]]:
    """Send requests, dealt out to clients, and return the times, s, and the answers in the order of the requests."""

    def send_share(sender: Sender, number: int) -> list[tuple[float, Any]]:
        return [sender.send(request) for request in requests[number::clients]]

    shares = _at_once(port, clients, send_share)
    in_order = [shares[number % clients][number // clients] for number in range(len(requests))]
    return [took_s for took_s, _ in in_order], [answer for _, answer in in_order]


def _pages(port: int, clients: int, renders: int) -> list[float]:
    """Page through all renders, some times over, and return the time of each page, s."""
    walks = max(1, round(REPEATS / ceil(renders / PAGE) / clients))

    def walk(sender: Sender, _number: int) -> list[float]:
        seconds = []
        for _ in range(walks):
            before, count = "", 0
            while before is not None:
                query = f"&before={before}" if before else ""
                took_s, page = sender.send(Request("GET", f"/v1/renders?most={PAGE}{query}"))
                seconds.append(took_s)
                before, count = page.get("next"), count + len(page["renders"])
            if count != renders:
                raise PullfocusError(f"the pages have {count} renders, {renders} were sent")
        return seconds

    return [took_s for share in _at_once(port, clients, walk) for took_s in share]


def _at_once(port: int, clients: int, work: Callable[[Sender, int], Found]) -> list[Found]:
    """Call a function for each client at the same time."""

    def call(number: int) -> Found:
        with closing(Sender(port, number)) as sender:
            return work(sender, number)

    with ThreadPoolExecutor(clients) as threads:
        return list(threads.map(call, range(clients)))
