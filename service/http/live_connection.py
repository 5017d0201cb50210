"""One client of live pictures on a WebSocket: the newest request wins, and at most two pictures are unacknowledged."""

from __future__ import annotations

import asyncio
import struct
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Any, NamedTuple, TypeVar

from fastapi import WebSocket, WebSocketDisconnect
from starlette.concurrency import run_in_threadpool

from service.http.clients import present_client
from service.http.errors import ServiceError, answer_to
from service.http.frame_requests import focus_tag, frame_request, tag_of_frame
from service.http.json_bodies import read_json
from service.http.service import Service
from service.http.viewers import Place
from service.models.base import Model, Problem
from service.models.frames import FrameQuery, PictureQuery
from service.models.live import (
    LiveAck,
    LiveHere,
    LivePictureHead,
    LiveProblem,
    LiveReadout,
    LiveRequest,
    LiveStop,
    LiveTiming,
)
from service.picture.calls import live, state
from service.picture.requests import LiveNumbers, LivePicture
from service.storage.store import ShotRecord
from service.workers.calls import stream_call
from service.workers.errors import SupersededError
from service.workers.jobs import Job
from service.workers.streaming import CROWD

RESTARTS_CODE = 1012
"""Code of a WebSocket that is closed because the service stops; the client may connect again."""
MAX_UNACKNOWLEDGED = 2
"""Pictures that may be sent before the client acknowledges one."""
CROWDED_S = 0.01
"""Least time between two requests of a client that reach a crowded lane, for each job that waits there, s.

Its turn comes once those that wait have had theirs, and only the newest request counts then.
"""
MAX_CROWDED_S = 1.0
FREE_S = 0.005
"""Processor time of one message that costs no pause, s: many times what a pointer's move needs."""
PAUSE_RATIO = 4
"""Pause after a message that took longer, relative to the time that it took: one client has a fifth of the loop at most."""
MAX_PROBLEMS = 32
"""Problems that may wait to be sent; a client that does not read them is not received from any more."""
_NO_REQUEST = '"ack"', '"stop"', '"here"', "\\"
"""Texts that a message has where it may be no request: the keys of the others, or an escape, which may hide one of them."""

Value = TypeVar("Value")


class LiveConnection:
    """Serves one connection. Runs in the event loop; the lane's callbacks come from threads of its own.

    Requests are numbered in order of arrival, since their ids are chosen by the client.

    Args:
        service: the running service.
        socket: an accepted WebSocket.
        shot_id: the shot to show.
    """

    def __init__(self, service: Service, socket: WebSocket, shot_id: str) -> None:
        self._service = service
        self._socket = socket
        self._shot_id = shot_id
        self._loop = asyncio.get_running_loop()
        self._job: Job[state.PictureWorkerState] | None = None
        self._client = replace(present_client(), viewer=self)
        self._problems: deque[str] = deque()
        self.on_look: Callable[[Place], None] = _do_nothing
        """Called with each place that the client looks at."""
        self._unsent_readout: str | None = None
        self._unsent_viewers: str | None = None
        self._unsent_picture: tuple[_Request, LivePicture] | None = None
        self._sent_count = self._acknowledged_count = 0
        self._request_count = 0
        self._unstarted: _Request | _Unread | None = None
        self._to_start = asyncio.Event()
        self._oldest_valid = (
            0  # number of the oldest request that may still send: earlier ones were overtaken or stopped
        )
        self._to_send = asyncio.Event()
        self._can_receive = asyncio.Event()
        self._can_receive.set()

    async def serve(self) -> None:
        """Receive requests and send pictures until the client disconnects."""
        works = self._send_all(), self._start_all(), self._receive_all(), self._service.stopping.wait()
        tasks = [asyncio.create_task(work) for work in works]
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            for task in done:
                with suppress(WebSocketDisconnect):
                    task.result()
        finally:
            for task in tasks:
                task.cancel()
            self._cancel_stream()
        if self._service.stopping.is_begun:
            with suppress(RuntimeError):  # the client has closed it already
                await self._socket.close(RESTARTS_CODE)

    async def _receive_all(self) -> None:
        while True:
            await self._can_receive.wait()
            message = await self._socket.receive()
            if message["type"] == "websocket.disconnect":
                return
            begun_s = time.thread_time()
            self._take(message.get("text"), time.perf_counter())
            took_s = time.thread_time() - begun_s
            if took_s > FREE_S:
                await asyncio.sleep(PAUSE_RATIO * took_s)

    def _take(self, text: object, received_s: float) -> None:
        """Handle a message, or keep it unread where the lane is crowded."""
        fields: dict[str, Any] = {}
        try:
            if self._crowd and isinstance(text, str) and not any(key in text for key in _NO_REQUEST):
                self._put(_Unread(text, self._next_number(), received_s))
            else:
                fields = _json_of(text)
                self._handle(fields, received_s)
        except Exception as error:
            self._report_problem(fields.get("id"), error)

    def _handle(self, fields: dict[str, Any], received_s: float) -> None:
        if "ack" in fields:
            ack = min(LiveAck.model_validate(fields).ack, self._sent_count)
            self._acknowledged_count = max(self._acknowledged_count, ack)
            self._to_send.set()
        elif "stop" in fields:
            LiveStop.model_validate(fields)
            self._stop()
        elif "here" in fields:
            here = LiveHere.model_validate(fields).here
            self.on_look(Place(here.camera, here.time))
        else:
            request = LiveRequest.model_validate(fields)
            self._put(_Request(request, self._next_number(), received_s))

    def _next_number(self) -> int:
        self._request_count += 1
        return self._request_count

    def _put(self, newest: _Request | _Unread) -> None:
        """Put a request in place of one that has not been started."""
        self._unstarted = newest
        self._to_start.set()

    async def _start_all(self) -> None:
        """Start the newest request, again and again. Those that it overtakes in a crowded lane are not even parsed."""
        while True:
            await self._to_start.wait()
            self._to_start.clear()
            newest, self._unstarted = self._unstarted, None
            if newest is None:  # stopped
                continue
            request = self._read(newest) if isinstance(newest, _Unread) else newest
            if request is not None:
                self.on_look(Place(request.request.camera, request.request.time))
                try:
                    await self._start(request)
                except Exception as error:
                    self._report_problem(request.request.id, error)
            await asyncio.sleep(min(CROWDED_S * self._crowd, MAX_CROWDED_S))

    def _read(self, unread: _Unread) -> _Request | None:
        """Read a message; None where it is no valid request, which is reported."""
        fields: dict[str, Any] = {}
        try:
            fields = _json_of(unread.text)
            return _Request(LiveRequest.model_validate(fields), unread.number, unread.received_s)
        except Exception as error:
            self._report_problem(fields.get("id"), error)
            return None

    @property
    def _crowd(self) -> int:
        """Jobs that wait in the lane, where they are a crowd; 0 where they are none."""
        waiting = self._service.lanes.live.waiting
        return waiting if waiting > CROWD else 0

    async def _start(self, pending: _Request) -> None:
        """Start a stream of pictures, in place of the one before, or send the final picture from the cache."""
        request = pending.request
        record = self._service.store.get(self._shot_id)
        edits = await run_in_threadpool(record.edit_text)
        if pending.number < self._oldest_valid:  # stopped meanwhile
            return
        if not request.moving and not request.changes:
            pending.tag = self._tag(record, edits, request)
            cache = self._service.frame_cache
            cached = cache.get(pending.tag)
            pending.focus_tag = focus_tag(self._service, record, edits, request)
            if cached is not None:
                self._cancel_stream()
                self._service.metrics.frames.labels("cache").inc()
                focus = cache.get(pending.focus_tag) if request.focus_maps else None
                self._queue_item(pending, replace(_cached_picture(cached, request.rays), focus=focus or b""))
                return
        if request.moving:  # one preview is drawn, in the time that is asked for
            limits = self._service.admission.check_preview(request)
        else:
            limits = self._service.admission.check(record.id, request).limits
        frame = frame_request(record, edits, request, limits)
        self._job = self._service.lanes.live.submit_stream(
            stream_call(
                live.stream_pictures, frame, request.changes, request.budget_ms, request.moving, request.focus_maps
            ),
            self._service.place_of(record),
            self._client,
            on_item=self._from_thread(lambda item: self._queue_item(pending, item)),
            on_end=self._from_thread(lambda error: self._end(pending, error)),
            group=self,
            view=(request.camera, request.time),
            is_first=not self._sent_count,
        )

    def _stop(self) -> None:
        """Discard all requests: nothing of them is sent any more."""
        self._cancel_stream()
        self._oldest_valid = self._request_count + 1
        self._unsent_picture = self._unsent_readout = self._unstarted = None

    def _tag(self, record: ShotRecord, edits: str, request: LiveRequest) -> str:
        """Return the tag of the final picture in the cache of frames, which is that of the same frame over HTTP."""
        same = {name: getattr(request, name) for name in PictureQuery.model_fields}
        return tag_of_frame(self._service, record, edits, FrameQuery(**same))

    def _from_thread(self, callback: Callable[[Value], None]) -> Callable[[Value], None]:
        """Wrap a callback so that another thread may call it."""

        def schedule(value: Value) -> None:
            with suppress(RuntimeError):  # the event loop is closed, because the service stops
                self._loop.call_soon_threadsafe(callback, value)

        return schedule

    def _queue_item(self, pending: _Request, item: LivePicture | LiveNumbers) -> None:
        """Queue a picture or readout for sending, in place of an older one that was not sent yet.

        A superseded request still shows one picture, because a moving pointer would never see one otherwise. That picture is
        dropped where it comes after one of a newer request.
        """
        if pending.number < self._oldest_valid:
            return
        if isinstance(item, LiveNumbers):
            self._unsent_readout = _to_json(LiveReadout(id=pending.request.id, **vars(item)))
            self._to_send.set()
            return
        if not pending.is_improved_by(item):  # a stream that was interrupted begins again
            return
        metrics = self._service.metrics
        metrics.live_pictures.labels(item.stage).inc()
        if pending.best is None:
            metrics.live_first.observe(pending.age_ms() / 1e3)
        pending.best, pending.answered_ms = item, pending.age_ms()
        if item.is_final and pending.tag is not None:
            self._service.frame_cache.put(pending.tag, item.data)
            if item.focus and pending.focus_tag is not None:
                self._service.frame_cache.put(pending.focus_tag, item.focus)
        self._oldest_valid = pending.number
        if self._unsent_picture is not None and self._unsent_picture[0] is pending and not item.focus:
            item = replace(item, focus=self._unsent_picture[1].focus)
        self._unsent_picture = pending, item
        self._to_send.set()

    def _end(self, pending: _Request, error: Exception | None) -> None:
        is_overtaken = pending.number < self._oldest_valid
        if error is not None and not is_overtaken and not isinstance(error, SupersededError):
            self._report_problem(pending.request.id, error)

    def _report_problem(self, request_id: Any, error: Exception) -> None:
        """Queue the description of an error for sending. An error that is a bug is raised again."""
        answer = answer_to(error)
        problem = Problem.model_validate_json(bytes(answer.body))
        valid_id = request_id if isinstance(request_id, int) else None
        self._problems.append(_to_json(LiveProblem(id=valid_id, status=answer.status_code, problem=problem)))
        if len(self._problems) >= MAX_PROBLEMS:
            self._can_receive.clear()
        self._to_send.set()

    async def _send_all(self) -> None:
        while True:
            await self._to_send.wait()
            self._to_send.clear()
            while self._problems:
                await self._socket.send_text(self._problems.popleft())
            self._can_receive.set()
            unacknowledged_count = self._sent_count - self._acknowledged_count
            if self._unsent_picture is not None and unacknowledged_count < MAX_UNACKNOWLEDGED:
                (pending, picture), self._unsent_picture = self._unsent_picture, None
                self._sent_count += 1
                await self._socket.send_bytes(_to_bytes(pending, picture, self._sent_count))
                self._to_send.set()
            if self._unsent_readout is not None:
                readout, self._unsent_readout = self._unsent_readout, None
                await self._socket.send_text(readout)
            if self._unsent_viewers is not None:
                viewers, self._unsent_viewers = self._unsent_viewers, None
                await self._socket.send_text(viewers)

    def tell_viewers(self, told: str) -> None:
        """Queue who looks at the shot for sending, in place of what was not sent yet."""
        self._unsent_viewers = told
        self._to_send.set()

    def _cancel_stream(self) -> None:
        if self._job is not None:
            self._service.lanes.live.cancel(self._job)
        self._job = None


class _Unread(NamedTuple):
    """A message of a crowded lane that may only be a request.

    Attributes:
        text: the message.
        number: counts the requests of the connection.
        received_s: time of its arrival, by `time.perf_counter`.
    """

    text: str
    number: int
    received_s: float


class _Request:
    """A request and the best picture of it so far.

    Args:
        request: what is asked for.
        number: counts the requests of the connection.
        received_s: time of its arrival, by `time.perf_counter`.
    """

    def __init__(self, request: LiveRequest, number: int, received_s: float) -> None:
        self.request = request
        self.number = number
        self.tag: str | None = None
        self.focus_tag: str | None = None
        self.best: LivePicture | None = None
        self.answered_ms = 0.0
        self._received_s = received_s

    def age_ms(self) -> float:
        """Return the time since the request was received."""
        return 1e3 * (time.perf_counter() - self._received_s)

    def is_improved_by(self, picture: LivePicture) -> bool:
        """Return whether a picture is better than those before."""
        return self.best is None or _rank(picture) > _rank(self.best)


def _do_nothing(place: Place) -> None:
    """Note no place."""


def _rank(picture: LivePicture) -> tuple[bool, bool, float]:
    return picture.is_final, picture.stage != "preview", picture.share


def _to_json(model: Model) -> str:
    return model.model_dump_json(by_alias=True)


def _json_of(text: object) -> dict[str, Any]:
    """Parse a message. Raises `ServiceError` 422 where it is no JSON object."""
    with suppress(ValueError):
        fields = read_json(text.encode()) if isinstance(text, str) else None  # a binary message has no text
        if isinstance(fields, dict):
            return fields
    raise ServiceError(422, "invalid_request", "A message to the service is a JSON object, sent as text.")


def _to_bytes(pending: _Request, picture: LivePicture, number: int) -> bytes:
    """Return a picture as it is sent: the length of its head as 4 bytes, big-endian; the head, as JSON; the picture;
    its focus map, if any."""
    head = LivePictureHead(
        id=pending.request.id,
        picture=number,
        stage=picture.stage,
        final=picture.is_final,
        format=picture.format,
        width=picture.width,
        height=picture.height,
        focus_map_bytes=len(picture.focus),
        timing=LiveTiming(
            **picture.took_ms,
            answered_ms=pending.answered_ms,
            rays=picture.rays,
            scale=picture.scale,
            share=picture.share,
        ),
    )
    encoded = _to_json(head).encode()
    return struct.pack(">I", len(encoded)) + encoded + picture.data + picture.focus


def _cached_picture(png: bytes, rays: int) -> LivePicture:
    """Return a final picture from the cache."""
    width, height = struct.unpack_from(">II", png, 16)  # of the header chunk, which is the first (PNG, 11.2.1)
    took_ms = dict.fromkeys(("read_ms", "peel_ms", "blur_ms", "finish_ms", "total_ms", "encode_ms"), 0.0)
    return LivePicture("final", "png", width, height, took_ms, rays, 1.0, 1.0, png)
