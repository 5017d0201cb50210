"""The service bench for people: plain tables. Times are seconds."""

from __future__ import annotations

from collections.abc import Iterator
from statistics import median

from render.lab.bench.progress import goal_lines
from service.bench.absurd import LEAVES_AFTER_S, WIDTH
from service.bench.results import ServiceBench, Spread, ViewersFound

_MOST_REASONS = 5


def report(found: ServiceBench) -> str:
    """The tables."""
    lines = [*_head(found), "", *_viewers(found), "", *_delays(found), "", *goal_lines(found.goals)]
    return "\n".join(lines) + "\n"


def _head(found: ServiceBench) -> Iterator[str]:
    machine = found.machine
    versions = ", ".join(f"{name} {version}" for name, version in machine.versions.items())
    yield f"{machine.device}; {machine.cores} cores, load {machine.load:.1f} before; {machine.date}"
    yield f"Python {machine.python}, {versions}"


def _viewers(found: ServiceBench) -> Iterator[str]:
    plan = found.plan
    yield (
        f"{found.running.viewers} live viewers drag ({plan.drag}) for {plan.seconds:g} s; pictures {plan.width} px wide, "
        f"{plan.rate:g} requests a second each"
    )
    compiled = ", its shaders not compiled" if plan.first else ""
    yield f"  a service that has just started{compiled}:"
    yield from _pictures(found.at_start)
    yield "  the same service right afterwards:"
    yield from _pictures(found.running)


def _pictures(each: ViewersFound) -> Iterator[str]:
    yield f"    refused              {each.refused}"
    yield from (f"      {reason}" for reason in each.refusals[:_MOST_REASONS])
    least, middle, most = each.pictures[0], median(each.pictures), each.pictures[-1]
    ratio = "" if each.ratio is None else f"; most over least {each.ratio:.2f}"
    yield f"    pictures of a viewer {least} least, {middle:g} median, {most} most{ratio}; {sum(each.pictures)} in all"
    if each.without_picture:
        yield f"    without any          {each.without_picture}"
    for name, times in (
        ("first picture, s", each.first),
        ("age of a picture, s", each.age),
        ("between two, s", each.gap),
    ):
        yield f"    {name:20} median {_s(times.median_s)}, p95 {_s(times.p95_s)}, longest {_s(times.most_s)}"


def _delays(found: ServiceBench) -> Iterator[str]:
    absurd = found.absurd
    refused = "none" if absurd.rays_refused is None else f"{absurd.rays_refused:,}"
    yield (
        f"Beside {found.beside} viewers: a GET of {WIDTH} px with {absurd.rays_admitted:,} rays for {found.plan.phase_s:g} s, "
        f"and one whose client left after {LEAVES_AFTER_S:g} s. Refused with 422 from: {refused} rays"
    )
    yield f"{'seconds: median / longest':34}{'alone':>16}{'absurd GET':>16}{'client left':>16}{'delay':>9}{'left':>9}"
    for row in found.delays:
        cells = "".join(f"{_pair(times):>16}" for times in (row.alone, row.absurd, row.left))
        yield f"{row.request:34}{cells}{_s(row.delay_s):>9}{_s(row.delay_left_s):>9}"
        yield from (f"    {failure}" for failure in row.failures[:_MOST_REASONS])


def _pair(times: Spread) -> str:
    return f"{_s(times.median_s)} / {_s(times.most_s)}"


def _s(seconds: float | None) -> str:
    return "none" if seconds is None else f"{seconds:.2f}"
