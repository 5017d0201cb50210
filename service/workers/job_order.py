"""Order of the jobs of a lane: whose turn it is, and which of the jobs that wait may begin.

- *Turns.* Of the jobs that wait, that of the principal who has used the least time is next, and of several viewers with one key,
  that of the viewer who has (`service.workers.turns`).
- *Crowds.* The jobs of a shot run in one process, one after the other. Where many of them wait, and beside a job that is overdue,
  another process of the shot takes them, unless the shot has one writer only.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Collection, Sequence
from typing import Any, TypeVar

from service.workers.jobs import Job
from service.workers.places import Place
from service.workers.streaming import CROWD
from service.workers.turns import Turns

State = TypeVar("State")

MAX_OVERDUE_EACH = 2
"""Jobs of one principal that may run beside those that a lane runs at a time."""


class JobOrder:
    """Order of the jobs of one lane, whose lock is held in each call.

    Args:
        slots: jobs that run at a time, those that are overdue not counted.
        is_single: whether a shot has at most one process.
    """

    def __init__(self, slots: int, *, is_single: bool) -> None:
        self._most_each = slots + MAX_OVERDUE_EACH
        self._is_single = is_single
        self._viewers = Turns()
        self._principals = Turns()

    def next(self, waiting: Sequence[Job[State]], running: Collection[Job[State]]) -> Job[State] | None:
        """Choose the next job: the first one of the viewer who has used the least time, of the principal who has.

        Jobs whose shot is busy are passed over, and those of a principal who has so many running that nobody else could begin.

        Args:
            waiting: jobs that wait.
            running: jobs that run.
        """
        busy = Counter(job.client.principal for job in running)
        free_places = self._free_places(waiting, running)
        free = (job for job in waiting if job.place in free_places and busy[job.client.principal] < self._most_each)

        def turn(job: Job[State]) -> tuple[float, float, int]:
            used_s = self._principals.used_s(job.client.principal), self._viewers.used_s(job.client.viewer)
            return *used_s, job.position

        return min(free, key=turn, default=None)

    def begin(self, job: Job[Any]) -> None:
        """Note that a job begins."""
        self._viewers.begin(job.client.viewer)
        self._principals.begin(job.client.principal)

    def charge(self, job: Job[Any], ran_s: float) -> None:
        """Add the time that a job ran to what its viewer and its principal have used, s."""
        self._viewers.charge(job.client.viewer, ran_s)
        self._principals.charge(job.client.principal, ran_s)

    def forget_absent(self, present: Collection[Job[Any]]) -> None:
        """Forget the viewers and principals that have no job, as far as they have used no more than others.

        Args:
            present: all jobs that wait or run.
        """
        self._viewers.forget_others({job.client.viewer for job in present})
        self._principals.forget_others({job.client.principal for job in present})

    def _free_places(self, waiting: Collection[Job[State]], running: Collection[Job[State]]) -> set[Place]:
        """Return the places whose waiting jobs may begin."""
        counts, now_s = Counter(job.place for job in waiting), time.monotonic()
        busy = Counter(job.place.key for job in running if self._is_single or job.holds_up_its_shot(now_s))
        return {
            place
            for place, count in counts.items()
            if place.key is None or not busy[place.key] or (not self._is_single and count > CROWD * busy[place.key])
        }
