"""One viewer on a WebSocket: the newest request wins, at most two pictures are on their way, and each says what it took."""

from __future__ import annotations

import asyncio
import json
import struct
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import Annotated, Any, TypeVar

from fastapi import WebSocket, WebSocketDisconnect
from pydantic import Field
from starlette.concurrency import run_in_threadpool

from service.http.errors import ServiceError, answer_to
from service.http.routes.frames import FrameQuery, PictureQuery, frame_request, tag_of_frame
from service.http.service import Service
from service.models.base import Model, Problem
from service.models.cameras import Readout
from service.models.changes import MAX_CHANGES, Change
from service.models.live import LiveAck, LivePictureHead, LiveProblem, LiveReadout, LiveStop, LiveTiming
from service.models.picture_size import check_pixels
from service.picture.calls import live, state
from service.picture.requests import LivePicture
from service.storage.store import ShotRecord
from service.workers.calls import stream_call
from service.workers.errors import SupersededError
from service.workers.worker_queue import QueuedStream

MOST_IN_FLIGHT = 2
"""Pictures that were sent and not acknowledged."""
MOST_PROBLEMS = 32
"""Problems that wait to be sent: a viewer that does not read of them is not heard any further."""

Heard = TypeVar("Heard")


class LiveRequest(PictureQuery):
    """Asks for a picture, in place of what was asked for before."""

    id: int = Field(ge=0, le=2**53 - 1, description="Names the request in what comes of it.", examples=[3])
    moving: bool = Field(
        default=False,
        description="While a hand moves: one picture, as good as comes in time. Else they get better until the final one.",
        examples=[True],
    )
    budget_ms: float = Field(
        default=100, ge=1, le=60_000, description="What the first picture may take.", examples=[100]
    )
    changes: Annotated[tuple[Change, ...], Field(max_length=MAX_CHANGES)] = Field(
        default=(), description="Changes that are tried in these pictures and not kept: those that an edit takes."
    )


class Viewer:
    """Serves one connection. Lives in the event loop; the lane calls back from a thread of its own.

    Args:
        service: of the service.
        socket: accepted.
        shot: id of the shot that is looked at.
    """

    def __init__(self, service: Service, socket: WebSocket, shot: str) -> None:
        self._service = service
        self._socket = socket
        self._shot = shot
        self._loop = asyncio.get_running_loop()
        self._stream: QueuedStream[state.PictureWorkerState] | None = None
        self._problems: deque[str] = deque()
        self._readout: str | None = None  # the newest that was not sent
        self._picture: tuple[_Asked, LivePicture] | None = None  # likewise
        self._sent = self._arrived = 0
        self._asked = 0  # requests so far
        self._since = (
            0  # number of the oldest of them that is still good: those before it have a newer picture, or were stopped
        )
        self._something = asyncio.Event()
        self._has_room = asyncio.Event()
        self._has_room.set()

    async def serve(self) -> None:
        """Hear what the viewer asks for, and answer, until it goes away."""
        tasks = [asyncio.create_task(self._send()), asyncio.create_task(self._hear())]
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            for task in done:
                with suppress(WebSocketDisconnect):
                    task.result()
        finally:
            for task in tasks:
                task.cancel()
            self._drop()

    async def _hear(self) -> None:
        while True:
            await self._has_room.wait()
            message = await self._socket.receive()
            if message["type"] == "websocket.disconnect":
                return
            said: Any = None
            try:
                said = _json_of(message.get("text"))
                if "ack" in said:
                    self._arrived = max(self._arrived, min(LiveAck.model_validate(said).ack, self._sent))
                    self._something.set()
                elif "stop" in said:
                    LiveStop.model_validate(said)
                    self._stop()
                else:
                    self._asked += 1
                    await self._begin(_Asked(LiveRequest.model_validate(said), self._asked))
            except Exception as error:
                self._complain(said.get("id") if isinstance(said, dict) else None, error)

    async def _begin(self, asked: _Asked) -> None:
        """Have pictures made, in place of those that were asked for before."""
        request = asked.request
        check_pixels(request.width, request.height, self._service.settings.max_picture_px)
        record = self._service.store.get(self._shot)
        edits = await run_in_threadpool(record.edit_text)
        if not request.moving and not request.changes:
            asked.tag = self._tag(record, edits, request)
            kept = self._service.frame_cache.get(asked.tag)
            if kept is not None:
                self._drop()
                self._service.metrics.frames.labels("cache").inc()
                self._take(asked, _as_kept(kept, request.rays))
                return
        frame = frame_request(self._service, record, edits, request)
        self._stream = self._service.picture_queue.submit_stream(
            stream_call(live.stream_pictures, frame, request.changes, request.budget_ms, request.moving),
            on_item=self._from_thread(lambda item: self._take(asked, item)),
            on_end=self._from_thread(lambda error: self._end(asked, error)),
            group=self,
        )

    def _stop(self) -> None:
        """Let go of all that was asked for: none of it is sent any more."""
        self._drop()
        self._since = self._asked + 1
        self._picture = self._readout = None

    def _tag(self, record: ShotRecord, edits: str, request: LiveRequest) -> str:
        """By which the final picture lies in the cache of frames, with those that were asked for over HTTP."""
        same = {name: getattr(request, name) for name in PictureQuery.model_fields}
        return tag_of_frame(self._service, record, edits, FrameQuery(**same))

    def _from_thread(self, hear: Callable[[Heard], None]) -> Callable[[Heard], None]:
        def call(heard: Heard) -> None:
            with suppress(RuntimeError):  # the event loop is closed, since the service ends
                self._loop.call_soon_threadsafe(hear, heard)

        return call

    def _take(self, asked: _Asked, item: LivePicture | Readout) -> None:
        """Have something sent, as soon as there is room. What was not sent is not worth sending when there is a newer one.

        What was superseded shows one picture nevertheless (else a hand that moves would never see anything), and may do so
        after something newer did: that comes too late.
        """
        if asked.number < self._since:
            return
        if isinstance(item, Readout):
            self._readout = _text_of(LiveReadout(id=asked.request.id, readout=item))
            self._something.set()
            return
        if not asked.is_better(item):  # made again, since the work was put off
            return
        metrics = self._service.metrics
        metrics.live_pictures.labels(item.stage).inc()
        if asked.best is None:
            metrics.live_first.observe(asked.age_ms() / 1e3)
        asked.best, asked.answered_ms = item, asked.age_ms()
        if item.is_final and asked.tag is not None:
            self._service.frame_cache.put(asked.tag, item.data)
        self._since = asked.number
        self._picture = asked, item
        self._something.set()

    def _end(self, asked: _Asked, error: Exception | None) -> None:
        is_late = asked.number < self._since
        if error is not None and not is_late and not isinstance(error, SupersededError):
            self._complain(asked.request.id, error)

    def _complain(self, request_id: Any, error: Exception) -> None:
        """Say what is wrong. Raises what is a fault of the program."""
        answer = answer_to(error)
        told = Problem.model_validate_json(bytes(answer.body))
        named = request_id if isinstance(request_id, int) else None
        self._problems.append(_text_of(LiveProblem(id=named, status=answer.status_code, problem=told)))
        if len(self._problems) >= MOST_PROBLEMS:
            self._has_room.clear()
        self._something.set()

    async def _send(self) -> None:
        while True:
            await self._something.wait()
            self._something.clear()
            while self._problems:
                await self._socket.send_text(self._problems.popleft())
            self._has_room.set()
            if self._readout is not None:
                readout, self._readout = self._readout, None
                await self._socket.send_text(readout)
            if self._picture is not None and self._sent - self._arrived < MOST_IN_FLIGHT:
                (asked, shown), self._picture = self._picture, None
                self._sent += 1
                await self._socket.send_bytes(_framed(asked, shown, self._sent))
                self._something.set()

    def _drop(self) -> None:
        if self._stream is not None:
            self._service.picture_queue.cancel_stream(self._stream)
        self._stream = None


class _Asked:
    """A request, and what came of it so far. Requests of a connection are numbered: their ids are for the viewer alone."""

    def __init__(self, request: LiveRequest, number: int) -> None:
        self.request = request
        self.number = number
        self.tag: str | None = None
        self.best: LivePicture | None = None
        self.answered_ms = 0.0
        self._began_s = time.perf_counter()

    def age_ms(self) -> float:
        """Since it was heard."""
        return 1e3 * (time.perf_counter() - self._began_s)

    def is_better(self, shown: LivePicture) -> bool:
        """Whether a picture is better than those before."""
        return self.best is None or _rank(shown) > _rank(self.best)


def _rank(shown: LivePicture) -> tuple[bool, bool, float]:
    return shown.is_final, shown.stage != "preview", shown.share


def _text_of(words: Model) -> str:
    return words.model_dump_json(by_alias=True)


def _json_of(text: object) -> dict[str, Any]:
    """A message as what it says. Raises `ServiceError` 422 where it says nothing."""
    with suppress(ValueError, TypeError, RecursionError):  # the last for brackets in brackets, thousands deep
        said = json.loads(text)  # type: ignore[arg-type]  # binary messages have no text
        if isinstance(said, dict):
            return said
    raise ServiceError(422, "invalid_request", "A message to the service is a JSON object, sent as text.")


def _framed(asked: _Asked, shown: LivePicture, number: int) -> bytes:
    """A picture as it travels: the length of its head as 4 bytes, big end first; the head, as JSON; the picture."""
    head = LivePictureHead(
        id=asked.request.id,
        picture=number,
        stage=shown.stage,
        final=shown.is_final,
        format=shown.format,
        width=shown.width,
        height=shown.height,
        timing=LiveTiming(
            **shown.took_ms, answered_ms=asked.answered_ms, rays=shown.rays, scale=shown.scale, share=shown.share
        ),
    )
    said = head.model_dump_json(by_alias=True).encode()
    return struct.pack(">I", len(said)) + said + shown.data


def _as_kept(png: bytes, rays: int) -> LivePicture:
    """A final picture that was made before."""
    width, height = struct.unpack_from(">II", png, 16)  # of the header chunk, which is the first (PNG, 11.2.1)
    spent = dict.fromkeys(("read_ms", "peel_ms", "blur_ms", "finish_ms", "total_ms", "encode_ms"), 0.0)
    return LivePicture("final", "png", width, height, spent, rays, 1.0, 1.0, png)
