"""The service's side of the template process: it starts the template, and has it fork workers."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from service.workers.errors import WorkerDiedError
from service.workers.template import MESSAGE_BYTES


@dataclass(frozen=True)
class Exit:
    """End of a worker process.

    Attributes:
        signal: the signal that ended it, 0 for none.
        peak_bytes: the most memory that it held.
    """

    signal: int = 0
    peak_bytes: int = 0


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

    @property
    def pid(self) -> int | None:
        """Process id, or None where it does not run."""
        return self._process.pid if self._process is not None and self._process.poll() is None else None

    def fork(self, pipe_fd: int, signals_fd: int) -> Forked:
        """Start a worker.

        Args:
            pipe_fd: descriptor of its end of the pipe.
            signals_fd: descriptor of its `service.workers.streaming.Signals`.

        Raises:
            WorkerDiedError: no process can be started.
        """
        with self._lock:
            for attempt in range(2):  # a template that died since the last fork is replaced
                self._ensure()
                try:
                    answer = self._ask({"do": "fork"}, [pipe_fd, signals_fd])
                    break
                except (OSError, EOFError) as error:
                    self._end()
                    if attempt:
                        raise WorkerDiedError(
                            "No worker process can be started; the service's log says why."
                        ) from error
            if "pid" not in answer:
                raise WorkerDiedError(f"No worker process can be started: {answer['error']}.")
            return Forked(answer["pid"], self._starts)

    def reap(self, worker: Forked) -> Exit | None:
        """Wait for a worker that has ended, or was killed, and return how it ended; None where it ended with its template."""
        with self._lock:
            if worker.template == self._starts and self._control is not None:
                with suppress(OSError, EOFError):
                    answer = self._ask({"do": "reap", "pid": worker.pid})
                    status = answer["status"]
                    return Exit(os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0, answer["peak_bytes"])
        return None

    def close(self) -> None:
        """End the process, and with it all its workers."""
        with self._lock:
            self._end()

    def _ensure(self) -> None:
        if self._process is not None and self._process.poll() is None:
            return
        self._end()
        here, there = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        environment = self._environment | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
        command = [sys.executable, "-s", "-P", "-m", "service.workers.template", str(there.fileno()), self._preload]
        with there:
            self._process = subprocess.Popen(
                command, env=environment, pass_fds=[there.fileno()], stdin=subprocess.DEVNULL, close_fds=True
            )
        self._control = here
        self._starts += 1
        try:
            threads = self._receive()["threads"]
        except (OSError, EOFError) as error:
            self._end()
            raise WorkerDiedError("The template of the workers cannot start; the service's log says why.") from error
        if threads != 1:
            self._end()
            raise WorkerDiedError(f"The template of the workers has {threads} threads, which a fork would not copy.")

    def _ask(self, request: Mapping[str, object], descriptors: list[int] | None = None) -> dict[str, Any]:
        assert self._control is not None
        socket.send_fds(self._control, [json.dumps(request).encode()], descriptors or [])
        return self._receive()

    def _receive(self) -> dict[str, Any]:
        assert self._control is not None
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
