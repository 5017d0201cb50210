"""The worker processes of a service, kept between calls while memory allows."""

from __future__ import annotations

import itertools
import threading
from collections import Counter
from collections.abc import Callable, Hashable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TypeVar, cast

from service.workers.caches import Caches
from service.workers.errors import BLAMED, End, WorkerDiedError
from service.workers.forking import Template
from service.workers.greed import greed_of
from service.workers.jobs import Job
from service.workers.places import Place
from service.workers.process import WorkerProcess
from service.workers.roles import Role

State = TypeVar("State")


@dataclass(frozen=True)
class Viewed:
    """Places and views that the processes of a role have drawn lately.

    Attributes:
        by_idle: those of idle processes.
        by_busy: those of busy ones.
    """

    by_idle: frozenset[tuple[Place, Hashable]]
    by_busy: frozenset[tuple[Place, Hashable]]

    def is_elsewhere(self, job: Job[Any]) -> bool:
        """Whether busy processes keep a job's view, and no idle one."""
        drawn = job.place, job.view
        return drawn in self.by_busy and drawn not in self.by_idle


class WorkerPool:
    """Worker processes by role and place. Any thread may use it.

    A process serves one shot at a time and one call at a time. Between calls it keeps the shot open; the processes that were not
    used for longest are ended where all of them hold more memory than they may.

    Args:
        template: forks them.
        max_bytes: memory that all processes may hold while they are idle.
        max_idle: processes that may be idle.
        gpus: GPUs that the workers which draw are spread over; 0 leaves the choice to the driver.
        caches: has their cache folders; None for workers without.
        on_blame: called with a place's key and the reason when a shot has ended its worker, in any thread.
    """

    def __init__(
        self,
        template: Template,
        *,
        max_bytes: int,
        max_idle: int = 16,
        gpus: int = 0,
        caches: Caches | None = None,
        on_blame: Callable[[str, End], None] = lambda key, end: None,
    ) -> None:
        self.template = template
        self.starts: Counter[str] = Counter()
        self.ends: Counter[tuple[str, End]] = Counter()
        self._peaks: dict[Role[Any], int] = {}
        self._max_bytes = max_bytes
        self._max_idle = max_idle
        self._on_blame = on_blame
        self._caches = caches
        self._gpus = itertools.cycle(range(gpus)) if gpus else None
        self._lock = threading.Lock()
        self._idle: list[WorkerProcess[Any]] = []  # that which was used last comes last
        self._busy: set[WorkerProcess[Any]] = set()
        self._left: set[WorkerProcess[Any]] = set()  # busy with a shot that was closed

    def take(self, role: Role[State], place: Place, view: Hashable | None = None) -> WorkerProcess[State]:
        """Return an idle process of a role and place, or start one. The caller gives it back.

        Args:
            role: of the process.
            place: the shot that it serves.
            view: one that it is about to draw; a process which has drawn it is preferred. None for no view.

        Raises:
            WorkerDiedError: no process can be started.
        """
        idle, dead = self._take_idle(role, place, view)
        self._end(dead, "killed")
        for process in dead:  # ended for a reason just before it was given back
            self._blame(process)
        if idle is not None:
            _note(idle, view)
            return idle
        gpu = next(self._gpus) if self._gpus is not None and role.draws else None
        started = self._start(role, place, gpu)
        with self._lock:
            self.starts[role.name] += 1
            self._peaks.setdefault(role, 0)
            self._busy.add(started)
        _note(started, view)
        return started

    def viewed(self, role: Role[Any]) -> Viewed:
        """Return the views that the processes of a role have drawn lately."""

        def views(processes: Iterable[WorkerProcess[Any]]) -> frozenset[tuple[Place, Hashable]]:
            return frozenset(
                (each.place, view) for each in processes if each.role == role for view in tuple(each.views)
            )

        with self._lock:
            return Viewed(views(self._idle), views(self._busy))

    def give_back(self, process: WorkerProcess[Any]) -> None:
        """Take a process back after a call, in whatever state it is."""
        process.rested_cpu_s = process.cpu_s()
        with self._lock:
            self._busy.discard(process)
            is_of_use = process.end is None and not process.role.is_thrown_away and process not in self._left
            self._left.discard(process)
            unused = [] if is_of_use else [process]
            if is_of_use:
                self._idle.append(process)
                unused += self._surplus()
        self._end(unused)
        for each in unused:
            self._blame(each)

    def close_place(self, key: str, role: Role[Any] | None = None) -> None:
        """End the processes of a shot, all or those of one role: those that are busy, after their call."""

        def is_meant(process: WorkerProcess[Any]) -> bool:
            return process.place.key == key and role in (None, process.role)

        with self._lock:
            self._left |= {process for process in self._busy if is_meant(process)}
            meant = [process for process in self._idle if is_meant(process)]
            self._idle = [process for process in self._idle if process not in meant]
        self._end(meant)

    def processes(self) -> list[WorkerProcess[Any]]:
        """Return all processes, idle ones first."""
        with self._lock:
            return [*self._idle, *self._busy]

    def peaks(self) -> dict[Role[Any], int]:
        """Return the most memory that a process of each role has held so far, bytes."""
        with self._lock:
            peaks, living = self._peaks.copy(), [*self._idle, *self._busy]
        for process in living:
            peaks[process.role] = max(peaks[process.role], process.peak_bytes())
        return peaks

    def end_full(self) -> None:
        """End the processes whose caches hold more than they may, and blame their shots: nothing that is drawn needs so much."""
        caches = self._caches
        if caches is None:
            return
        full = [each for each in self.processes() if each.cache is not None and caches.is_full(each.cache)]
        with self._lock:
            idle = [process for process in full if process in self._idle]
            self._idle = [process for process in self._idle if process not in idle]
            busy = self._busy.intersection(full)
        self._end(idle, "disk")
        for process in idle:
            self._blame(process)
        for process in busy:
            process.kill("disk")

    def end_greedy(self) -> None:
        """End the processes that use what nothing else limits: see `service.workers.greed`."""
        with self._lock:  # so that none is given work between the look and the end
            idle = [(process, why) for process in self._idle if (why := greed_of(process, is_idle=True)) is not None]
            for process, _ in idle:
                self._idle.remove(process)
            busy = [*self._busy]
        for process, why in idle:
            self._end([process], why)
            if why != "cpu":  # it may have made what later calls need
                self._blame(process)
        for process in busy:
            if (why := greed_of(process, is_idle=False)) is not None:
                process.kill(why)

    def close(self) -> None:
        """End all processes that are idle, and the template, which ends the others."""
        with self._lock:
            idle, self._idle = self._idle, []
        for process in idle:
            process.close("stopping")
        self.template.close()

    def _take_idle(
        self, role: Role[State], place: Place, view: Hashable | None
    ) -> tuple[WorkerProcess[State] | None, list[WorkerProcess[Any]]]:
        """Take the idle process of a role and place that drew a view, or was used last, and those found dead on the way."""
        dead: list[WorkerProcess[Any]] = []
        with self._lock:
            fit = [each for each in reversed(self._idle) if each.role == role and each.place == place]
            for process in sorted(fit, key=lambda each: view not in each.views):
                self._idle.remove(process)
                if process.is_alive():
                    self._busy.add(process)
                    return cast("WorkerProcess[State]", process), dead
                dead.append(process)
        return None, dead

    def _start(self, role: Role[State], place: Place, gpu: int | None) -> WorkerProcess[State]:
        if self._caches is None:
            return WorkerProcess(self.template, role, place, gpu)
        cache, base = self._caches.create(), self._caches.base if role.draws else None
        try:
            return WorkerProcess(self.template, role, place, gpu, cache=cache, base=base)
        except WorkerDiedError:
            if cache is not None:
                self._caches.discard(cache)
            raise

    def _surplus(self) -> list[WorkerProcess[Any]]:
        """Remove the idle processes that are too many, or hold too much, and return them."""
        self._idle.sort(key=lambda process: process.role.keeps_state)  # which is lost only where nothing else is left
        held = [process.memory_bytes() for process in self._idle]
        count = max(0, len(self._idle) - self._max_idle)
        while count < len(held) and sum(held[count:]) > self._max_bytes:
            count += 1
        surplus, self._idle = self._idle[:count], self._idle[count:]
        return surplus

    def _blame(self, process: WorkerProcess[Any]) -> None:
        """Tell of a process that its shot has ended."""
        if process.place.key is not None and process.end in BLAMED:
            self._on_blame(process.place.key, process.end)

    def _end(self, processes: list[WorkerProcess[Any]], why: End = "released") -> None:
        """End processes. Without the lock, since it takes as long as they and the template take."""
        for process in processes:
            end = process.close(why)
            with self._lock:
                self.ends[process.role.name, end] += 1
                self._peaks[process.role] = max(self._peaks.get(process.role, 0), process.peak_bytes())
            if self._caches is not None and process.cache is not None:
                self._caches.discard(process.cache)


def _note(process: WorkerProcess[Any], view: Hashable | None) -> None:
    """Note that a process draws a view."""
    if view is not None:
        with suppress(ValueError):
            process.views.remove(view)
        process.views.append(view)
