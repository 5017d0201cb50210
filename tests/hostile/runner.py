"""Sends hostile files to a service, asks for all that a user asks for, and judges the answers."""

from __future__ import annotations

import io
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass

import httpx
import numpy as np
from PIL import Image, UnidentifiedImageError
from prometheus_client.parser import text_string_to_metric_families

from tests.hostile.asking import PATIENCE_S, SIDE_READS, Answer, answer_of, ask_all
from tests.hostile.corpus import Canaries, Case, controls

Ask = Callable[[httpx.Client, str], Iterable[Answer]]

SIDE_PATHS = {"curve": "focus-curve", "lens": "camera/lens"}
NO_ANSWER = 599
"""Status that stands for no answer in time."""
COLOUR_STEPS = 6
"""Distance from a colour, of 255, within which a picture has that colour, after JPEG too."""


@dataclass(frozen=True)
class Verdict:
    """Outcome of one case.

    Attributes:
        case: its name.
        statuses: of the upload and, where it was taken, of what was asked for and of the deletion.
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
    client: httpx.Client, cases: Iterable[Case], canaries: Canaries, places: tuple[str, ...], ask: Ask = ask_all
) -> Iterator[Verdict]:
    """Run cases one after the other.

    Args:
        client: of the service.
        cases: what is sent.
        canaries: what must not be seen.
        places: folders of the machine, which must not be seen either.
        ask: what is asked for of a shot that is taken.
    """
    host = HostShot(client)
    for case in cases:
        begun_s = time.monotonic()
        answers = send_and_ask(client, case, ask) if case.kind == "shot" else host.send(case)
        leaks = (*_leaked_text(case, answers, canaries, places), *_leaked_pixels(answers, canaries))
        statuses = tuple(answer.status for answer in answers)
        seconds, peaks = time.monotonic() - begun_s, peak_memory(client).values()
        is_within = all(peak < limit for peak, limit in peaks)
        yield Verdict(case.name, statuses, seconds, leaks, max(peak for peak, _ in peaks), is_within)


def send_and_ask(client: httpx.Client, case: Case, ask: Ask) -> list[Answer]:
    """Upload a file and, where it is taken, ask for something and delete the shot."""
    sent = client.post("/v1/shots", files={"file": (case.file, case.content)}, timeout=PATIENCE_S)
    answers = [answer_of(sent)]
    if sent.status_code == 201:
        shot_id = sent.json()["id"]
        try:
            for answer in ask(client, shot_id):
                answers.append(answer)
        except (httpx.HTTPError, TimeoutError) as error:
            answers.append(Answer(NO_ANSWER, repr(error).encode(), is_text=True))
        answers.append(answer_of(client.delete(f"/v1/shots/{shot_id}", timeout=PATIENCE_S)))
    return answers


class HostShot:
    """A harmless shot that files are sent to which are no shots by themselves.

    Args:
        client: of the service.
    """

    def __init__(self, client: httpx.Client) -> None:
        self._client = client
        self._shot: str | None = None

    def send(self, case: Case) -> list[Answer]:
        """Send a curve or a lens to the shot and, where it is taken, ask for what follows from it and take it back."""
        if self._shot is None:
            good = next(controls())
            sent = self._client.post("/v1/shots", files={"file": (good.file, good.content)}, timeout=PATIENCE_S)
            self._shot = f"/v1/shots/{sent.json()['id']}"
        path = f"{self._shot}/{SIDE_PATHS[case.kind]}"
        files = {"file": (case.file, case.content)}
        sent = self._client.put(path, files=files, timeout=PATIENCE_S)
        answers = [answer_of(sent)]
        if sent.status_code < 300:
            for read, query in SIDE_READS:
                answers.append(answer_of(self._client.get(self._shot + read, params=query, timeout=PATIENCE_S)))
            answers.append(answer_of(self._client.post(f"{self._shot}/edits/undo", timeout=PATIENCE_S)))
        return answers


def _leaked_text(case: Case, answers: list[Answer], canaries: Canaries, places: tuple[str, ...]) -> Iterator[str]:
    sent_by_us = case.content.decode("utf-8", "replace") + case.name
    yield from (value for value in canaries.values if any(value.encode() in answer.content for answer in answers))
    texts = [answer.content.decode("utf-8", "replace") for answer in answers if answer.is_text]
    yield from (place for place in places if place not in sent_by_us and any(place in text for text in texts))


def _leaked_pixels(answers: list[Answer], canaries: Canaries) -> Iterator[str]:
    """Say where a picture has the one colour that the secret look-up table gives it."""
    if canaries.colour is None:
        return
    for number, answer in enumerate(answers):
        pixels = None if answer.is_text else picture_of(answer)
        if pixels is not None and np.abs(pixels - np.asarray(canaries.colour)).max() <= COLOUR_STEPS:
            yield f"the picture of answer {number} has the colour of the secret table"


def picture_of(answer: Answer) -> np.ndarray | None:
    """Pixels of an answer that is a PNG or JPEG, ``(height, width, 3)``, 0 to 255; None where it is something else."""
    with suppress(UnidentifiedImageError):
        return np.asarray(Image.open(io.BytesIO(answer.content)).convert("RGB"), np.int16)
    return None


def peak_memory(client: httpx.Client) -> dict[str, tuple[int, int]]:
    """For each kind of worker, the most memory that one has held so far and that it may take, MiB."""
    found: dict[str, list[int]] = {}
    for family in text_string_to_metric_families(client.get("/metrics").text):
        if family.name in ("pullfocus_worker_peak_memory_bytes", "pullfocus_worker_memory_limit_bytes"):
            for sample in family.samples:
                found.setdefault(sample.labels["worker"], []).append(int(sample.value) >> 20)
    return {worker: (peak, limit) for worker, (peak, limit) in found.items()}


def finished_in(client: httpx.Client) -> dict[str, int]:
    """For each lane, the number of requests that were worked on."""
    families = text_string_to_metric_families(client.get("/metrics").text)
    return {
        sample.labels["lane"]: int(sample.value)
        for family in families
        for sample in family.samples
        if sample.name == "pullfocus_lane_run_seconds_count"
    }
