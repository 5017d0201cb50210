"""Pictures sent to a viewer, whatever the order of its requests; the worker and the socket are scripted."""

from __future__ import annotations

import asyncio
import json
import struct
from collections.abc import Awaitable, Callable
from types import SimpleNamespace

import pytest

from service.http.errors import ServiceError
from service.http.frame_cache import FrameCache
from service.http.metrics import Metrics
from service.http.viewing import MOST_PROBLEMS, Viewer
from service.models.cameras import READOUT_EXAMPLE, Readout
from service.picture.requests import LivePicture

SPENT = dict.fromkeys(("read_ms", "peel_ms", "blur_ms", "finish_ms", "total_ms", "encode_ms"), 1.0)
PREVIEW = LivePicture("preview", "jpeg", 24, 14, SPENT, 0, 0.25, 0.0, b"preview")
REFINING = LivePicture("refining", "jpeg", 96, 54, SPENT, 6, 1.0, 0.1, b"refining")
BETTER = LivePicture("refining", "jpeg", 96, 54, SPENT, 12, 1.0, 0.2, b"better")
FINAL = LivePicture(
    "final", "png", 96, 54, SPENT, 8, 1.0, 1.0, b"\x89PNG\r\n\x1a\n" + struct.pack(">I4sII", 13, b"IHDR", 96, 54)
)

READOUT = Readout.model_validate(READOUT_EXAMPLE)


class Socket:
    """The viewer's end of a connection."""

    def __init__(self) -> None:
        self.to_service: asyncio.Queue[str] = asyncio.Queue()
        self.heard: list[tuple[int, str]] = []
        self.said: list[dict] = []
        self.taken = 0
        self.reads = asyncio.Event()
        self.reads.set()

    async def receive(self) -> dict[str, str]:
        text = await self.to_service.get()
        self.taken += 1
        return {"type": "websocket.receive", "text": text}

    async def send_bytes(self, data: bytes) -> None:
        await self.reads.wait()
        head = json.loads(data[4 : 4 + struct.unpack_from(">I", data)[0]])
        self.heard.append((head["id"], head["stage"]))

    async def send_text(self, text: str) -> None:
        await self.reads.wait()
        self.said.append(json.loads(text))

    async def say(self, **said: object) -> None:
        self.to_service.put_nowait(json.dumps(said))
        await settled()

    async def ask(self, number: int, **asked: object) -> None:
        await self.say(id=number, width=96, height=54, rays=8, **({"time": number} | asked))


class Pictures:
    """A queue whose pictures come from the test."""

    def __init__(self) -> None:
        self.streams: list[SimpleNamespace] = []
        self.dropped: list[SimpleNamespace] = []

    def submit_stream(self, work: object, **ears: object) -> SimpleNamespace:
        self.streams.append(SimpleNamespace(work=work, **ears))
        return self.streams[-1]

    def cancel_stream(self, stream: SimpleNamespace) -> None:
        self.dropped.append(stream)

    async def show(self, index: int, shown: LivePicture) -> None:
        self.streams[index].on_item(shown)
        await settled()


async def settled() -> None:
    """Let all that can happen now happen, reading a shot's edits in a thread included."""
    for _ in range(20):
        await asyncio.sleep(0.001)


def watched(play: Callable[[Socket, Pictures], Awaitable[None]]) -> None:
    """Serve a viewer while a test plays the worker and the page."""

    async def served() -> None:
        record = SimpleNamespace(id="room", created_at=SimpleNamespace(isoformat=lambda: "now"), edit_text=lambda: "")
        socket, pictures = Socket(), Pictures()
        service = SimpleNamespace(
            settings=SimpleNamespace(max_picture_px=10**6),
            store=SimpleNamespace(get=lambda shot: record),
            picture_queue=pictures,
            frame_cache=FrameCache(10**6),
            metrics=Metrics(queues=()),
            run_id="run",
        )
        viewer = asyncio.create_task(Viewer(service, socket, "room").serve())
        try:
            await play(socket, pictures)
            assert not viewer.done()
        finally:
            viewer.cancel()

    asyncio.run(served())


def test_what_still_comes_of_an_older_request_does_not_take_the_place_of_a_kept_picture():
    async def play(socket: Socket, pictures: Pictures) -> None:
        await socket.ask(2)
        await pictures.show(0, FINAL)  # from here on it is kept
        await socket.say(ack=1)
        await socket.ask(1)
        await pictures.show(1, PREVIEW)
        await pictures.show(1, REFINING)
        await socket.ask(3, time=2)
        assert pictures.dropped == [pictures.streams[1]]
        await pictures.show(1, BETTER)
        pictures.streams[1].on_end(ServiceError(504, "timeout", "It took too long."))
        assert socket.heard[1:] == [(1, "preview"), (1, "refining")]  # two are on their way
        await socket.say(ack=3)
        assert socket.heard[3:] == [(3, "final")]
        assert socket.said == []

    watched(play)


def test_what_was_superseded_shows_its_one_picture_until_something_newer_has():
    async def play(socket: Socket, pictures: Pictures) -> None:
        for number in (1, 2, 3):
            await socket.ask(number, moving=True)
        await pictures.show(0, PREVIEW)
        await pictures.show(2, PREVIEW)
        await socket.say(ack=2)
        await pictures.show(1, PREVIEW)
        assert socket.heard == [(1, "preview"), (3, "preview")]

    watched(play)


def test_after_a_stop_nothing_is_sent_until_something_is_asked_for():
    async def play(socket: Socket, pictures: Pictures) -> None:
        await socket.ask(1)
        await pictures.show(0, PREVIEW)
        await pictures.show(0, REFINING)
        await pictures.show(0, BETTER)  # which waits for an ack
        await socket.say(stop=True)
        assert pictures.dropped == pictures.streams
        await socket.say(ack=2)
        await pictures.show(0, FINAL)
        assert socket.heard == [(1, "preview"), (1, "refining")]
        await socket.ask(2)
        await pictures.show(1, PREVIEW)
        assert socket.heard[2:] == [(2, "preview")]
        assert socket.said == []

    watched(play)


def test_who_never_reads_is_not_heard_for_ever():
    async def play(socket: Socket, pictures: Pictures) -> None:
        socket.reads.clear()
        for _ in range(10 * MOST_PROBLEMS):
            socket.to_service.put_nowait("no json")
        await settled()
        assert MOST_PROBLEMS <= socket.taken <= MOST_PROBLEMS + 2
        socket.reads.set()
        while len(socket.said) < 10 * MOST_PROBLEMS:
            await asyncio.sleep(0.001)

    watched(play)


def test_of_what_the_lens_did_the_newest_alone_is_told():
    async def play(socket: Socket, pictures: Pictures) -> None:
        socket.reads.clear()
        for number in range(1, 6):
            await socket.ask(number, moving=True)
            pictures.streams[-1].on_item(PREVIEW)
            pictures.streams[-1].on_item(READOUT)
            await settled()
        socket.reads.set()
        await settled()
        assert [told["id"] for told in socket.said] == [1, 5]  # the first was on its way

    watched(play)


@pytest.mark.parametrize("said", ["[" * 500_000, '{"id":' * 500_000, '{"stop": false}', '{"stop": true, "id": 1}'])
def test_what_is_no_message_is_told_and_the_next_one_is_heard(said):
    async def play(socket: Socket, pictures: Pictures) -> None:
        socket.to_service.put_nowait(said)
        await settled()
        assert [told["problem"]["code"] for told in socket.said] == ["invalid_request"]
        await socket.ask(1)
        await pictures.show(0, PREVIEW)
        assert socket.heard == [(1, "preview")]

    watched(play)
