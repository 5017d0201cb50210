"""Frames that the workers of a Dask scheduler draw: `pullfocus worker` joins, is killed, and comes back."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

from render.errors import SettingsError
from service.http.settings import Settings
from service.jobs.dask_executor import DaskAddress
from tests.service.conftest import Running, running, send, until

pytestmark = pytest.mark.gl

SMALL = {"width": 32, "rays": 4, "engine": "pinhole"}
LARGE = {"width": 480, "rays": 100}


class Farm:
    """A scheduler and workers, each a process of its own.

    Args:
        folder: for their files.
    """

    def __init__(self, folder: Path):
        self._folder = folder
        self.processes: list[subprocess.Popen] = []
        program = (
            "import asyncio\nfrom distributed import Scheduler\nasync def main():\n"
            " async with Scheduler(host='127.0.0.1', port=0, dashboard=False, dashboard_address='127.0.0.1:0') as scheduler:\n"
            "  print(scheduler.address, flush=True)\n  await scheduler.finished()\nasyncio.run(main())"
        )
        scheduler = self._start([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
        self.address = scheduler.stdout.readline().strip()

    def join(self, name: str, *arguments: str) -> subprocess.Popen:
        """Start a worker."""
        command = [sys.executable, "-m", "render.cli", "worker", "--dask", self.address, "--name", name]
        return self._start([*command, "--folder", str(self._folder / name), *arguments])

    def close(self) -> None:
        """End all processes."""
        for process in reversed(self.processes):
            process.terminate()
        for process in self.processes:
            process.wait()

    def _start(self, command: list[str], **options) -> subprocess.Popen:
        log = (self._folder / f"{len(self.processes)}.log").open("w")
        self.processes.append(subprocess.Popen(command, stderr=log, **options))
        return self.processes[-1]


@pytest.fixture(scope="module")
def farm(tmp_path_factory) -> Iterator[Farm]:
    farm = Farm(tmp_path_factory.mktemp("farm"))
    yield farm
    farm.close()


@pytest.fixture(scope="module")
def service(farm, tmp_path_factory) -> Iterator[Running]:
    """A service that has its frames drawn by the farm."""
    with running(Settings(data=tmp_path_factory.mktemp("data"), demo=False, dask=farm.address)) as service:
        yield service


@pytest.fixture(scope="module")
def room(service, room_file) -> str:
    return send(service.client, "room.usda", room_file.read_bytes()).json()["id"]


def sent(service: Running, shot: str, **request) -> str:
    answer = service.client.post("/v1/renders", json=SMALL | {"shot": shot} | request)
    assert answer.status_code == 201, answer.text
    return f"/v1/renders/{answer.json()['id']}"


def wait_for(service: Running, render: str, is_there) -> dict:
    until(lambda: is_there(service.client.get(render).json()))
    return service.client.get(render).json()


def attempts_of(service: Running, render: str) -> list[list[tuple[str, str]]]:
    tasks = service.client.get(f"{render}/tasks").json()["tasks"]
    return [[(one["worker"], one["outcome"]) for one in task["attempts"]] for task in tasks]


def is_done(render: dict) -> bool:
    return render["state"] == "done"


def test_workers_draw_frames_as_the_service_does(farm, service, room):
    render = sent(service, room, frames="1-3", formats=["png"])
    worker = farm.join("one")  # it waited for one
    wait_for(service, render, is_done)
    assert attempts_of(service, render) == [[("one", "done")]] * 3
    own = service.client.get(f"/v1/shots/{room}/frame", params=SMALL | {"time": 2})
    assert service.client.get(f"{render}/frames/2").content == own.content
    assert service.client.get("/v1/renders").json()["renders"][0]["failed"] == 0
    log = service.client.get(f"{render}/frames/2/log").text
    assert log.count("load scene: ") == 1
    assert str(service.settings.data) not in log
    assert log.index("by worker one") < log.index("encode: ") < log.index("stored png: ")
    assert worker.poll() is None


def test_what_cannot_be_drawn_fails_with_its_reason(service, room):
    render = sent(service, room, frames="1", camera="/World/none")
    failed = wait_for(service, render, lambda now: now["state"] == "failed")
    assert failed["failed"] == 1
    (task,) = service.client.get(f"{render}/tasks").json()["tasks"]
    assert "/World/none" in task["attempts"][0]["error"]
    assert len(task["attempts"]) == 1  # another worker could not either


def test_a_killed_worker_loses_no_frame(farm, service, room):
    render = sent(service, room, frames="1-4", **LARGE)
    wait_for(service, render, lambda now: now["running"] == 2)
    killed = farm.processes[-1]
    family = psutil.Process(killed.pid).children(recursive=True)
    assert family
    killed.kill()
    killed.wait()
    farm.join("two")
    wait_for(service, render, is_done)
    attempts = attempts_of(service, render)
    assert all(tries[-1][1] == "done" for tries in attempts)
    assert any(tries[0] == ("one", "lost") and tries[-1][0] == "two" for tries in attempts)
    until(lambda: not any(one.is_running() and one.status() != psutil.STATUS_ZOMBIE for one in family))


def test_a_canceled_render_is_given_up_by_its_worker(farm, service, room, monkeypatch):
    monkeypatch.setattr("service.http.render_runner.LEASE_S", 1.0)
    render = sent(service, room, frames="1-9", **LARGE | {"rays": 4096})
    wait_for(service, render, lambda now: now["running"] == 2)
    until(lambda: "load scene: " in service.client.get(f"{render}/frames/1/log").text)  # while it is drawn
    service.client.post(f"{render}/cancel")
    wait_for(service, render, lambda now: now["state"] == "canceled")
    after = sent(service, room, frames="7")
    wait_for(service, after, is_done)  # the worker is free again


def test_a_worker_leaves_when_it_is_told(farm, service):
    leaving = farm.processes[-1]
    leaving.send_signal(signal.SIGTERM)
    assert leaving.wait() == 0


def test_a_folder_has_one_worker(farm, tmp_path):
    farm.join("three")
    folder = farm._folder / "three"
    until(lambda: (folder / "shots").exists())
    command = [sys.executable, "-m", "render.cli", "worker", "--dask", farm.address, "--folder", str(folder)]
    refused = subprocess.run(command, capture_output=True, text=True, check=False)
    assert refused.returncode == 1
    assert "--folder" in refused.stderr


def test_a_cluster_of_this_machine_draws(tmp_path, room_file):
    with running(Settings(data=tmp_path, demo=False, dask="local:1")) as service:
        shot = send(service.client, "room.usda", room_file.read_bytes()).json()["id"]
        render = sent(service, shot, frames="1-2")
        wait_for(service, render, is_done)
        assert attempts_of(service, render) == [[("0", "done")]] * 2
        (nanny,) = [one for one in psutil.Process().children() if "spawn" in " ".join(one.cmdline())] or [None]
    if nanny is not None:
        until(lambda: not nanny.is_running() or nanny.status() == psutil.STATUS_ZOMBIE)


@pytest.mark.parametrize(
    "text", ["farm", "http://farm:80", "tcp://farm", "local:0", "local:x", "tcp://:1:2", "tcp:// :1"]
)
def test_addresses_of_other_kinds_are_refused(text):
    with pytest.raises(SettingsError, match="address of Dask"):
        DaskAddress.parse(text)


def test_addresses_are_read():
    assert DaskAddress.parse("local") == DaskAddress(None, 1)
    assert DaskAddress.parse("local:4") == DaskAddress(None, 4)
    assert DaskAddress.parse("tls://farm.example:8786") == DaskAddress("tls://farm.example:8786")


def test_a_worker_needs_a_scheduler():
    command = [sys.executable, "-m", "render.cli", "worker", "--dask", "local"]
    refused = subprocess.run(command, capture_output=True, text=True, check=False, env=os.environ)
    assert refused.returncode == 2
    assert "tcp://HOST:PORT" in refused.stderr
