"""Live viewers as a service sees them: connections that send a request with each move of the pointer and acknowledge pictures."""

from __future__ import annotations

import asyncio
import json
import struct
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from time import monotonic, sleep
from typing import Any

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake

from render.errors import PullfocusError
from service.bench.plan import LoadPlan

ASPECT = 9 / 16
FIRST_TIME, LAST_TIME = 1.0, 96.0
NEAR_M, FAR_M = 1.0, 12.0
STEPS = 60
"""Moves of the pointer from one end to the other."""
OPEN_S = 60.0


@dataclass
class Viewer:
    """Pictures and refusals of one viewer.

    Attributes:
        number: counts the viewers from 0.
        refusals: reasons why the connection or a request was refused.
        pictures: number of pictures.
        first_s: time from the first request to the first picture, s; None without one.
        ages_s: time from each picture's request to its arrival, s.
        gaps_s: time between pictures, s; the first is since the first request, the last until the end.
        last_s: time of the latest picture, or of the first request, by the clock of `monotonic`; None before.
    """

    number: int
    refusals: list[str] = field(default_factory=list)
    pictures: int = 0
    first_s: float | None = None
    ages_s: list[float] = field(default_factory=list)
    gaps_s: list[float] = field(default_factory=list)
    last_s: float | None = None

    def gaps_since(self, count: int, began_s: float) -> list[float]:
        """Return the times between pictures of a phase, s. The time since the latest picture counts where it is the longest.

        Args:
            count: number of `gaps_s` when the phase began.
            began_s: time of its begin.
        """
        gaps = self.gaps_s[count:]
        waited_s = monotonic() - max(began_s, self.last_s or 0.0)
        return gaps if gaps and max(gaps) >= waited_s else [*gaps, waited_s]


def address_of(number: int) -> str:
    """Return an address of this machine for a client, so that the service tells clients apart.

    Args:
        number: of the client, less than 60,000.
    """
    return f"127.0.{1 + number // 250}.{1 + number % 250}"


def request_of(plan: LoadPlan, viewer: int, number: int) -> dict[str, Any]:
    """Return a viewer's request as the page sends it while something is dragged to and fro.

    Args:
        plan: what is dragged, and the size of the pictures.
        viewer: number of the viewer, who begins at a place of his own.
        number: of the request.
    """
    step = (number + 7 * viewer) % (2 * STEPS)
    share = min(step, 2 * STEPS - step) / STEPS
    height = 2 * round(ASPECT * plan.width / 2)
    drags_time = plan.drag == "time" or (plan.drag == "mixed" and viewer % 2 == 1)
    time = FIRST_TIME + share * (LAST_TIME - FIRST_TIME) if drags_time else FIRST_TIME + viewer % LAST_TIME
    quality = {"rays": 100, "layers": 4, "supersample": 0, "motion": 1, "motionBy": "velocities"}
    request = {"id": number, "time": time, "width": plan.width, "height": height, "moving": True, **quality}
    if not drags_time:
        distance = {"type": "setCamera", "values": {"focusDistanceM": NEAR_M + share * (FAR_M - NEAR_M)}}
        request["changes"] = [{"type": "setFocus", "values": {"mode": "manual"}}, distance]
    return request


async def drag_together(port: int, shot: str, plan: LoadPlan, viewers: Sequence[Viewer], stop: asyncio.Event) -> None:
    """Let viewers connect, all at once, and drag until they are stopped.

    Args:
        port: of the service.
        shot: its id.
        plan: what they drag, and how fast.
        viewers: filled in.
        stop: ends the drag.
    """
    async with asyncio.TaskGroup() as group:
        for viewer in viewers:
            group.create_task(_drag(port, shot, plan, viewer, stop))


async def drag_for(port: int, shot: str, plan: LoadPlan, count: int) -> list[Viewer]:
    """Let viewers drag for the plan's time; see `drag_together`."""
    viewers = [Viewer(number) for number in range(count)]
    stop = asyncio.Event()
    dragging = asyncio.create_task(drag_together(port, shot, plan, viewers, stop))
    await asyncio.sleep(plan.seconds)
    stop.set()
    await dragging
    return viewers


class ViewersBeside:
    """Viewers who drag in a thread of their own while something else is measured.

    Args:
        port: of the service.
        shot: its id.
        plan: what they drag, and how fast.
        count: of viewers.
    """

    def __init__(self, port: int, shot: str, plan: LoadPlan, count: int) -> None:
        self.viewers = [Viewer(number) for number in range(count)]
        self._stop = asyncio.Event()
        self._loop = asyncio.new_event_loop()
        work = drag_together(port, shot, plan, self.viewers, self._stop)
        self._thread = threading.Thread(target=self._loop.run_until_complete, args=(work,), name="viewers")

    def __enter__(self) -> ViewersBeside:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._loop.call_soon_threadsafe(self._stop.set)
        self._thread.join()
        self._loop.close()

    def wait_for_pictures(self) -> None:
        """Wait until everybody has a picture. Raises `PullfocusError` where somebody gets none."""
        until_s = monotonic() + OPEN_S
        while not all(viewer.pictures for viewer in self.viewers):
            if monotonic() > until_s:
                refusals = "; ".join({refusal for viewer in self.viewers for refusal in viewer.refusals})
                raise PullfocusError(f"a viewer got no picture within {OPEN_S:g} s. {refusals[:500]}".rstrip())
            sleep(0.1)

    def begin_phase(self) -> Callable[[], tuple[list[float], list[str]]]:
        """Begin a phase. Returns the function that ends it: the times between pictures in it, s, and what was refused."""
        began_s = monotonic()
        counts = [(len(viewer.gaps_s), len(viewer.refusals)) for viewer in self.viewers]

        def end_phase() -> tuple[list[float], list[str]]:
            both = list(zip(self.viewers, counts, strict=True))
            gaps = [gap for viewer, (count, _) in both for gap in viewer.gaps_since(count, began_s)]
            return gaps, [refusal for viewer, (_, count) in both for refusal in viewer.refusals[count:]]

        return end_phase


async def _drag(port: int, shot: str, plan: LoadPlan, viewer: Viewer, stop: asyncio.Event) -> None:
    address = f"ws://127.0.0.1:{port}/v1/shots/{shot}/live"
    local = (address_of(viewer.number), 0)
    try:
        async with connect(
            address,
            compression=None,
            max_size=None,
            local_addr=local,
            open_timeout=OPEN_S,
            ping_interval=None,
            proxy=None,
        ) as socket:
            await _drag_on(socket, plan, viewer, stop)
    except (InvalidHandshake, ConnectionClosed, OSError, TimeoutError) as error:
        viewer.refusals.append(f"{type(error).__name__}: {error}")


async def _drag_on(socket: ClientConnection, plan: LoadPlan, viewer: Viewer, stop: asyncio.Event) -> None:
    sent_s: list[float] = []
    receiving = asyncio.create_task(_receive(socket, viewer, sent_s))
    began_s = viewer.last_s = monotonic()
    try:
        while not stop.is_set():
            number = len(sent_s)
            sent_s.append(monotonic())
            await socket.send(json.dumps(request_of(plan, viewer.number, number)))
            if receiving.done():
                break
            with suppress(TimeoutError):
                await asyncio.wait_for(stop.wait(), began_s + len(sent_s) / plan.rate - monotonic())
    finally:
        receiving.cancel()
        viewer.gaps_s.append(monotonic() - viewer.last_s)


async def _receive(socket: ClientConnection, viewer: Viewer, sent_s: Sequence[float]) -> None:
    """Note and acknowledge pictures until this is cancelled or the service closes the connection."""
    try:
        await _receive_open(socket, viewer, sent_s)
        viewer.refusals.append("the service closed the connection")
    except ConnectionClosed as error:
        viewer.refusals.append(f"the service closed the connection: {error}")


async def _receive_open(socket: ClientConnection, viewer: Viewer, sent_s: Sequence[float]) -> None:
    async for message in socket:
        now_s = monotonic()
        if isinstance(message, str):
            said = json.loads(message)
            if "problem" in said:
                viewer.refusals.append(f"{said['status']} {said['problem']['code']}: {said['problem']['detail']}")
            continue
        (length,) = struct.unpack_from(">I", message)
        head = json.loads(message[4 : 4 + length])
        viewer.pictures += 1
        viewer.ages_s.append(now_s - sent_s[head["id"]])
        if viewer.first_s is None:
            viewer.first_s = now_s - sent_s[0]
        viewer.gaps_s.append(now_s - (viewer.last_s or sent_s[0]))
        viewer.last_s = now_s
        await socket.send(json.dumps({"ack": head["picture"]}))
