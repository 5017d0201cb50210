"""A worker process: it runs one call at a time, and a fresh process replaces it when it dies.

Work that can crash a process (a graphics driver, a parser reading an untrusted file) runs here and never in the HTTP process.
A `service.workers.calls.Call` is pickled to the worker; the reply, or the error that was raised, is pickled back. The worker
creates its ``state`` once and passes it to every call. A `StreamCall` has any number of replies.
"""

from __future__ import annotations

import logging
import multiprocessing
import pickle
import signal
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, Generic, TypeVar

from render.errors import InputError, PullfocusError, SettingsError
from service.workers.calls import Call, StreamCall, name_of, resolve
from service.workers.errors import WorkerDiedError, WorkerFailedError, WorkerTimeoutError
from service.workers.streaming import Signals, StaleCheck

log = logging.getLogger("pullfocus.service")

State = TypeVar("State")
Reply = TypeVar("Reply")
Item = TypeVar("Item")


@dataclass(frozen=True)
class _Answer:
    """A message from the worker: a value, an error that was raised on purpose, or the traceback of a bug."""

    value: object = None
    error: PullfocusError | None = None
    fault: str = ""
    is_last: bool = True

    @property
    def is_value(self) -> bool:
        """Whether the call succeeded."""
        return self.error is None and not self.fault


@dataclass(frozen=True)
class _StreamOrder(Generic[State]):
    """A stream call as it is sent to the worker."""

    call: StreamCall[State, Any]
    serial: int
    has_yielded: bool
    grace_s: float


class WorkerProcess(Generic[State]):
    """The parent's side of a worker process. Not thread-safe: one thread calls it (see `service.workers.worker_queue`).

    Args:
        name: of the process, for logs.
        make_state: registered class or function that creates the worker's state, or a reference to it; sent by name.

    Attributes:
        starts: number of processes started so far.
        proven: whether the current process has completed a call and has not failed since.
        signals: interrupt a running stream; any thread may set them.
    """

    def __init__(self, name: str, make_state: Callable[[], State]) -> None:
        self.name = name
        self.starts = 0
        self.proven = False
        self._make_state = name_of(make_state)
        # A forked GL context or USD thread pool would be broken.
        self._context = multiprocessing.get_context("spawn")
        self.signals = Signals(self._context)
        self._process: BaseProcess | None = None
        self._pipe: Connection | None = None

    @property
    def pid(self) -> int | None:
        """Process id of the worker, or None before the first request and after a death."""
        return self._process.pid if self._process is not None and self._process.is_alive() else None

    def call(self, call: Call[State, Reply], timeout_s: float) -> Reply:
        """Run a call in the worker, starting one when there is none.

        Raises:
            PullfocusError: the function raised it.
            WorkerDiedError: the worker died; the next call starts another.
            WorkerTimeoutError: no answer in ``timeout_s``; the worker was ended.
            WorkerFailedError: the function raised anything else.
        """
        value: Reply = self._unpack(next(self._answers(call, timeout_s)))
        return value

    def stream(
        self,
        call: StreamCall[State, Item],
        timeout_s: float,
        deliver: Callable[[Item], None],
        *,
        serial: int,
        has_yielded: bool = False,
        grace_s: float = 0.0,
    ) -> bool:
        """Run a stream call in the worker, starting one when there is none.

        Args:
            call: the generator function and its arguments.
            timeout_s: time for all of it.
            deliver: called with each item.
            serial: number of the stream in `signals`; unique, not 0.
            has_yielded: as for `service.workers.streaming.StaleCheck`.
            grace_s: likewise.

        Returns:
            Whether it came to its end; False where it was interrupted or cancelled.

        Raises:
            PullfocusError: the function raised it; and the other errors of `call`.
        """
        for answer in self._answers(_StreamOrder(call, serial, has_yielded, grace_s), timeout_s):
            value = self._unpack(answer)
            if not answer.is_last:
                deliver(value)
        return bool(value)

    def _answers(self, order: object, timeout_s: float) -> Iterator[_Answer]:
        """Send an order to the worker, starting one when there is none, and yield its answers."""
        process, pipe = self._ensure_running()
        deadline_s = time.monotonic() + timeout_s
        answer = None
        try:
            pipe.send(order)
            while answer is None or not answer.is_last:
                if not wait([pipe, process.sentinel], deadline_s - time.monotonic()):
                    self.close()
                    raise WorkerTimeoutError(f"The {self.name} worker took longer than {timeout_s:g} s and was ended.")
                # The answer of a worker that then died is still in the pipe.
                answer = pipe.recv()
                yield answer
        except (EOFError, OSError) as error:
            self.close()
            raise WorkerDiedError(f"The {self.name} worker ended while it worked on this request.") from error

    def _unpack(self, answer: _Answer) -> Any:
        self.proven = self.proven if isinstance(answer.error, InputError | SettingsError) else answer.is_value
        if answer.error is not None:
            raise answer.error
        if answer.fault:
            log.error("the %s worker failed:\n%s", self.name, answer.fault)
            raise WorkerFailedError(f"The {self.name} worker failed on this request; the service's log says why.")
        return answer.value

    def _ensure_running(self) -> tuple[BaseProcess, Connection]:
        if self._process is None or self._pipe is None or not self._process.is_alive():
            self.close()
            here, there = self._context.Pipe()
            arguments = (there, self._make_state, self.signals)
            process = self._context.Process(target=_serve, args=arguments, name=f"pullfocus-{self.name}", daemon=True)
            process.start()
            there.close()
            self._process, self._pipe = process, here
            self.starts += 1
        return self._process, self._pipe

    def kill(self) -> None:
        """End the worker at once. The only method that any thread may call."""
        if self._process is not None and self._process.is_alive():
            self._process.kill()

    def close(self) -> None:
        """End the worker and release its pipe."""
        if self._pipe is not None:
            self._pipe.close()
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process.close()
        self._process = self._pipe = None
        self.proven = False


def _serve(pipe: Connection, make_state: str, signals: Signals) -> None:
    """Run calls until the parent is gone. Runs in the worker."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C ends the parent, which then closes the pipe
    with suppress(OSError):  # Linux only: when memory runs out, the kernel ends a worker rather than the service
        Path("/proc/self/oom_score_adj").write_text("500")
    state = resolve(make_state)()
    with suppress(EOFError, BrokenPipeError):  # the parent is gone
        while True:
            order: Call[Any, object] | _StreamOrder[Any] = pipe.recv()
            pipe.send_bytes(_answer(order, state, pipe, signals))


def _answer(
    order: Call[State, object] | _StreamOrder[State], state: State, pipe: Connection, signals: Signals
) -> bytes:
    """Run a call and pickle its reply. A reply that cannot be pickled is a fault of the program, not the end of the worker."""
    try:
        if isinstance(order, _StreamOrder):
            return pickle.dumps(_Answer(value=_stream(order, state, pipe, signals)))
        return pickle.dumps(_Answer(value=order.run(state)))
    except (EOFError, BrokenPipeError):  # the parent is gone
        raise
    except PullfocusError as error:
        return pickle.dumps(_Answer(error=error))
    except Exception:
        return pickle.dumps(_Answer(fault=traceback.format_exc()))


def _stream(order: _StreamOrder[State], state: State, pipe: Connection, signals: Signals) -> bool:
    """Send the items of a stream. Returns whether the stream came to its end."""
    is_stale = StaleCheck(signals, order.serial, has_yielded=order.has_yielded, grace_s=order.grace_s)
    items: Any = order.call.run(state, is_stale)
    with closing(items):
        for item in items:
            pipe.send_bytes(pickle.dumps(_Answer(value=item, is_last=False)))
            is_stale.has_yielded = True
    return not is_stale.has_ended
