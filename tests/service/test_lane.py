"""The worker process and the lane before it: errors come back, deaths are survived, the newest request wins."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator

import pytest

from render.errors import StageError
from service.http.errors import ServiceError
from service.workers.calls import call
from service.workers.lane import Lane
from service.workers.process import WorkerProcess
from tests.service.conftest import until
from tests.service.fake_work import Tally, crash, echo, fail, process_id, refuse, unpicklable, unregistered

WAIT_S = 60


@pytest.fixture(scope="module")
def shared_lane() -> Iterator[Lane[Tally]]:
    lane = Lane(WorkerProcess("tally", Tally), max_waiting=3, timeout_s=WAIT_S)
    yield lane
    lane.close()


def problem_of(future) -> ServiceError:
    error = future.exception(WAIT_S)
    assert isinstance(error, ServiceError)
    return error


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
    error = problem_of(shared_lane.submit(call(function)))
    assert (error.status, error.code) == (500, "internal")
    assert shared_lane.submit(call(process_id)).result(WAIT_S) == before


@pytest.mark.parametrize("die", ["crash", "kill"])
def test_a_dead_worker_costs_one_request(shared_lane, die):
    worker_id = shared_lane.submit(call(process_id)).result(WAIT_S)
    if die == "crash":
        lost = shared_lane.submit(call(crash))
    else:
        lost = shared_lane.submit(call(echo, pause_s=WAIT_S))
        until(lost.running)
        os.kill(worker_id, signal.SIGKILL)
    error = problem_of(lost)
    assert (error.status, error.code) == (503, "worker_died")
    assert "Retry-After" in error.headers
    assert shared_lane.submit(call(echo, "still here")).result(WAIT_S) == ("still here", 1)


def test_a_worker_that_died_while_idle_costs_nothing(shared_lane):
    os.kill(shared_lane.submit(call(process_id)).result(WAIT_S), signal.SIGKILL)
    until(lambda: shared_lane.worker.pid is None)
    assert shared_lane.submit(call(echo, "fresh")).result(WAIT_S) == ("fresh", 1)


def test_the_newest_request_of_a_group_wins(shared_lane):
    running = shared_lane.submit(call(echo, "running", pause_s=0.5), group="viewer")
    until(running.running)
    alone = shared_lane.submit(call(echo, "alone"))
    old = shared_lane.submit(call(echo, "old"), group="viewer")
    other = shared_lane.submit(call(echo, "other"), group="another viewer")
    new = shared_lane.submit(call(echo, "new"), group="viewer")
    assert (problem_of(old).status, problem_of(old).code) == (409, "superseded")
    assert [f.result(WAIT_S)[0] for f in (running, alone, other, new)] == ["running", "alone", "other", "new"]


def test_the_queue_is_bounded(shared_lane):
    running = shared_lane.submit(call(echo, "running", pause_s=0.5))
    until(running.running)
    waiting = [shared_lane.submit(call(echo, str(n))) for n in range(3)]
    with pytest.raises(ServiceError) as refused:
        shared_lane.submit(call(echo, "one too many"))
    assert (refused.value.status, refused.value.code) == (503, "busy")
    assert "Retry-After" in refused.value.headers
    assert [f.result(WAIT_S)[0] for f in waiting] == ["0", "1", "2"]


def test_what_nobody_waits_for_is_not_done(shared_lane):
    first = shared_lane.submit(call(echo, pause_s=0.3)).result(WAIT_S)[1]
    shared_lane.submit(call(echo, pause_s=0.3))
    given_up = shared_lane.submit(call(echo, "unwanted"))
    assert given_up.cancel()
    assert shared_lane.submit(call(echo, "next")).result(WAIT_S) == ("next", first + 2)


def test_a_request_that_takes_too_long_is_ended():
    lane = Lane(WorkerProcess("slow", Tally), max_waiting=3, timeout_s=3.0)
    try:
        assert problem_of(lane.submit(call(echo, pause_s=WAIT_S))).status == 504
        assert lane.submit(call(echo, "next")).result(WAIT_S) == ("next", 1)
    finally:
        lane.close()


def test_closing_answers_everyone_and_ends_the_worker():
    lane = Lane(WorkerProcess("closing", Tally), max_waiting=3, timeout_s=WAIT_S)
    worker_id = lane.submit(call(process_id)).result(WAIT_S)
    running = lane.submit(call(echo, pause_s=WAIT_S))
    until(running.running)
    waiting = lane.submit(call(echo))
    lane.close()
    assert problem_of(running).status == 503
    assert problem_of(waiting).status == 503
    with pytest.raises(ProcessLookupError):
        os.kill(worker_id, 0)
    with pytest.raises(ServiceError):
        lane.submit(call(echo))


def test_the_process_that_speaks_http_imports_neither_usd_nor_gl():
    """A stranger's file, or a driver, can only take a process down that loads it."""
    heavy = ["pxr", "OpenGL", "moderngl", "pyrender", "OpenImageIO", "PyOpenColorIO"]
    code = f"import sys, service.http.app; print([name for name in {heavy} if name in sys.modules])"
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert printed == "[]\n"
