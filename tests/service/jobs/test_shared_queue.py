"""The queue of renders as several processes use it, and as its server goes away and comes back."""

from __future__ import annotations

import json
import subprocess
import sys
from contextlib import ExitStack
from itertools import chain

import pytest

from render.errors import OutputError
from service.jobs.queue import RenderQueue
from service.jobs.states import state_of
from service.storage.database.connection import open_database, revisions, time_of, transaction
from service.storage.events import EventLog
from tests.service.kits.queues import new_render, opened

WORKER = """
import json, sys
from pathlib import Path
from service.jobs.queue import RenderQueue
from service.storage.database.connection import open_database
from service.storage.events import EventLog

def in_step():
    print(flush=True)
    input()

in_step()
engine = open_database(Path(sys.argv[1]), sys.argv[2])
queue = RenderQueue(engine, EventLog(engine))
in_step()
frames = []
while (claim := queue.claim(sys.argv[3], 60.0)) is not None:
    frames.append(claim.frame)
    assert queue.finish(claim, {"exr": {"size_bytes": 1, "sha256": "hash"}}, 24.0)
print(json.dumps(frames))
"""

FILES = {"exr": {"size_bytes": 1, "sha256": "hash"}}


def go_on(processes: list[subprocess.Popen]) -> None:
    """Let all of them go on once each of them waits."""
    for process in processes:
        assert process.stdout.readline() == "\n", process.communicate()[1]
    for process in processes:
        process.stdin.write("\n")
        process.stdin.flush()


def test_processes_that_start_at_once_share_a_queue(tmp_path, database):
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with ExitStack() as stack:
        processes = []
        for name in ("one", "two"):
            command = [sys.executable, "-c", WORKER, str(tmp_path), database, name]
            processes.append(stack.enter_context(subprocess.Popen(command, **pipes)))
        go_on(processes)  # one of them makes the tables
        queue = opened(tmp_path, database)
        sent = [queue.submit(new_render(frames)) for frames in (range(1, 41), range(41, 61))]
        go_on(processes)
        claimed = [json.loads(process.communicate()[0]) for process in processes]
    assert sorted(chain.from_iterable(claimed)) == list(range(1, 61))
    assert [state_of(queue.get(row.id)) for row in sent] == ["done", "done"]
    queue.close()
    present, known = revisions(tmp_path, database)
    assert present == known[0]


def test_a_server_that_comes_back_is_used_again(tmp_path, postgresql, postgresql_database):
    queue = opened(tmp_path, postgresql_database)
    sent = queue.submit(new_render([1, 2]))
    claim = queue.claim("one", 60.0)
    postgresql.stop()
    try:
        for call in (
            queue.totals.numbers,
            lambda: queue.finish(claim, FILES, 24.0),
            lambda: queue.submit(new_render([3])),
        ):
            with pytest.raises(OutputError, match="its database cannot be reached") as raised:
                call()
            assert raised.value.code == "queue_unusable"
    finally:
        postgresql.start()
    assert queue.finish(claim, FILES, 24.0)
    assert queue.claim("one", 60.0).frame == 2
    assert queue.get(sent.id).done == 1
    queue.close()


def test_a_server_that_goes_away_in_a_transaction_undoes_it(tmp_path, postgresql, postgresql_database):
    queue = opened(tmp_path, postgresql_database)
    sent = queue.submit(new_render([1]))
    queue.finish(queue.claim("one", 60.0), FILES, 24.0)
    try:
        with pytest.raises(OutputError, match="its database cannot be reached"):
            queue.remove(sent.id, postgresql.stop)
    finally:
        postgresql.start()
    assert queue.get(sent.id).done == 1
    queue.close()


def test_leases_go_by_the_clock_of_the_server(tmp_path, postgresql_database, monkeypatch):
    engine = open_database(tmp_path, postgresql_database)
    monkeypatch.setattr("time.time", lambda: 0.0)
    queue = RenderQueue(engine, EventLog(engine))
    queue.submit(new_render([1]))
    queue.claim("one", 60.0)
    with transaction(engine, only_reads=True) as session:
        now = time_of(session)
    ((task, (attempt,)),) = queue.tasks(queue.list(None, 1)[0].id)
    assert 1.7e9 < attempt.started_at <= now
    assert task.lease_until == pytest.approx(attempt.started_at + 60.0)
    queue.close()
