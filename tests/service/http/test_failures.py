"""Failures other than bad input: a full disk, a fault of the program, a machine without GL."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys

import pytest

from service.http.settings import Settings
from service.storage.store import ShotStore
from tests.service.conftest import ROOM, is_running, running, send, until

SHAPE = {"code", "detail", "path", "errors"}


def test_a_full_disk_is_reported_and_nothing_is_left(service, client, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    kept = list((service.settings.data / "shots").iterdir())
    monkeypatch.setattr("service.http.routes.shots.store_upload", full)
    answer = send(client, "room.usda", ROOM.encode())
    assert (answer.status_code, answer.json()["code"]) == (507, "disk_full")
    assert set(answer.json()) == SHAPE
    assert list((service.settings.data / "shots").iterdir()) == kept


def test_an_edit_that_cannot_be_saved_changes_nothing(service, client, room):
    shot, folder = f"/v1/shots/{room}", service.settings.data / "shots" / room / "edits"
    first = {"type": "setCamera", "values": {"fStop": 4}}
    assert client.post(f"{shot}/edits", json={"changes": [first]}).status_code == 200
    before = client.get(f"{shot}/edits").text, client.get(f"{shot}/edits/history").json()
    second = {"changes": [{"type": "setCamera", "values": {"fStop": 5}}]}
    for name in ("history", "edits.usda"):
        (folder / name).rename(folder / "aside")
        (folder / name).touch() if name == "history" else (folder / name).mkdir()
        answer = client.post(f"{shot}/edits", json=second)
        (folder / name).unlink() if name == "history" else (folder / name).rmdir()
        (folder / "aside").rename(folder / name)
        assert answer.status_code == 507, answer.text
        assert str(service.settings.data) not in answer.text
        assert (client.get(f"{shot}/edits").text, client.get(f"{shot}/edits/history").json()) == before
    assert client.post(f"{shot}/edits", json=second).status_code == 200


def test_a_service_without_room_for_the_demo_runs(tmp_path, monkeypatch, caplog):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(ShotStore, "begin", full)
    with running(Settings(data=tmp_path)) as service:
        assert service.client.get("/v1/shots").json() == {"shots": []}
    assert "the service runs without it: [Errno 28] No space left on device" in caplog.text


def test_a_fault_of_the_program_has_the_shape_and_tells_no_secrets(client, monkeypatch):
    def faulty(_):
        raise RuntimeError("the secret is 42")

    with monkeypatch.context() as patch:
        patch.setattr(ShotStore, "list", faulty)
        answer = client.get("/v1/shots")
    assert (answer.status_code, answer.json()["code"]) == (500, "internal")
    assert answer.headers.get("connection") != "close"
    assert set(answer.json()) == SHAPE
    assert "42" not in answer.text
    assert client.get("/v1/shots").status_code == 200


def test_without_gl_all_but_pictures_works(tmp_path, monkeypatch):
    monkeypatch.setenv("PYOPENGL_PLATFORM", "egl")
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent.json")  # the loader finds no driver
    with running(Settings(data=tmp_path, demo=False)) as service:
        shot = send(service.client, "room.usda", ROOM.encode()).json()["id"]
        for path in (f"/v1/shots/{shot}/frame?time=1&width=8", "/readyz"):
            answer = service.client.get(path)
            assert (answer.status_code, answer.json()["code"]) == (503, "graphics")
        assert service.client.get(f"/v1/shots/{shot}/readout", params={"time": 1}).status_code == 200


WITH_A_BUSY_WORKER = """
import time
from tests.service.workers.fake_work import echo, process_id
from tests.service.workers.kit import tally_lane, tally_pool
from service.workers.calls import call
if __name__ == "__main__":
    with tally_pool() as pool, tally_lane(pool) as lane:
        worker_id = lane.submit(call(process_id)).result(60)
        print(pool.template.pid, worker_id, flush=True)
        lane.submit(call(echo, pause_s=60))
        time.sleep(60)
"""


@pytest.mark.parametrize("is_stopped", [False, True], ids=["running", "stopped"])
def test_busy_workers_do_not_outlive_a_killed_service(tmp_path, is_stopped):
    script = tmp_path / "parent.py"
    script.write_text(WITH_A_BUSY_WORKER)
    command = [sys.executable, str(script)]
    environment = os.environ | {"PYTHONPATH": os.getcwd()}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as parent:
        processes = [int(word) for word in parent.stdout.readline().split()]
        assert all(is_running(process) for process in processes)
        if is_stopped:
            for process in processes:
                os.kill(process, signal.SIGSTOP)
        parent.kill()
    until(lambda: not any(is_running(process) for process in processes))
