"""Cost of work: wall time, and processor time of the whole process, threads of a software rasteriser included.

Wall time is what a user waits, and what counts on a GPU. On a machine that has other work to do it measures that work too;
processor time does not.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import median


@dataclass(frozen=True)
class Spent:
    """Time, in milliseconds: of the wall's clock and of the processor."""

    wall_ms: float = 0.0
    cpu_ms: float = 0.0

    def __add__(self, other: Spent) -> Spent:
        return Spent(self.wall_ms + other.wall_ms, self.cpu_ms + other.cpu_ms)


@dataclass(frozen=True)
class Repeats:
    """Repetitions of a measurement for its median: many where it is quick, few where it is slow.

    Attributes:
        least: fewest repetitions.
        most: most repetitions.
        enough_ms: wall time after which no further repetition is begun.
    """

    least: int
    most: int = 9
    enough_ms: float = 2000.0

    def more(self, runs: int, spent_ms: float) -> bool:
        """Whether another repetition is due after ``runs`` repetitions in ``spent_ms``."""
        return runs < self.least or (runs < self.most and spent_ms < self.enough_ms)


class StageClock:
    """Clock of stages of work on the device; it waits for the device at the end of each. A stage may come more than once, as
    in pictures that are traced in tiles.

    Args:
        finish: returns when the device has executed all commands.
    """

    def __init__(self, finish: Callable[[], None]) -> None:
        self._finish = finish
        self.spent: dict[str, Spent] = {}
        finish()
        self._began = _now()

    def __call__(self, stage: str) -> None:
        """Add the time since the last call to the stage."""
        self._finish()
        now = _now()
        spent = Spent(now.wall_ms - self._began.wall_ms, now.cpu_ms - self._began.cpu_ms)
        self.spent[stage] = self.spent.get(stage, Spent()) + spent
        self._began = now


def median_spent(runs: Sequence[Spent]) -> Spent:
    """The median over runs, of either time by itself."""
    return Spent(median(run.wall_ms for run in runs), median(run.cpu_ms for run in runs))


def time_work(finish: Callable[[], None], work: Callable[[], None], repeats: Repeats) -> Spent:
    """The median of some runs, each until the device has done it.

    Args:
        finish: returns when the device has executed all commands.
        work: to be measured.
        repeats: repetitions.
    """
    runs: list[Spent] = []
    while repeats.more(len(runs), sum(run.wall_ms for run in runs)):
        clock = StageClock(finish)
        work()
        clock("work")
        runs.append(clock.spent["work"])
    return median_spent(runs)


def _now() -> Spent:
    return Spent(1000 * time.perf_counter(), 1000 * time.process_time())
