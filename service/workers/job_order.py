"""Order of the jobs of a lane: whose turn it is, and which of the jobs that wait may begin.

- *Turns.* Of the jobs that wait, that of the principal who has used the least time is next, and of several viewers with one key,
  that of the viewer who has (`service.workers.turns`).
- *Crowds.* The jobs of a shot run in one process, one after the other. Where many of them wait, and beside a job that is overdue,
  another process of the shot takes them, unless the shot has one writer only. As many processes open a shot at a time as jobs run
  at a time: more of them would only slow each other down.
- *Views.* A process keeps what it has drawn of a view. A job whose view is kept by a process that is busy lets those go first
  that would have no use for the process which is free, unless it has waited for them for long enough.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Collection, Hashable, Sequence
from typing import Any, TypeVar

from service.workers.jobs import Job
from service.workers.places import Place
from service.workers.streaming import CROWD
from service.workers.turns import Turns

State = TypeVar("State")

MAX_OVERDUE_EACH = 2
"""Jobs of one principal that may run beside those that a lane runs at a time."""
ANEW_TURNS = 2.0
"""Usual turns that a job may lose to others before a process draws a view anew which another one keeps."""


class JobOrder:
    """Order of the jobs of one lane, whose lock is held in each call.

    Args:
        slots: jobs that run at a time, those that are overdue not counted.
        is_single: whether a shot has at most one process.
    """

    def __init__(self, slots: int, *, is_single: bool) -> None:
        self._slots = slots
        self._most_each = slots + MAX_OVERDUE_EACH
        self._is_single = is_single
        self._viewers = Turns()
        self._principals = Turns()

    def next(
        self,
        waiting: Sequence[Job[State]],
        running: Collection[Job[State]],
        is_kept_elsewhere: Callable[[Job[State]], bool] = lambda job: False,
    ) -> Job[State] | None:
        """Choose the next job: the first one of the viewer who has used the least time, of the principal who has.

        Jobs whose shot is busy are passed over, and those of a principal who has so many running that nobody else could begin.

        Args:
            waiting: jobs that wait.
            running: jobs that run.
            is_kept_elsewhere: whether only processes that are busy keep a job's view.
        """
        busy = Counter(job.client.principal for job in running)
        free_places = self._free_places(waiting, running)
        by_principal: dict[Hashable, list[Job[State]]] = {}
        for job in waiting:
            if job.place in free_places and busy[job.client.principal] < self._most_each:
                by_principal.setdefault(job.client.principal, []).append(job)

        def turn(job: Job[State]) -> tuple[float, int]:
            used_s = self._viewers.used_s(job.client.viewer)
            return used_s + (ANEW_TURNS * self._viewers.usual_s if is_kept_elsewhere(job) else 0.0), job.position

        def turn_of_principal(principal: Hashable) -> tuple[float, int]:
            jobs, used_s = by_principal[principal], self._principals.used_s(principal)
            lost_s = ANEW_TURNS * self._principals.usual_s if all(is_kept_elsewhere(job) for job in jobs) else 0.0
            return used_s + lost_s, min(job.position for job in jobs)

        return min(by_principal[min(by_principal, key=turn_of_principal)], key=turn) if by_principal else None

    def arrive(self, job: Job[Any]) -> None:
        """Note that a job waits."""
        self._viewers.arrive(job.client.viewer)
        self._principals.arrive(job.client.principal)

    def begin(self, job: Job[Any]) -> None:
        """Note that a job begins."""
        self._viewers.begin(job.client.viewer)
        self._principals.begin(job.client.principal)

    def charge(self, job: Job[Any], ran_s: float, *, is_usual: bool) -> None:
        """Add the time that a job ran to what its viewer and its principal have used.

        Args:
            job: has run.
            ran_s: time that it ran, s.
            is_usual: whether no more than a usual turn is added, because the rest of the time serves later jobs, too.
        """
        for turns, name in ((self._viewers, job.client.viewer), (self._principals, job.client.principal)):
            (turns.charge_usual if is_usual else turns.charge)(name, ran_s)

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
            if place.key is None or not busy[place.key] or self._is_crowded(count, busy[place.key])
        }

    def _is_crowded(self, waiting: int, busy: int) -> bool:
        """Whether so many jobs of a shot wait for its busy processes that another one takes them."""
        return not self._is_single and busy < self._slots and waiting > CROWD * busy
