"""The service's side of the template process: it starts the template, and has it fork workers."""

from __future__ import annotations

import json
import logging
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import Any

from service.workers.errors import WorkerDiedError
from service.workers.template import MESSAGE_BYTES

log = logging.getLogger("pullfocus.service")

START_S = 60.0
"""Time that a template has to import what workers need, s."""
ANSWER_S = 10.0
"""Time that a template has to fork a worker, or to reap one, s. One that takes longer is broken, and is replaced."""


@dataclass(frozen=True)
class Exit:
    """End of a worker process.

    Attributes:
        signal: the signal that ended it, 0 for none.
        peak_bytes: the most memory that it held.
        cpu_s: processor time that it used, s.
    """

    signal: int = 0
    peak_bytes: int = 0
    cpu_s: float = 0.0


@dataclass(frozen=True)
class Forked:
    """A worker process that a template has forked.

    Attributes:
        pid: process id, valid until it is reaped.
        template: number of its template, which alone can reap it.
    """

    pid: int
    template: int

    def kill(self) -> None:
        """End it at once. Any thread may call this, before it is reaped."""
        with suppress(ProcessLookupError):
            os.kill(self.pid, signal.SIGKILL)


class Template:
    """A template process, started by the first fork and again after a death. Any thread may use it.

    Args:
        preload: module whose import prepares all workers.
        environment: of the workers, but for ``PYTHONPATH``, which is this process's path.
    """

    def __init__(self, preload: str, environment: Mapping[str, str]) -> None:
        self._preload = preload
        self._environment = dict(environment)
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._control: socket.socket | None = None
        self._starts = 0
        self._is_closed = False

    @property
    def pid(self) -> int | None:
        """Process id, or None where it does not run."""
        return self._process.pid if self._process is not None and self._process.poll() is None else None

    def fork(self, pipe_fd: int, signals_fd: int, output_fd: int) -> Forked:
        """Start a worker.

        Args:
            pipe_fd: descriptor of its end of the pipe.
            signals_fd: descriptor of its `service.workers.streaming.Signals`.
            output_fd: descriptor of its output, from `service.workers.output.create_output`.

        Raises:
            WorkerDiedError: no process can be started.
        """
        with self._lock:
            answer = self._ask_living({"do": "fork"}, [pipe_fd, signals_fd, output_fd])
            return Forked(answer["pid"], self._starts)

    def check(self, within_s: float) -> None:
        """See that workers can be forked. A template that does not answer is replaced.

        Args:
            within_s: time that it has to become free, s; `ANSWER_S` and `START_S` bound the rest.

        Raises:
            WorkerDiedError: it is not so.
        """
        with self._locked(within_s):
            self._ask_living({"do": "try"})

    def reap(self, worker: Forked) -> Exit | None:
        """Wait for a worker that has ended, or was killed, and return how it ended; None where it ended with its template."""
        with self._lock:
            if worker.template == self._starts and self._control is not None:
                try:
                    answer = self._ask({"do": "reap", "pid": worker.pid})
                except (OSError, EOFError):  # the answer that is missing would be taken for that of the next request
                    self._end()
                    return None
                status = answer["status"]
                return Exit(os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0, answer["peak_bytes"], answer["cpu_s"])
        return None

    def close(self) -> None:
        """End the process, and with it all its workers. No more can be started."""
        with self._lock:
            self._is_closed = True
            self._end()

    @contextmanager
    def _locked(self, within_s: float) -> Iterator[None]:
        if not self._lock.acquire(timeout=within_s):
            raise WorkerDiedError(f"The template of the workers was not free within {within_s:g} s.", "killed")
        try:
            yield
        finally:
            self._lock.release()

    def _ask_living(self, request: Mapping[str, object], descriptors: list[int] | None = None) -> dict[str, Any]:
        """Ask the template; one that died since it was last asked, or does not answer, is replaced."""
        if self._is_closed:
            raise WorkerDiedError("No worker process can be started: the service is stopping.", "stopping")
        for _ in range(2):
            self._ensure()
            try:
                answer = self._ask(request, descriptors)
            except (OSError, EOFError) as error:
                log.error("the template of the workers is replaced: %s", error or "it has ended")
                self._end()
                continue
            if "error" in answer:
                raise WorkerDiedError(f"No worker process can be started: {answer['error']}.", "killed")
            return answer
        raise WorkerDiedError("No worker process can be started; the service's log says why.", "killed")

    def _ensure(self) -> None:
        if self._process is not None and self._process.poll() is None:
            return
        self._end()
        try:
            threads = self._start()
        except (OSError, EOFError) as error:
            self._end()
            raise WorkerDiedError(
                "The template of the workers cannot start; the service's log says why.", "killed"
            ) from error
        if threads != 1:
            self._end()
            raise WorkerDiedError(f"The template of the workers has {threads} threads, which a fork would not copy.")

    def _start(self) -> int:
        """Start the process and wait until it has imported everything. Returns the number of its threads."""
        here, there = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._control = here
        environment = self._environment | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
        command = [sys.executable, "-s", "-P", "-m", "service.workers.template", str(there.fileno()), self._preload]
        with there:
            self._process = _start_kept(command, environment, there)
        self._starts += 1
        threads: int = self._receive(START_S)["threads"]
        return threads

    def _ask(self, request: Mapping[str, object], descriptors: list[int] | None = None) -> dict[str, Any]:
        assert self._control is not None
        socket.send_fds(self._control, [json.dumps(request).encode()], descriptors or [])
        return self._receive(ANSWER_S)

    def _receive(self, within_s: float) -> dict[str, Any]:
        assert self._control is not None
        self._control.settimeout(within_s)
        message = self._control.recv(MESSAGE_BYTES)
        if not message:
            raise EOFError
        answer: dict[str, Any] = json.loads(message)
        return answer

    def _end(self) -> None:
        if self._control is not None:
            self._control.close()
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        self._process = self._control = None


def _start_kept(command: list[str], environment: Mapping[str, str], control: socket.socket) -> subprocess.Popen[bytes]:
    """Start a template in a thread that lasts as long as it does: the kernel ends a template with the thread that started it."""
    started: Future[subprocess.Popen[bytes]] = Future()

    def keep() -> None:
        try:
            process = subprocess.Popen(
                command, env=environment, pass_fds=[control.fileno()], stdin=subprocess.DEVNULL, close_fds=True
            )
        except BaseException as error:
            started.set_exception(error)
            return
        started.set_result(process)
        process.wait()

    threading.Thread(target=keep, name="template", daemon=True).start()
    return started.result()
