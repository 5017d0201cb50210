"""Delivery to webhooks: order, tries, restarts, gaps and leases, with receivers on this machine and a clock that pauses move."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Sequence

import pytest

from service.http.event_feed import EventFeed
from service.http.webhook_delivery import Deliveries
from service.http.webhook_sending import MAX_ANSWER, Answer, Message, Sender
from service.storage.database.connection import open_database
from service.storage.events import EventLog, NewEvent, Wanted
from service.storage.webhooks import MOST_WEBHOOKS, Webhooks
from tests.service.kits.queues import Clock
from tests.service.kits.receivers import Receiver, certified, receiving

SECRET = "whsec_of-the-tests"
NAME = "hooks.studio.example"


class Bench:
    """Events, webhooks and a service's deliveries, over one database."""

    def __init__(self, engine) -> None:
        self.clock = Clock()
        self.events = EventLog(engine, self.clock)
        self.webhooks = Webhooks(engine, self.clock)
        self.pauses: list[float] = []
        self.outcomes: list[str] = []

    def note(self, count: int = 1, **fields) -> None:
        for _ in range(count):
            self.events.note(NewEvent(**{"topic": "shots", "kind": "shot-added", "project": "default"} | fields))

    def add(self, receiver: Receiver, **wanted) -> str:
        return self.webhooks.add(receiver.url, SECRET, Wanted(**wanted)).id

    def row(self, webhook: str):
        return self.webhooks.get(webhook, None)

    def sender(self, *, allows_private: bool = True) -> Sender:
        return Sender(allows_private, self.outcomes.append, clock=lambda: self.clock.now)

    async def pause(self, pause_s: float) -> None:
        """Move the clock on."""
        if pause_s:
            self.pauses.append(pause_s)
            self.clock.now += pause_s
        await asyncio.sleep(0)

    def deliver(self, until: Callable[[], bool], worker: str = "one", **sender) -> None:
        """Deliver until something is true, then stop in order."""
        asyncio.run(self._deliver(until, worker, self.sender(**sender)))

    async def _deliver(self, until: Callable[[], bool], worker: str, sender: Sender) -> None:
        feed = EventFeed(self.events)
        deliveries = Deliveries(self.webhooks, feed, sender, worker, self.pause)
        await ended_once(until, feed.run(), deliveries.run())


async def ended_once(true: Callable[[], bool], *works: Awaitable[None]) -> None:
    """Cancel works once something is true."""
    tasks = [asyncio.ensure_future(work) for work in works]
    while not true():
        assert not any(task.done() for task in tasks)
        await asyncio.sleep(0.005)
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


@pytest.fixture
def bench(tmp_path, database):
    engine = open_database(tmp_path, database)
    yield Bench(engine)
    engine.dispose()


@pytest.fixture
def receiver():
    with receiving() as receiver:
        yield receiver


def test_events_are_delivered_in_order_and_signed(bench, receiver):
    bench.note()
    webhook = bench.add(receiver)  # gets what comes after it was made
    bench.note(3, shot="demo", data={"name": "Tram"})
    bench.deliver(lambda: bench.row(webhook).after == 4)
    assert receiver.names == [f"{webhook}-{number}" for number in (2, 3, 4)]
    first = receiver.deliveries[0]
    assert (first.kind, first.headers["Content-Type"]) == ("shot-added", "application/json")
    assert first.json["data"] == {"name": "Tram"}
    assert (first.json["number"], first.json["shot"], "render" in first.json) == (2, "demo", False)
    assert all(one.is_signed(SECRET) and not one.is_signed("another") for one in receiver.deliveries)
    assert first.headers["Pullfocus-Signature"].startswith(f"t={int(bench.clock.now)},v1=")
    assert bench.outcomes == ["delivered"] * 3


def test_a_receiver_gets_what_it_wants(bench, receiver):
    webhook = bench.add(receiver, project="tram", topics=["renders"])
    bench.note(topic="renders", kind="render-sent", project="other")
    bench.note(project="tram")
    bench.note(topic="renders", kind="render-sent", project="tram")
    bench.deliver(lambda: bench.row(webhook).after == 3)
    assert receiver.names == [f"{webhook}-3"]


def test_a_failure_is_tried_again_later_and_later(bench, receiver, caplog):
    receiver.statuses = [500, 302, 404, 200]
    receiver.headers = {"Location": receiver.url}
    webhook = bench.add(receiver)
    bench.note(2)
    bench.deliver(lambda: bench.row(webhook).after == 2)
    assert receiver.names == [f"{webhook}-1"] * 4 + [f"{webhook}-2"]
    assert bench.pauses == [2, 4, 8]
    row = bench.row(webhook)
    assert (row.failures, row.last_status, row.last_error, row.next_try_at) == (0, 200, None, None)
    assert bench.outcomes == ["failed"] * 3 + ["delivered"] * 2
    assert caplog.text.count(webhook) == 1  # once for a streak
    assert SECRET not in caplog.text


def test_pauses_end_at_ten_minutes_and_tries_after_a_day(bench, receiver):
    receiver.statuses = [503]
    webhook = bench.add(receiver)
    bench.note()
    begun = bench.clock.now
    bench.deliver(lambda: bench.row(webhook).disabled is not None)
    assert bench.pauses[:10] == [2, 4, 8, 16, 32, 64, 128, 256, 512, 600]
    assert max(bench.pauses) == 600
    assert 86_400 <= bench.clock.now - begun < 86_400 + 600
    row = bench.row(webhook)
    assert row.disabled == "no success for 24 hours; the receiver answered with status 503"
    assert (row.after, row.last_status, row.next_try_at, row.worker) == (0, 503, None, None)
    receiver.statuses = [200]
    receiver.deliveries.clear()
    assert bench.webhooks.enable(webhook, None).disabled is None
    bench.deliver(lambda: bench.row(webhook).after == 1)
    assert receiver.names == [f"{webhook}-1"]


def test_a_receiver_that_is_gone_gets_nothing_more(bench, receiver):
    receiver.statuses = [410]
    webhook = bench.add(receiver)
    bench.note(2)
    bench.deliver(lambda: bench.row(webhook).disabled is not None)
    assert receiver.names == [f"{webhook}-1"]
    assert (bench.row(webhook).disabled, bench.pauses) == ("the receiver answered with status 410", [])
    assert bench.outcomes == ["gone"]


def test_a_restart_goes_on_where_it_was(bench, receiver):
    webhook = bench.add(receiver)
    bench.note(2)
    bench.deliver(lambda: bench.row(webhook).after == 2)
    bench.note(2)
    bench.deliver(lambda: bench.row(webhook).after == 4, worker="two")
    assert receiver.names == [f"{webhook}-{number}" for number in (1, 2, 3, 4)]


def test_a_restart_waits_for_the_next_try(bench, receiver):
    webhook = bench.add(receiver)
    bench.note()
    bench.webhooks.hold("one", 60, {})
    assert bench.webhooks.note_failed(webhook, "one", None, "it is away", False) == 2
    bench.clock.now += 0.5
    bench.webhooks.release("one", {})
    bench.deliver(lambda: bench.row(webhook).after == 1, worker="two")
    assert bench.pauses == [1.5]


def test_a_gap_is_told_first(bench, receiver):
    webhook = bench.add(receiver)
    bench.note(4)
    bench.events.prune(-1.0)
    bench.deliver(lambda: bench.row(webhook).after == 4)
    assert receiver.kinds == ["gap", "shot-added"]
    assert receiver.names == [f"{webhook}-gap-4", f"{webhook}-4"]
    assert receiver.deliveries[0].json == {"after": 0, "oldest": 4}
    assert receiver.deliveries[0].is_signed(SECRET)


def test_events_that_are_not_wanted_make_no_gap(bench, receiver, monkeypatch):
    monkeypatch.setattr("service.http.webhook_delivery.LOOK_PAUSE_S", 0.01)
    webhook = bench.add(receiver, project="tram")
    bench.note(3)

    def is_noted() -> bool:
        bench.clock.now += 30  # it is noted when the lease is extended
        return bench.row(webhook).after == 3

    bench.deliver(is_noted)
    bench.events.prune(-1.0)
    bench.note(project="tram")
    bench.deliver(lambda: bench.row(webhook).after == 4, worker="two")
    assert receiver.kinds == ["shot-added"]


def test_a_slow_receiver_holds_up_no_other(bench, receiver):
    receiver.may_answer.clear()
    with receiving() as quick:
        slow, other = bench.add(receiver), bench.add(quick)
        bench.note(3)
        bench.deliver(lambda: bench.row(other).after == 3 and len(receiver.deliveries) == 1)
        assert bench.row(slow).after == 0
        receiver.may_answer.set()


def test_a_receiver_that_does_not_answer_in_time_fails(bench, receiver, monkeypatch):
    monkeypatch.setattr("service.http.webhook_sending.WITHIN_S", 0.05)
    receiver.may_answer.clear()
    webhook = bench.add(receiver)
    bench.note()
    bench.deliver(lambda: bench.row(webhook).failures > 0)
    row = bench.row(webhook)
    assert (row.last_status, row.last_error) == (None, "the receiver did not answer within 0.05 s")


def test_what_may_not_be_reached_is_not(bench, receiver):
    webhook = bench.add(receiver)
    bench.note()
    bench.deliver(lambda: bench.row(webhook).failures > 1, allows_private=False)
    assert bench.row(webhook).last_error == "no address of '127.0.0.1' may be reached: 127.0.0.1 is this machine"
    assert (receiver.deliveries, set(bench.outcomes)) == ([], {"refused"})


def answers(*urls: str, addresses: Sequence[str] = ("127.0.0.1",)) -> tuple[list[Answer], list[str]]:
    """Answers of receivers to one sender, whose names all lead to some addresses; the names that were looked up."""
    asked = []

    async def look_up(host: str, port: int) -> list[str]:
        asked.append(host)
        return list(addresses)

    async def send_all() -> list[Answer]:
        sender = Sender(True, lambda _: None, look_up)
        try:
            return [await sender.send(url, SECRET, Message("test", "d", "{}")) for url in urls]
        finally:
            await sender.close()

    return asyncio.run(send_all()), asked


def test_a_receiver_is_asked_for_by_its_name_and_looked_up_once(receiver):
    url = receiver.url.replace("127.0.0.1", NAME)
    receiver.answer = b"x" * 5000
    receiver.headers = {"Set-Cookie": "a=b"}
    got, asked = answers(url, url, addresses=("127.0.0.2", "127.0.0.1"))  # nothing listens at the first one
    assert [(one.status, one.text, one.error) for one in got] == [(200, "x" * MAX_ANSWER, None)] * 2
    assert asked == [NAME] * 2
    assert receiver.deliveries[1].headers["Host"] == url.split("/")[2]
    assert "Cookie" not in receiver.deliveries[1].headers


def test_the_certificate_of_the_name_is_checked(tmp_path, monkeypatch):
    tls, certificate = certified(NAME, tmp_path)
    with receiving(tls) as receiver:
        url = receiver.url.replace("http://127.0.0.1", f"https://{NAME}")
        other = url.replace(NAME, "other.studio.example")
        (unknown,), _ = answers(url)
        monkeypatch.setenv("SSL_CERT_FILE", str(certificate))
        (known, another), _ = answers(url, other)
    assert (known.status, known.error) == (200, None)
    for refused in (unknown, another):
        assert (refused.status, "CERTIFICATE_VERIFY_FAILED" in refused.error) == (None, True)
    assert len(receiver.deliveries) == 1


def test_a_receiver_that_is_not_there_fails(bench):
    with receiving() as receiver:
        webhook = bench.add(receiver)
    bench.note()
    bench.deliver(lambda: bench.row(webhook).failures > 0)
    assert "the receiver cannot be reached" in bench.row(webhook).last_error


def test_one_service_alone_holds_a_webhook(tmp_path, receiver, postgresql_database):
    engine = open_database(tmp_path, postgresql_database)
    bench = Bench(engine)
    webhook = bench.add(receiver)
    bench.note()
    (held,) = bench.webhooks.hold("one", 60, {})
    assert (held.id, bench.webhooks.hold("two", 60, {})) == (webhook, [])
    bench.clock.now += 30  # extended
    bench.webhooks.hold("one", 60, {webhook: 1})
    bench.clock.now += 50
    assert bench.webhooks.hold("two", 60, {}) == []
    bench.clock.now += 11  # it has run out
    (held,) = bench.webhooks.hold("two", 60, {})
    assert held.after == 1
    assert bench.webhooks.hold("one", 60, {}) == []
    assert not bench.webhooks.note_delivered(webhook, "one", 7, 200)  # what comes too late counts for nothing
    assert bench.webhooks.note_failed(webhook, "one", 500, "late", False) is None
    assert (bench.row(webhook).after, bench.row(webhook).failures) == (1, 0)
    engine.dispose()


def test_a_killed_service_leaves_its_webhooks_to_the_next(tmp_path, receiver):
    engine = open_database(tmp_path)
    bench = Bench(engine)
    bench.add(receiver)
    assert len(bench.webhooks.hold("killed", 60, {})) == 1
    assert len(bench.webhooks.hold("next", 60, {})) == 1
    engine.dispose()


def test_a_webhook_that_is_removed_gets_nothing_more(bench, receiver):
    receiver.statuses = [500]
    bench.note()
    with receiving() as other:
        removed, present, count = bench.add(receiver), bench.add(other), None
        bench.note()

        def is_seen() -> bool:
            nonlocal count
            if count is None and len(receiver.deliveries) > 2:
                bench.webhooks.remove(removed, None)
                count = len(receiver.deliveries)
                bench.note(20)
            return count is not None and bench.row(present).after == 22

        bench.deliver(is_seen)
        assert len(other.deliveries) == 21
    assert len(receiver.deliveries) <= count + 1  # one try had begun


def test_a_service_has_so_many_webhooks(bench, receiver):
    for _ in range(MOST_WEBHOOKS):
        bench.add(receiver)
    assert bench.webhooks.add(receiver.url, SECRET, Wanted()) is None
