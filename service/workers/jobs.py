"""Work that waits or runs in a lane: calls, which have one reply, and streams, which have any number of items."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable
from concurrent.futures import Future
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from render.steps import Step
from service.workers.calls import Call, StreamCall
from service.workers.errors import SupersededError
from service.workers.output import JobOutput
from service.workers.places import Place
from service.workers.process import WorkerProcess

State = TypeVar("State")

LIKE_CPU_S, LIKE_S = 6.0, 20.0
"""Processor time, and time, for which a job keeps those of its shot waiting that would take as long as it in another process."""
FIRST_GRACE_S = 0.25
"""Time that a stream keeps others waiting after its first interruption; it doubles with each further one."""


@dataclass(frozen=True)
class Client:
    """Client that work is done for.

    Attributes:
        principal: whose key it is, or the address of a client without one; the work that waits is limited for each.
        viewer: a connection, or the principal; viewers take turns.
    """

    principal: str = ""
    viewer: Hashable = ""


NOBODY = Client()
"""The service itself."""


@dataclass(frozen=True)
class Finished:
    """A job that was run.

    Attributes:
        lane: name of the lane.
        client: who it was done for.
        place: the shot that it was about.
        waited_s: time in the queue, s.
        ran_s: time in the worker, s.
        cpu_s: processor time of the worker, s.
        estimate_s: processor time that it was expected to take, s; 0 where nobody has estimated it.
        error: what ended it, or None.
        ended_ns: time at which it ended, ns since 1970.
        worker: process id of its worker; 0 where there was none.
        steps: times of the call and its parts in the worker, where an observer asked for them.
        has_started_process: whether its process had to start and open the shot for it.
    """

    lane: str
    client: Client
    place: Place
    waited_s: float
    ran_s: float
    cpu_s: float
    estimate_s: float
    error: Exception | None
    ended_ns: int = 0
    worker: int = 0
    steps: tuple[Step, ...] = ()
    has_started_process: bool = False


Observer = Callable[[Finished], None]

observer: ContextVar[Observer | None] = ContextVar("observer", default=None)
"""Told of the jobs that the present task has begun, when they have ended. It must not raise. None for nobody."""


@dataclass(eq=False)
class CallWork(Generic[State]):
    """A call, and the future of its reply."""

    call: Call[State, Any]
    future: Future[Any] = field(default_factory=Future)
    grace_s: float = 0.0

    def begin(self) -> bool:
        """Mark the call as running. Returns False where the caller has cancelled it."""
        return self.future.running() or self.future.set_running_or_notify_cancel()

    def run(self, process: WorkerProcess[State], cpu_s: float, serial: int) -> bool:
        """Run the call to its end. Returns True."""
        self.future.set_result(process.call(self.call, cpu_s))
        return True

    def fail(self, error: Exception) -> None:
        """End the call with an error, after `begin`."""
        self.future.set_exception(error)


@dataclass(eq=False)
class StreamWork(Generic[State]):
    """A stream. The callbacks run in a thread of the lane and must not raise.

    Attributes:
        call: the generator function and its arguments.
        on_item: called with each item.
        on_end: called once, after the last item; with the error that ended the stream, or None.
        has_yielded: whether there was an item, in this run or an interrupted one.
        is_cancelled: whether its items are of no more use.
        grace_s: time that it keeps others waiting after its first item.
    """

    call: StreamCall[State, Any]
    on_item: Callable[[Any], None]
    on_end: Callable[[Exception | None], None]
    has_yielded: bool = False
    is_cancelled: bool = False
    grace_s: float = 0.0

    def begin(self) -> bool:
        """Return False where the stream was cancelled."""
        return not self.is_cancelled

    def run(self, process: WorkerProcess[State], cpu_s: float, serial: int) -> bool:
        """Run the stream, or a part of it. Returns False where it was interrupted and has to run again."""

        def deliver(item: Any) -> None:
            self.has_yielded = True
            if self.is_cancelled:
                process.signals.cancelled_stream = serial
            self.on_item(item)

        is_complete = process.stream(
            self.call, cpu_s, deliver, serial=serial, has_yielded=self.has_yielded, grace_s=self.grace_s
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


@dataclass(eq=False)
class Job(Generic[State]):
    """Work in a lane.

    Attributes:
        work: the call or stream.
        place: the shot that it is about.
        client: who it is done for.
        group: newer work of the same group replaces it.
        serial: its number, not 0.
        estimate_s: processor time that it was expected to take, s; 0 where nobody has estimated it.
        position: orders the jobs of one viewer: its number, that of the job whose place it took, or a new one where it was
            interrupted.
        view: the view that it draws, or None.
        is_first: whether its viewer has no picture yet.
        queued_s: monotonic time at which it was queued.
        begun_s: monotonic time at which it last began to run.
        begun_cpu_s: processor time that its process had used before, s.
        process: runs it, or None.
        starts_process: whether its process has answered nothing before.
        is_overdue: whether it runs for so long that it no longer keeps others waiting.
        unwanted_s: monotonic time at which the client of a running call went away, or None.
        observer: told when it has run.
        worker: process id of the last worker that ran it; 0 for none.
        steps: times that it told.
        output: collects what the process writes to standard error, and the steps of the call; None for nobody.
    """

    work: CallWork[State] | StreamWork[State]
    place: Place
    client: Client
    group: Hashable | None
    serial: int
    position: int
    estimate_s: float = 0.0
    view: Hashable | None = None
    is_first: bool = False
    queued_s: float = field(default_factory=time.monotonic)
    begun_s: float = 0.0
    begun_cpu_s: float = 0.0
    process: WorkerProcess[State] | None = None
    starts_process: bool = False
    is_overdue: bool = False
    unwanted_s: float | None = None
    observer: Observer | None = field(default_factory=observer.get)
    worker: int = 0
    steps: tuple[Step, ...] = ()
    output: JobOutput | None = None

    def cpu_s(self) -> float:
        """Return the processor time that it has used since it last began, s."""
        return 0.0 if self.process is None else max(0.0, self.process.cpu_s() - self.begun_cpu_s)

    def holds_up_its_shot(self, now_s: float) -> bool:
        """Whether other jobs of its shot wait for it: until it is overdue.

        Where another process would take as long, because it had to open the shot or because previews of one shot are alike, they
        wait for longer.

        Args:
            now_s: monotonic time.
        """
        are_alike = self.starts_process or isinstance(self.work, StreamWork)
        return not self.is_overdue or (are_alike and now_s - self.begun_s < LIKE_S and self.cpu_s() < LIKE_CPU_S)
