"""Faults of a run. Each is made, lasts for a while and is over when its function returns; the service may need longer."""

from __future__ import annotations

import os
import random
import signal
import time
from collections.abc import Callable
from contextlib import suppress
from email.utils import parsedate_to_datetime

import httpx

from tests.faults.disk import Disk
from tests.faults.editor import Log
from tests.faults.service_process import ServiceProcess

DAY_S = 86_400.0
JUMPS_S = (-400 * DAY_S, -3600.0, 3600.0, 40 * DAY_S, 4000 * DAY_S)
DATE_S = 1.5
"""Time after which the server sends another date, s."""
READY_ASKED_S = 60.0
KINDS = ("read", "stage", "live", "final")


class Faults:
    """Makes faults.

    Args:
        service: that they happen to.
        disk: of its data.
        seed: chooses them.
        log: of the run.
    """

    def __init__(self, service: ServiceProcess, disk: Disk, seed: int, log: Log) -> None:
        self._service = service
        self._disk = disk
        self._random = random.Random(seed)
        self._log = log

    def all(self) -> dict[str, Callable[[], None]]:
        """Return the faults that can be made on this machine, by name."""
        faults: dict[str, Callable[[], None]] = {}
        for kind in KINDS:
            faults[f"kill {kind}"] = lambda kind=kind: self._signal(kind, signal.SIGKILL)
            faults[f"stop {kind}"] = lambda kind=kind: self._signal(kind, signal.SIGSTOP)
        faults["kill template"] = self._kill_template
        faults["stop template"] = self._stop_template
        faults["kill service"] = self._kill_service
        faults["kill service after a stop"] = self._kill_stopped_service
        if self._service.has_clock:
            faults["set clock"] = self._set_clock
        if self._disk.can_fill:
            faults["full disk"] = self._fill_disk
            faults["kill service on a full disk"] = self._kill_on_full_disk
        return faults

    def _signal(self, kind: str, number: int) -> None:
        workers = self._await_workers(kind)
        for pid in workers:
            _kill(pid, number)
        if number == signal.SIGSTOP:
            time.sleep(self._random.uniform(0.2, 3))
            for pid in workers:
                _kill(pid, signal.SIGCONT)
        self._log.count(f"signalled {kind}" if workers else f"no {kind} worker")

    def _await_workers(self, kind: str) -> list[int]:
        until = time.monotonic() + 3.0
        while not (workers := self._service.workers(kind)) and time.monotonic() < until:
            time.sleep(0.002)
        return workers

    def _kill_template(self) -> None:
        pid = self._service.template()
        if pid:
            _kill(pid, signal.SIGKILL)

    def _stop_template(self) -> None:
        """Stop the template: the service says that it is not ready, and replaces it."""
        pid = self._service.template()
        if pid is None:
            return
        _kill(pid, signal.SIGSTOP)
        self._expect_not_ready("the template is stopped")
        _kill(pid, signal.SIGCONT)

    def _kill_service(self) -> None:
        time.sleep(self._random.uniform(0, 0.5))  # at any point of what the editors do
        self._service.kill()
        self._service.start()

    def _kill_stopped_service(self) -> None:
        pid = self._service.template()
        if pid:
            _kill(pid, signal.SIGSTOP)
        self._kill_service()

    def _set_clock(self) -> None:
        shift_s = self._random.choice(JUMPS_S)
        self._service.shift_clock(shift_s)
        time.sleep(DATE_S)
        date = httpx.get(f"{self._service.address}/livez", timeout=READY_ASKED_S).headers["date"]
        if abs(parsedate_to_datetime(date).timestamp() - time.time() - shift_s) > READY_ASKED_S:
            self._log.find(f"the clock of the service says {date} after it was shifted by {shift_s:g} s")

    def _fill_disk(self) -> None:
        with self._disk.full():
            self._expect_not_ready("the disk is full")
            time.sleep(self._random.uniform(0.5, 3))

    def _kill_on_full_disk(self) -> None:
        with self._disk.full():
            time.sleep(self._random.uniform(0, 1))
            self._service.kill()
            self._service.start()
            self._expect_not_ready("it started on a full disk")
            time.sleep(self._random.uniform(0.5, 2))

    def _expect_not_ready(self, why: str) -> None:
        with suppress(httpx.TransportError):
            if httpx.get(f"{self._service.address}/readyz", timeout=READY_ASKED_S).status_code == 200:
                self._log.find(f"/readyz says 200 while {why}")


def _kill(pid: int, number: int) -> None:
    with suppress(ProcessLookupError):
        os.kill(pid, number)
