"""A run: editors at work, one fault after the other, and what must hold after each and at the end."""

from __future__ import annotations

import random
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

import httpx

from tests.faults.disk import make_disk
from tests.faults.editor import Editor, Log, Visitor, new_client
from tests.faults.events import Faults
from tests.faults.folder_checks import faults_of_folder
from tests.faults.service_process import ServiceProcess
from tests.service.conftest import ROOM, send

SHOTS = 3
HEAL_S = 90.0
"""Time after a fault within which the service is ready again, without a restart."""
PAUSE_S = 1.0
"""Work between two faults, at the most."""


class Run:
    """Clients of a service, each in a thread of its own, which can be paused.

    Args:
        service: that they use.
        seed: chooses their steps.
        log: of the run.
    """

    def __init__(self, service: ServiceProcess, seed: int, log: Log) -> None:
        self._service = service
        self._log = log
        client = new_client(service.address)
        shots = [send(client, "room.usda", ROOM.encode()).json()["id"] for _ in range(SHOTS)]
        self._clients = [
            *(Editor(new_client(service.address), shot, seed + n, log) for n, shot in enumerate(shots)),
            Visitor(new_client(service.address), log),
        ]
        self._locks = [threading.Lock() for _ in self._clients]
        self._is_over = threading.Event()
        self._shot = shots[0]
        self.faults_begun = 0

    @contextmanager
    def working(self) -> Iterator[None]:
        """Let the clients work, and ask whether the service is ready all the while."""
        threads = [
            threading.Thread(target=self._work, args=each) for each in zip(self._clients, self._locks, strict=True)
        ]
        threads.append(threading.Thread(target=self._watch_readiness))
        for thread in threads:
            thread.start()
        try:
            yield
        finally:
            self._is_over.set()
            for thread in threads:
                thread.join()

    def check(self, after: str) -> None:
        """See that the service is ready again, and that all is there that was acknowledged."""
        with ExitStack() as paused:
            for lock in self._locks:
                paused.enter_context(lock)
            until = time.monotonic() + HEAL_S
            while self._ready() != 200:
                if time.monotonic() > until:
                    self._log.find(f"the service is not ready {HEAL_S:g} s after: {after}")
                    self._service.kill()
                    self._service.start()
                    return
                time.sleep(0.1)
            for failure in self._failures():
                self._log.find(f"after {after}, /readyz says 200 and {failure}")
            for client in self._clients:
                if not client.compare():
                    self._log.find(f"after {after}, the edits cannot be read")

    def _work(self, client: Editor | Visitor, lock: threading.Lock) -> None:
        while not self._is_over.is_set():
            with lock:
                client.step()
            time.sleep(0.01)

    def _watch_readiness(self) -> None:
        """Whenever the service says that it is ready, and no fault comes between, requests succeed."""
        while not self._is_over.is_set():
            begun = self.faults_begun
            self._log.count("readyz")
            if begun % 2 == 0 and self._ready() == 200:
                failures = self._failures()
                if failures and self.faults_begun == begun:
                    self._log.find(f"/readyz said 200 and {failures[0]}")
            time.sleep(0.2)

    def _ready(self) -> int:
        try:
            return httpx.get(f"{self._service.address}/readyz", timeout=HEAL_S).status_code
        except httpx.TransportError:
            return 0

    def _failures(self) -> list[str]:
        """Ask for what needs a worker of each kind. Returns what failed."""
        failures = []
        pixel = {"time": 1, "width": 160, "height": 90, "x": 60, "y": 45}
        for method, path, body in (("GET", "", None), ("GET", "/frame?time=1&width=8", None), ("POST", "/pick", pixel)):
            try:
                url = f"{self._service.address}/v1/shots/{self._shot}{path}"
                answer = httpx.request(method, url, json=body, timeout=HEAL_S)
                if answer.status_code != 200:
                    failures.append(f"{method} shot{path}: {answer.status_code} {answer.text[:200]}")
            except httpx.TransportError as error:
                failures.append(f"{method} shot{path}: {error!r}")
        return failures


def run_faults(folder: Path, seed: int, seconds: float, only: Sequence[str] = ()) -> Log:
    """Run a service under faults.

    Args:
        folder: an empty one.
        seed: chooses faults and steps; threads and processes take their own time, so that no two runs are the same.
        seconds: for which faults are made.
        only: faults to make, each once and in this order; all of them at random where it is empty.
    """
    log = Log()
    disk = make_disk(folder / "disk")
    service = ServiceProcess(folder, disk.folder / "data")
    service.start()
    try:
        run, faults = Run(service, seed, log), Faults(service, disk, seed, log).all()
        with run.working():
            for name in [name for name in only if name in faults] or _at_random(list(faults), seed, seconds):
                time.sleep(random.Random(f"{seed} {run.faults_begun}").uniform(0, PAUSE_S))
                run.faults_begun += 1  # odd while a fault lasts
                faults[name]()
                log.count(name)
                run.check(name)
                run.faults_begun += 1
        service.shift_clock(0.0)
        service.kill()
        service.start()
        run.check("the end")
        for fault in faults_of_folder(service.data):
            log.find(fault)
    finally:
        service.kill()
    for orphan in service.orphans:
        log.find(f"process {orphan} outlived the service")
    log.counts["tracebacks in the service's log"] = service.count_in_log("Traceback")
    return log


def _at_random(names: list[str], seed: int, seconds: float) -> Iterator[str]:
    choose, until = random.Random(seed), time.monotonic() + seconds
    while time.monotonic() < until:
        yield choose.choice(names)
