"""Workers that use what no limit of the kernel holds are ended, idle or busy, and their shot is blamed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from service.workers import greed
from service.workers.calls import Call, call
from service.workers.errors import UnfitError
from service.workers.lane import Lane
from service.workers.places import Place
from service.workers.pool import WorkerPool
from tests.service.conftest import until
from tests.service.workers.fake_work import Tally, burn_idle, echo, map_shared, process_id, spin, start_threads
from tests.service.workers.kit import LIMITS, WAIT_S, tally_lane, tally_pool, wait_until_idle

ROOM = Place("room")
BLAMES = list[tuple[str, str]]


@contextmanager
def watched() -> Iterator[tuple[WorkerPool, Lane[Tally], BLAMES]]:
    blames: BLAMES = []
    with tally_pool(on_blame=lambda key, end: blames.append((key, end))) as pool, tally_lane(pool) as lane:
        yield pool, lane, blames


def run(lane: Lane[Tally], work: Call[Tally, object]) -> object:
    answer = lane.submit(work, ROOM).result(WAIT_S)
    wait_until_idle(lane)
    return answer


def test_an_idle_worker_that_uses_the_processor_is_ended(monkeypatch):
    monkeypatch.setattr(greed, "IDLE_CPU_S", 0.5)
    with watched() as (pool, lane, blames):
        run(lane, call(burn_idle))
        (burning,) = pool.processes()
        until(lambda: burning.cpu_s() - burning.rested_cpu_s > greed.IDLE_CPU_S)
        pool.end_greedy()
        assert blames == []  # it may have made what later calls need
        assert pool.processes() == []
        assert pool.ends["tally", "cpu"] == 1
        assert run(lane, call(process_id)) != burning.pid


def test_work_of_a_call_is_not_held_against_an_idle_worker(monkeypatch):
    monkeypatch.setattr(greed, "IDLE_CPU_S", 0.1)
    with watched() as (pool, lane, blames):
        run(lane, call(spin, 0.5))
        (worker,) = pool.processes()
        assert worker.cpu_s() > 0.3
        pool.end_greedy()
        assert pool.processes() == [worker]
        spinning = lane.submit(call(spin, 1.0), ROOM)
        until(lambda: worker.cpu_s() - worker.rested_cpu_s > 0.3)
        pool.end_greedy()
        spinning.result(WAIT_S)
    assert blames == []


GREEDY = {
    "threads": (lambda pause_s: call(start_threads, 30, pause_s), "threads"),
    "memory": (lambda pause_s: call(map_shared, 48 << 20, pause_s), "memory"),
}


@pytest.fixture
def tight(monkeypatch):
    """Limits that a small process reaches, but for those that the kernel holds."""
    monkeypatch.setattr(greed, "MAX_THREADS", 20)
    shared = greed.WorkerProcess.shared_bytes
    monkeypatch.setattr(greed.WorkerProcess, "shared_bytes", lambda process: shared(process) * 32)


def test_shared_memory_is_measured():
    with watched() as (pool, lane, _):
        run(lane, call(map_shared, 48 << 20))
        (worker,) = pool.processes()
        assert 48 << 20 <= worker.shared_bytes() < 60 << 20
        assert worker.shared_bytes() * 32 > LIMITS.memory_bytes


@pytest.mark.parametrize("why", GREEDY)
def test_an_idle_worker_that_holds_too_much_is_ended(tight, why):
    with watched() as (pool, lane, blames):
        assert run(lane, call(echo, "x")) == ("x", 1)
        pool.end_greedy()
        assert len(pool.processes()) == 1
        run(lane, GREEDY[why][0](0.0))
        pool.end_greedy()
        assert pool.processes() == []
    assert blames == [("room", why)]


@pytest.mark.parametrize("why", GREEDY)
def test_a_busy_worker_that_takes_too_much_is_ended(tight, why):
    with watched() as (pool, lane, blames):
        taking = lane.submit(GREEDY[why][0](WAIT_S), ROOM)

        def is_ended() -> bool:
            pool.end_greedy()
            return taking.done()

        until(is_ended)
        error = taking.exception(WAIT_S)
        assert isinstance(error, UnfitError)
        assert GREEDY[why][1] in str(error)
        until(lambda: bool(blames))
    assert blames == [("room", why)]
