"""The end of `pullfocus serve`: what was begun ends, what is new is refused, and no process is left."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import httpx
import pytest
from PIL import Image
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from tests.service.conftest import ROOM, is_running, send, until

SLOW = {"time": 1, "width": 1600, "rays": 200}


@dataclass(frozen=True)
class Served:
    """A service in a process of its own."""

    process: subprocess.Popen
    client: httpx.Client
    shot: str

    def descendants(self) -> list[int]:
        """Process ids of its template and of all workers."""
        found, todo = [], [self.process.pid]
        while todo:
            parent = todo.pop()
            for task in Path(f"/proc/{parent}/task").iterdir():
                children = [int(child) for child in (task / "children").read_text().split()]
                found += children
                todo += children
        return found

    def is_busy(self) -> bool:
        return (
            re.search(r"pullfocus_lane_running{lane=\"(final|long)\"} 1.0", self.client.get("/metrics").text)
            is not None
        )


@contextmanager
def served(folder: Path, **settings: object) -> Iterator[Served]:
    config = folder / "config.toml"
    config.write_text("".join(f"{name} = {json.dumps(value)}\n" for name, value in settings.items()))
    command = [sys.executable, "-m", "render.cli", "serve", "--port", "0", "--no-demo", "--data", str(folder / "data")]
    with subprocess.Popen([*command, "--config", str(config)], stderr=subprocess.PIPE, text=True) as process:
        try:
            address = re.search(r"http://\S+/", next(line for line in process.stderr if "http://" in line))[0]
            threading.Thread(target=process.stderr.read, daemon=True).start()
            with httpx.Client(base_url=address, timeout=120) as client:
                yield Served(process, client, send(client, "room.usda", ROOM.encode()).json()["id"])
        finally:
            process.kill()


@contextmanager
def slow_frame(service: Served) -> Iterator:
    """Ask for a frame of some seconds; yields the future answer once it is being drawn."""
    with ThreadPoolExecutor() as threads:
        answer = threads.submit(
            lambda: httpx.get(service.client.base_url.join(f"/v1/shots/{service.shot}/frame"), params=SLOW, timeout=600)
        )
        until(lambda: service.is_busy() or answer.done())
        assert not answer.done(), answer.result().text
        yield answer


def test_a_frame_in_progress_ends_before_the_service(tmp_path):
    with served(tmp_path, stop_grace_s=600) as service, slow_frame(service) as frame:
        processes = service.descendants()
        assert len(processes) >= 2
        address = str(service.client.base_url.join(f"/v1/shots/{service.shot}/live")).replace("http", "ws")
        with connect(address) as viewer:
            service.process.send_signal(signal.SIGTERM)
            with pytest.raises(ConnectionClosed) as closed:
                viewer.recv(30)
        assert closed.value.rcvd.code == 1012
        for path in ("/readyz", "/v1/shots"):
            refused = service.client.get(path)
            assert (refused.status_code, refused.json()["code"]) == (503, "stopping")
            assert int(refused.headers["retry-after"]) > 0
        with pytest.raises(InvalidStatus, match="503"):
            connect(address)
        assert service.client.get("/livez").status_code == 200
        assert not frame.done()
        picture = frame.result(600)
        assert picture.status_code == 200, picture.text
        assert Image.open(BytesIO(picture.content)).convert("RGB").width == SLOW["width"]
        assert service.process.wait(30) == 0
        until(lambda: not any(is_running(process) for process in processes))


def test_a_second_signal_ends_the_service_at_once(tmp_path):
    with served(tmp_path, stop_grace_s=600) as service, slow_frame(service) as frame:
        processes = service.descendants()
        service.process.send_signal(signal.SIGTERM)
        until(lambda: service.client.get("/readyz").status_code == 503)
        assert service.process.poll() is None
        service.process.send_signal(signal.SIGTERM)
        assert service.process.wait(300) == -signal.SIGTERM
        with pytest.raises(httpx.TransportError):
            frame.result(30)
        until(lambda: not any(is_running(process) for process in processes))


def test_after_the_grace_what_goes_on_is_answered_503(tmp_path):
    with served(tmp_path, stop_grace_s=0.5) as service, slow_frame(service) as frame:
        service.process.send_signal(signal.SIGTERM)
        answer = frame.result(30)
        assert (answer.status_code, answer.json()["code"]) == (503, "stopping")
        assert service.process.wait(30) == 0
