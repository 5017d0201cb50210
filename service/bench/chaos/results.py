"""Results of the chaos bench as plain data: the fields are the keys of its JSON."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from render.lab.bench.results import Goal
from service.bench.chaos.plan import ChaosPlan
from service.bench.chaos.strikes import Strike
from service.bench.results import Machine
from service.client.models import RenderTask
from service.jobs.files import name_of
from service.picture.requests import THUMBNAIL


@dataclass(frozen=True)
class StrikeRow:
    """A strike.

    Attributes:
        kind: what was done.
        at_s: time since the render was sent, s.
        done: frames that were done by then.
        recovery_s: time until the next frame was done, s; None where none was.
    """

    kind: Strike
    at_s: float
    done: int
    recovery_s: float | None


@dataclass(frozen=True)
class FrameCounts:
    """Counts of the frames of a render.

    Attributes:
        done: that are drawn.
        twice: that were stored more than once.
        not_stored: files that are missing, not whole or not those of the last attempt.
        strange: files beside those of frames.
        unlike_record: that differ from what `pullfocus record` draws.
        unended: attempts without an end.
        outcomes: of all attempts.
    """

    done: int
    twice: int
    not_stored: int
    strange: int
    unlike_record: int
    unended: int
    outcomes: dict[str, int]


@dataclass(frozen=True)
class ChaosBench:
    """Result of the bench.

    Attributes:
        machine: that it ran on.
        plan: of the bench.
        left_out: strikes that could not be done here.
        strikes: those that were.
        state: of the render at the end.
        wall_s: time from when the render was sent to its end, s.
        restarts: of each part.
        frames: what became of them.
        orphans: processes that outlived the part that had started them.
        goals: judged.
    """

    machine: Machine
    plan: ChaosPlan
    left_out: list[Strike]
    strikes: list[StrikeRow]
    state: str
    wall_s: float
    restarts: dict[str, int]
    frames: FrameCounts
    orphans: int
    goals: list[Goal]


def count_frames(
    tasks: Sequence[RenderTask], stored: Mapping[str, str], recorded: Mapping[int, str], suffix: str
) -> FrameCounts:
    """Judge the frames of a render.

    Args:
        tasks: of the render.
        stored: hashes of the files in its folder, by name.
        recorded: hashes of what `pullfocus record` has drawn, by frame.
        suffix: of the files.
    """
    outcomes = Counter(attempt.outcome or "none" for task in tasks for attempt in task.attempts)
    names = {task.frame: name_of(task.frame, task.attempts[-1].number, suffix) for task in tasks if task.attempts}
    small = {name_of(task.frame, task.attempts[-1].number, THUMBNAIL) for task in tasks if task.attempts}
    told = {task.frame: {file.sha256 for file in task.files} for task in tasks}
    return FrameCounts(
        sum(task.state == "done" for task in tasks),
        sum([attempt.outcome for attempt in task.attempts].count("done") > 1 for task in tasks),
        sum(told[task.frame] != {stored.get(names.get(task.frame, ""))} for task in tasks),
        len(stored.keys() - set(names.values()) - small),
        sum(told[task.frame] != {recorded.get(task.frame)} for task in tasks),
        outcomes["none"],
        dict(outcomes),
    )


def goals_of(plan: ChaosPlan, state: str, frames: FrameCounts, orphans: int, strikes: int) -> list[Goal]:
    """Judge what was found."""
    wants = (
        ("strikes", plan.strikes, strikes),
        ("the render is done", 1, int(state == "done")),
        ("frames that are done", plan.frames, frames.done),
        ("frames that were stored twice", 0, frames.twice),
        ("files that are missing or not whole", 0, frames.not_stored),
        ("files beside those of frames", 0, frames.strange),
        ("frames unlike those of record", 0, frames.unlike_record),
        ("attempts without an end", 0, frames.unended),
        ("processes without a parent", 0, orphans),
    )
    return [Goal(name, want, got, got == want) for name, want, got in wants]
