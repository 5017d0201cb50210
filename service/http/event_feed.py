"""Feed of events: readers get those that are kept, then new ones as they come."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncGenerator, Sequence
from contextlib import suppress
from datetime import UTC, datetime

from starlette.concurrency import run_in_threadpool

from render.errors import OutputError
from service.models.base import Model
from service.models.events import Event, EventData, EventGap
from service.storage.database.tables import EventRow
from service.storage.events import EventLog, Wanted

log = logging.getLogger("pullfocus.service")

PAGE = 500
"""Events that are read at a time."""
LOOK_PAUSE_S = 1.0
"""Time between two looks for events of other services over the same database."""


class EventFeed:
    """The feed of a service. Used in its event loop.

    Args:
        events: the log that is read.
    """

    def __init__(self, events: EventLog) -> None:
        self._events = events
        self._bell = asyncio.Event()

    async def run(self) -> None:
        """Tell the readers of new events until the service stops."""
        loop = asyncio.get_running_loop()

        def ring() -> None:
            with suppress(RuntimeError):  # the loop is closed, because the service stops
                loop.call_soon_threadsafe(self._ring)

        self._events.on_new = ring
        newest = -1
        while True:
            before, bell = newest, self._bell
            with suppress(OutputError):
                newest = await run_in_threadpool(self._events.newest)
            if newest != before:
                self._ring()
            await _wait(bell, LOOK_PAUSE_S)

    async def start_of(self, after: int | None) -> tuple[int, EventGap | None]:
        """Return the number that a reader goes on after, and what it has missed.

        Args:
            after: number of the last event that it knows; None for one that begins now.

        Raises:
            OutputError: the database cannot be used.
        """
        newest = await run_in_threadpool(self._events.newest)
        if after is None:
            return newest, None
        oldest = await run_in_threadpool(self._events.oldest)
        if after > newest:  # of a database that an older backup has replaced
            return newest, EventGap(after=after, oldest=oldest)
        if after < oldest - 1:
            return oldest - 1, EventGap(after=after, oldest=oldest)
        return after, None

    async def follow(self, after: int, wanted: Wanted, pause_s: float) -> AsyncGenerator[tuple[Sequence[Event], int]]:
        """Yield events as they come, the oldest first, with the number to go on after.

        Args:
            after: number of the last event that the reader knows.
            wanted: which events.
            pause_s: longest time without a word; none of them may have come then.
        """
        while True:
            bell = self._bell
            rows, after = await run_in_threadpool(self._events.after, after, wanted, PAGE)
            yield [shown(row) for row in rows], after
            if len(rows) < PAGE:
                while not await _wait(bell, pause_s):
                    yield [], after

    def _ring(self) -> None:
        bell, self._bell = self._bell, asyncio.Event()
        bell.set()


def shown(row: EventRow) -> Event:
    """Return an event as it is sent."""
    return Event(
        number=row.number,
        at=datetime.fromtimestamp(row.at, UTC),
        topic=row.topic,  # type: ignore[arg-type]  # validated here
        kind=row.kind,  # type: ignore[arg-type]
        project=row.project,
        shot=row.shot,
        render=row.render,
        data=EventData.model_validate(row.data),
    )


def text_of(model: Model) -> str:
    """Return what is told as JSON, without what is not known.

    Args:
        model: an event, or what else a reader is told.
    """
    return model.model_dump_json(by_alias=True, exclude_none=True)


async def _wait(bell: asyncio.Event, most_s: float) -> bool:
    """Wait for a bell. Returns whether it has rung in time."""
    with suppress(TimeoutError):
        async with asyncio.timeout(most_s):  # `wait_for` of Python 3.11 may swallow a cancellation
            await bell.wait()
    return bell.is_set()
