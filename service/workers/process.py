"""A worker process as the service sees it: it runs one call at a time, for one shot.

Work that can crash a process (a graphics driver, a parser reading an untrusted file) runs here and never in the HTTP process.
A `service.workers.calls.Call` is sent to the worker; the reply, or the error that was raised, comes back. The worker creates its
``state`` once and passes it to every call. A `StreamCall` has any number of replies.
"""

from __future__ import annotations

import logging
import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Hashable, Iterator
from contextlib import ExitStack, suppress
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Generic, TypeVar

from render.steps import Step
from service.workers.calls import Call, StreamCall
from service.workers.errors import (
    End,
    StoppingError,
    SupersededError,
    UnfitError,
    WorkerDiedError,
    WorkerError,
    WorkerFailedError,
)
from service.workers.forking import Exit, Forked, Template
from service.workers.messages import (
    Answer,
    Assignment,
    Begun,
    Order,
    UnsafeMessageError,
    pack,
    receive_answer,
)
from service.workers.output import WorkerOutput, create_output
from service.workers.places import Place
from service.workers.roles import Role
from service.workers.step_times import checked_steps
from service.workers.streaming import Signals, create_memory

log = logging.getLogger("pullfocus.service")

State = TypeVar("State")
Reply = TypeVar("Reply")
Item = TypeVar("Item")

KEPT_VIEWS = 64
"""Views that a process is expected to keep drawings of."""
NEAR_LIMIT = 0.6
"""A worker that crashed with this share of its memory in use is taken to have run out of it: allocators ask for large pieces."""
_TICKS_PER_S = os.sysconf("SC_CLK_TCK")
_PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")


class NotBegunError(Exception):
    """The worker ended before it began with the call, which can be sent to another one."""


class WorkerProcess(Generic[State]):
    """A worker process. One thread at a time calls it; any thread may end it.

    Args:
        template: forks it.
        role: its kind.
        place: the shot that it serves.
        gpu: number of the GPU that it draws on, or None for the one that the driver prefers.
        cache: folder of its own that it may write; None for none.
        base: folder that the cache begins as a copy of; None for an empty one.

    Attributes:
        role: its kind.
        place: the shot that it serves.
        cache: its cache folder, which remains when it has ended.
        signals: interrupt a running stream; any thread may set them.
        output: what it has written to standard error, and the steps of its call.
        end: why it ended, or None.
        has_served: whether it has answered a call: its state is made.
        views: the last ones that it was taken for.
        rested_cpu_s: processor time that it had used when its last call ended, s.
        records_steps: whether the times of the steps of its next calls are wanted.
        records_output: whether their output is.
        steps: those of its last call.

    Raises:
        WorkerDiedError: it cannot be started.
    """

    def __init__(
        self,
        template: Template,
        role: Role[State],
        place: Place,
        gpu: int | None = None,
        *,
        cache: Path | None = None,
        base: Path | None = None,
    ) -> None:
        self.role = role
        self.place = place
        self.cache = cache
        self.end: End | None = None
        self.has_served = False
        self.views: deque[Hashable] = deque(maxlen=KEPT_VIEWS)
        self.rested_cpu_s = 0.0
        self.records_steps = self.records_output = False
        self.steps: tuple[Step, ...] = ()
        self._template = template
        self._ending: End | None = None
        self._is_reaped = False
        self._peak_bytes = 0
        self._ended_cpu_s = 0.0
        self._lock = threading.Lock()
        self._oom_kills = _count_oom_kills()
        try:
            self._pipe, self._forked, self.signals, self.output = _start(template)
        except OSError as error:
            raise WorkerDiedError(f"No worker process can be started: {error.strerror}.", "killed") from error
        with suppress(OSError):  # it has ended already: the first call finds out
            self._pipe.send_bytes(pack(Assignment(role, place, gpu, cache, base)))

    @property
    def pid(self) -> int:
        """Process id; another process may have it after the end."""
        return self._forked.pid

    def is_alive(self) -> bool:
        """Whether the worker, which runs no call, can take one: it has not ended, and no signal has stopped it."""
        try:  # an idle worker sends nothing: what comes is its end
            return self.end is None and not self._pipe.poll() and not self._is_stopped()
        except OSError:
            return False

    def _is_stopped(self) -> bool:
        fields = self._stat()
        return bool(fields) and fields[0] in ("T", "t")

    def _stat(self) -> list[str]:
        """Fields of ``/proc/PID/stat`` from the state on; none where the worker has ended."""
        with suppress(OSError):
            return Path(f"/proc/{self.pid}/stat").read_text().rpartition(")")[2].split()
        return []

    def cpu_s(self) -> float:
        """Processor time that the worker has used, s."""
        if self.end is not None:
            return self._ended_cpu_s
        fields = self._stat()
        return (int(fields[11]) + int(fields[12])) / _TICKS_PER_S if fields else 0.0

    def memory_bytes(self) -> int:
        """Memory that the worker holds for itself, without what it shares with its template; 0 where it has ended."""
        with suppress(OSError, ValueError, IndexError):
            _, resident, shared, *_ = Path(f"/proc/{self.pid}/statm").read_text().split()
            return (int(resident) - int(shared)) * _PAGE_BYTES
        return 0

    def peak_bytes(self) -> int:
        """Most memory that the worker has held, with what it shares with its template; once it has ended, until its end."""
        found = self._status("VmHWM") if self.end is None else None
        return self._peak_bytes if found is None else found * 1024

    def threads(self) -> int:
        """Count the worker's threads; 0 where it has ended."""
        return self._status("Threads") or 0

    def shared_bytes(self) -> int:
        """Memory that the worker has mapped to be shared, which no limit of the kernel counts; 0 where it has ended."""
        return (self._status("RssShmem") or 0) * 1024

    def _status(self, name: str) -> int | None:
        """A number of ``/proc/PID/status``; None where the worker has ended."""
        with suppress(OSError):
            for line in Path(f"/proc/{self.pid}/status").read_text().splitlines():
                if line.startswith(f"{name}:"):
                    return int(line.split()[1])
        return None

    def call(self, call: Call[State, Reply], cpu_s: float) -> Reply:
        """Run a call in the worker.

        Args:
            call: the function and its arguments.
            cpu_s: processor time that it may take, s.

        Raises:
            PullfocusError: the function raised it.
            NotBegunError: the worker had ended before.
            WorkerError: the worker ended during the call, or the function raised anything else.
        """
        value: Reply = self._unpack(next(self._answers(self._order(call, cpu_s))))
        return value

    def stream(
        self,
        call: StreamCall[State, Item],
        cpu_s: float,
        deliver: Callable[[Item], None],
        *,
        serial: int,
        has_yielded: bool = False,
        grace_s: float = 0.0,
    ) -> bool:
        """Run a stream call in the worker.

        Args:
            call: the generator function and its arguments.
            cpu_s: processor time that it may take, s.
            deliver: called with each item.
            serial: number of the stream in `signals`; unique, not 0.
            has_yielded: as for `service.workers.streaming.StaleCheck`.
            grace_s: likewise.

        Returns:
            Whether it came to its end; False where it was interrupted or cancelled.

        Raises:
            PullfocusError: the function raised it; and the other errors of `call`.
        """
        for answer in self._answers(self._order(call, cpu_s, serial, has_yielded, grace_s)):
            value = self._unpack(answer)
            if not answer.is_last:
                deliver(value)
        return bool(value)

    def _order(
        self,
        call: Call[State, Any] | StreamCall[State, Any],
        cpu_s: float,
        serial: int = 0,
        has_yielded: bool = False,
        grace_s: float = 0.0,
    ) -> Order[State]:
        return Order(call, cpu_s, serial, has_yielded, grace_s, self.records_steps, self.records_output)

    def _answers(self, order: Order[State]) -> Iterator[Answer]:
        """Send an order and yield its answers."""
        has_begun = False
        self.steps = ()
        self._oom_kills = _count_oom_kills()
        try:
            self._pipe.send_bytes(pack(order))
            while True:
                answer = receive_answer(self._pipe)
                if isinstance(answer, Begun):
                    has_begun = True
                    continue
                if answer.is_last:
                    self.has_served = True
                    self.steps = checked_steps(answer.steps)
                yield answer
                if answer.is_last:
                    return
        except UnsafeMessageError as error:
            log.error("the %s worker was ended: %s", self.role.name, error)
            raise _explain(self.role, self.close("unsafe")) from error
        except (EOFError, OSError) as error:
            end = self._reap()
            if not has_begun and self._ending is None:
                self.end = "killed"  # whatever it was, the call is not to blame for it
                raise NotBegunError from error
            raise _explain(self.role, end) from error

    def _unpack(self, answer: Answer) -> Any:
        if answer.error is not None:
            raise answer.error
        if answer.fault:
            log.error("the %s worker failed:\n%s", self.role.name, answer.fault)
            raise WorkerFailedError(f"The {self.role.name} worker failed on this request; the service's log says why.")
        return answer.value

    def kill(self, why: End) -> None:
        """End the worker at once. The thread that runs a call there gets the error that belongs to the reason.

        Work that takes too long because the worker was stopped from outside is not to blame for it: it was ``killed``.
        """
        with self._lock:
            if not self._is_reaped:
                if why == "timeout" and self._is_stopped():
                    why = "killed"
                self._ending = self._ending or why
                self._forked.kill()

    def close(self, why: End = "released") -> End:
        """End the worker, release what it holds, and return why it ended."""
        self.kill(why)
        return self._reap()

    def _reap(self) -> End:
        """Release what an ended worker holds, and find out why it ended."""
        with self._lock:
            if self.end is None:
                self._forked.kill()  # it may have closed its pipe and go on
                self._is_reaped = True  # its number may be another process's from here on
                self._pipe.close()
                self.output.close()
                found = self._template.reap(self._forked)
                self._peak_bytes = found.peak_bytes if found is not None else 0
                self._ended_cpu_s = found.cpu_s if found is not None else 0.0
                self.end = self._ending or _judge(found, self.role, _count_oom_kills() - self._oom_kills)
            return self.end


def _start(template: Template) -> tuple[Connection, Forked, Signals, WorkerOutput]:
    """Have a worker forked. Raises `WorkerDiedError`; `OSError`: there are no more descriptors or no memory."""
    with ExitStack() as kept, ExitStack() as given:
        here, there = Pipe()
        kept.callback(here.close)
        given.callback(there.close)
        memory = create_memory()
        given.callback(os.close, memory)
        signals = Signals(memory)
        output = create_output()
        kept.callback(os.close, output)
        forked = template.fork(there.fileno(), memory, output)
        kept.pop_all()
        return here, forked, signals, WorkerOutput(output)


def _judge(end: Exit | None, role: Role[Any], oom_kills: int) -> End:
    """Judge why a worker ended that the service did not end."""
    if end is None:
        return "killed"
    if end.signal == signal.SIGXCPU:
        return "cpu"
    if end.signal == signal.SIGKILL:
        return "memory" if oom_kills else "killed"
    return "memory" if end.peak_bytes > NEAR_LIMIT * role.limits.memory_bytes else "crash"


def _explain(role: Role[Any], end: End) -> WorkerError:
    match end:
        case "memory":
            limit_mb = role.limits.memory_bytes >> 20
            return UnfitError(
                f"This takes more than the {limit_mb:,} MiB of memory that a {role.name} worker has.", end
            )
        case "timeout" | "cpu":
            return UnfitError(f"This takes longer than a {role.name} worker may work on a request.", end)
        case "disk":
            return UnfitError(f"This fills more of the disk than a {role.name} worker has for temporary files.", end)
        case "threads":
            return UnfitError(f"This starts more threads than a {role.name} worker may have.", end)
        case "crash" | "unsafe":
            return UnfitError(f"The {role.name} worker crashed on this request.", end)
        case "stopping":
            return StoppingError()
        case "cancelled":
            return SupersededError()
        case "killed" | "released":
            return WorkerDiedError(f"The {role.name} worker was ended while it worked on this request.", end)


def _count_oom_kills() -> int:
    """Count the processes of this machine that the kernel has ended because memory ran out; 0 where it does not say."""
    with suppress(OSError, ValueError):
        for line in Path("/proc/vmstat").read_text().splitlines():
            name, count = line.split()
            if name == "oom_kill":
                return int(count)
    return 0
