"""Two services over one PostgreSQL and one bucket: one queue, whose renders either draws, and either may be killed."""

from __future__ import annotations

import json
import sys
from contextlib import contextmanager

import httpx
import pytest

from service.bench.chaos.parts import Part, free_port
from service.http import render_runner
from service.http.settings import Settings
from service.storage.bucket import Bucket
from tests.service.conftest import running, send, until

pytestmark = pytest.mark.gl

SMALL = {"width": 32, "rays": 4, "engine": "pinhole"}


@pytest.fixture
def shared(postgresql_database, bucket) -> dict[str, str]:
    """The settings that both services have."""
    return {"database": postgresql_database, **bucket}


@contextmanager
def two_services(tmp_path, shared):
    with (
        running(Settings(data=tmp_path / "first", demo=False, **shared)) as first,
        running(Settings(data=tmp_path / "second", demo=False, **shared)) as second,
    ):
        yield first, second


def shot_of(client: httpx.Client, room_file) -> str:
    return send(client, "room.usda", room_file.read_bytes()).json()["id"]


def done(client: httpx.Client, render: str) -> bool:
    return client.get(f"/v1/renders/{render}").json()["state"] == "done"


def test_either_service_draws_and_shows_the_frames_of_both(tmp_path, shared, room_file, monkeypatch):
    with two_services(tmp_path, shared) as (first, second):
        shot = shot_of(first.client, room_file)
        monkeypatch.setattr(
            first.internal.renders, "claim", lambda *_: None
        )  # it is busy; only the other one draws from here on
        request = SMALL | {"shot": shot, "frames": "1-3", "formats": ["png", "exr"]}
        render = first.client.post("/v1/renders", json=request).json()["id"]
        until(lambda: done(first.client, render))
        tasks = second.client.get(f"/v1/renders/{render}/tasks").json()["tasks"]
        own = first.client.get(f"/v1/shots/{shot}/frame", params=SMALL | {"time": 2})
        report = first.client.get(f"/v1/renders/{render}/focus-report").json()
        for service in (first, second):
            assert service.client.get(f"/v1/renders/{render}/frames/2?format=png").content == own.content
            assert service.client.get(f"/v1/renders/{render}/contact-sheet").status_code == 200
            assert service.client.get(f"/v1/renders/{render}/focus-report").json() == report
        assert {attempt["outcome"] for task in tasks for attempt in task["attempts"]} == {"done"}
        assert second.client.get(f"/v1/shots/{shot}").status_code == 404  # shots are each service's own

        opened = Bucket(shared["bucket"], shared["bucket_endpoint"])
        assert len(opened.sizes("renders")) == 9  # three files of each frame
        opened.delete(f"renders/{render}/{name}" for name in opened.sizes(f"renders/{render}") if name.startswith("3."))
        assert second.client.post(f"/v1/renders/{render}/retry").json()["ready"] == 1
        until(lambda: done(second.client, render))
        assert second.client.delete(f"/v1/renders/{render}").status_code == 204
        assert opened.sizes("renders") == {}


def test_a_bucket_that_is_gone_is_said_and_waited_for(tmp_path, shared, room_file, monkeypatch):
    with running(Settings(data=tmp_path / "one", demo=False, **shared)) as service:
        shot = shot_of(service.client, room_file)
        with monkeypatch.context() as patch:
            gone = Bucket(shared["bucket"], "http://127.0.0.1:1")
            patch.setattr(service.internal.shared.bucket, "_store", gone._store)
            refused = service.client.post("/v1/renders", json=SMALL | {"shot": shot, "frames": "1"})
            assert (refused.status_code, refused.json()["code"]) == (503, "bucket_unusable")
            ready = service.client.get("/readyz")
            assert (ready.status_code, ready.json()["code"]) == (503, "not_ready")
            assert "bucket of renders cannot be used" in ready.json()["detail"]
        assert service.client.get("/readyz").status_code == 200
        assert service.client.post("/v1/renders", json=SMALL | {"shot": shot, "frames": "1"}).status_code == 201


def test_frames_wait_for_a_bucket_that_is_gone(tmp_path, shared, room_file, monkeypatch, caplog):
    monkeypatch.setattr(render_runner, "BUSY_PAUSE_S", 0.01)
    monkeypatch.setattr(render_runner, "ROOM_PAUSE_S", 0.01)
    gone = Bucket(shared["bucket"], "http://127.0.0.1:1")
    with two_services(tmp_path, shared) as (first, second):
        shot = shot_of(first.client, room_file)
        monkeypatch.setattr(first.internal.renders, "claim", lambda *_: None)
        with monkeypatch.context() as patch:
            patch.setattr(second.internal.shared.bucket, "_store", gone._store)
            request = SMALL | {"shot": shot, "frames": "1-2", "formats": ["png"]}
            render = first.client.post("/v1/renders", json=request).json()["id"]
            until(lambda: caplog.text.count("cannot be begun now: the bucket") > 3)  # it does not have the shot
        until(lambda: done(first.client, render))
        caplog.clear()
        with monkeypatch.context() as patch:
            patch.setattr(second.internal.shared.bucket, "_store", gone._store)
            again = first.client.post("/v1/renders", json=request).json()["id"]
            until(lambda: "cannot be stored now" in caplog.text)
        until(lambda: done(first.client, again))
        for one in (render, again):
            tasks = first.client.get(f"/v1/renders/{one}/tasks").json()["tasks"]
            assert {attempt["outcome"] for task in tasks for attempt in task["attempts"]} == {"done"}


def test_without_a_bucket_each_service_draws_its_own(tmp_path, postgresql_database, room_file):
    with two_services(tmp_path, {"database": postgresql_database}) as (first, second):
        sent = {}
        for service in (first, second):
            shot = shot_of(service.client, room_file)
            answer = service.client.post(
                "/v1/renders", json=SMALL | {"shot": shot, "frames": "1-2", "formats": ["png"]}
            )
            sent[service] = answer.json()["id"]
        for service, other in ((first, second), (second, first)):
            until(lambda service=service: done(service.client, sent[service]))
            assert service.client.get(f"/v1/renders/{sent[service]}/frames/1").status_code == 200
            refused = other.client.get(f"/v1/renders/{sent[service]}/frames/1")
            assert (refused.status_code, refused.json()["code"]) == (409, "other_service")


def is_up(client: httpx.Client) -> bool:
    try:
        return client.get("/livez").status_code == 200
    except httpx.TransportError:
        return False


def test_either_service_may_be_killed(tmp_path, shared, room_file):
    parts, clients = [], []
    for name in ("first", "second"):
        port = free_port()
        settings = shared | {"data": str(tmp_path / name), "port": port, "demo": False}
        file = tmp_path / f"{name}.toml"
        file.write_text("".join(f"{key} = {json.dumps(value)}\n" for key, value in settings.items()))
        command = [sys.executable, "-m", "render.cli", "serve", "--log-format", "text", "--config", str(file)]
        parts.append(Part(name, command, tmp_path / f"{name}.log"))
        clients.append(httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60))
    first, second = clients
    try:
        for part, client in zip(parts, clients, strict=True):
            part.tend()
            until(lambda part=part, client=client: (part.tend(), is_up(client))[1])
        request = {"width": 480, "rays": 64, "frames": "1-8", "formats": ["png"], "shot": shot_of(first, room_file)}
        render = first.post("/v1/renders", json=request).json()["id"]
        until(lambda: second.get(f"/v1/renders/{render}").json()["done"] >= 1)
        parts[0].kill()  # the one that has the shot, and perhaps a frame under way
        until(lambda: second.get(f"/v1/renders/{render}").json()["done"] >= 4)
        parts[0].tend()
        until(lambda: (parts[0].tend(), is_up(first))[1])  # it takes back what it held, at once
        parts[1].kill()
        parts[1].tend()
        until(lambda: done(first, render))
        frames = [first.get(f"/v1/renders/{render}/frames/{frame}") for frame in range(1, 9)]
        assert {frame.headers["content-type"] for frame in frames} == {"image/png"}
        tasks = first.get(f"/v1/renders/{render}/tasks").json()["tasks"]
        assert [[attempt["outcome"] for attempt in task["attempts"]].count("done") for task in tasks] == [1] * 8
    finally:
        for client in clients:
            client.close()
        for part in parts:
            part.stop()
