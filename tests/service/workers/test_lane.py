"""Lanes of calls: errors come back, deaths are survived, the newest call of a group wins, and nobody blocks the others."""

from __future__ import annotations

import asyncio
import os
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from render.errors import SettingsError, StageError
from service.http.errors import answer_to
from service.workers import forking
from service.workers.calls import call
from service.workers.errors import QueueFullError, StoppingError, WorkerDiedError, WorkerError
from service.workers.jobs import LIKE_S, Client
from service.workers.lane import MAX_PATIENCE_S, Lane
from service.workers.places import Place
from service.workers.pool import WorkerPool
from service.workers.streaming import CROWD
from tests.service.conftest import is_running, until
from tests.service.workers.fake_work import (
    Tally,
    chosen_gpu,
    crash,
    devour_memory,
    echo,
    fail,
    hold_memory,
    lie,
    process_id,
    refuse,
    run_out_of_memory,
    spin,
    unpicklable,
    unregistered,
)
from tests.service.workers.kit import WAIT_S, tally_lane, tally_pool, wait_until_idle


@pytest.fixture(scope="module")
def pool() -> Iterator[WorkerPool]:
    with tally_pool() as pool:
        yield pool


@pytest.fixture(scope="module")
def shared_lane(pool) -> Iterator[Lane[Tally]]:
    with tally_lane(pool) as lane:
        yield lane


def status_and_code(future) -> tuple[int, str]:
    """The HTTP status and the code of the error that ended a call."""
    error = future.exception(WAIT_S)
    assert isinstance(error, WorkerError)
    answer = answer_to(error)
    assert ("Retry-After" in answer.headers) == (answer.status_code == 503)
    return answer.status_code, error.code


def test_state_lives_from_request_to_request(shared_lane):
    first = shared_lane.submit(call(echo, "a")).result(WAIT_S)[1]
    assert shared_lane.submit(call(echo, "b")).result(WAIT_S) == ("b", first + 1)


def test_work_runs_in_another_process(shared_lane):
    assert shared_lane.submit(call(process_id)).result(WAIT_S) != os.getpid()


def test_an_error_raised_on_purpose_arrives_whole(shared_lane):
    error = shared_lane.submit(call(refuse)).exception(WAIT_S)
    assert isinstance(error, StageError)
    assert (error.detail, error.code, error.path) == ("set.usda is no USD stage", "stage_unreadable", "set.usda")


@pytest.mark.parametrize("function", [fail, unpicklable, unregistered])
def test_a_fault_is_an_answer_and_no_death(shared_lane, function):
    before = shared_lane.submit(call(process_id)).result(WAIT_S)
    assert status_and_code(shared_lane.submit(call(function))) == (500, "internal")
    assert shared_lane.submit(call(process_id)).result(WAIT_S) == before


@pytest.mark.parametrize("die", ["crash", "kill"])
def test_a_dead_worker_costs_one_request(shared_lane, die):
    worker_id = shared_lane.submit(call(process_id)).result(WAIT_S)
    if die == "crash":
        lost = shared_lane.submit(call(crash))
    else:
        lost = shared_lane.submit(call(echo, pause_s=WAIT_S))
        until(lost.running)
        time.sleep(0.1)  # it has begun: before that, another worker would take the call
        os.kill(worker_id, signal.SIGKILL)
    assert status_and_code(lost) == ((422, "unfit") if die == "crash" else (503, "worker_died"))
    assert shared_lane.submit(call(echo, "still here")).result(WAIT_S) == ("still here", 1)


def test_a_worker_that_died_while_idle_costs_nothing(shared_lane):
    worker_id = shared_lane.submit(call(process_id)).result(WAIT_S)
    os.kill(worker_id, signal.SIGKILL)
    until(lambda: not is_running(worker_id))
    assert shared_lane.submit(call(echo, "fresh")).result(WAIT_S) == ("fresh", 1)


def test_the_newest_request_of_a_group_wins(shared_lane):
    running = shared_lane.submit(call(echo, "running", pause_s=0.5), group="viewer")
    until(running.running)
    alone = shared_lane.submit(call(echo, "alone"))
    old = shared_lane.submit(call(echo, "old"), group="viewer")
    other = shared_lane.submit(call(echo, "other"), group="another viewer")
    new = shared_lane.submit(call(echo, "new"), group="viewer")
    assert status_and_code(old) == (409, "superseded")
    assert [f.result(WAIT_S)[0] for f in (running, alone, other, new)] == ["running", "alone", "other", "new"]


def test_the_queue_is_bounded(shared_lane):
    running = shared_lane.submit(call(echo, "running", pause_s=0.5))
    until(running.running)
    waiting = [shared_lane.submit(call(echo, str(n))) for n in range(3)]
    with pytest.raises(QueueFullError) as refused:
        shared_lane.submit(call(echo, "one too many"))
    answer = answer_to(refused.value)
    assert (answer.status_code, refused.value.code) == (503, "busy")
    assert "Retry-After" in answer.headers
    assert [f.result(WAIT_S)[0] for f in waiting] == ["0", "1", "2"]


def test_a_cancelled_request_is_not_run(shared_lane):
    first = shared_lane.submit(call(echo, pause_s=0.3)).result(WAIT_S)[1]
    shared_lane.submit(call(echo, pause_s=0.3))
    given_up = shared_lane.submit(call(echo, "unwanted"))
    assert given_up.cancel()
    assert shared_lane.submit(call(echo, "next")).result(WAIT_S) == ("next", first + 2)


def test_a_request_that_takes_too_long_is_ended(pool):
    with tally_lane(pool, timeout_s=0.5) as lane:
        assert status_and_code(lane.submit(call(echo, pause_s=WAIT_S))) == (422, "unfit")
        assert lane.submit(call(echo, "next")).result(WAIT_S)[0] == "next"


def test_closing_answers_everyone_and_ends_the_worker(pool):
    with tally_lane(pool) as lane:
        worker_id = lane.submit(call(process_id)).result(WAIT_S)
        running = lane.submit(call(echo, pause_s=WAIT_S))
        until(running.running)
        waiting = lane.submit(call(echo))
        until(lambda: lane.waiting == 1)
    assert status_and_code(running) == (503, "stopping")
    assert status_and_code(waiting) == (503, "stopping")
    assert not is_running(worker_id)
    with pytest.raises(StoppingError):
        lane.submit(call(echo))


SCENE, OTHER_SCENE = Place("scene"), Place("other scene")


def test_each_shot_has_a_process_of_its_own(shared_lane):
    workers = [shared_lane.submit(call(process_id), place).result(WAIT_S) for place in (SCENE, OTHER_SCENE, SCENE)]
    assert workers[0] == workers[2] != workers[1]


def test_viewers_take_turns_however_much_one_asks_for(pool):
    with tally_lane(pool, max_waiting=99) as lane:
        busy = Client(viewer="busy")
        calls = [lane.submit(call(echo, "busy", pause_s=0.05), SCENE, busy) for _ in range(20)]
        until(lambda: calls[1].done())
        modest = lane.submit(call(echo, "modest"), SCENE, Client(viewer="modest"))
        before = sum(each.done() for each in calls)
        assert modest.result(WAIT_S)[1] <= before + 3  # after the one that ran, and one more at most


def test_cheap_work_has_more_turns_than_dear_work(pool):
    order: list[str] = []
    with tally_lane(pool, max_waiting=99) as lane:
        lane.submit(call(echo), SCENE, Client(viewer="earlier")).result(WAIT_S)  # starts the process
        blocking = lane.submit(call(echo, pause_s=0.2))
        for _ in range(4):
            for viewer, pause_s in (("dear", 0.2), ("cheap", 0.04)):
                future = lane.submit(call(echo, pause_s=pause_s), SCENE, Client(viewer=viewer))
                future.add_done_callback(lambda _, viewer=viewer: order.append(viewer))
        blocking.result(WAIT_S)
        wait_until_idle(lane)
    first_of_dear = order.index("dear")
    assert order[first_of_dear + 1 :].index("dear") >= 3  # cheap ones come between


def test_a_viewer_does_not_pay_for_the_start_of_a_process(pool):
    ended = []
    with tally_lane(pool, max_waiting=99) as lane:
        for _ in range(2):  # the first one starts a process
            lane.submit(call(echo, pause_s=0.2), SCENE, Client("earlier", "earlier")).result(WAIT_S)
        first = lane.submit(call(echo, pause_s=2.0), Place("started"), Client("first", "first"))
        until(first.running)
        lane.submit(call(echo, pause_s=1.3), Place("started"), Client("second", "second")).result(WAIT_S)
        running = lane.submit(call(echo, pause_s=0.3), Place("started"), Client("third", "third"))
        until(running.running)
        for name in ("second", "first"):
            asked = lane.submit(call(echo), Place("started"), Client(name, name))
            asked.add_done_callback(lambda _, name=name: ended.append(name))
        wait_until_idle(lane)
    assert ended == ["first", "second"]


def test_a_newer_request_keeps_the_place_of_its_predecessor(pool):
    order: list[str] = []
    with tally_lane(pool, max_waiting=99) as lane:
        running = lane.submit(call(echo, pause_s=0.3))
        until(running.running)
        lane.submit(call(echo, "old"), group="viewer")
        for word in ("second", "third"):
            lane.submit(call(echo), group=word).add_done_callback(lambda _, word=word: order.append(word))
        lane.submit(call(echo, "new"), group="viewer").add_done_callback(lambda _: order.append("new"))
        wait_until_idle(lane)
    assert order == ["new", "second", "third"]


def test_work_that_takes_long_blocks_nobody(pool):
    with tally_lane(pool, max_waiting=99) as lane:
        absurd = [lane.submit(call(echo, pause_s=8.0), Place(f"absurd {n}")) for n in range(2)]
        until(absurd[0].running)
        began_s = time.monotonic()
        assert lane.submit(call(echo, "modest"), SCENE).result(WAIT_S)[0] == "modest"
        assert time.monotonic() - began_s < 6.0
        assert not absurd[0].done()


def test_others_get_a_second_process_beside_long_work(pool):
    with tally_lane(pool) as lane:
        lane.submit(call(echo), SCENE).result(WAIT_S)
        absurd = lane.submit(call(echo, pause_s=WAIT_S), SCENE)
        until(absurd.running)
        assert lane.submit(call(echo, "modest"), SCENE).result(LIKE_S - 1) == ("modest", 1)
        assert not absurd.done()


def test_a_crowd_of_one_shot_gets_a_second_process(pool):
    with tally_lane(pool, slots=2, max_waiting=99) as lane:
        first = lane.submit(call(echo, pause_s=1.0), SCENE)
        until(first.running)
        few = [lane.submit(call(process_id), SCENE) for _ in range(CROWD)]
        time.sleep(0.1)
        assert not any(future.running() or future.done() for future in few)
        lane.submit(call(process_id), SCENE)
        assert few[0].result(WAIT_S)
        assert not first.done()


def test_jobs_wait_for_the_start_of_the_process_of_their_shot(pool):
    with tally_lane(pool, max_waiting=99) as lane:
        first = lane.submit(call(echo, "first", pause_s=MAX_PATIENCE_S + 1), Place("new"))
        until(first.running)
        assert lane.submit(call(echo, "second"), Place("new")).result(WAIT_S) == ("second", 2)


def test_a_job_that_takes_much_of_the_processor_is_overdue(pool, monkeypatch):
    monkeypatch.setattr("service.workers.lane.MAX_PATIENCE_S", 2 * WAIT_S)
    with tally_lane(pool, max_waiting=99) as lane:
        lane.submit(call(spin, 0.0), SCENE).result(WAIT_S)
        greedy = lane.submit(call(spin, WAIT_S), SCENE)
        until(greedy.running)
        assert lane.submit(call(echo, "modest"), SCENE).result(WAIT_S) == ("modest", 1)
        assert not greedy.done()


def test_the_only_writer_of_a_shot_stays_the_only_one(pool):
    with tally_lane(pool, options={"is_single": True}) as lane:
        long = lane.submit(call(echo, "first", pause_s=2.0), SCENE)
        assert lane.submit(call(echo, "second"), SCENE).result(WAIT_S) == ("second", 2)
        assert long.done()


def test_one_client_cannot_fill_the_lane(pool):
    with tally_lane(pool, max_waiting=9, max_waiting_each=2) as lane:
        running = lane.submit(call(echo, pause_s=0.3))
        until(running.running)
        greedy = Client("greedy", "greedy")
        for _ in range(2):
            lane.submit(call(echo), client=greedy)
        with pytest.raises(QueueFullError, match="2 of your requests"):
            lane.submit(call(echo), client=greedy)
        lane.submit(call(echo), client=Client("modest", "modest"))
        wait_until_idle(lane)


@pytest.mark.parametrize("where", ["running", "waiting"])
def test_work_ends_when_its_client_has_gone(pool, where):
    async def ask_and_leave(lane: Lane[Tally]) -> None:
        asked = asyncio.create_task(lane.result(call(echo, pause_s=WAIT_S)))
        await asyncio.to_thread(until, lambda: lane.running > 0 if where == "running" else lane.waiting > 0)
        asked.cancel()
        with pytest.raises(asyncio.CancelledError):
            await asked

    with tally_lane(pool) as lane:
        other = lane.submit(call(echo, pause_s=1.0)) if where == "waiting" else None
        asyncio.run(ask_and_leave(lane))
        wait_until_idle(lane)
        assert other is None or other.result(0)[0] == ""
        assert pool.ends["tally", "cancelled"] == (1 if where == "running" else pool.ends["tally", "cancelled"])


@pytest.mark.parametrize(("function", "end"), [(crash, "crash"), (devour_memory, "memory"), (lie, "unsafe")])
def test_a_shot_is_blamed_for_the_end_of_its_worker(function, end):
    blamed: list[tuple[str, str]] = []
    with tally_pool(on_blame=lambda key, why: blamed.append((key, why))) as pool, tally_lane(pool) as lane:
        error = lane.submit(call(function), SCENE).exception(WAIT_S)
        assert isinstance(error, WorkerDiedError)
        assert error.end == end
        until(lambda: bool(blamed))
    assert blamed == [("scene", end)]


def test_work_that_gets_no_memory_is_refused_and_its_worker_lives(shared_lane):
    before = shared_lane.submit(call(process_id)).result(WAIT_S)
    error = shared_lane.submit(call(run_out_of_memory)).exception(WAIT_S)
    assert isinstance(error, SettingsError)
    assert error.code == "out_of_memory"
    assert shared_lane.submit(call(process_id)).result(WAIT_S) == before


def test_nobody_is_blamed_for_a_kill_from_outside():
    blamed: list[str] = []
    with tally_pool(on_blame=lambda key, why: blamed.append(key)) as pool, tally_lane(pool) as lane:
        worker_id = lane.submit(call(process_id), SCENE).result(WAIT_S)
        lost = lane.submit(call(echo, pause_s=WAIT_S), SCENE)
        until(lost.running)
        time.sleep(0.1)
        os.kill(worker_id, signal.SIGKILL)
        assert status_and_code(lost) == (503, "worker_died")
    assert blamed == []


def test_nobody_is_blamed_for_the_end_of_the_template():
    blamed: list[str] = []
    with tally_pool(on_blame=lambda key, why: blamed.append(key)) as pool, tally_lane(pool) as lane:
        lane.submit(call(echo), SCENE).result(WAIT_S)
        lost = lane.submit(call(echo, pause_s=WAIT_S), SCENE)
        until(lost.running)
        time.sleep(0.1)
        os.kill(pool.template.pid, signal.SIGKILL)
        assert status_and_code(lost) == (503, "worker_died")
    assert blamed == []


def test_shots_stay_open_while_memory_allows():
    with tally_pool(max_bytes=130 << 20) as pool, tally_lane(pool) as lane:
        for name in ("a", "b", "c"):
            lane.submit(call(hold_memory, 40 << 20), Place(name)).result(WAIT_S)
            wait_until_idle(lane)
        assert {process.place.key for process in pool.processes()} == {"b", "c"}


def test_the_most_memory_is_known_of_ended_workers_too():
    with tally_pool() as pool, tally_lane(pool) as lane:
        lane.submit(call(hold_memory, 200 << 20), Place("a")).result(WAIT_S)
        while_alive = pool.peaks()
        pool.close_place("a")
        lane.submit(call(echo), Place("b")).result(WAIT_S)
        afterwards = pool.peaks()
    for peaks in (while_alive, afterwards):
        assert 200 << 20 < peaks[lane.role] < 600 << 20


def test_workers_that_draw_are_spread_over_the_gpus():
    with tally_pool(gpus=2) as pool, tally_lane(pool, options={"draws": True}) as lane:
        seen = [lane.submit(call(chosen_gpu), Place(str(n))).result(WAIT_S) for n in range(3)]
    assert seen == ["0", "1", "0"]


def test_a_thrown_away_worker_runs_one_call(pool):
    with tally_lane(pool, options={"is_thrown_away": True}) as lane:
        assert [lane.submit(call(echo), SCENE).result(WAIT_S)[1] for _ in range(2)] == [1, 1]


def test_a_dead_template_is_replaced():
    with tally_pool() as pool, tally_lane(pool) as lane:
        lane.submit(call(echo)).result(WAIT_S)
        os.kill(pool.template.pid, signal.SIGKILL)
        until(lambda: pool.template.pid is None)
        assert lane.submit(call(echo, "again"), SCENE).result(WAIT_S) == ("again", 1)
        assert lane.submit(call(echo, "fresh")).result(WAIT_S) == ("fresh", 1)


def test_a_template_that_does_not_answer_is_replaced(monkeypatch):
    monkeypatch.setattr(forking, "ANSWER_S", 0.5)
    with tally_pool() as pool, tally_lane(pool) as lane:
        lane.submit(call(echo), SCENE).result(WAIT_S)
        stopped = pool.template.pid
        os.kill(stopped, signal.SIGSTOP)
        assert lane.submit(call(echo, "other"), Place("other")).result(WAIT_S) == ("other", 1)
        os.kill(pool.template.pid, signal.SIGSTOP)
        pool.close_place("other")  # a worker is ended though nobody can tell how it did
        pool.template.check(WAIT_S)
        assert pool.template.pid != stopped
        assert not is_running(stopped)


def test_a_template_lives_longer_than_the_thread_that_asked():
    with tally_pool() as pool:
        asking = threading.Thread(target=pool.template.check, args=(WAIT_S,))
        asking.start()
        asking.join()
        began = pool.template.pid
        pool.template.check(WAIT_S)
        assert pool.template.pid == began


def test_nobody_is_blamed_where_a_worker_was_stopped():
    blamed: list[str] = []
    with tally_pool(on_blame=lambda key, why: blamed.append(key)) as pool, tally_lane(pool, timeout_s=1.0) as lane:
        worker_id = lane.submit(call(process_id), SCENE).result(WAIT_S)
        lost = lane.submit(call(echo, pause_s=WAIT_S), SCENE)
        until(lost.running)
        time.sleep(0.3)
        os.kill(worker_id, signal.SIGSTOP)
        assert status_and_code(lost) == (503, "worker_died")
    assert blamed == []


def test_a_worker_that_is_stopped_while_idle_costs_nothing(shared_lane):
    worker_id = shared_lane.submit(call(process_id), SCENE).result(WAIT_S)
    wait_until_idle(shared_lane)
    os.kill(worker_id, signal.SIGSTOP)
    until(lambda: Path(f"/proc/{worker_id}/stat").read_text().rpartition(")")[2].split()[0] == "T")
    assert shared_lane.submit(call(process_id), SCENE).result(WAIT_S) != worker_id
    assert not is_running(worker_id)
