"""The worker process and its queue: errors come back, deaths are survived, the newest call of a group wins."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator

import pytest

from render.errors import StageError
from service.http.errors import answer_to
from service.workers.calls import call
from service.workers.errors import QueueFullError, StoppingError, WorkerError
from service.workers.process import WorkerProcess
from service.workers.worker_queue import WorkerQueue
from tests.service.conftest import until
from tests.service.workers.fake_work import Tally, crash, echo, fail, process_id, refuse, unpicklable, unregistered

WAIT_S = 60


@pytest.fixture(scope="module")
def shared_queue() -> Iterator[WorkerQueue[Tally]]:
    queue = WorkerQueue(WorkerProcess("tally", Tally), max_waiting=3, timeout_s=WAIT_S)
    yield queue
    queue.close()


def status_and_code(future) -> tuple[int, str]:
    """The HTTP status and the code of the error that ended a call."""
    error = future.exception(WAIT_S)
    assert isinstance(error, WorkerError)
    answer = answer_to(error)
    assert ("Retry-After" in answer.headers) == (answer.status_code == 503)
    return answer.status_code, error.code


def test_state_lives_from_request_to_request(shared_queue):
    first = shared_queue.submit(call(echo, "a")).result(WAIT_S)[1]
    assert shared_queue.submit(call(echo, "b")).result(WAIT_S) == ("b", first + 1)


def test_work_runs_in_another_process(shared_queue):
    assert shared_queue.submit(call(process_id)).result(WAIT_S) != os.getpid()


def test_an_error_raised_on_purpose_arrives_whole(shared_queue):
    error = shared_queue.submit(call(refuse)).exception(WAIT_S)
    assert isinstance(error, StageError)
    assert (error.detail, error.code, error.path) == ("set.usda is no USD stage", "stage_unreadable", "set.usda")


@pytest.mark.parametrize("function", [fail, unpicklable, unregistered])
def test_a_fault_is_an_answer_and_no_death(shared_queue, function):
    before = shared_queue.submit(call(process_id)).result(WAIT_S)
    assert status_and_code(shared_queue.submit(call(function))) == (500, "internal")
    assert shared_queue.submit(call(process_id)).result(WAIT_S) == before


@pytest.mark.parametrize("die", ["crash", "kill"])
def test_a_dead_worker_costs_one_request(shared_queue, die):
    worker_id = shared_queue.submit(call(process_id)).result(WAIT_S)
    if die == "crash":
        lost = shared_queue.submit(call(crash))
    else:
        lost = shared_queue.submit(call(echo, pause_s=WAIT_S))
        until(lost.running)
        os.kill(worker_id, signal.SIGKILL)
    assert status_and_code(lost) == (503, "worker_died")
    assert shared_queue.submit(call(echo, "still here")).result(WAIT_S) == ("still here", 1)


def test_a_worker_that_died_while_idle_costs_nothing(shared_queue):
    os.kill(shared_queue.submit(call(process_id)).result(WAIT_S), signal.SIGKILL)
    until(lambda: shared_queue.worker.pid is None)
    assert shared_queue.submit(call(echo, "fresh")).result(WAIT_S) == ("fresh", 1)


def test_the_newest_request_of_a_group_wins(shared_queue):
    running = shared_queue.submit(call(echo, "running", pause_s=0.5), group="viewer")
    until(running.running)
    alone = shared_queue.submit(call(echo, "alone"))
    old = shared_queue.submit(call(echo, "old"), group="viewer")
    other = shared_queue.submit(call(echo, "other"), group="another viewer")
    new = shared_queue.submit(call(echo, "new"), group="viewer")
    assert status_and_code(old) == (409, "superseded")
    assert [f.result(WAIT_S)[0] for f in (running, alone, other, new)] == ["running", "alone", "other", "new"]


def test_the_queue_is_bounded(shared_queue):
    running = shared_queue.submit(call(echo, "running", pause_s=0.5))
    until(running.running)
    waiting = [shared_queue.submit(call(echo, str(n))) for n in range(3)]
    with pytest.raises(QueueFullError) as refused:
        shared_queue.submit(call(echo, "one too many"))
    answer = answer_to(refused.value)
    assert (answer.status_code, refused.value.code) == (503, "busy")
    assert "Retry-After" in answer.headers
    assert [f.result(WAIT_S)[0] for f in waiting] == ["0", "1", "2"]


def test_a_cancelled_request_is_not_run(shared_queue):
    first = shared_queue.submit(call(echo, pause_s=0.3)).result(WAIT_S)[1]
    shared_queue.submit(call(echo, pause_s=0.3))
    given_up = shared_queue.submit(call(echo, "unwanted"))
    assert given_up.cancel()
    assert shared_queue.submit(call(echo, "next")).result(WAIT_S) == ("next", first + 2)


def test_a_request_that_takes_too_long_is_ended():
    queue = WorkerQueue(WorkerProcess("slow", Tally), max_waiting=3, timeout_s=3.0)
    try:
        assert status_and_code(queue.submit(call(echo, pause_s=WAIT_S))) == (504, "timeout")
        assert queue.submit(call(echo, "next")).result(WAIT_S) == ("next", 1)
    finally:
        queue.close()


def test_closing_answers_everyone_and_ends_the_worker():
    queue = WorkerQueue(WorkerProcess("closing", Tally), max_waiting=3, timeout_s=WAIT_S)
    worker_id = queue.submit(call(process_id)).result(WAIT_S)
    running = queue.submit(call(echo, pause_s=WAIT_S))
    until(running.running)
    waiting = queue.submit(call(echo))
    queue.close()
    assert status_and_code(running) == (503, "stopping")
    assert status_and_code(waiting) == (503, "stopping")
    with pytest.raises(ProcessLookupError):
        os.kill(worker_id, 0)
    with pytest.raises(StoppingError):
        queue.submit(call(echo))
