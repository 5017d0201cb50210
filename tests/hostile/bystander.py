"""A client who works on a shot of its own while hostile files are sent: how much longer its requests take."""

from __future__ import annotations

import itertools
import threading
import time
from statistics import median

import httpx

from tests.hostile.corpus import Case

PAUSE_S = 0.5
ALONE = 8
"""Requests of each kind that are timed before the files are sent."""
TIMEOUT_S = 120.0
ADDRESS = "127.0.0.9"
"""The service takes it for another client than the one who sends the files."""


class Bystander:
    """Times a readout and a small picture of a harmless shot, again and again, in a thread of its own.

    Args:
        address: of the service.
        case: the harmless shot.

    Attributes:
        alone_s: times of each kind of request while nobody else asked for anything, s.
        beside_s: those in the context, s.
        failures: statuses of at least 400.
    """

    def __init__(self, address: httpx.URL, case: Case) -> None:
        transport = httpx.HTTPTransport(local_address=ADDRESS)
        self._client = httpx.Client(base_url=address, timeout=TIMEOUT_S, transport=transport)
        self._times = itertools.count(1)
        self.alone_s: dict[str, list[float]] = {}
        self.beside_s: dict[str, list[float]] = {}
        self.failures: list[int] = []
        sent = self._client.post("/v1/shots", files={"file": (case.file, case.content)})
        self._shot = f"/v1/shots/{sent.raise_for_status().json()['id']}"
        self._ask({})  # its workers start
        for _ in range(ALONE):
            self._ask(self.alone_s)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._work, name="bystander")

    def __enter__(self) -> Bystander:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()
        self._client.close()

    def delays_s(self) -> dict[str, float]:
        """Return the longest delay of each kind of request: what it took more than at the median alone, s."""
        return {kind: max(times) - median(self.alone_s[kind]) for kind, times in self.beside_s.items()}

    def _work(self) -> None:
        while not self._stop.wait(PAUSE_S):
            self._ask(self.beside_s)

    def _ask(self, times: dict[str, list[float]]) -> None:
        """Ask for what no cache has: each request is about a time of its own."""
        at = 1 + next(self._times) / 1000
        for kind, path in (("readout", "/readout?"), ("picture", "/frame?width=64&rays=8&layers=2&")):
            begun_s = time.monotonic()
            answer = self._client.get(f"{self._shot}{path}time={at:.3f}")
            times.setdefault(kind, []).append(time.monotonic() - begun_s)
            if answer.status_code >= 400:
                self.failures.append(answer.status_code)
