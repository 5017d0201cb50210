"""Results of the jobs bench as plain data: the fields are the keys of its JSON."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil
from statistics import median

from render.lab.bench.results import Goal
from service.bench.jobs.plan import JobsPlan
from service.bench.results import Machine

MOST_MS = 50.0
"""Bound of the 95th percentile of `JUDGED` requests, ms."""
JUDGED = ("submit", "list the newest 50", "list a page of 50", "cancel")
LEAST_EFFICIENCY = 0.95
MOST_JUDGED_WORKERS = 4
ENDS = 100
"""Renders at either end of a queue that is filled, of which the times to submit them are compared."""


@dataclass(frozen=True)
class Times:
    """Times of requests of one kind, ms.

    Attributes:
        count: how many.
        median_ms: their median.
        p95_ms: the time that 95 % do not exceed.
        p99_ms: likewise.
        most_ms: the longest.
    """

    count: int
    median_ms: float
    p95_ms: float
    p99_ms: float
    most_ms: float


def times_of(seconds: Sequence[float]) -> Times:
    """Summarize times, s, of which there is one at least."""
    ordered = sorted(1000 * each for each in seconds)
    p95, p99 = (ordered[ceil(share * len(ordered)) - 1] for share in (0.95, 0.99))
    return Times(len(ordered), median(ordered), p95, p99, ordered[-1])


@dataclass(frozen=True)
class RequestRow:
    """Requests of one kind.

    Attributes:
        request: its name.
        clients: that send them at the same time, each one after the other.
        times: from a request to the end of its answer.
    """

    request: str
    clients: int
    times: Times


@dataclass(frozen=True)
class GrowthRow:
    """Time to submit a render, as the queue grows.

    Attributes:
        clients: that submit at the same time.
        renders: at either end that are compared.
        first_p95_ms: 95th percentile of the first ones, ms.
        last_p95_ms: 95th percentile of the last ones, ms.
    """

    clients: int
    renders: int
    first_p95_ms: float
    last_p95_ms: float


def growth_of(clients: int, seconds: Sequence[float]) -> GrowthRow:
    """Compare the times, s, of the first and the last renders that were submitted."""
    count = min(ENDS, ceil(len(seconds) / 2))
    first, last = times_of(seconds[:count]), times_of(seconds[-count:])
    return GrowthRow(clients, count, first.p95_ms, last.p95_ms)


@dataclass(frozen=True)
class WorkersRow:
    """Some workers who sleep as long as a frame takes.

    Attributes:
        workers: how many.
        frame_s: time that they sleep for a frame, s.
        frames: how many they drew.
        wall_s: from the time when the last render was sent to the time when the last frame was stored, s.
        frames_per_hour: that they drew.
        efficiency: share of their time that they slept for frames.
    """

    workers: int
    frame_s: float
    frames: int
    wall_s: float
    frames_per_hour: float
    efficiency: float


def workers_row(workers: int, frame_s: float, frames: int, wall_s: float) -> WorkersRow:
    """Return the row of some workers; see `WorkersRow`."""
    return WorkersRow(workers, frame_s, frames, wall_s, 3600 * frames / wall_s, frames * frame_s / (workers * wall_s))


@dataclass(frozen=True)
class ReaderRow:
    """A reader of events.

    Attributes:
        over: `process` or `HTTP`.
        topics: that it reads; empty for all.
        start: number that it began after.
        events: that there were for it.
        cuts: times that it was cut off and went on.
        missed: events that it did not get.
        doubled: events that it got once more.
        strange: events that it got and that were none of its.
        out_of_order: events that it got after a later one.
    """

    over: str
    topics: Sequence[str]
    start: int
    events: int
    cuts: int
    missed: int
    doubled: int
    strange: int
    out_of_order: int


@dataclass
class Reader:
    """Events that a reader got.

    Attributes:
        over: `process` or `HTTP`.
        topics: that it reads; empty for all.
        start: number that it begins after.
        last: number that it goes on after.
        numbers: of the events that it got, in their order.
        cuts: times that it was cut off.
    """

    over: str
    topics: Sequence[str]
    start: int
    last: int
    numbers: list[int]
    cuts: int = 0

    @classmethod
    def after(cls, over: str, topics: Sequence[str], start: int) -> Reader:
        """Return a reader that has got nothing yet."""
        return cls(over, topics, start, start, [])

    def note(self, number: int) -> None:
        """Note an event."""
        self.numbers.append(number)
        self.last = number


def reader_row(reader: Reader, kept: Iterable[tuple[int, str]], until: int) -> ReaderRow:
    """Compare what a reader got with the events that there are.

    Args:
        reader: the reader.
        kept: number and topic of all events.
        until: number of the last event that it should have.
    """
    due = {
        number
        for number, topic in kept
        if reader.start < number <= until and (not reader.topics or topic in reader.topics)
    }
    got = [number for number in reader.numbers if number <= until]
    each = set(got)
    return ReaderRow(
        reader.over,
        list(reader.topics),
        reader.start,
        len(due),
        reader.cuts,
        missed=len(due - each),
        doubled=len(got) - len(each),
        strange=len(each - due),
        out_of_order=sum(after < before for before, after in pairwise(got)),
    )


@dataclass(frozen=True)
class JobsBench:
    """All of it.

    Attributes:
        machine: what it ran on.
        plan: of the measurements.
        database: its kind and version.
        requests: rows by kind of request and number of clients.
        growth: of the time to submit a render.
        workers: rows by time of a frame and number of workers.
        queue: what the queue itself takes for a frame, without HTTP.
        readers: of events.
        goals: goals and whether they are met.
    """

    machine: Machine
    plan: JobsPlan
    database: str
    requests: list[RequestRow]
    growth: list[GrowthRow]
    workers: list[WorkersRow]
    queue: list[RequestRow]
    readers: list[ReaderRow]
    goals: list[Goal]


def goals_of(requests: Sequence[RequestRow], workers: Sequence[WorkersRow], readers: Sequence[ReaderRow]) -> list[Goal]:
    """Judge what was found."""
    return [
        *(
            Goal(f"{row.request}, {_clients(row.clients)}, p95, ms, at most", MOST_MS, p95_ms, p95_ms <= MOST_MS)
            for row in requests
            if row.request in JUDGED
            for p95_ms in (row.times.p95_ms,)
        ),
        *(
            Goal(
                f"efficiency of {row.workers} workers, frames of {row.frame_s:g} s, at least",
                LEAST_EFFICIENCY,
                row.efficiency,
                row.efficiency >= LEAST_EFFICIENCY,
            )
            for row in workers
            if row.workers <= MOST_JUDGED_WORKERS
        ),
        *_events_goals(readers),
    ]


def _events_goals(readers: Sequence[ReaderRow]) -> list[Goal]:
    counts = {
        "missed": sum(row.missed for row in readers),
        "doubled": sum(row.doubled for row in readers),
        "of others": sum(row.strange for row in readers),
        "out of order": sum(row.out_of_order for row in readers),
    }
    due, cuts = sum(row.events for row in readers), sum(row.cuts for row in readers)
    return [
        *(Goal(f"events {what}, at most", 0, count, count == 0) for what, count in counts.items()),
        Goal("events that readers had to get, at least", 1, due, due >= 1),
        Goal("times that readers were cut off, at least", 1, cuts, cuts >= 1),
    ]


def _clients(count: int) -> str:
    return "one client" if count == 1 else f"{count} clients"
