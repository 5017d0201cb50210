"""The jobs bench for people: plain tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from render.lab.bench.progress import goal_lines
from service.bench.jobs.results import JobsBench, RequestRow

_HEAD = f"{'count':>8}{'median':>9}{'p95':>9}{'p99':>9}{'worst':>9}"


def report(found: JobsBench) -> str:
    """The tables."""
    parts = (_head(found), _requests(found), _workers(found), _readers(found), goal_lines(found.goals))
    return "\n\n".join("\n".join(part) for part in parts) + "\n"


def _head(found: JobsBench) -> Iterator[str]:
    machine = found.machine
    versions = ", ".join(f"{name} {version}" for name, version in machine.versions.items())
    yield f"{found.database}; {machine.cores} cores, load {machine.load:.1f} before; {machine.date}"
    yield f"Python {machine.python}, {versions}; seed {found.plan.seed}"


def _requests(found: JobsBench) -> Iterator[str]:
    plan = found.plan
    yield f"Requests over HTTP, ms: {plan.renders:,} renders of {plan.frames:,} frames, none of which is drawn"
    yield f"{'':24}{'clients':>8}{_HEAD}"
    yield from _rows(found.requests, "clients")
    for row in found.growth:
        yield (
            f"submit, {row.clients} at a time, p95: first {row.renders} {row.first_p95_ms:.1f}, "
            f"last {row.renders} {row.last_p95_ms:.1f}"
        )


def _workers(found: JobsBench) -> Iterator[str]:
    waiting = found.plan.renders
    yield f"Workers who sleep as long as a frame takes, and draw nothing; {waiting:,} more renders wait"
    yield f"{'workers':>8}{'frame, s':>10}{'frames':>8}{'wall, s':>9}{'frames an hour':>16}{'efficiency':>12}"
    for row in found.workers:
        yield (
            f"{row.workers:>8}{row.frame_s:>10g}{row.frames:>8}{row.wall_s:>9.2f}{row.frames_per_hour:>16,.0f}"
            f"{row.efficiency:>12.1%}"
        )
    yield ""
    yield "The same queue by itself, without HTTP, ms"
    yield f"{'':24}{'':>8}{_HEAD}"
    yield from _rows(found.queue, "")


def _rows(rows: Sequence[RequestRow], clients: str) -> Iterator[str]:
    for row in rows:
        times = row.times
        told = "".join(f"{each:>9.1f}" for each in (times.median_ms, times.p95_ms, times.p99_ms, times.most_ms))
        yield f"{row.request:24}{row.clients if clients else '':>8}{times.count:>8}{told}"


def _readers(found: JobsBench) -> Iterator[str]:
    yield "Readers of events, who begin anywhere, are cut off at random and go on"
    yield (
        f"{'over':8}{'topics':>16}{'after':>8}{'events':>8}{'cuts':>6}{'missed':>8}{'doubled':>9}{'strange':>9}"
        f"{'disorder':>10}"
    )
    for row in found.readers:
        yield (
            f"{row.over:8}{', '.join(row.topics) or 'all':>16}{row.start:>8}{row.events:>8}{row.cuts:>6}{row.missed:>8}"
            f"{row.doubled:>9}{row.strange:>9}{row.out_of_order:>10}"
        )
