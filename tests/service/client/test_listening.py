"""Waiting by events: a render is looked at when something has happened, and now and then where nothing can be heard."""

from __future__ import annotations

import asyncio
from itertools import pairwise

import httpx
import pytest

from service.client import AsyncClient, WaitTimeoutError
from service.client.listening import Heard
from tests.service.client.fake import QUICK, RENDER, Fake

QUEUED, RUNNING, DONE = ({"state": "queued", "done": 0}, {"state": "running", "done": 1}, {"state": "done", "done": 2})


class Stream(httpx.SyncByteStream, httpx.AsyncByteStream):
    """The body of a stream.

    Args:
        parts: as they come.
        end: an error that ends it; None for a regular end.
    """

    def __init__(self, *parts, end=None):
        self.parts, self.end, self.read, self.is_closed = parts, end, 0, False

    def __iter__(self):
        for part in self.parts:
            self.read += 1
            yield part
        if self.end is not None:
            raise self.end

    async def __aiter__(self):
        for part in self:
            yield part

    def close(self):
        self.is_closed = True

    async def aclose(self):
        self.close()


def mark(number):
    return f"id: {number}\nretry: 2000\n\n".encode()


def event(number):
    return f'event: tasks\ndata: {{"number":{number}}}\nid: {number}\n\n'.encode()


def told(*parts, end=None):
    return answer_by(Stream(*parts, end=end))


def answer_by(stream):
    return httpx.Response(200, headers={"Content-Type": "text/event-stream"}, stream=stream)


class Service:
    """A service whose render is in some states in turn, and which answers those who follow events; the last ones stay.

    Args:
        states: of the render.
        answers: to requests for events: responses, errors, or functions that return them.
    """

    def __init__(self, states, answers):
        self.states, self.answers, self.questions, self.looks = [*states], [*answers], [], 0
        self.fake = Fake(self.reply)

    def reply(self, request):
        if request.url.path == "/v1/renders/r-1":
            self.looks += 1
            return httpx.Response(200, json=RENDER | next_of(self.states))
        assert request.url.path == "/v1/events"
        self.questions.append(dict(request.url.params) | {"most_s": request.extensions["timeout"]["read"]})
        answer = next_of(self.answers)
        answer = answer(request) if callable(answer) else answer
        if isinstance(answer, Exception):
            raise answer
        return answer


def next_of(waiting):
    return waiting.pop(0) if len(waiting) > 1 else waiting[0]


@pytest.fixture
def clock(monkeypatch):
    """A clock that stands still but for the pauses of the client, which it keeps."""

    class Clock:
        now_s, pauses = 1000.0, ()

        def pause(self, seconds, _=None):
            self.now_s += seconds
            self.pauses += (seconds,)

    clock = Clock()
    monkeypatch.setattr("service.client.operations.time.monotonic", lambda: clock.now_s)
    monkeypatch.setattr("service.client.sync_client._pause", clock.pause)
    return clock


def test_a_render_is_looked_at_after_each_event(clock):
    service = Service(
        [QUEUED, RUNNING, RUNNING, DONE],
        [told(mark(4)), told(mark(4) + event(6), event(7)), told(mark(6), event(7) + event(9))],
    )
    seen = []
    with service.fake.client() as client:
        assert client.wait("r-1", on_progress=seen.append).state == "done"
    assert [now.state for now in seen] == ["queued", "running", "done"]
    assert service.questions == [
        {"render": "r-1", "follow": "false", "most_s": 15.0},
        {"render": "r-1", "after": "4", "most_s": 15.0},
        {"render": "r-1", "after": "6", "most_s": 15.0},
    ]
    assert clock.pauses == (0.25, 0.25), "events in quick succession are one"


def test_nothing_is_read_after_an_event(clock):
    parts = [bytes([byte]) for byte in (mark(4) + event(5)).replace(b"\n", b"\r\n")]
    stream = Stream(*parts, *[event(6)] * 99)
    with Service([QUEUED, RUNNING, DONE], [told(mark(4)), answer_by(stream)]).fake.client() as client:
        client.wait("r-1")
    assert stream.read == len(parts)
    assert stream.is_closed


def test_a_quiet_render_is_looked_at_now_and_then(clock):
    def quiet(request):
        clock.now_s += request.extensions["timeout"]["read"]
        return told(mark(4), end=httpx.ReadTimeout("nothing came"))

    service = Service([QUEUED] * 5 + [DONE], [told(mark(4)), quiet])
    with service.fake.client() as client:
        client.wait("r-1")
    assert clock.pauses == ()
    assert (service.looks, clock.now_s) == (6, 1000 + 4 * 15)


def test_a_second_mark_is_a_time_to_look(clock):
    stream = Stream(mark(4), mark(8), mark(9))
    with Service([QUEUED, QUEUED, DONE], [told(mark(4)), answer_by(stream)]).fake.client() as client:
        client.wait("r-1")
    assert stream.read == 2


@pytest.mark.parametrize(
    "answer",
    [
        httpx.Response(503, json={"code": "busy", "detail": "64 readers of events are connected already."}),
        httpx.Response(404, json={"code": "not_found", "detail": "There is nothing."}),
        httpx.Response(200, json=RENDER),
        httpx.ConnectError("nobody listens"),
        httpx.ReadTimeout("no head comes"),
        told(),
        told(mark(4), end=httpx.ReadError("it broke")),
        told(mark(4)),
        told(*[bytes(1 << 18)] * 99),
        told(b"data: no number\n\n"),
        told(b"id: 99999999999999999999\n\n"),
    ],
    ids=(
        "busy",
        "unknown",
        "other",
        "unreachable",
        "late",
        "empty",
        "broken",
        "ended",
        "endless",
        "unnumbered",
        "absurd",
    ),
)
def test_a_stream_that_fails_is_replaced_by_looks(clock, answer):
    service = Service([QUEUED] * 9 + [DONE], [told(mark(4)), answer])
    with service.fake.client() as client:
        client.wait("r-1")
    assert len(service.questions) == 2, "it is not asked for again at once"
    assert list(clock.pauses) == sorted(clock.pauses)
    assert (clock.pauses[0], clock.pauses[-1]) == (0.25, 3.0)


def test_a_stream_that_fails_is_asked_for_ever_more_rarely(clock):
    asked_s = []

    def refuse(_):
        asked_s.append(clock.now_s)
        return httpx.Response(503)

    with Service([QUEUED], [refuse]).fake.client() as client, pytest.raises(WaitTimeoutError):
        client.wait("r-1", timeout_s=4000)
    gaps = [after - before for before, after in pairwise(asked_s)]
    assert all(
        least <= gap <= least + 3 for gap, least in zip(gaps, (15, 30, 60, 120, 240, 480, 600, 600), strict=False)
    )
    assert len(gaps) >= 8


def test_a_stream_that_is_there_again_is_used(clock):
    service = Service([QUEUED] * 30 + [DONE], [httpx.Response(503), told(mark(4)), lambda _: told(mark(4), event(5))])
    with service.fake.client() as client:
        client.wait("r-1")
    assert [question.get("after") for question in service.questions[:4]] == [None, None, "4", "5"]


def test_waiting_for_an_event_ends_in_time(clock):
    def quiet(request):
        clock.now_s += request.extensions["timeout"]["read"]
        return told(mark(4), end=httpx.ReadTimeout("nothing came"))

    service = Service([QUEUED], [told(mark(4)), quiet])
    with service.fake.client() as client, pytest.raises(WaitTimeoutError, match="r-1 is queued after 20 s"):
        client.wait("r-1", timeout_s=20)
    assert [question["most_s"] for question in service.questions] == [15, 15, 5]
    assert clock.now_s == 1020


def test_a_stream_that_trickles_ends_in_time(clock):
    heard = Heard(15)
    heard.write(mark(4))
    for _ in range(14):
        clock.now_s += 1
        heard.write(b": \n")
        assert not heard.is_enough()
    clock.now_s += 1
    assert heard.is_enough()


def test_a_render_that_has_ended_needs_no_events(clock):
    service = Service([DONE], [AssertionError("nobody has to listen")])
    with service.fake.client() as client:
        client.wait("r-1")
    assert service.questions == []


def test_an_event_loop_waits_by_events():
    service = Service([QUEUED, RUNNING, DONE], [told(mark(4)), told(mark(4), event(5), event(6))])

    async def go():
        transport = httpx.MockTransport(service.fake)
        async with AsyncClient("http://service", retries=QUICK, transport=transport) as client:
            return await client.wait("r-1")

    assert asyncio.run(go()).state == "done"
    assert [question.get("after") for question in service.questions] == [None, "4"]


def test_a_wait_that_is_canceled_closes_its_stream():
    class Silent(Stream):
        async def __aiter__(self):
            yield mark(4)
            listening.set()
            await asyncio.Event().wait()

    listening, silent = asyncio.Event(), Silent()

    async def go():
        transport = httpx.MockTransport(Service([QUEUED], [told(mark(4)), answer_by(silent)]).fake)
        async with AsyncClient("http://service", retries=QUICK, transport=transport) as client:
            waiting = asyncio.create_task(client.wait("r-1"))
            await listening.wait()
            waiting.cancel()
            await asyncio.gather(waiting, return_exceptions=True)
            assert waiting.cancelled()

    asyncio.run(go())
    assert silent.is_closed
