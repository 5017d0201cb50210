"""All that a user asks a service about a shot: its data, edits, pictures over HTTP and live, and a long exposure."""

from __future__ import annotations

import json
import struct
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import httpx
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

PATIENCE_S = 180.0
"""Time for one answer, s: a worker ends earlier."""
SMALL: dict[str, Any] = {"time": 1, "width": 64, "rays": 8, "layers": 2}
LONG: dict[str, Any] = {"time": 1, "width": 112, "noise": 0.0005, "wavelengths": 64, "layers": 2}
"""Expected to take long, and drawn soon: a harmless shot has little noise and no lens with colour errors."""
EXPOSURE: dict[str, Any] = {"first": 1, "last": 2, "width": 64, "rays": 8, "layers": 2}
POINT: dict[str, Any] = {"time": 1, "width": 64, "height": 36, "x": 20, "y": 18}
READS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("", {}),
    ("/inspect", {}),
    ("/cameras", {"time": 1}),
    ("/readout", {"time": 1}),
    ("/readout/exposure", {"time": 1}),
    ("/focus-curve", {}),
    ("/focus-points", {"time": 1}),
    ("/camera", {"time": 1}),
    ("/camera/focus", {"time": 1}),
    ("/camera/grades", {"time": 1}),
    ("/edits/history", {}),
    ("/frame", SMALL),
    ("/frame", SMALL | {"format": "exr"}),
)
PICTURES: tuple[tuple[str, dict[str, Any]], ...] = (("/frame", SMALL | {"engine": "flag"}), ("/frame", LONG))
SIDE_READS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("/camera", {"time": 1}),
    ("/readout", {"time": 1}),
    ("/focus-curve", {}),
    ("/frame", SMALL),
)
"""Questions whose answers a curve or a lens may change."""
STATUS_OF_CLOSE = {1008: 422, 1013: 503}
"""Statuses that mean the same as codes of closed WebSockets; all others are faults of the service."""


@dataclass(frozen=True)
class Answer:
    """One answer.

    Attributes:
        status: of HTTP, or what means the same.
        content: its bytes.
        is_text: whether it is for reading.
    """

    status: int
    content: bytes
    is_text: bool


def answer_of(response: httpx.Response) -> Answer:
    """Convert an answer of HTTP."""
    return Answer(response.status_code, response.content, "json" in response.headers.get("content-type", ""))


def ask_briefly(client: httpx.Client, shot_id: str) -> Iterator[Answer]:
    """Ask for the data and a frame, which takes a stage process and a picture process.

    Args:
        client: of the service.
        shot_id: the shot.
    """
    for path, query in READS:
        yield answer_of(client.get(f"/v1/shots/{shot_id}{path}", params=query, timeout=PATIENCE_S))


def ask_all(client: httpx.Client, shot_id: str) -> Iterator[Answer]:
    """Ask for everything, one after the other, which takes a process of each kind.

    Args:
        client: of the service.
        shot_id: the shot.
    """
    shot = f"/v1/shots/{shot_id}"
    yield from ask_briefly(client, shot_id)
    for path, query in PICTURES:
        yield answer_of(client.get(shot + path, params=query, timeout=PATIENCE_S))
    yield answer_of(client.post(f"{shot}/pick", json=POINT, timeout=PATIENCE_S))
    yield answer_of(client.patch(f"{shot}/camera", json={"fStop": 2.8}, timeout=PATIENCE_S))
    yield from watch_live(client, shot)
    yield from expose_long(client, shot)


def watch_live(client: httpx.Client, shot: str) -> Iterator[Answer]:
    """Watch a picture until it is final, or something is wrong with it."""
    address = f"ws://{client.base_url.host}:{client.base_url.port}{shot}/live"
    try:
        with connect(address, compression=None, max_size=None) as socket:
            socket.send(json.dumps(SMALL | {"id": 1}))
            end_s = time.monotonic() + PATIENCE_S
            while True:
                received = socket.recv(max(0.0, end_s - time.monotonic()))
                if isinstance(received, str):
                    message = json.loads(received)
                    yield Answer(message.get("status", 200), received.encode(), is_text=True)
                    if "status" in message:
                        return
                    continue
                (size,) = struct.unpack_from(">I", received)
                head = json.loads(received[4 : 4 + size])
                yield Answer(200, received[4 + size :], is_text=False)
                if head["final"]:
                    return
                socket.send(json.dumps({"ack": head["picture"]}))
    except InvalidStatus as refused:
        yield Answer(refused.response.status_code, refused.response.body or b"", is_text=True)
    except ConnectionClosed as closed:
        end = closed.rcvd
        code, reason = (end.code, end.reason) if end is not None else (1006, "")
        yield Answer(STATUS_OF_CLOSE.get(code, 500), reason.encode(), is_text=True)


def expose_long(client: httpx.Client, shot: str) -> Iterator[Answer]:
    """Expose a picture over two frames, until the shutter closes."""
    path = f"{shot}/long-exposure"
    state = client.post(path, json=EXPOSURE, timeout=PATIENCE_S)
    yield answer_of(state)
    if state.status_code != 201:
        return
    end_s = time.monotonic() + PATIENCE_S
    while state.json()["shutter"] == "open":
        if time.monotonic() > end_s:
            raise TimeoutError(f"the shutter of {shot} stays open")
        time.sleep(0.02)
        state = client.get(path, timeout=PATIENCE_S)
        if state.status_code != 200:
            break
    yield answer_of(state)
    yield answer_of(client.get(f"{path}/picture", timeout=PATIENCE_S))
    yield answer_of(client.delete(path, timeout=PATIENCE_S))
