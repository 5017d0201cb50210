"""Shots apart from each other: what one does to its workers, or asks of them, is of no concern to others."""

from __future__ import annotations

import os
import signal
import socket
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace

import pytest

from service.http.settings import Settings
from service.workers.places import Place
from service.workers.process import WorkerProcess
from tests.service.conftest import ROOM, is_running, running, send, until

DEAR = {"time": 1, "width": 1280, "height": 720, "rays": 3000}
CHEAP = {"time": 1, "width": 64, "height": 36, "rays": 4}


@pytest.fixture
def another(client, room_file):
    """A second shot."""
    shot = send(client, "another.usda", room_file.read_bytes()).json()["id"]
    yield shot
    client.delete(f"/v1/shots/{shot}")


@contextmanager
def asking(client, room, **parameters) -> Iterator[None]:
    """Ask for a frame over a connection that is closed at the end."""
    query = "&".join(f"{name}={value}" for name, value in parameters.items())
    with socket.create_connection((client.base_url.host, client.base_url.port)) as connection:
        connection.sendall(f"GET /v1/shots/{room}/frame?{query} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode())
        yield


def test_workers_serve_one_shot_each(service, client, room, another):
    for shot in (room, another):
        assert client.get(f"/v1/shots/{shot}").status_code == 200
        assert client.get(f"/v1/shots/{shot}/frame", params=CHEAP).status_code == 200
    for shot, other in ((room, another), (another, room)):
        for role in ("stage", "final"):
            assert service.worker(role, shot) != service.worker(role, other)
    for process in service.internal.pool.processes():
        seen = {path.parts[-2] for path in process.place.read}
        products = {"renders"} if process.place.key is None else set()  # a worker that makes a movie of stored frames
        assert seen <= {process.place.key} | products


def test_work_on_a_frame_ends_when_its_client_has_gone(service, client, room):
    lane = service.internal.lanes.long
    with asking(client, room, **DEAR, seed=1):
        until(lambda: lane.running == 1)
        with asking(client, room, **DEAR, seed=2):
            until(lambda: lane.waiting == 1)
        until(lambda: lane.waiting == 0)
    until(lambda: lane.running == 0)
    assert client.get(f"/v1/shots/{room}/frame", params=CHEAP | {"seed": 2}).status_code == 200


def test_a_dear_frame_delays_no_other(service, client, room, another):
    lane = service.internal.lanes.long
    with asking(client, room, **DEAR, seed=3):
        until(lambda: lane.running == 1)
        for shot in (another, room):  # the second one needs another process of the same shot
            assert client.get(f"/v1/shots/{shot}/frame", params=CHEAP | {"seed": 4}).status_code == 200
        until(lambda: lane.running == 1)  # the dear one
    until(lambda: lane.running == 0)


def test_a_long_reading_delays_no_edit_of_its_shot(service, client, room, monkeypatch):
    curve, camera = f"/v1/shots/{room}/focus-curve", f"/v1/shots/{room}/camera"
    before = client.get(curve, params={"frames": "1"}).json()
    reader = service.worker("read", room)
    monkeypatch.setattr(WorkerProcess, "is_alive", lambda worker: True)  # a stopped one would be replaced
    os.kill(reader, signal.SIGSTOP)
    with ThreadPoolExecutor() as threads:
        try:
            waiting = threads.submit(client.get, curve, params={"frames": "1"})
            until(lambda: service.internal.lanes.read.running == 1)
            assert client.patch(camera, json={"fStop": 11}).status_code == 200
            assert client.get(camera, params={"time": 1}).status_code == 200
            assert not waiting.done()
        finally:
            os.kill(reader, signal.SIGCONT)
        assert waiting.result().json() == before
    assert client.get(curve, params={"frames": "1"}).json() != before


def test_a_worker_killed_while_idle_costs_nobody_an_error(service, client, room):
    assert client.get(f"/v1/shots/{room}").status_code == 200
    assert client.get(f"/v1/shots/{room}/frame", params=CHEAP | {"seed": 6}).status_code == 200
    for role in ("stage", "final"):
        worker = service.worker(role, room)
        os.kill(worker, signal.SIGKILL)
        until(lambda worker=worker: not is_running(worker))
    assert client.get(f"/v1/shots/{room}").status_code == 200
    assert client.get(f"/v1/shots/{room}/frame", params=CHEAP | {"seed": 7}).status_code == 200


def test_a_shot_that_ends_workers_is_put_in_quarantine(tmp_path):
    settings = Settings(data=tmp_path, demo=False, max_blames=2)
    with running(settings) as service:
        client = service.client
        shot = send(client, "room.usda", ROOM.encode()).json()["id"]
        for attempt in range(2):
            with ThreadPoolExecutor() as threads:
                lost = threads.submit(client.get, f"/v1/shots/{shot}/frame", params=DEAR | {"seed": attempt})
                until(lambda: service.internal.lanes.long.running == 1)
                os.kill(service.working("long", shot), signal.SIGSEGV)
                assert (lost.result().status_code, lost.result().json()["code"]) == (422, "unfit")
        for path in ("", "/frame?time=1&width=8", "/inspect", "/meter?time=1"):
            refusal = client.get(f"/v1/shots/{shot}{path}")
            assert (refusal.status_code, refusal.json()["code"]) == (423, "quarantined")
            assert "damaged" in refusal.json()["detail"]
    with running(settings) as service:  # which it survives
        client = service.client
        assert client.get(f"/v1/shots/{shot}").status_code == 423
        listed = client.get("/v1/shots").json()["shots"]
        assert "damaged" in listed[0]["quarantine"]
        assert client.delete(f"/v1/shots/{shot}/quarantine").status_code == 204
        assert client.get(f"/v1/shots/{shot}").json()["quarantine"] is None


def test_an_upload_that_needs_too_much_memory_is_refused(tmp_path):
    settings = Settings(data=tmp_path, demo=False, check_memory_mb=512)
    points = ", ".join(["(1.25, 2.5, 3.75)"] * 3_000_000)
    greedy = ROOM.replace("[(-1, -0.6, -3), (0, -0.6, -3), (0, 0.6, -3), (-1, 0.6, -3)]", f"[{points}]")
    with running(replace(settings, max_upload_mb=128)) as service:
        refusal = send(service.client, "greedy.usda", greedy.encode())
        assert (refusal.status_code, refusal.json()["code"]) == (422, "stage_unreadable")
        assert "memory" in refusal.json()["detail"]
        assert list((tmp_path / "shots").iterdir()) == []
        assert send(service.client, "room.usda", ROOM.encode()).status_code == 201


def test_a_place_without_a_shot_sees_none(service):
    assert service.internal.place_of(None) == Place()
