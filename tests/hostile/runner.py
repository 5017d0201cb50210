"""Sends hostile files to a service, asks for all that a user asks for, and judges the answers."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import httpx
from prometheus_client.parser import text_string_to_metric_families

from tests.hostile.corpus import Canaries, Case

MAX_ANSWER_S = 60.0
FRAME = "/frame?time=1&width=64&rays=8&layers=2"
READS = (
    "",
    "/inspect",
    "/cameras?time=1",
    "/readout?time=1",
    "/focus-curve",
    FRAME,
    f"{FRAME}&format=exr",
    "/camera/grades?time=1",
)


@dataclass(frozen=True)
class Verdict:
    """Outcome of one case.

    Attributes:
        case: its name.
        statuses: of the upload and, where it was taken, of the reads and of the deletion.
        seconds: time of all.
        leaks: canaries that were seen in an answer.
        peak_mib: largest memory of a worker so far, of those that have ended too.
        is_within_memory: whether each worker has kept to its limit so far.
    """

    case: str
    statuses: tuple[int, ...]
    seconds: float
    leaks: tuple[str, ...]
    peak_mib: int
    is_within_memory: bool

    @property
    def is_good(self) -> bool:
        """Whether no answer was a fault of the service, nothing came from outside of the upload, and memory sufficed."""
        return not self.leaks and self.is_within_memory and all(status < 500 for status in self.statuses)


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
        seconds, peaks = time.monotonic() - begun_s, peak_memory(client).values()
        is_within = all(peak < limit for peak, limit in peaks)
        yield Verdict(case.name, statuses, seconds, tuple(seen), max(peak for peak, _ in peaks), is_within)


def peak_memory(client: httpx.Client) -> dict[str, tuple[int, int]]:
    """For each kind of worker, the most memory that one has held so far and that it may take, MiB."""
    found: dict[str, list[int]] = {}
    for family in text_string_to_metric_families(client.get("/metrics").text):
        if family.name in ("pullfocus_worker_peak_memory_bytes", "pullfocus_worker_memory_limit_bytes"):
            for sample in family.samples:
                found.setdefault(sample.labels["worker"], []).append(int(sample.value) >> 20)
    return {worker: (peak, limit) for worker, (peak, limit) in found.items()}
