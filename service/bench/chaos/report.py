"""The chaos bench for people: plain tables."""

from __future__ import annotations

from collections.abc import Iterator

from render.lab.bench.progress import goal_lines
from service.bench.chaos.results import ChaosBench


def report(found: ChaosBench) -> str:
    """The tables."""
    parts = (_head(found), _strikes(found), _attempts(found), goal_lines(found.goals))
    return "\n\n".join("\n".join(part) for part in parts) + "\n"


def _head(found: ChaosBench) -> Iterator[str]:
    machine, plan = found.machine, found.plan
    versions = ", ".join(f"{name} {version}" for name, version in machine.versions.items())
    yield f"{plan.database}; {machine.device}, {machine.cores} cores, load {machine.load:.1f} before; {machine.date}"
    yield f"Python {machine.python}, {versions}; seed {plan.seed}"
    yield f"{plan.frames} frames of {plan.width} px and {plan.rays} rays by {plan.workers} workers: {found.wall_s:.0f} s"
    if found.left_out:
        yield f"left out, as they cannot be done here: {', '.join(found.left_out)}"


def _strikes(found: ChaosBench) -> Iterator[str]:
    yield f"{'':16}{'at, s':>8}{'frames done':>13}{'next frame after, s':>21}"
    for row in found.strikes:
        recovery = "none" if row.recovery_s is None else f"{row.recovery_s:.1f}"
        yield f"{row.kind:16}{row.at_s:>8.1f}{row.done:>13}{recovery:>21}"


def _attempts(found: ChaosBench) -> Iterator[str]:
    yield "attempts: " + ", ".join(f"{count} {outcome}" for outcome, count in sorted(found.frames.outcomes.items()))
    yield "started again: " + ", ".join(f"{name} {count}" for name, count in found.restarts.items())
