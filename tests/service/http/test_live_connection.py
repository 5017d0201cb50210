"""Pictures sent to a viewer, whatever the order of its requests; the worker and the socket are scripted."""

from __future__ import annotations

import asyncio
import json
import struct
import time
from collections.abc import Awaitable, Callable
from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import patch

import pytest

from service.http.admission import Admission
from service.http.errors import ServiceError
from service.http.frame_cache import FrameCache
from service.http.live_connection import FREE_S, MAX_PROBLEMS, PAUSE_RATIO, LiveConnection
from service.http.metrics import Metrics
from service.http.stopping import Stopping
from service.models.cameras import READOUT_EXAMPLE, Readout
from service.picture.requests import LiveNumbers, LivePicture
from service.workers.places import NOWHERE

SPENT = dict.fromkeys(("read_ms", "peel_ms", "blur_ms", "finish_ms", "total_ms", "encode_ms"), 1.0)
PREVIEW = LivePicture("preview", "jpeg", 24, 14, SPENT, 0, 0.25, 0.0, b"preview")
REFINING = LivePicture("refining", "jpeg", 96, 54, SPENT, 6, 1.0, 0.1, b"refining")
BETTER = LivePicture("refining", "jpeg", 96, 54, SPENT, 12, 1.0, 0.2, b"better")
FINAL = LivePicture(
    "final", "png", 96, 54, SPENT, 8, 1.0, 1.0, b"\x89PNG\r\n\x1a\n" + struct.pack(">I4sII", 13, b"IHDR", 96, 54)
)

NUMBERS = LiveNumbers(Readout.model_validate(READOUT_EXAMPLE), [])


class Socket:
    """The client's end of a connection."""

    def __init__(self) -> None:
        self.to_service: asyncio.Queue[str] = asyncio.Queue()
        self.pictures: list[tuple[int, str]] = []
        self.ends: list[bytes] = []
        self.order: list[str] = []
        self.texts: list[dict] = []
        self.received_count = 0
        self.reads = asyncio.Event()
        self.reads.set()

    async def receive(self) -> dict[str, str]:
        text = await self.to_service.get()
        self.received_count += 1
        return {"type": "websocket.receive", "text": text}

    async def send_bytes(self, data: bytes) -> None:
        await self.reads.wait()
        end = 4 + struct.unpack_from(">I", data)[0]
        head = json.loads(data[4:end])
        self.ends.append(data[end:])
        self.pictures.append((head["id"], head["stage"]))
        self.order.append("picture")

    async def send_text(self, text: str) -> None:
        await self.reads.wait()
        self.texts.append(json.loads(text))
        self.order.append("readout" if "readout" in self.texts[-1] else "problem")

    async def send(self, **fields: object) -> None:
        self.to_service.put_nowait(json.dumps(fields))
        await settled()

    async def request(self, number: int, **fields: object) -> None:
        self.put(number, **fields)
        await settled()

    def put(self, number: int, **fields: object) -> None:
        """Send a request, and wait for nothing."""
        given = {"id": number, "width": 96, "height": 54, "rays": 8, "time": number} | fields
        self.to_service.put_nowait(json.dumps(given))


class Pictures:
    """A queue whose pictures come from the test."""

    def __init__(self) -> None:
        self.streams: list[SimpleNamespace] = []
        self.dropped: list[SimpleNamespace] = []
        self.waiting = 0
        self.connection: LiveConnection | None = None
        self.looks: list[tuple[str | None, float]] = []

    def submit_stream(self, work: object, place: object, client: object, **callbacks: object) -> SimpleNamespace:
        self.streams.append(SimpleNamespace(work=work, **callbacks))
        return self.streams[-1]

    def cancel(self, stream: SimpleNamespace) -> None:
        self.dropped.append(stream)

    async def show(self, index: int, shown: LivePicture) -> None:
        self.streams[index].on_item(shown)
        await settled()


def started_times(pictures: Pictures) -> list[float]:
    """Times of the frames of all streams, which are the numbers of their requests."""
    return [stream.view[1] for stream in pictures.streams]


async def started(pictures: Pictures, number: int) -> None:
    """Wait until a request has been started."""
    async with asyncio.timeout(10):
        while number not in started_times(pictures):
            await asyncio.sleep(0.001)


async def at_once(function: Callable, *given: object) -> object:
    """Call a function here rather than in a thread, so that `settled` depends on no other."""
    return function(*given)


async def settled() -> None:
    """Let all pending tasks run."""
    for _ in range(20):
        await asyncio.sleep(0.001)


def serve(play: Callable[[Socket, Pictures], Awaitable[None]]) -> None:
    """Serve a connection while a test plays the worker and the page."""

    async def run() -> None:
        record = SimpleNamespace(id="room", created_at=SimpleNamespace(isoformat=lambda: "now"), edit_text=lambda: "")
        socket, pictures = Socket(), Pictures()
        service = SimpleNamespace(
            settings=SimpleNamespace(max_picture_px=10**6),
            store=SimpleNamespace(get=lambda shot: record),
            lanes=SimpleNamespace(live=pictures),
            place_of=lambda record: NOWHERE,
            admission=Admission(600, max_px=10**6),
            frame_cache=FrameCache(10**6),
            metrics=Metrics(SimpleNamespace()),
            stopping=Stopping(),
            run_id="run",
        )
        pictures.connection = LiveConnection(service, socket, "room")
        pictures.connection.on_look = lambda place: pictures.looks.append((place.camera, place.time))
        connection = asyncio.create_task(pictures.connection.serve())
        try:
            await play(socket, pictures)
            assert not connection.done()
        finally:
            connection.cancel()

    with patch("service.http.live_connection.run_in_threadpool", at_once):
        asyncio.run(run())


def test_late_pictures_of_an_old_request_do_not_replace_a_cached_one():
    async def play(socket: Socket, pictures: Pictures) -> None:
        await socket.request(2)
        await pictures.show(0, FINAL)  # which is cached now
        await socket.send(ack=1)
        await socket.request(1)
        await pictures.show(1, PREVIEW)
        await pictures.show(1, REFINING)
        await socket.request(3, time=2)
        assert pictures.dropped == [pictures.streams[1]]
        await pictures.show(1, BETTER)
        pictures.streams[1].on_end(ServiceError(422, "unfit", "It took too long."))
        assert socket.pictures[1:] == [(1, "preview"), (1, "refining")]  # two are unacknowledged
        await socket.send(ack=3)
        assert socket.pictures[3:] == [(3, "final")]
        assert socket.texts == []

    serve(play)


def test_a_superseded_request_shows_a_picture_unless_a_newer_one_did():
    async def play(socket: Socket, pictures: Pictures) -> None:
        for number in (1, 2, 3):
            await socket.request(number, moving=True)
        await pictures.show(0, PREVIEW)
        await pictures.show(2, PREVIEW)
        await socket.send(ack=2)
        await pictures.show(1, PREVIEW)
        assert socket.pictures == [(1, "preview"), (3, "preview")]

    serve(play)


def test_after_a_stop_nothing_is_sent_until_the_next_request():
    async def play(socket: Socket, pictures: Pictures) -> None:
        await socket.request(1)
        await pictures.show(0, PREVIEW)
        await pictures.show(0, REFINING)
        await pictures.show(0, BETTER)  # waits for an ack
        await socket.send(stop=True)
        assert pictures.dropped == pictures.streams
        await socket.send(ack=2)
        await pictures.show(0, FINAL)
        assert socket.pictures == [(1, "preview"), (1, "refining")]
        await socket.request(2)
        await pictures.show(1, PREVIEW)
        assert socket.pictures[2:] == [(2, "preview")]
        assert socket.texts == []

    serve(play)


def test_in_a_crowd_only_the_newest_of_quick_requests_is_started():
    async def play(socket: Socket, pictures: Pictures) -> None:
        pictures.waiting = 50
        await socket.request(1, moving=True)
        for number in range(2, 6):  # all are there before the pause after the first is over
            socket.put(number, moving=True)
        await started(pictures, 5)
        assert started_times(pictures) == [1, 5]
        await pictures.show(-1, PREVIEW)
        assert socket.pictures == [(5, "preview")]

    serve(play)


def test_in_a_crowd_what_is_overtaken_is_not_even_parsed():
    async def play(socket: Socket, pictures: Pictures) -> None:
        pictures.waiting = 50
        await socket.request(1, moving=True)
        for text in ("no json", json.dumps({"id": 2, "width": "broad"})):
            socket.to_service.put_nowait(text)
        await socket.request(3, moving=True)
        await started(pictures, 3)
        assert socket.texts == []

    serve(play)


@pytest.mark.parametrize("text", ["no json", '{"id": 2, "width": "broad"}'])
def test_what_is_no_request_replaces_none(text):
    async def play(socket: Socket, pictures: Pictures) -> None:
        for sent in (json.dumps({"id": 1, "width": 96, "height": 54, "rays": 8, "time": 1}), text):
            socket.to_service.put_nowait(sent)  # both are there before the first one is started
        await settled()
        assert started_times(pictures) == [1]
        assert len(socket.texts) == 1

    serve(play)


@pytest.mark.parametrize("waiting", [0, 50])
@pytest.mark.parametrize(
    "fields", [{"camera": "/\\u0061"}, {"camera": '/"stop"'}, {"film": "ack"}, {"film": "stop"}], ids=str
)
def test_a_request_may_say_what_other_messages_say(fields, waiting):
    async def play(socket: Socket, pictures: Pictures) -> None:
        pictures.waiting = waiting
        await socket.request(1, **fields)
        await pictures.show(0, PREVIEW)
        assert socket.pictures == [(1, "preview")]

    serve(play)


def test_an_ack_may_be_written_with_an_escape():
    async def play(socket: Socket, pictures: Pictures) -> None:
        await socket.request(1)
        for shown in (PREVIEW, REFINING, BETTER):  # the last one waits for an ack
            await pictures.show(0, shown)
        socket.to_service.put_nowait('{"\\u0061ck": 2}')
        await settled()
        assert len(socket.pictures) == 3

    serve(play)


def test_a_stop_in_a_crowd_discards_what_was_not_started():
    async def play(socket: Socket, pictures: Pictures) -> None:
        pictures.waiting = 50
        await socket.request(1, moving=True)
        socket.put(2, moving=True)
        await socket.send(stop=True)
        assert pictures.dropped == pictures.streams
        await socket.request(3)
        await started(pictures, 3)
        assert started_times(pictures) == [1, 3]

    serve(play)


def test_a_client_that_never_reads_is_not_received_from():
    async def play(socket: Socket, pictures: Pictures) -> None:
        socket.reads.clear()
        for _ in range(10 * MAX_PROBLEMS):
            socket.to_service.put_nowait('{"ack": "no number"}')
        await settled()
        assert MAX_PROBLEMS <= socket.received_count <= MAX_PROBLEMS + 2
        socket.reads.set()
        while len(socket.texts) < 10 * MAX_PROBLEMS:
            await asyncio.sleep(0.001)

    serve(play)


def test_a_client_of_large_messages_has_pauses():
    async def play(socket: Socket, pictures: Pictures) -> None:
        for _ in range(3):
            socket.to_service.put_nowait(json.dumps({"id": 1, "changes": [{} for _ in range(90_000)]}))
        await settled()
        begun_s = time.perf_counter()
        assert socket.received_count == 1
        async with asyncio.timeout(60):
            while len(socket.texts) < 3:
                await asyncio.sleep(0.001)
        assert time.perf_counter() - begun_s > 2 * PAUSE_RATIO * FREE_S

    serve(play)


def test_a_focus_map_outlives_the_picture_that_it_came_with():
    async def play(socket: Socket, pictures: Pictures) -> None:
        await socket.request(1, focusMaps=True)
        pictures.streams[0].on_item(replace(PREVIEW, focus=b"map"))
        pictures.streams[0].on_item(REFINING)  # takes the preview's place before it is sent
        await settled()
        assert socket.pictures == [(1, "refining")]
        assert socket.ends == [b"refiningmap"]

    serve(play)


def test_a_readout_follows_the_picture_that_it_belongs_to():
    async def play(socket: Socket, pictures: Pictures) -> None:
        await socket.request(1, moving=True)
        pictures.streams[0].on_item(PREVIEW)
        pictures.streams[0].on_item(NUMBERS)  # both wait before either is sent
        await settled()
        assert socket.order == ["picture", "readout"]

    serve(play)


def test_only_the_newest_unsent_readout_is_sent():
    async def play(socket: Socket, pictures: Pictures) -> None:
        socket.reads.clear()
        for number in range(1, 6):
            await socket.request(number, moving=True)
            pictures.streams[-1].on_item(PREVIEW)
            pictures.streams[-1].on_item(NUMBERS)
            await settled()
        socket.reads.set()
        await settled()
        assert [message["id"] for message in socket.texts] == [5]  # the first picture was being sent

    serve(play)


@pytest.mark.parametrize("waiting", [0, 50])
def test_the_places_that_are_asked_for_are_noted(waiting):
    async def play(socket: Socket, pictures: Pictures) -> None:
        pictures.waiting = waiting
        await socket.request(1, camera="/cam")
        await started(pictures, 1)
        await socket.send(here={"camera": "/cam", "time": 7})
        await socket.send(here={"time": 8.5})
        await socket.send(here={"time": "soon"})
        assert pictures.looks == [("/cam", 1.0), ("/cam", 7.0), (None, 8.5)]
        assert [message["problem"]["code"] for message in socket.texts] == ["invalid_request"]

    serve(play)


def test_only_the_newest_of_unsent_viewers_is_sent():
    async def play(socket: Socket, pictures: Pictures) -> None:
        socket.reads.clear()
        await socket.request(1)
        await pictures.show(0, PREVIEW)
        for number in range(5):
            pictures.connection.tell_viewers(json.dumps({"id": number}))
        await settled()
        assert socket.texts == []
        socket.reads.set()
        await settled()
        assert socket.texts == [{"id": 4}]

    serve(play)


MANY_KEYS = json.dumps({"ack": 1} | dict.fromkeys(map(str, range(50_000)), 0))


@pytest.mark.parametrize(
    "text", [MANY_KEYS, "[" * 500_000, '{"id":' * 500_000, '{"stop": false}', '{"stop": true, "id": 1}']
)
def test_an_invalid_message_is_reported_and_the_next_one_answered(text):
    async def play(socket: Socket, pictures: Pictures) -> None:
        socket.to_service.put_nowait(text)
        await settled()
        assert [message["problem"]["code"] for message in socket.texts] == ["invalid_request"]
        await socket.request(1)
        await started(pictures, 1)
        await pictures.show(0, PREVIEW)
        assert socket.pictures == [(1, "preview")]

    serve(play)
