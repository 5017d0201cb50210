"""Readers of events over HTTP, who are cut off at random and go on."""

from __future__ import annotations

import http.client
import random
import threading
from collections.abc import Generator, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from itertools import islice
from typing import NamedTuple
from urllib.parse import urlencode

from service.bench.jobs.plan import JobsPlan
from service.bench.jobs.requests import Request, Sender, send_render
from service.bench.jobs.results import Reader
from service.bench.requests import ANSWER_S, FIRST_CLIENT
from service.bench.viewers import address_of

RENDERS = 100
"""Renders that come and go while the readers read."""
MOST_UNTIL_CUT = 400
"""Events after which a reader is cut off at the latest."""
TOPICS = ((), ("renders",), ("tasks", "renders"))
"""Topics of readers, in turn."""


class Told(NamedTuple):
    """One event of Server-Sent Events.

    Attributes:
        number: its id; None without one.
        is_event: whether it has data; else it is a mark.
    """

    number: int | None
    is_event: bool


def read_streams(port: int, plan: JobsPlan) -> tuple[list[Reader], int]:
    """Let readers read from any number on while renders come and go.

    Args:
        port: of a service that has events already.
        plan: of the measurements.

    Returns:
        The readers, and the number of the last event that each should have.

    Raises:
        OSError: the service does not answer.
        HTTPException: an answer breaks off, or is none of HTTP.
        PullfocusError: an answer is an error.
    """
    chance = random.Random(plan.seed)
    newest = _newest(port)
    readers = [
        Reader.after("HTTP", TOPICS[number % len(TOPICS)], chance.randint(0, newest)) for number in range(plan.readers)
    ]
    is_over = threading.Event()
    with ThreadPoolExecutor(len(readers)) as threads:
        reading = [
            threads.submit(_read, port, number, reader, random.Random(f"{plan.seed}/{number}"), is_over)
            for number, reader in enumerate(readers)
        ]
        try:
            _make_events(port, plan)
            until = _newest(port)
        finally:
            is_over.set()
        for each in reading:
            each.result()
    return readers, until


def _make_events(port: int, plan: JobsPlan) -> None:
    """Send, pause, resume, cancel and remove renders."""
    with closing(Sender(port, 0)) as sender:
        for _ in range(min(RENDERS, plan.renders)):
            path = f"/v1/renders/{sender.send(send_render(plan))[1]['id']}"
            for verb in ("pause", "resume", "cancel"):
                sender.send(Request("POST", f"{path}/{verb}"))
            sender.send(Request("DELETE", path))


def _read(port: int, number: int, reader: Reader, chance: random.Random, is_over: threading.Event) -> None:
    """Read until it is over, cut off at random, and then what is left."""
    while not is_over.is_set():
        most = chance.randint(1, MOST_UNTIL_CUT)
        with closing(_stream(port, number, reader, follow=True)) as stream:
            for told in islice(stream, most):
                _take(reader, told)
        reader.cuts += not is_over.is_set()
    for told in _stream(port, number, reader, follow=False):
        _take(reader, told)


def _take(reader: Reader, told: Told) -> None:
    if told.number is None:
        return
    if told.is_event:
        reader.note(told.number)
    else:
        reader.last = told.number


def _newest(port: int) -> int:
    """Return the number of the newest event: a stream without a number begins with it."""
    with closing(_stream(port, 0, None, follow=False)) as stream:
        first = next(stream)
    assert first.number is not None, "a mark has a number"
    return first.number


def _stream(port: int, number: int, reader: Reader | None, *, follow: bool) -> Generator[Told, None, None]:
    """Yield what a reader is told. One that follows ends after a second in which nothing comes, too."""
    patience_s = 1.0 if follow else ANSWER_S
    address = address_of(FIRST_CLIENT + 100 + number), 0
    query = [("follow", str(follow).lower()), *(("topic", topic) for topic in (reader.topics if reader else ()))]
    headers = {"Last-Event-ID": str(reader.last)} if reader else {}
    with closing(http.client.HTTPConnection("127.0.0.1", port, patience_s, address)) as connection:
        try:
            connection.request("GET", f"/v1/events?{urlencode(query)}", headers=headers)
            answer = connection.getresponse()
            if answer.status != 200:
                raise http.client.HTTPException(f"the events are answered {answer.status}")
            yield from _parse(answer)
        except TimeoutError:
            if not follow:
                raise


def _parse(answer: http.client.HTTPResponse) -> Iterator[Told]:
    """Yield Server-Sent Events as they come; what breaks off is none."""
    number, is_event = None, False
    for line in answer:
        name, _, value = line.decode().rstrip("\r\n").partition(": ")
        if name == "id":
            number = int(value)
        elif name == "data":
            is_event = True
        elif not name:
            yield Told(number, is_event)
            number, is_event = None, False
