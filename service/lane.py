"""A lane: the queue before one worker process. Bounded, in order, and the newest request of a client wins.

A scrubbing page asks for more pictures than anyone can render. Requests carry a *group* (one client looking at one
shot); when a newer request of a group arrives, those of the same group that still wait are answered `superseded`.
The one that is being worked on is finished: its picture is cached and soon asked for again.
"""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Hashable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from service.errors import RETRY_AFTER, ServiceError
from service.process import Request, State, WorkerDiedError, WorkerFailedError, WorkerProcess, WorkerTimeoutError

log = logging.getLogger("pullfocus.service")
Reply = TypeVar("Reply")


@dataclass(eq=False)
class _Waiting(Generic[State]):
    request: Request[State, Any]
    group: Hashable | None
    future: Future[Any]


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
        self._queue: deque[_Waiting[State]] = deque()
        self._changed = threading.Condition()
        self._closing = False
        self._busy = False
        self._thread = threading.Thread(target=self._work, name=f"lane-{worker.name}", daemon=True)
        self._thread.start()

    @property
    def waiting(self) -> int:
        """Requests in the queue, the running one not counted."""
        return len(self._queue)

    @property
    def busy(self) -> bool:
        """Whether the worker is at work on a request."""
        return self._busy

    def submit(self, request: Request[State, Reply], *, group: Hashable | None = None) -> Future[Reply]:
        """Put a request in the queue; those of the same group that still wait are superseded.

        Raises:
            ServiceError: 503 ``busy`` when too many wait, or the lane is closed.
        """
        future: Future[Reply] = Future()
        with self._changed:
            if self._closing:
                raise _stopping()
            if group is not None:
                self._supersede(group)
            if len(self._queue) >= self._max_waiting:
                detail = f"{len(self._queue)} requests wait for the {self.worker.name} worker already; try again soon."
                raise ServiceError(503, "busy", detail, headers=RETRY_AFTER)
            self._queue.append(_Waiting(request, group, future))
            self._changed.notify()
        return future

    def _supersede(self, group: Hashable) -> None:
        old = [w for w in self._queue if w.group == group]
        for waiting in old:
            self._queue.remove(waiting)
            detail = "A newer request of the same client took this one's place."
            _drop(waiting, ServiceError(409, "superseded", detail))

    def close(self) -> None:
        """Answer what waits with 503, end the worker and the thread."""
        with self._changed:
            self._closing = True
            for waiting in self._queue:
                _drop(waiting, _stopping())
            self._queue.clear()
            self._changed.notify()
        self.worker.kill()
        self._thread.join()
        self.worker.close()

    def _work(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._queue or self._closing)
                if self._closing:
                    return
                waiting = self._queue.popleft()
            # False when the asker went away while the request waited: nobody wants the answer.
            if waiting.future.set_running_or_notify_cancel():
                self._busy = True
                self._answer(waiting)
                self._busy = False

    def _answer(self, waiting: _Waiting[State]) -> None:
        try:
            waiting.future.set_result(self.worker.call(waiting.request, self._timeout_s))
        except WorkerDiedError as error:
            waiting.future.set_exception(_stopping() if self._closing else _died(error))
        except WorkerTimeoutError as error:
            waiting.future.set_exception(ServiceError(504, "timeout", str(error)))
        except WorkerFailedError as error:
            waiting.future.set_exception(ServiceError(500, "internal", str(error)))
        except Exception as error:
            waiting.future.set_exception(error)


def _stopping() -> ServiceError:
    return ServiceError(503, "stopping", "The service is stopping.", headers=RETRY_AFTER)


def _died(error: WorkerDiedError) -> ServiceError:
    log.error("%s The next request starts another.", error)
    return ServiceError(503, "worker_died", str(error), headers=RETRY_AFTER)


def _drop(waiting: _Waiting[State], error: ServiceError) -> None:
    """Answer a request that will not be worked on, unless its asker went away."""
    if waiting.future.set_running_or_notify_cancel():
        waiting.future.set_exception(error)
