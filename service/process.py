"""A worker process: it answers one request at a time, and a fresh one takes its place when it dies.

Work that can take the process down with it (a graphics driver, a parser fed with a stranger's file) runs here, so that
the process that speaks HTTP never does. A request is an object with a ``run(state)`` method; it is pickled to the
worker, and what ``run`` returns or raises is pickled back. ``state`` is made once in the worker and lives as long as it.
"""

from __future__ import annotations

import logging
import multiprocessing
import pickle
import signal
import traceback
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from render.errors import InputError, PullfocusError, SettingsError

log = logging.getLogger("pullfocus.service")

State_contra = TypeVar("State_contra", contravariant=True)
State = TypeVar("State")
Reply_co = TypeVar("Reply_co", covariant=True)
Reply = TypeVar("Reply")


class Request(Protocol[State_contra, Reply_co]):
    """Work that can be sent to a worker: picklable, and run there."""

    def run(self, state: State_contra, /) -> Reply_co:
        """Do the work in the worker process."""


class WorkerDiedError(Exception):
    """The worker process ended while it worked on a request."""


class WorkerTimeoutError(Exception):
    """The worker did not answer in time and was ended."""


class WorkerFailedError(Exception):
    """The request raised something that is nobody's bad input: a fault of the program. The worker lives on."""


@dataclass(frozen=True)
class _Answer:
    """What comes back over the pipe: a value, an error that was raised on purpose, or the traceback of a fault."""

    value: object = None
    error: PullfocusError | None = None
    fault: str = ""

    @property
    def is_value(self) -> bool:
        """Whether the request did what it was to do."""
        return self.error is None and not self.fault


class WorkerProcess(Generic[State]):
    """The parent's side. Not thread-safe: one thread calls it (see ``service.lane``).

    Args:
        name: of the process, for logs.
        make_state: called once in the worker; a function of a module, since it is sent by name.

    Attributes:
        starts: how many workers there have been.
        proven: whether the present one has done work, and not failed since.
    """

    def __init__(self, name: str, make_state: Callable[[], State]) -> None:
        self.name = name
        self.starts = 0
        self.proven = False
        self._make_state = make_state
        self._process: BaseProcess | None = None
        self._pipe: Connection | None = None

    @property
    def pid(self) -> int | None:
        """Process id of the worker, or None before the first request and after a death."""
        return self._process.pid if self._process is not None and self._process.is_alive() else None

    def call(self, request: Request[State, Reply], timeout_s: float) -> Reply:
        """Run a request in the worker, starting one when there is none.

        Raises:
            PullfocusError: the request raised it.
            WorkerDiedError: the worker died on it; the next call starts another.
            WorkerTimeoutError: no answer in ``timeout_s``; the worker was ended.
            WorkerFailedError: the request raised anything else.
        """
        process, pipe = self._running()
        try:
            pipe.send(request)
            ready = wait([pipe, process.sentinel], timeout_s)
            if not ready:
                self.close()
                raise WorkerTimeoutError(f"The {self.name} worker took longer than {timeout_s:g} s and was ended.")
            # A worker that answered and then died still leaves its answer in the pipe: read that first.
            answer = pipe.recv()
        except (EOFError, OSError) as error:
            self.close()
            raise WorkerDiedError(f"The {self.name} worker ended while it worked on this request.") from error
        value: Reply = self._unpack(answer)
        return value

    def _unpack(self, answer: _Answer) -> Any:
        self.proven = self.proven if isinstance(answer.error, InputError | SettingsError) else answer.is_value
        if answer.error is not None:
            raise answer.error
        if answer.fault:
            log.error("the %s worker failed:\n%s", self.name, answer.fault)
            raise WorkerFailedError(f"The {self.name} worker failed on this request; the service's log says why.")
        return answer.value

    def _running(self) -> tuple[BaseProcess, Connection]:
        if self._process is None or self._pipe is None or not self._process.is_alive():
            self.close()
            context = multiprocessing.get_context("spawn")  # a forked GL context or USD thread pool would be broken
            here, there = context.Pipe()
            process = context.Process(
                target=_serve, args=(there, self._make_state), name=f"pullfocus-{self.name}", daemon=True
            )
            process.start()
            there.close()
            self._process, self._pipe = process, here
            self.starts += 1
        return self._process, self._pipe

    def kill(self) -> None:
        """End the worker under whatever it is doing; the one method that any thread may call."""
        if self._process is not None and self._process.is_alive():
            self._process.kill()

    def close(self) -> None:
        """End the worker and let go of it."""
        if self._pipe is not None:
            self._pipe.close()
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process.close()
        self._process = self._pipe = None
        self.proven = False


def _serve(pipe: Connection, make_state: Callable[[], State]) -> None:
    """The worker's side: answer requests until the parent is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent, which then closes the pipe
    with suppress(OSError):  # Linux alone has it: when memory runs out, a worker goes and the service stays
        Path("/proc/self/oom_score_adj").write_text("500")
    state = make_state()
    with suppress(EOFError, BrokenPipeError):  # the parent is gone
        while True:
            request: Request[State, object] = pipe.recv()
            pipe.send_bytes(_answer(request, state))


def _answer(request: Request[State, object], state: State) -> bytes:
    """Run a request; pickled here, where a reply that cannot be pickled is still an answer and no death."""
    try:
        answer = _Answer(value=request.run(state))
        return pickle.dumps(answer)
    except PullfocusError as error:
        return pickle.dumps(_Answer(error=error))
    except Exception:
        return pickle.dumps(_Answer(fault=traceback.format_exc()))
