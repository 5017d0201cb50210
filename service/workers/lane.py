"""A lane: the queue before one worker process. Bounded, in order, and the newest request of a client wins.

A scrubbing page asks for more pictures than anyone can render. Requests carry a *group* (one client looking at one
shot); when a newer request of a group arrives, those of the same group that still wait are answered `superseded`.
The one that is being worked on is finished: its picture is cached and soon asked for again.

A *stream* (`service.workers.streaming`) is work that goes on for long and shows something every now and then. It makes way: for a
newer one of its group for good, once it has shown something (else a hand that moves would never see anything), and for
other work that waits until that is done. Each time it is put off like this it may work for longer before the next time,
so that it too comes to its end however many others there are.
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

from service.http.errors import RETRY_AFTER, ServiceError
from service.workers.calls import Call, StreamCall
from service.workers.process import (
    State,
    WorkerDiedError,
    WorkerFailedError,
    WorkerProcess,
    WorkerTimeoutError,
)

log = logging.getLogger("pullfocus.service")
Reply = TypeVar("Reply")
Item = TypeVar("Item")

FIRST_PATIENCE_S = 0.25
"""How long others wait for a stream that was put off once; twice as long each time after that."""


@dataclass(eq=False)
class _Waiting(Generic[State]):
    """A request, and who wants its answer."""

    call: Call[State, Any]
    group: Hashable | None
    future: Future[Any]

    def begin(self) -> bool:
        """Whether somebody still waits for the answer, so that it is worth beginning."""
        return self.future.set_running_or_notify_cancel()

    def answer(self, worker: WorkerProcess[State], timeout_s: float) -> bool:
        """Have it done. Always the end of it."""
        self.future.set_result(worker.call(self.call, timeout_s))
        return True

    def fail(self, error: Exception) -> None:
        """Answer with an error, after `begin`."""
        self.future.set_exception(error)


@dataclass(eq=False)
class Stream(Generic[State]):
    """A streamed request in a lane. The last two functions are called in the lane's thread, and must not raise.

    Attributes:
        call: the generator function and its arguments.
        group: whose newer work takes its place.
        serial: its number.
        on_item: called with each answer.
        on_end: called once, when no answer comes any more; with an error, or None where all went well.
    """

    call: StreamCall[State, Any]
    group: Hashable | None
    serial: int
    on_item: Callable[[Any], None]
    on_end: Callable[[Exception | None], None]
    has_shown: bool = False
    is_wanted: bool = True
    patience_s: float = 0.0

    def begin(self) -> bool:
        """Whether it is still wanted."""
        return self.is_wanted

    def answer(self, worker: WorkerProcess[State], timeout_s: float) -> bool:
        """Have it done, or some of it. Returns whether that was the end of it."""

        def deliver(item: Any) -> None:
            self.has_shown = True
            if not self.is_wanted:
                worker.signals.dropped = self.serial
            self.on_item(item)

        has_ended = worker.stream(
            self.call,
            timeout_s,
            deliver,
            serial=self.serial,
            has_shown=self.has_shown,
            patience_s=self.patience_s,
        )
        if has_ended or not self.is_wanted:
            self.on_end(None if has_ended else _superseded())
            return True
        self.patience_s = max(FIRST_PATIENCE_S, 2 * self.patience_s)
        return False

    def fail(self, error: Exception) -> None:
        """End it with an error."""
        self.is_wanted = False
        self.on_end(error)


_Job = _Waiting[State] | Stream[State]


class Lane(Generic[State]):
    """Feeds one worker from a bounded queue, in a thread of its own.

    Args:
        worker: the process that does the work; the lane owns it.
        max_waiting: requests that may wait, the running one not counted.
        timeout_s: time for one request, waiting not counted.
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
        self._thread = threading.Thread(target=self._work, name=f"lane-{worker.name}", daemon=True)
        self._thread.start()

    @property
    def waiting(self) -> int:
        """Requests in the queue, the running one not counted."""
        return len(self._queue)

    @property
    def busy(self) -> bool:
        """Whether the worker is at work on a request."""
        return self._running is not None

    def submit(self, call: Call[State, Reply], *, group: Hashable | None = None) -> Future[Reply]:
        """Put a request in the queue; those of the same group that still wait are superseded.

        Raises:
            ServiceError: 503 ``busy`` when too many wait, or the lane is closed.
        """
        future: Future[Reply] = Future()
        self._enqueue(_Waiting(call, group, future))
        return future

    async def result(self, call: Call[State, Reply], group: Hashable | None = None) -> Reply:
        """Put a call in the queue and wait for its reply; see `submit`."""
        return await asyncio.wrap_future(self.submit(call, group=group))

    def stream(
        self,
        call: StreamCall[State, Item],
        *,
        on_item: Callable[[Item], None],
        on_end: Callable[[Exception | None], None],
        group: Hashable | None = None,
    ) -> Stream[State]:
        """Put a streamed request in the queue; those of the same group that wait or run are superseded.

        Args:
            call: the generator function and its arguments.
            on_item: called with each answer, in a thread of the lane's; it must not raise.
            on_end: called once, when no answer comes any more, likewise; with an error, or None where all went well.
            group: one client looking at one shot.

        Returns:
            For `drop`.

        Raises:
            ServiceError: 503 ``busy`` when too many wait, or the lane is closed.
        """
        stream = Stream(call, group, next(self._serials), on_item, on_end)
        self._enqueue(stream)
        return stream

    def drop(self, stream: Stream[State]) -> None:
        """Have a stream end as soon as it can: nobody wants it any more. Does nothing where it has ended.

        Args:
            stream: as `stream` gave it.
        """
        with self._changed:
            stream.is_wanted = False
            if stream in self._queue:
                self._remove(stream, _superseded())
            elif stream is self._running:
                self.worker.signals.dropped = stream.serial

    def _enqueue(self, job: _Job[State]) -> None:
        with self._changed:
            if self._closing:
                raise _stopping()
            # First, since what is older of its group goes on where there is no room for this one.
            ahead = [other for other in self._queue if job.group is None or other.group != job.group]
            if len(ahead) >= self._max_waiting:
                detail = f"{len(ahead)} requests wait for the {self.worker.name} worker already; try again soon."
                raise ServiceError(503, "busy", detail, headers=RETRY_AFTER)
            if job.group is not None:
                self._supersede(job.group)
            self._queue.append(job)
            self._tell()

    def _supersede(self, group: Hashable) -> None:
        for job in [job for job in self._queue if job.group == group]:
            self._remove(job, _superseded())
        running = self._running
        if isinstance(running, Stream) and running.group == group:
            running.is_wanted = False
            if running.has_shown:  # else as soon as it has
                self.worker.signals.dropped = running.serial

    def _remove(self, job: _Job[State], error: ServiceError) -> None:
        self._queue.remove(job)
        if isinstance(job, Stream) or job.begin():
            job.fail(error)
        self._tell()

    def _tell(self) -> None:
        """Let the lane's thread, and the worker in its work, know what waits."""
        self.worker.signals.waiting = len(self._queue)
        self._changed.notify()

    def close(self) -> None:
        """Answer what waits with 503, end the worker and the thread."""
        with self._changed:
            self._closing = True
            for job in list(self._queue):
                self._remove(job, _stopping())
            self._changed.notify()
        self.worker.kill()
        self._thread.join()
        self.worker.close()

    def _work(self) -> None:
        while True:
            with self._changed:
                self._running = None
                self._changed.wait_for(lambda: self._queue or self._closing)
                if self._closing:
                    return
                job = self._queue.popleft()
                self._tell()
                # False when the asker went away while the request waited: nobody wants the answer.
                if not job.begin():
                    continue
                self._running = job
            if not self._answer(job):
                self._put_off(job)

    def _put_off(self, job: _Job[State]) -> None:
        """Let a stream that made way wait behind the others."""
        with self._changed:
            if self._closing:
                job.fail(_stopping())
            elif not job.begin():
                job.fail(_superseded())
            else:
                self._queue.append(job)
                self._tell()

    def _answer(self, job: _Job[State]) -> bool:
        """Have a request done; whether it came to its end."""
        try:
            return job.answer(self.worker, self._timeout_s)
        except WorkerDiedError as error:
            job.fail(_stopping() if self._closing else _died(error))
        except WorkerTimeoutError as error:
            job.fail(ServiceError(504, "timeout", str(error)))
        except WorkerFailedError as error:
            job.fail(ServiceError(500, "internal", str(error)))
        except Exception as error:
            job.fail(error)
        return True


def _superseded() -> ServiceError:
    return ServiceError(409, "superseded", "A newer request of the same client took this one's place.")


def _stopping() -> ServiceError:
    return ServiceError(503, "stopping", "The service is stopping.", headers=RETRY_AFTER)


def _died(error: WorkerDiedError) -> ServiceError:
    log.error("%s The next request starts another.", error)
    return ServiceError(503, "worker_died", str(error), headers=RETRY_AFTER)
