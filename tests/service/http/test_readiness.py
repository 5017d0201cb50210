"""`/readyz`: 200 where the next piece of work can be done, else 503 with the reason."""

from __future__ import annotations

import errno
import os
import shutil
import signal
from collections import namedtuple
from contextlib import contextmanager

import pytest

from service.http import readiness
from service.workers import forking
from service.workers.lane import Lane
from service.workers.process import WorkerProcess
from tests.service.conftest import until


def refused(client) -> str:
    """Ask whether the service is ready; the reason why it is not."""
    answer = client.get("/readyz")
    assert (answer.status_code, answer.json()["code"]) == (503, "not_ready"), answer.text
    assert int(answer.headers["retry-after"]) > 0
    return answer.json()["detail"]


@pytest.fixture(autouse=True)
def ready_again(client):
    yield
    assert client.get("/readyz").json()["status"] == "ok"


def test_a_folder_that_takes_no_files_is_not_ready(service, client, monkeypatch):
    def read_only(**_):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(service.settings.data))

    before = sorted(service.settings.data.iterdir())
    assert client.get("/readyz").status_code == 200
    assert sorted(service.settings.data.iterdir()) == before
    with monkeypatch.context() as patch:
        patch.setattr(readiness.tempfile, "TemporaryFile", read_only)
        detail = refused(client)
    assert "Read-only file system" in detail
    assert str(service.settings.data) not in detail


def test_a_disk_that_is_nearly_full_is_not_ready(client, monkeypatch):
    usage = namedtuple("usage", "total used free")
    with monkeypatch.context() as patch:
        patch.setattr(shutil, "disk_usage", lambda _: usage(10**12, 10**12, 255 * 2**20))
        assert "255 MiB free" in refused(client)
        patch.setattr(shutil, "disk_usage", lambda _: usage(10**12, 10**12, 256 * 2**20))
        assert client.get("/readyz").status_code == 200


def test_a_lane_that_is_held_up_is_not_ready(service, client, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(Lane, "oldest_waiting_s", property(lambda lane: 61.0 if lane.role.name == "final" else 0.0))
        assert "final lane for 61 s" in refused(client)
        patch.setattr(Lane, "oldest_waiting_s", property(lambda _: 59.0))
        assert client.get("/readyz").status_code == 200


@contextmanager
def frozen(service, role):
    """Halt the workers of a role that serve no shot."""
    workers = [worker.pid for worker in service.internal.pool.processes() if worker.role.name == role]
    assert workers
    for worker in workers:
        os.kill(worker, signal.SIGSTOP)
    try:
        yield
    finally:
        for worker in workers:
            os.kill(worker, signal.SIGCONT)


@pytest.mark.parametrize(("role", "name"), [("stage", "stage worker"), ("live", "picture worker")])
def test_workers_that_do_not_answer_are_not_ready(service, client, monkeypatch, role, name):
    assert client.get("/readyz").status_code == 200
    with monkeypatch.context() as patch, frozen(service, role):
        patch.setattr(readiness, "ANSWER_WITHIN_S", 0.3)
        patch.setattr(WorkerProcess, "is_alive", lambda worker: True)  # a stopped one would be replaced
        assert refused(client) == f"The {name} did not answer within 0.3 s."


def test_a_template_that_does_not_fork_is_not_ready(service, client, monkeypatch):
    assert client.get("/readyz").status_code == 200
    with monkeypatch.context() as patch:
        patch.setattr(readiness, "ANSWER_WITHIN_S", 0.3)
        patch.setattr(forking, "ANSWER_S", 2.0)
        os.kill(service.internal.pool.template.pid, signal.SIGSTOP)
        assert refused(client) == "The template of the workers did not answer within 0.3 s."
        client.timeout = 5  # nor does anything else wait for it that needs no worker
        assert client.get("/metrics").status_code == client.get("/v1/shots").status_code == 200
        client.timeout = 120
        until(lambda: client.get("/readyz").status_code == 200)  # it was replaced
