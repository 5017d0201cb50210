"""A service in memory for the clients: it answers by a function, and keeps what it was sent."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import httpx

from service.client import Client, Retries

QUICK = Retries(tries=3, first_s=0.0)
"""Retries without pauses."""
RENDER: dict[str, Any] = {
    "id": "r-1",
    "name": "night",
    "shot": "demo",
    "revision": "5a",
    "project": "default",
    "owner": "Mara",
    "state": "done",
    "priority": 50,
    "frames": "1-2",
    "count": 2,
    "ready": 0,
    "running": 0,
    "done": 2,
    "failed": 0,
    "width": 480,
    "rays": 16,
    "formats": ["exr"],
    "aovs": [],
    "canceled": 0,
    "accepted": False,
    "waitsFor": [],
    "createdAt": "2026-11-27T08:00:00Z",
    "startedAt": None,
    "finishedAt": None,
    "secondsLeft": None,
}
PICTURES = {1: b"the first picture", 2: b"the second picture"}

Reply = Callable[[httpx.Request], httpx.Response]


@dataclass
class Fake:
    """Answers and requests.

    Attributes:
        reply: called for each request.
        requests: that were sent.
    """

    reply: Reply
    requests: list[httpx.Request] = field(default_factory=list)

    def __call__(self, request: httpx.Request) -> httpx.Response:
        request.read()
        self.requests.append(request)
        reply = self.reply(request)
        if reply.is_stream_consumed:  # it has its content, of which the network would have sent the bytes
            return httpx.Response(reply.status_code, headers=reply.headers, stream=httpx.ByteStream(reply.content))
        return reply

    def client(self, url: str = "http://service", key: str | None = None) -> Client:
        """A client of it that does not pause."""
        return Client(url, key, retries=QUICK, transport=httpx.MockTransport(self))

    @property
    def sent(self) -> list[str]:
        """Methods and paths of the requests."""
        return [f"{request.method} {request.url.path}" for request in self.requests]


def in_turn(*replies: httpx.Response | Exception) -> Fake:
    """Make a service that answers with each of some in turn."""
    waiting: Iterator[httpx.Response | Exception] = iter(replies)

    def reply(_: httpx.Request) -> httpx.Response:
        one = next(waiting)
        if isinstance(one, Exception):
            raise one
        return one

    return Fake(reply)


def task(frame: int, content: bytes, *, file: dict[str, Any] | None = None, **changes: Any) -> dict[str, Any]:
    """A frame that is stored as an EXR; `file` changes what is told of its file."""
    digest = hashlib.sha256(content).hexdigest()
    stored = {"format": "exr", "sizeBytes": len(content), "sha256": digest} | (file or {})
    return {"frame": frame, "state": "done", "attempts": [], "files": [stored]} | changes


def render_service(**frames: Any) -> Fake:
    """Make a service with one render that is done.

    Args:
        **frames: `render`, `tasks`, `pictures` and `type` in place of the usual ones.
    """
    render = RENDER | frames.get("render", {})
    pictures = frames.get("pictures", PICTURES)
    tasks = frames.get("tasks", [task(frame, content) for frame, content in PICTURES.items()])

    def reply(request: httpx.Request) -> httpx.Response:
        path = request.url.path
        if path.endswith("/tasks"):
            return httpx.Response(200, json={"tasks": tasks})
        if "/frames/" in path:
            content = pictures[int(path.rpartition("/")[2])]
            return httpx.Response(200, content=content, headers={"Content-Type": frames.get("type", "image/x-exr")})
        return httpx.Response(200, json=render)

    return Fake(reply)
