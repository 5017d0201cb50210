"""Delivery of events to webhooks: in order, at least once, each webhook by a task of its own."""

from __future__ import annotations

import asyncio
import logging
import secrets
from collections.abc import Awaitable, Callable, Sequence
from contextlib import aclosing, suppress
from datetime import UTC, datetime
from typing import Any, TypeVar

from starlette.concurrency import run_in_threadpool

from render.errors import OutputError
from service.http.event_feed import EventFeed, text_of
from service.http.webhook_sending import Answer, Message, Sender
from service.models.events import Event
from service.models.webhooks import WebhookTest
from service.storage.database.tables import WebhookRow
from service.storage.webhooks import Held, Webhooks

log = logging.getLogger("pullfocus.service")

LEASE_S = 60.0
"""Time after which a service is taken for gone, and another one delivers in its place."""
LOOK_PAUSE_S = 1.0
"""Longest time between two looks for webhooks that were made, removed or left by another service."""
IDLE_PAUSE_S = 60.0
"""Longest time without a look for events; new ones are told at once."""

Pause = Callable[[float], Awaitable[None]]
Noted = TypeVar("Noted")


class Deliveries:
    """Deliveries of one service. Used in its event loop.

    Args:
        webhooks: the webhooks.
        feed: tells the events.
        sender: sends them.
        worker: name of the service, which no other one has.
        pause: waits for some time, s.
    """

    def __init__(
        self, webhooks: Webhooks, feed: EventFeed, sender: Sender, worker: str, pause: Pause = asyncio.sleep
    ) -> None:
        self.wake = asyncio.Event()
        """Set when a webhook was made, removed or enabled."""
        self._webhooks = webhooks
        self._feed = feed
        self._sender = sender
        self._worker = worker
        self._pause = pause
        self._tasks: dict[str, asyncio.Task[None]] = {}
        self._reached: dict[str, int] = {}

    async def run(self) -> None:
        """Deliver until this is cancelled; other services may go on then."""
        has_failed = False
        try:
            while True:
                try:
                    await self._look()
                    has_failed = False
                except OutputError as error:
                    if not has_failed:
                        log.error("webhooks cannot be looked for: %s", error)
                    has_failed = True
                with suppress(TimeoutError):
                    async with asyncio.timeout(LOOK_PAUSE_S):  # `wait_for` of Python 3.11 may swallow a cancellation
                        await self.wake.wait()
                self.wake.clear()
        finally:
            for task in self._tasks.values():
                task.cancel()
            await asyncio.gather(*self._tasks.values(), return_exceptions=True)
            with suppress(OutputError):  # the leases run out
                self._webhooks.release(self._worker, self._reached)
            await self._sender.close()

    async def test(self, row: WebhookRow) -> Answer:
        """Send a test to the receiver of a webhook, once, also where it is disabled.

        Args:
            row: the webhook.
        """
        text = text_of(WebhookTest(webhook=row.id, at=datetime.now(UTC)))
        return await self._sender.send(
            row.url, row.secret, Message("test", f"{row.id}-test-{secrets.token_hex(4)}", text)
        )

    async def _look(self) -> None:
        """Begin to deliver to webhooks that are held now, and end with those that are no longer."""
        for name in [name for name, task in self._tasks.items() if task.done()]:
            _log_end(name, self._tasks.pop(name))
            self._reached.pop(name, None)
        held = await run_in_threadpool(self._webhooks.hold, self._worker, LEASE_S, dict(self._reached))
        for name in self._tasks.keys() - {one.id for one in held}:
            self._tasks[name].cancel()
        for one in held:
            if one.id not in self._tasks:
                self._tasks[one.id] = asyncio.create_task(self._deliver_all(one))

    async def _deliver_all(self, held: Held) -> None:
        """Deliver events to a webhook, until it is disabled or no longer held. A database that cannot be read ends it, too."""
        after, has_failed = held.after, held.failures > 0
        await self._pause(held.wait_s)
        while True:
            start, gap = await self._feed.start_of(after)
            if gap is None:
                events, after = await self._next_events(held, start)
                sent = [(Message(one.kind, f"{held.id}-{one.number}", text_of(one)), one.number) for one in events]
            else:
                after, sent = start, [(Message("gap", f"{held.id}-gap-{gap.oldest}", text_of(gap)), start)]
            for message, number in sent:
                if not await self._deliver(held, message, number, has_failed):
                    return
                has_failed = False
            self._reached[held.id] = after

    async def _next_events(self, held: Held, start: int) -> tuple[Sequence[Event], int]:
        """Wait for events that a webhook wants. What is kept is looked at before each page of them."""
        async with aclosing(self._feed.follow(start, held.wanted, IDLE_PAUSE_S)) as pages:
            async for events, number in pages:
                if events:
                    return events, number
                self._reached[held.id] = number
        raise AssertionError("the feed has no end")

    async def _deliver(self, held: Held, message: Message, number: int, has_failed: bool) -> bool:
        """Try a delivery until it succeeds, whereupon events go on after a number. Returns whether they go on."""
        while True:
            answer = await self._sender.send(held.url, held.secret, message)
            if answer.error is None:
                self._reached[held.id] = number
                return await self._noted(self._webhooks.note_delivered, held, number, answer.status)
            if not has_failed:
                log.warning("webhook %s: %s", held.id, answer.error)
            has_failed = True
            ends = answer.outcome == "gone"
            pause_s = await self._noted(self._webhooks.note_failed, held, answer.status, answer.error, ends)
            if pause_s is None:
                log.warning("webhook %s gets no more events from this service", held.id)
                return False
            await self._pause(pause_s)

    async def _noted(self, note: Callable[..., Noted], held: Held, *args: Any) -> Noted:
        """Note what became of a try, however long the database cannot be used: the try is not made again for that."""
        while True:
            try:
                return await run_in_threadpool(note, held.id, self._worker, *args)
            except OutputError:
                await self._pause(LOOK_PAUSE_S)


def _log_end(name: str, task: asyncio.Task[None]) -> None:
    """Log what ended the deliveries to a webhook, which begin again. A database that cannot be used is logged elsewhere."""
    error = None if task.cancelled() else task.exception()
    if error is not None and not isinstance(error, OutputError):
        log.error("deliveries to webhook %s have failed", name, exc_info=error)
