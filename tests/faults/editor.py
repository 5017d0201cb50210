"""Clients of a run: editors who know what their shot must have, and a visitor who uploads, looks and deletes."""

from __future__ import annotations

import random
import threading
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import httpx

from tests.faults.expected_history import ExpectedHistory, Step
from tests.service.conftest import ROOM

ANSWER_S = 120.0
"""Time after which a request counts as lost for good: more than any fault of a run lasts."""
MAY_FAIL = (503, 507)
"""Statuses of requests that a fault may cost."""


@dataclass
class Log:
    """Counts of a run, and what was found wrong."""

    counts: Counter[str] = field(default_factory=Counter)
    findings: list[str] = field(default_factory=list)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def count(self, name: str) -> None:
        """Count something."""
        with self._lock:
            self.counts[name] += 1

    def find(self, text: str) -> None:
        """Note a finding, once."""
        with self._lock:
            if text not in self.findings:
                self.findings.append(text)


def new_client(address: str) -> httpx.Client:
    """Return a client of a service that may be away."""
    return httpx.Client(base_url=address, timeout=ANSWER_S)


class Editor:
    """The only editor of a shot. It edits, undoes and redoes, and compares the shot with what was acknowledged.

    Args:
        client: of the service.
        shot: id of the shot.
        seed: chooses the steps.
        log: of the run.
    """

    def __init__(self, client: httpx.Client, shot: str, seed: int, log: Log) -> None:
        self.shot = shot
        self._client = client
        self._random = random.Random(seed)
        self._log = log
        self._gesture = ""
        self._number = 0
        self._unanswered: tuple[Step, str] | None = None
        self._expected = ExpectedHistory.beginning_with(self._get("/history")["revision"])

    def step(self) -> None:
        """Send one request, after it is known what the last one did."""
        if self._unanswered is not None and not self.compare():
            return
        step: Step = self._random.choices(("edit", "undo", "redo"), (6, 3, 1))[0]
        gesture = self._next_gesture() if step == "edit" else ""
        answer = self._send(step, gesture)
        if answer is None or answer.status_code in MAY_FAIL:
            self._unanswered = step, gesture
            self._log.count(f"{step} not acknowledged")
        elif answer.status_code == 200:
            self._log.count(step)
            self._note(step, gesture, answer.json())
        elif answer.status_code != 409 or self._expected.walked(step) is not None:
            self._log.find(f"{step} of {self.shot}: {answer.status_code} {answer.text[:300]}")

    def compare(self) -> bool:
        """Compare the shot with what was acknowledged. Returns False where the service does not answer."""
        try:
            history = self._get("/history")
        except (httpx.TransportError, httpx.HTTPStatusError):
            return False
        revisions, now = tuple(step["revision"] for step in history["steps"]), history["now"]
        found: ExpectedHistory | None = self._expected
        if self._unanswered is not None:
            found = self._expected.after_unanswered(*self._unanswered, revisions, now)
        if found is None or not found.agrees(revisions, now):
            self._log.find(
                f"{self.shot}: expected {self._expected.now} of {self._expected.revisions}, "
                f"unanswered {self._unanswered}, found {now} of {revisions}"
            )
            found = ExpectedHistory(revisions, ("",) * len(revisions), now)
        self._expected, self._unanswered, self._gesture = found, None, ""
        return True

    def _next_gesture(self) -> str:
        self._number += 1
        self._gesture = self._random.choice(("", self._gesture, f"drag{self._number}"))
        return self._gesture

    def _send(self, step: Step, gesture: str) -> httpx.Response | None:
        url = f"/v1/shots/{self.shot}/edits"
        change = {"type": "setCamera", "values": {"fStop": 1 + self._number / 1000}}
        try:
            if step == "edit":
                return self._client.post(url, json={"gesture": gesture, "changes": [change]})
            return self._client.post(f"{url}/{step}")
        except httpx.TransportError as error:
            if isinstance(error, httpx.TimeoutException):
                self._log.find(f"{step} of {self.shot}: no answer within {ANSWER_S:g} s")
            return None

    def _note(self, step: Step, gesture: str, answer: dict) -> None:
        revision = answer["history"]["revision"] if step == "edit" else answer["revision"]
        after = self._expected.edited(revision, gesture) if step == "edit" else self._expected.walked(step)
        if after is None or after.present != revision:
            self._log.find(f"{step} of {self.shot} came to {revision}, expected {after}")
            return
        self._expected = after

    def _get(self, path: str) -> dict:
        answer = self._client.get(f"/v1/shots/{self.shot}/edits{path}")
        if answer.status_code not in (200, *MAY_FAIL):
            self._log.find(f"{path} of {self.shot}: {answer.status_code} {answer.text[:300]}")
        answer.raise_for_status()
        return answer.json()


class Visitor:
    """Uploads shots, looks at them and deletes them: what was acknowledged is listed, or in the trash.

    Args:
        client: of the service.
        log: of the run.
    """

    def __init__(self, client: httpx.Client, log: Log) -> None:
        self._client = client
        self._log = log
        self._kept: set[str] = set()
        self._unknown: set[str] = set()
        self._deleted: set[str] = set()

    def step(self) -> None:
        """Upload a shot, look at it and delete the one before."""
        sent = self._try("POST", "", "upload", files={"file": ("room.usda", ROOM.encode())})
        if sent is not None and sent.status_code == 201:
            shot = sent.json()["id"]
            self._try("GET", f"/{shot}/frame?time=1&width=8&seed={self._log.counts['frame']}", "frame")
            self._try("POST", f"/{shot}/pick", "pick", json={"time": 1, "width": 160, "height": 90, "x": 60, "y": 45})
            self._delete_others(shot)
            self._kept.add(shot)

    def compare(self) -> bool:
        """Compare the lists with what was acknowledged. Returns False where the service does not answer."""
        try:
            listed = {shot["id"] for shot in self._client.get("/v1/shots").json()["shots"]}
            trashed = {shot["shot"] for shot in self._client.get("/v1/trash").json()["shots"]}
        except (httpx.TransportError, KeyError):
            return False
        for what, lost in (("uploaded", self._kept - listed), ("deleted", self._deleted - trashed)):
            if lost:
                self._log.find(f"{what} shots are lost: {sorted(lost)}")
        if self._deleted & listed:
            self._log.find(f"deleted shots are there again: {sorted(self._deleted & listed)}")
        if self._unknown - listed - trashed:
            self._log.find(f"shots are neither listed nor in the trash: {sorted(self._unknown - listed - trashed)}")
        return True

    def _delete_others(self, shot: str) -> None:
        for old in sorted(self._kept - {shot}):
            self._kept.discard(old)
            answer = self._try("DELETE", f"/{old}", "delete")
            (self._deleted if answer is not None and answer.status_code == 204 else self._unknown).add(old)

    def _try(self, method: str, path: str, name: str, **content: Any) -> httpx.Response | None:
        try:
            answer = self._client.request(method, f"/v1/shots{path}", **content)
        except httpx.TransportError:
            return None
        if answer.status_code < 300:
            self._log.count(name)
        elif answer.status_code not in MAY_FAIL:
            self._log.find(f"{name}: {answer.status_code} {answer.text[:300]}")
        return answer
