"""Queue of one worker process: bounded and in order, except that the newest call of a group replaces its predecessors.

A page that scrubs through time asks for more pictures than can be rendered. Calls carry a *group* (one client viewing one shot);
when a newer call of a group arrives, those of the group that still wait fail with `SupersededError`. The one that is running is
finished: its picture is cached and likely to be requested again.

A *stream* is a long call that yields items on the way. It ends early for a newer call of its group, once it has yielded an item
(else a moving pointer would never see a picture), and it is put back in the queue for other calls that wait. Each time this
happens it may run longer before the next time, so that it reaches its end however many other calls there are.
"""

from __future__ import annotations

import asyncio
import itertools
import logging
import threading
from collections import deque
from collections.abc import Callable, Hashable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from service.workers.calls import Call, StreamCall
from service.workers.errors import QueueFullError, StoppingError, SupersededError, WorkerDiedError
from service.workers.process import WorkerProcess

log = logging.getLogger("pullfocus.service")
State = TypeVar("State")
Reply = TypeVar("Reply")
Item = TypeVar("Item")

FIRST_GRACE_S = 0.25
"""Time that a stream keeps others waiting after its first interruption; it doubles with each further one."""


@dataclass(eq=False)
class _QueuedCall(Generic[State]):
    """A call in a queue, and the future of its reply."""

    call: Call[State, Any]
    group: Hashable | None
    future: Future[Any]

    def begin(self) -> bool:
        """Mark the call as running. Returns False where the caller has cancelled it."""
        return self.future.set_running_or_notify_cancel()

    def run(self, worker: WorkerProcess[State], timeout_s: float) -> bool:
        """Run the call to its end. Returns True."""
        self.future.set_result(worker.call(self.call, timeout_s))
        return True

    def fail(self, error: Exception) -> None:
        """End the call with an error, after `begin`."""
        self.future.set_exception(error)


@dataclass(eq=False)
class QueuedStream(Generic[State]):
    """A stream in a queue. The callbacks run in the queue's thread and must not raise.

    Attributes:
        call: the generator function and its arguments.
        group: newer work of the same group replaces it.
        serial: its number; not 0.
        on_item: called with each item.
        on_end: called once, after the last item; with the error that ended the stream, or None.
        has_yielded: whether there was an item, in this run or an interrupted one.
        is_cancelled: whether its items are of no more use.
        grace_s: time that it keeps others waiting after its first item.
    """

    call: StreamCall[State, Any]
    group: Hashable | None
    serial: int
    on_item: Callable[[Any], None]
    on_end: Callable[[Exception | None], None]
    has_yielded: bool = False
    is_cancelled: bool = False
    grace_s: float = 0.0

    def begin(self) -> bool:
        """Return False where the stream was cancelled."""
        return not self.is_cancelled

    def run(self, worker: WorkerProcess[State], timeout_s: float) -> bool:
        """Run the stream, or a part of it. Returns False where it was interrupted and has to run again."""

        def deliver(item: Any) -> None:
            self.has_yielded = True
            if self.is_cancelled:
                worker.signals.cancelled_stream = self.serial
            self.on_item(item)

        is_complete = worker.stream(
            self.call, timeout_s, deliver, serial=self.serial, has_yielded=self.has_yielded, grace_s=self.grace_s
        )
        if is_complete or self.is_cancelled:
            self.on_end(None if is_complete else SupersededError())
            return True
        self.grace_s = max(FIRST_GRACE_S, 2 * self.grace_s)
        return False

    def fail(self, error: Exception) -> None:
        """End the stream with an error."""
        self.is_cancelled = True
        self.on_end(error)


_Job = _QueuedCall[State] | QueuedStream[State]


class WorkerQueue(Generic[State]):
    """Bounded queue that feeds one worker process from a thread of its own.

    Args:
        worker: the process, which the queue owns.
        max_waiting: calls that may wait, the running one not counted.
        timeout_s: time for one call, waiting not counted.
    """

    def __init__(self, worker: WorkerProcess[State], *, max_waiting: int, timeout_s: float) -> None:
        self.worker = worker
        self._max_waiting = max_waiting
        self._timeout_s = timeout_s
        self._queue: deque[_Job[State]] = deque()
        self._running: _Job[State] | None = None
        self._serials = itertools.count(1)
        self._changed = threading.Condition()
        self._closing = False
        self._thread = threading.Thread(target=self._work, name=f"queue-{worker.name}", daemon=True)
        self._thread.start()

    @property
    def waiting(self) -> int:
        """Calls in the queue, the running one not counted."""
        return len(self._queue)

    @property
    def busy(self) -> bool:
        """Whether the worker is running a call."""
        return self._running is not None

    def submit(self, call: Call[State, Reply], *, group: Hashable | None = None) -> Future[Reply]:
        """Put a call in the queue; those of the same group that still wait are superseded.

        Raises:
            QueueFullError: too many calls wait.
            StoppingError: the queue is closed.
        """
        future: Future[Reply] = Future()
        self._enqueue(_QueuedCall(call, group, future))
        return future

    async def result(self, call: Call[State, Reply], group: Hashable | None = None) -> Reply:
        """Put a call in the queue and wait for its reply; see `submit`."""
        return await asyncio.wrap_future(self.submit(call, group=group))

    def submit_stream(
        self,
        call: StreamCall[State, Item],
        *,
        on_item: Callable[[Item], None],
        on_end: Callable[[Exception | None], None],
        group: Hashable | None = None,
    ) -> QueuedStream[State]:
        """Put a stream in the queue; calls of the same group that wait, and a stream of it that runs, are superseded.

        Args:
            call: the generator function and its arguments.
            on_item: called with each item, in the queue's thread; it must not raise.
            on_end: called once after the last item, likewise; with the error that ended the stream, or None.
            group: one client viewing one shot.

        Returns:
            The stream, for `cancel_stream`.

        Raises:
            QueueFullError: too many calls wait.
            StoppingError: the queue is closed.
        """
        stream = QueuedStream(call, group, next(self._serials), on_item, on_end)
        self._enqueue(stream)
        return stream

    def cancel_stream(self, stream: QueuedStream[State]) -> None:
        """End a stream as soon as possible. Does nothing where it has ended.

        Args:
            stream: as `submit_stream` returned it.
        """
        with self._changed:
            stream.is_cancelled = True
            if stream in self._queue:
                self._remove(stream, SupersededError())
            elif stream is self._running:
                self.worker.signals.cancelled_stream = stream.serial

    def close(self) -> None:
        """Fail the calls that wait, end the worker and the thread."""
        with self._changed:
            self._closing = True
            for job in list(self._queue):
                self._remove(job, StoppingError())
            self._changed.notify()
        self.worker.kill()
        self._thread.join()
        self.worker.close()

    def _enqueue(self, job: _Job[State]) -> None:
        with self._changed:
            if self._closing:
                raise StoppingError
            # Checked before anything is superseded: older work of the group goes on where this job finds no room.
            ahead = [other for other in self._queue if job.group is None or other.group != job.group]
            if len(ahead) >= self._max_waiting:
                name = self.worker.name
                raise QueueFullError(f"{len(ahead)} requests wait for the {name} worker already; try again soon.")
            if job.group is not None:
                self._supersede(job.group)
            self._queue.append(job)
            self._notify()

    def _supersede(self, group: Hashable) -> None:
        for job in [job for job in self._queue if job.group == group]:
            self._remove(job, SupersededError())
        running = self._running
        if isinstance(running, QueuedStream) and running.group == group:
            running.is_cancelled = True
            if running.has_yielded:  # otherwise after its first item
                self.worker.signals.cancelled_stream = running.serial

    def _remove(self, job: _Job[State], error: Exception) -> None:
        self._queue.remove(job)
        if isinstance(job, QueuedStream) or job.begin():
            job.fail(error)
        self._notify()

    def _notify(self) -> None:
        """Publish the length of the queue to the thread and to the worker."""
        self.worker.signals.queue_length = len(self._queue)
        self._changed.notify()

    def _work(self) -> None:
        while True:
            with self._changed:
                self._running = None
                self._changed.wait_for(lambda: self._queue or self._closing)
                if self._closing:
                    return
                job = self._queue.popleft()
                self._notify()
                if not job.begin():
                    continue
                self._running = job
            if not self._run(job):
                self._requeue(job)

    def _requeue(self, job: _Job[State]) -> None:
        """Put an interrupted stream at the end of the queue."""
        with self._changed:
            if self._closing:
                job.fail(StoppingError())
            elif not job.begin():
                job.fail(SupersededError())
            else:
                self._queue.append(job)
                self._notify()

    def _run(self, job: _Job[State]) -> bool:
        """Run a job. Returns False where it is an interrupted stream."""
        try:
            return job.run(self.worker, self._timeout_s)
        except WorkerDiedError as error:
            if self._closing:
                job.fail(StoppingError())
            else:
                log.error("%s The next request starts another.", error)
                job.fail(error)
        except Exception as error:
            job.fail(error)
        return True
