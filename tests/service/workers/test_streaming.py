"""Streams in a lane: many items from one call, interrupted for newer or waiting calls, and complete in the end."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator

import pytest

from render.errors import StageError
from service.workers.calls import StreamCall, call, stream_call
from service.workers.errors import QueueFullError, WorkerError
from service.workers.lane import TICK_S, Lane
from service.workers.places import Place
from service.workers.pool import WorkerPool
from service.workers.streaming import CROWD, Signals, StaleCheck, create_memory
from tests.service.conftest import until
from tests.service.workers.fake_work import Tally, crash, echo, fail, refine, refuse
from tests.service.workers.kit import WAIT_S, tally_lane, tally_pool


class Watched:
    """A stream in a lane, with its items and its end."""

    def __init__(self, lane: Lane[Tally], work: StreamCall[Tally, tuple[str, int]], group: str | None = None) -> None:
        self.lane = lane
        self.items: list[tuple[str, int]] = []
        self.error: Exception | None = None
        self._ended = threading.Event()
        self.stream = lane.submit_stream(work, on_item=self.items.append, on_end=self._end, group=group)

    def _end(self, error: Exception | None) -> None:
        assert not self._ended.is_set(), "a stream ends once"
        self.error = error
        self._ended.set()

    def result(self) -> Exception | None:
        """Result of the stream."""
        assert self._ended.wait(WAIT_S)
        return self.error

    def code(self) -> str:
        error = self.result()
        assert isinstance(error, WorkerError)
        return error.code

    def cancel(self) -> None:
        self.lane.cancel(self.stream)


@pytest.fixture(scope="module")
def pool() -> Iterator[WorkerPool]:
    with tally_pool() as pool:
        yield pool


@pytest.fixture(scope="module")
def lane(pool) -> Iterator[Lane[Tally]]:
    with tally_lane(pool) as lane:
        yield lane


def begun(lane: Lane[Tally], work: StreamCall[Tally, tuple[str, int]], group: str | None = None) -> Watched:
    """A stream that has shown something."""
    watched = Watched(lane, work, group)
    until(lambda: bool(watched.items))
    return watched


def test_answers_come_one_after_the_other(lane):
    stream = Watched(lane, stream_call(refine, "a", shows=4))
    assert stream.result() is None
    assert stream.items == [("a", number) for number in range(4)]
    assert lane.submit(call(echo, "after")).result(WAIT_S)[0] == "after"


def test_a_newer_one_of_its_group_takes_its_place_at_once(lane):
    old = begun(lane, stream_call(refine, "old", shows=10_000), "viewer")
    new = Watched(lane, stream_call(refine, "new", shows=2), "viewer")
    assert old.code() == "superseded"
    assert new.result() is None
    assert new.items == [("new", 0), ("new", 1)]


def test_while_a_hand_moves_each_that_was_begun_shows_one_picture(lane):
    first = Watched(lane, stream_call(refine, "first", shows=5, pieces=20), "viewer")
    until(lambda: first.stream.process is not None)
    skipped, last = (
        Watched(lane, stream_call(refine, "skipped"), "viewer"),
        Watched(lane, stream_call(refine, "last"), "viewer"),
    )
    assert (first.code(), skipped.code(), last.result()) == ("superseded", "superseded", None)
    assert first.items == [("first", 0)]
    assert skipped.items == []
    assert len(last.items) == 3


def test_other_work_runs_between_and_the_stream_still_ends(lane):
    stream = begun(lane, stream_call(refine, "fine", shows=100))
    shown = lane.submit(call(echo, "pick")).result(WAIT_S)
    assert shown[0] == "pick"
    assert len(stream.items) < 100
    assert stream.result() is None
    assert stream.items[-1] == ("fine", 99)


def test_however_many_others_there_are_a_stream_comes_to_its_end(lane):
    stream = Watched(lane, stream_call(refine, "fine", shows=40, piece_s=0.02))
    while ("fine", 39) not in stream.items:
        lane.submit(call(echo)).result(WAIT_S)
    assert stream.result() is None
    assert stream.items.count(("fine", 0)) > 1  # it was put off, and begun anew


@pytest.mark.parametrize("where", ["running", "waiting"])
def test_a_cancelled_stream_ends(lane, where):
    running = begun(lane, stream_call(refine, "running", shows=10_000))
    unwanted = running if where == "running" else Watched(lane, stream_call(refine, "waiting", shows=10_000), "viewer")
    unwanted.cancel()
    assert unwanted.code() == "superseded"
    running.cancel()
    running.result()
    unwanted.cancel()  # which has ended: nothing happens
    assert lane.submit(call(echo, "next")).result(WAIT_S)[0] == "next"


def test_one_that_is_dropped_before_it_showed_anything_ends_too(lane):
    stream = Watched(lane, stream_call(refine, shows=1, pieces=10_000))
    until(lambda: stream.stream.process is not None)
    stream.cancel()
    assert stream.code() == "superseded"
    assert stream.items == []


def test_the_process_of_a_cancelled_stream_may_finish_a_long_piece(lane, pool, monkeypatch):
    monkeypatch.setattr("service.workers.lane.UNWANTED_S", 0.01)
    stream = Watched(lane, stream_call(refine, pieces=2, piece_s=8 * TICK_S))
    until(lambda: stream.stream.process is not None)
    starts = pool.starts["tally"]
    stream.cancel()
    assert stream.code() == "superseded"
    assert lane.submit(call(echo)).result(WAIT_S)
    assert pool.starts["tally"] == starts


def test_a_cancelled_stream_that_does_not_end_loses_its_process(lane, pool, monkeypatch):
    monkeypatch.setattr("service.workers.lane.UNWANTED_STREAM_S", 0.01)
    stream = Watched(lane, stream_call(refine, piece_s=WAIT_S))
    until(lambda: stream.stream.process is not None)
    ends = pool.ends["tally", "cancelled"]
    stream.cancel()
    assert stream.code() == "superseded"
    assert pool.ends["tally", "cancelled"] == ends + 1


def test_a_cancelled_stream_makes_way_for_another_shot(pool, monkeypatch):
    monkeypatch.setattr("service.workers.lane.UNWANTED_S", 0.01)
    with tally_lane(pool, slots=1) as lane:
        stream = Watched(lane, stream_call(refine, piece_s=WAIT_S))
        until(lambda: stream.stream.process is not None)
        time.sleep(2 * TICK_S)  # it is in its piece of work
        ends = pool.ends["tally", "cancelled"]
        stream.cancel()
        assert lane.submit(call(echo), Place("another")).result(WAIT_S)
        assert pool.ends["tally", "cancelled"] == ends + 1


def test_an_error_comes_after_what_was_shown(lane):
    refused = Watched(lane, stream_call(refine, "a", shows=2, ending=refuse))
    assert isinstance(refused.result(), StageError)
    assert refused.items == [("a", 0), ("a", 1)]
    assert Watched(lane, stream_call(refine, ending=fail)).code() == "internal"


def test_a_dead_worker_costs_the_stream_and_nothing_else(lane):
    assert Watched(lane, stream_call(refine, ending=crash)).code() == "unfit"
    assert lane.submit(call(echo, "fresh")).result(WAIT_S) == ("fresh", 1)


def test_streams_wait_in_the_bounded_lane(lane):
    running = begun(lane, stream_call(refine, "running", shows=10_000, piece_s=0.2))
    waiting = [Watched(lane, stream_call(refine, str(n), pieces=10_000), f"viewer {n}") for n in range(3)]
    with pytest.raises(QueueFullError):
        Watched(lane, stream_call(refine, "one too many"))
    for stream in (*waiting, running):
        stream.cancel()
    assert {stream.code() for stream in (*waiting, running)} == {"superseded"}


def test_what_is_refused_takes_the_place_of_nothing(lane):
    running = Watched(lane, stream_call(refine, "running", shows=2, pieces=40, piece_s=0.02), "viewer")
    until(lambda: running.stream.process is not None)
    waiting = [Watched(lane, stream_call(refine, str(n)), f"viewer {n}") for n in range(3)]
    with pytest.raises(QueueFullError):
        Watched(lane, stream_call(refine, "one too many"), "viewer")
    newer = Watched(lane, stream_call(refine, "newer"), "viewer 0")  # which takes a place that is there already
    assert [stream.result() for stream in (running, *waiting[1:], newer)] == [None] * 4
    assert waiting[0].code() == "superseded"
    assert ("running", 1) in running.items


def test_closing_ends_those_that_run_and_those_that_wait(pool):
    with tally_lane(pool) as lane:
        running, waiting = begun(lane, stream_call(refine, shows=10_000)), Watched(lane, stream_call(refine))
    assert (running.code(), waiting.code()) == ("stopping", "stopping")


def test_one_that_takes_too_long_is_ended(pool):
    with tally_lane(pool, timeout_s=0.5) as lane:
        assert Watched(lane, stream_call(refine, shows=100_000)).code() == "unfit"
        assert lane.submit(call(echo, "next")).result(WAIT_S) == ("next", 1)


def test_a_stream_knows_when_more_calls_wait_than_a_few():
    descriptor = create_memory()
    signals = Signals(descriptor)
    os.close(descriptor)
    is_stale = StaleCheck(signals, 1, has_yielded=False, grace_s=0.0)
    signals.queue_length = CROWD
    assert not is_stale.is_crowded
    signals.queue_length = CROWD + 1
    assert is_stale.is_crowded
    assert not is_stale()  # its first item comes whoever waits
