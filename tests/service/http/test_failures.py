"""Failures other than bad input: a full disk, a fault of the program, a machine without GL."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
import time

from service.http.settings import Settings
from service.storage.store import ShotStore
from tests.service.conftest import ROOM, running, send, until

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


WITH_A_WORKER = """
import time
from tests.service.workers.fake_work import Tally, process_id
from service.workers.calls import call
from service.workers.process import WorkerProcess
if __name__ == "__main__":
    worker = WorkerProcess("orphan", Tally)
    print(worker.call(call(process_id), 60), flush=True)
    time.sleep(60)
"""


def test_a_worker_does_not_outlive_a_killed_service(tmp_path):
    script = tmp_path / "parent.py"
    script.write_text(WITH_A_WORKER)
    command = [sys.executable, str(script)]
    environment = os.environ | {"PYTHONPATH": os.getcwd()}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as parent:
        worker_id = int(parent.stdout.readline())
        assert is_running(worker_id)
        parent.kill()
    until(lambda: not is_running(worker_id))


def is_running(process_id: int) -> bool:
    """Whether a process is there and no zombie."""
    time.sleep(0.02)
    try:
        with open(f"/proc/{process_id}/stat") as stat:
            return stat.read().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False
