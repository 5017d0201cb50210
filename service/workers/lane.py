"""Lane of one kind of work: bounded, fair to its viewers, and not to be blocked by one of them.

A lane runs a few jobs at a time, each in a worker process that serves its shot (`service.workers.pool`).

- *Turns.* Which of the jobs that wait is next, see `service.workers.job_order`.
- *Groups.* A page that scrubs through time asks for more pictures than can be rendered. Calls carry a *group* (one client viewing
  one shot); a newer call of a group takes the place of those that still wait, which fail with `SupersededError`. One that is
  running is finished: its picture is cached and likely to be requested again.
- *Streams.* A stream is a long call that yields items on the way. It ends early for a newer call of its group, once it has
  yielded an item (else a moving pointer would never see a picture), and it is put back in the lane for other jobs that wait. Each
  time this happens it may run longer before the next time, so that it reaches its end however many other jobs there are.
- *Patience.* A job that takes more than `PATIENCE_S` of the processor while others wait becomes overdue: it runs on, and does not
  count among those that run at a time. The processor is then shared by the kernel.
"""

from __future__ import annotations

import asyncio
import itertools
import logging
import os
import threading
import time
from collections import Counter
from collections.abc import Callable, Hashable
from concurrent.futures import Future, InvalidStateError, ThreadPoolExecutor
from contextlib import nullcontext, suppress
from typing import Any, Generic, TypeVar

from service.workers.calls import Call, StreamCall
from service.workers.errors import QueueFullError, StoppingError, SupersededError, WorkerDiedError
from service.workers.job_order import JobOrder
from service.workers.jobs import NOBODY, CallWork, Client, Finished, Job, StreamWork
from service.workers.output import JobOutput
from service.workers.places import NOWHERE, Place
from service.workers.pool import WorkerPool
from service.workers.process import NotBegunError, WorkerProcess
from service.workers.roles import Role

log = logging.getLogger("pullfocus.service")
State = TypeVar("State")
Reply = TypeVar("Reply")
Item = TypeVar("Item")

PATIENCE_S = 1.0
"""Processor time after which a job no longer keeps others waiting."""
MAX_PATIENCE_S = 1.5
"""Time after which it does not, however little of the processor it got."""
MAX_OVERDUE = 4
"""Jobs of a lane that may be overdue at a time."""
UNWANTED_S = 1.0
"""Time that a call may go on after its client has gone, before its process is ended."""
UNWANTED_STREAM_S = 10.0
"""The same time of a stream: it ends by itself after a piece of work, and a new process would have to open the shot."""
TICK_S = 0.1
ATTEMPTS = 3
"""Processes that a call is sent to, where each has ended before it began."""


class Lane(Generic[State]):
    """Lane of the jobs that one role of workers does. Any thread may use it.

    Args:
        role: of the workers.
        pool: of the processes; other lanes use it too.
        slots: jobs that run at a time, those that are overdue not counted.
        max_waiting: jobs that may wait.
        max_waiting_each: jobs of one principal that may wait.
        timeout_s: time for one job, waiting not counted.
        on_finished: called after each job, in a thread of the lane; it must not raise.
    """

    def __init__(
        self,
        role: Role[State],
        pool: WorkerPool,
        *,
        slots: int = 1,
        max_waiting: int,
        max_waiting_each: int | None = None,
        timeout_s: float,
        on_finished: Callable[[Finished], None] = lambda finished: None,
    ) -> None:
        self.role = role
        self.pool = pool
        self._slots = slots
        self._max_waiting = max_waiting
        self._max_waiting_each = max_waiting if max_waiting_each is None else max_waiting_each
        self._timeout_s = timeout_s
        self._on_finished = on_finished
        self._queue: list[Job[State]] = []
        self._running: list[Job[State]] = []
        self._order = JobOrder(slots, is_single=role.is_single)
        self._serials = itertools.count(1)
        self._changed = threading.Condition()
        self._is_stopping = False
        self._is_closed = False
        self._threads = ThreadPoolExecutor(slots + MAX_OVERDUE, thread_name_prefix=f"lane-{role.name}")
        self._watcher = threading.Thread(target=self._watch, name=f"watch-{role.name}", daemon=True)
        self._watcher.start()

    @property
    def slots(self) -> int:
        """Jobs that run at a time, those that are overdue not counted."""
        return self._slots

    @property
    def waiting(self) -> int:
        """Jobs in the queue, those that run not counted."""
        return len(self._queue)

    @property
    def running(self) -> int:
        """Jobs that run."""
        return len(self._running)

    @property
    def oldest_waiting_s(self) -> float:
        """Time that the oldest waiting job has waited, s; 0 where none waits."""
        with self._changed:
            return max((time.monotonic() - job.queued_s for job in self._queue), default=0.0)

    def submit(
        self,
        call: Call[State, Reply],
        place: Place = NOWHERE,
        client: Client = NOBODY,
        *,
        group: Hashable | None = None,
    ) -> Future[Reply]:
        """Put a call in the lane; those of the same group that still wait are superseded.

        Args:
            call: the function and its arguments.
            place: the shot that it is about.
            client: who it is made for.
            group: one client viewing one shot.

        Raises:
            QueueFullError: too many jobs wait.
            StoppingError: the service stops.
        """
        work: CallWork[State] = CallWork(call)
        self._enqueue(work, place, client, group)
        return work.future

    async def result(
        self,
        call: Call[State, Reply],
        place: Place = NOWHERE,
        client: Client = NOBODY,
        *,
        group: Hashable | None = None,
        estimate_s: float = 0.0,
        output: JobOutput | None = None,
    ) -> Reply:
        """Put a call in the lane and wait for its reply; see `submit`. Cancelling this ends the call.

        Args:
            call: the function and its arguments.
            place: the shot that it is about.
            client: who it is made for.
            group: one client viewing one shot.
            estimate_s: processor time that it is expected to take, s; `Finished` has it beside the time that it took.
            output: collects what the process writes to standard error, and the steps of the call; None for nobody.
        """
        work: CallWork[State] = CallWork(call)
        job = self._enqueue(work, place, client, group, estimate_s, output=output)
        try:
            reply: Reply = await asyncio.wrap_future(work.future)
        except asyncio.CancelledError:
            self.cancel(job)
            raise
        return reply

    def submit_stream(
        self,
        call: StreamCall[State, Item],
        place: Place = NOWHERE,
        client: Client = NOBODY,
        *,
        on_item: Callable[[Item], None],
        on_end: Callable[[Exception | None], None],
        group: Hashable | None = None,
        view: Hashable | None = None,
        is_first: bool = False,
    ) -> Job[State]:
        """Put a stream in the lane; jobs of the same group that wait, and a stream of it that runs, are superseded.

        Args:
            call: the generator function and its arguments.
            place: the shot that it is about.
            client: who it is made for.
            on_item: called with each item, in a thread of the lane; it must not raise.
            on_end: called once after the last item, likewise; with the error that ended the stream, or None.
            group: one client viewing one shot.
            view: the view that it draws; the process that drew it last is preferred. None for no view.
            is_first: whether the viewer has no picture yet: what the first one takes counts as a usual turn at most.

        Returns:
            The job, for `cancel`.

        Raises:
            QueueFullError: too many jobs wait.
            StoppingError: the service stops.
        """
        work: StreamWork[State] = StreamWork(call, on_item, on_end)
        return self._enqueue(work, place, client, group, view=view, is_first=is_first)

    def cancel(self, job: Job[State]) -> None:
        """End a job that nobody wants any more, as soon as possible. Does nothing where it has ended.

        A stream ends between two pieces of work. The process is ended where it goes on for longer than `UNWANTED_S`, or
        `UNWANTED_STREAM_S` for a stream, unless work on another shot waits.
        """
        with self._changed:
            if job in self._queue:
                self._remove(job, SupersededError())
            elif job in self._running:
                job.unwanted_s = job.unwanted_s or time.monotonic()
                if isinstance(job.work, StreamWork):
                    job.work.is_cancelled = True
                    self._signal_end(job)

    def close(self) -> None:
        """Fail the jobs that wait and those that run, and end their processes."""
        with self._changed:
            self._is_stopping = self._is_closed = True
            for job in list(self._queue):
                self._remove(job, StoppingError())
            for job in self._running:
                if job.process is not None:
                    job.process.kill("stopping")
            self._changed.notify_all()
        self._threads.shutdown()
        self._watcher.join()

    def _enqueue(
        self,
        work: CallWork[State] | StreamWork[State],
        place: Place,
        client: Client,
        group: Hashable | None,
        estimate_s: float = 0.0,
        view: Hashable | None = None,
        is_first: bool = False,
        output: JobOutput | None = None,
    ) -> Job[State]:
        with self._changed:
            if self._is_stopping:
                raise StoppingError
            # Checked before anything is superseded: older work of the group goes on where this job finds no room.
            same = [other for other in self._queue if group is not None and other.group == group]
            ahead = [other for other in self._queue if other not in same]
            if len(ahead) >= self._max_waiting:
                raise QueueFullError(
                    f"{len(ahead)} requests wait for the {self.role.name} lane already; try again soon."
                )
            if sum(other.client.principal == client.principal for other in ahead) >= self._max_waiting_each:
                raise QueueFullError(
                    f"{self._max_waiting_each} of your requests wait for the {self.role.name} lane already; try again soon."
                )
            serial = next(self._serials)
            position = min((other.position for other in same), default=serial)
            job = Job(work, place, client, group, serial, position, estimate_s, view=view, is_first=is_first)
            job.output = output
            if group is not None:
                self._supersede(group, same)
            self._queue.append(job)
            self._order.arrive(job)
            self._dispatch()
            return job

    def _supersede(self, group: Hashable, waiting: list[Job[State]]) -> None:
        for job in waiting:
            self._remove(job, SupersededError())
        for job in self._running:
            if job.group == group and isinstance(job.work, StreamWork):
                job.work.is_cancelled = True
                if job.work.has_yielded:  # otherwise after its first item
                    self._signal_end(job)

    def _signal_end(self, job: Job[State]) -> None:
        if job.process is not None:
            job.process.signals.cancelled_stream = job.serial

    def _remove(self, job: Job[State], error: Exception) -> None:
        self._queue.remove(job)
        if isinstance(job.work, StreamWork) or job.work.begin():
            job.work.fail(error)
        self._publish()

    def _publish(self) -> None:
        """Tell the running workers how many jobs wait."""
        for job in self._running:
            if job.process is not None:
                job.process.signals.queue_length = len(self._queue)

    def _dispatch(self) -> None:
        """Begin jobs while there is room."""
        while sum(not job.is_overdue for job in self._running) < self._slots:
            job = self._order.next(self._queue, self._running, self.pool.viewed(self.role).is_elsewhere)
            if job is None:
                break
            self._queue.remove(job)
            if not job.work.begin():
                if isinstance(job.work, StreamWork):
                    job.work.fail(SupersededError())
                continue
            job.begun_s = time.monotonic()
            self._order.begin(job)
            self._running.append(job)
            self._threads.submit(self._run, job)
            self._changed.notify_all()
        self._publish()

    def _run(self, job: Job[State]) -> None:
        """Run a job in a thread of the lane."""
        error: Exception | None = None
        is_complete, cpu_s = True, 0.0
        try:
            is_complete, cpu_s = self._run_in_worker(job)
        except Exception as cause:
            error, cpu_s = cause, job.cpu_s()
            if isinstance(error, WorkerDiedError):
                log.error("%s (%s)", error, error.end)
            with suppress(InvalidStateError):
                job.work.fail(error)
        finally:
            self._finish(job, is_complete=is_complete, cpu_s=cpu_s, error=error)

    def _run_in_worker(self, job: Job[State]) -> tuple[bool, float]:
        """Run a job in a worker that lives. Returns whether it came to its end, and the processor time that it took, s."""
        for _ in range(ATTEMPTS):
            process = self.pool.take(self.role, job.place, job.view)
            try:
                self._attach(job, process)
                with nullcontext() if job.output is None else job.output.collect(process.output):
                    is_complete = job.work.run(process, self._timeout_s * (os.cpu_count() or 1), job.serial)
                return is_complete, job.cpu_s()
            except NotBegunError:
                continue
            finally:
                job.steps = process.steps
                self.pool.give_back(process)
        raise WorkerDiedError(f"The {self.role.name} worker ended before it began with this request.", "killed")

    def _attach(self, job: Job[State], process: WorkerProcess[State]) -> None:
        """Note which process runs a job, which may have been cancelled meanwhile."""
        with self._changed:
            job.process, job.begun_cpu_s, job.worker = process, process.cpu_s(), process.pid
            job.starts_process = not process.has_served
            process.records_steps = job.observer is not None
            process.records_output = job.output is not None
            if self._is_closed:
                process.kill("stopping")
            if isinstance(job.work, StreamWork) and job.unwanted_s is not None:
                self._signal_end(job)
            self._publish()

    def _finish(self, job: Job[State], *, is_complete: bool, cpu_s: float, error: Exception | None) -> None:
        now_s = time.monotonic()
        waited_s, ran_s = job.begun_s - job.queued_s, now_s - job.begun_s
        finished = Finished(
            self.role.name,
            job.client,
            job.place,
            waited_s,
            ran_s,
            cpu_s,
            job.estimate_s,
            error,
            ended_ns=time.time_ns(),
            worker=job.worker,
            steps=job.steps,
            has_started_process=job.starts_process,
        )
        for tell in (self._on_finished, job.observer):
            with suppress(Exception):
                if tell is not None:
                    tell(finished)
        with self._changed:
            self._running.remove(job)
            is_shared = job.starts_process and not self.role.is_thrown_away  # those who come later use the process, too
            self._order.charge(job, ran_s, is_usual=is_shared or job.is_first)
            if not is_complete:
                self._requeue(job)
            self._order.forget_absent((*self._running, *self._queue))
            self._dispatch()

    def _requeue(self, job: Job[State]) -> None:
        """Put an interrupted stream at the end of the queue."""
        if self._is_closed:
            job.work.fail(StoppingError())
        elif not job.work.begin():
            job.work.fail(SupersededError())
        else:
            job.process, job.is_overdue, job.queued_s = None, False, time.monotonic()
            job.position = next(self._serials)
            self._queue.append(job)

    def _watch(self) -> None:
        """End jobs that take too long or that nobody wants, and let others begin beside those that are overdue."""
        with self._changed:
            while not self._is_closed:
                self._changed.wait(TICK_S if self._running else None)
                now_s = time.monotonic()
                for job in self._running:
                    self._watch_job(job, now_s)
                self._dispatch_beside_overdue(now_s)

    def _watch_job(self, job: Job[State], now_s: float) -> None:
        if job.process is None:
            return
        if now_s - job.begun_s > self._timeout_s:
            job.process.kill("timeout")
        elif job.unwanted_s is not None:
            # Work on the same shot waits the better for the process that has it open.
            is_in_the_way = any(other.place != job.place for other in self._queue)
            is_patient = isinstance(job.work, StreamWork) and not is_in_the_way
            most_s = UNWANTED_STREAM_S if is_patient else UNWANTED_S
            if now_s - job.unwanted_s > most_s:
                job.process.kill("cancelled")

    def _dispatch_beside_overdue(self, now_s: float) -> None:
        if not self._queue:
            return
        overdue = Counter(job.is_overdue for job in self._running)[True]
        for job in list(self._running):
            if not job.is_overdue and overdue < MAX_OVERDUE and _takes_long(job, now_s):
                job.is_overdue = True
                overdue += 1
        self._dispatch()


def _takes_long(job: Job[Any], now_s: float) -> bool:
    grace_s = job.work.grace_s
    return job.cpu_s() > PATIENCE_S + grace_s or now_s - job.begun_s > MAX_PATIENCE_S + grace_s
