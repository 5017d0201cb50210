"""Sends hostile files to a service, asks for all that a user asks for, and judges the answers."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import httpx

from tests.hostile.corpus import Canaries, Case

MAX_ANSWER_S = 60.0
FRAME = "/frame?time=1&width=64&rays=8&layers=2"
READS = ("", "/inspect", FRAME, f"{FRAME}&format=exr", "/camera/grades?time=1")


@dataclass(frozen=True)
class Verdict:
    """Outcome of one case.

    Attributes:
        case: its name.
        statuses: of the upload and, where it was taken, of the reads and of the deletion.
        seconds: time of all.
        leaks: canaries that were seen in an answer.
        peak_mib: largest memory of a worker so far.
    """

    case: str
    statuses: tuple[int, ...]
    seconds: float
    leaks: tuple[str, ...]
    peak_mib: int

    @property
    def is_good(self) -> bool:
        """Whether no answer was a fault of the service, and nothing came from outside of the upload."""
        return not self.leaks and all(status < 500 for status in self.statuses)


def run_cases(
    client: httpx.Client, cases: Iterable[Case], canaries: Canaries, places: tuple[str, ...]
) -> Iterator[Verdict]:
    """Run cases one after the other.

    Args:
        client: of the service.
        cases: what is sent.
        canaries: what must not be seen.
        places: folders of the machine, which must not be seen either.
    """
    for case in cases:
        begun_s, answers = time.monotonic(), []
        sent = client.post("/v1/shots", files={"file": (case.file, case.content)}, timeout=MAX_ANSWER_S * 3)
        answers.append(sent)
        if sent.status_code == 201:
            shot = f"/v1/shots/{sent.json()['id']}"
            answers += [client.get(shot + read, timeout=MAX_ANSWER_S * 3) for read in READS]
            answers.append(client.delete(shot))
        sent_by_us = case.content.decode("utf-8", "replace") + case.name
        seen = [value for value in canaries.values if any(value.encode() in answer.content for answer in answers)]
        texts = [answer.text for answer in answers if "json" in answer.headers.get("content-type", "")]
        seen += [place for place in places if place not in sent_by_us and any(place in text for text in texts)]
        statuses = tuple(answer.status_code for answer in answers)
        yield Verdict(case.name, statuses, time.monotonic() - begun_s, tuple(seen), peak_mib())


def peak_mib() -> int:
    """Largest memory that a process below this one has had, of those that live."""
    parents, peaks = {}, {}
    for folder in Path("/proc").iterdir():
        if folder.name.isdecimal():
            try:
                lines = (folder / "status").read_text().splitlines()
            except OSError:  # it has ended
                continue
            values = dict(line.split(":", 1) for line in lines if ":" in line)
            parents[int(folder.name)] = int(values["PPid"])
            peaks[int(folder.name)] = int(values.get("VmHWM", "0 kB").split()[0]) // 1024
    return max((peaks[pid] for pid in parents if _is_below(pid, parents)), default=0)


def _is_below(pid: int, parents: dict[int, int]) -> bool:
    while pid in parents:
        pid = parents[pid]
        if pid == os.getpid():
            return True
    return False
