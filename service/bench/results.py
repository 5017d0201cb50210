"""Results of the service bench as plain data: the fields are the keys of its JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from statistics import median

from render.lab.bench.results import Goal
from service.bench.plan import LoadPlan

MOST_RATIO, MOST_DELAY_S = 2.0, 2.0


@dataclass(frozen=True)
class Machine:
    """Machine that the bench ran on.

    Attributes:
        date: in ISO format, UTC.
        cores: that the process may use.
        device: the OpenGL driver's name of what draws.
        load: mean number of processes that wanted a core in the minute before; other work disturbs the results.
        python: its version.
        versions: of packages, by name.
    """

    date: str
    cores: int
    device: str
    load: float
    python: str
    versions: dict[str, str]


@dataclass(frozen=True)
class Spread:
    """Several times, s.

    Attributes:
        count: how many.
        median_s: their median; None without any.
        p95_s: the time that 95 % do not exceed.
        most_s: the longest.
    """

    count: int
    median_s: float | None
    p95_s: float | None
    most_s: float | None


def spread_of(seconds: Sequence[float]) -> Spread:
    """Summarize times."""
    if not seconds:
        return Spread(0, None, None, None)
    ordered = sorted(seconds)
    return Spread(len(ordered), median(ordered), ordered[ceil(0.95 * len(ordered)) - 1], ordered[-1])


@dataclass(frozen=True)
class ViewersFound:
    """Pictures and refusals of the viewers who drag together.

    Attributes:
        viewers: how many there were.
        refused: viewers who were refused, once or more often.
        refusals: reasons, each once.
        pictures: number of pictures of each viewer, least first.
        ratio: most over least; None where somebody got none.
        without_picture: viewers who got none.
        first: from a viewer's first request to the first picture.
        age: from the request of a picture to its arrival.
        gap: between the pictures of a viewer.
    """

    viewers: int
    refused: int
    refusals: list[str]
    pictures: list[int]
    ratio: float | None
    without_picture: int
    first: Spread
    age: Spread
    gap: Spread


@dataclass(frozen=True)
class DelayRow:
    """Waiting of one kind of request.

    Attributes:
        request: its name.
        alone: beside the viewers alone.
        absurd: beside an absurd GET too.
        left: beside an absurd GET whose client has left.
        delay_s: longest time beside the absurd GET minus the median without.
        delay_left_s: likewise, after the client has left.
        failures: answers that were errors, each once.
    """

    request: str
    alone: Spread
    absurd: Spread
    left: Spread
    delay_s: float
    delay_left_s: float
    failures: list[str]


@dataclass(frozen=True)
class AbsurdFound:
    """The absurd GET.

    Attributes:
        rays_refused: rays of a picture that was answered 422; None where none was.
        rays_admitted: rays of the absurd GET.
        was_busy: whether it was worked on until the end of its phase; else the others had nothing to wait for.
    """

    rays_refused: int | None
    rays_admitted: int
    was_busy: bool


@dataclass(frozen=True)
class ServiceBench:
    """All of it.

    Attributes:
        machine: what it ran on.
        plan: of the measurements.
        at_start: what they got of a service that has just started.
        running: what they got right afterwards.
        beside: viewers of the second part.
        absurd: the absurd GET.
        delays: rows by kind of request.
        goals: goals and whether they are met.
    """

    machine: Machine
    plan: LoadPlan
    at_start: ViewersFound
    running: ViewersFound
    beside: int
    absurd: AbsurdFound
    delays: list[DelayRow]
    goals: list[Goal]


def goals_of(
    at_start: ViewersFound, running: ViewersFound, absurd: AbsurdFound, delays: Sequence[DelayRow]
) -> list[Goal]:
    """Judge what was found."""
    was_refused = absurd.rays_refused is not None
    failures = sum(len(row.failures) for row in delays)
    worst = {
        "an absurd GET": max(row.delay_s for row in delays),
        "a GET whose client has left": max(row.delay_left_s for row in delays),
    }
    return [
        *_fairness(at_start, "at the start: "),
        *_fairness(running, ""),
        Goal("pictures above the limit refused with 422, at least", 1, was_refused, was_refused),
        Goal("absurd GETs worked on until their phase ends, at least", 1, absurd.was_busy, absurd.was_busy),
        *(
            Goal(f"longest delay of others by {name}, s, at most", MOST_DELAY_S, delay, delay <= MOST_DELAY_S)
            for name, delay in worst.items()
        ),
        Goal("failed requests of others, at most", 0, failures, failures == 0),
    ]


def _fairness(found: ViewersFound, when: str) -> list[Goal]:
    nobody = [
        Goal(f"{when}viewers refused, at most", 0, found.refused, found.refused == 0),
        Goal(f"{when}viewers without a picture, at most", 0, found.without_picture, found.without_picture == 0),
    ]
    if found.ratio is None:  # somebody got no picture
        return nobody
    is_fair = found.ratio <= MOST_RATIO
    return [*nobody, Goal(f"{when}pictures of a viewer, most over least, at most", MOST_RATIO, found.ratio, is_fair)]
