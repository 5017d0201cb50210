"""Output of worker processes: the steps of a call, and what its libraries and the graphics driver write to standard error.

It is in memory of a fixed size that the service and the worker share. A worker never waits for a reader, and what it has written
remains when it crashes. What does not fit is lost.
"""

from __future__ import annotations

import os
import re
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import UTC, datetime

from service.workers.shared_memory import create_shared

MOST_OUTPUT = 64 << 10
"""Size of the output of one call, bytes."""
_NEARLY_FULL = MOST_OUTPUT - (4 << 10)
_FULL = "Further lines may be missing: this log is full."
_CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")
"""Characters that steer a terminal."""


class WorkerOutput:
    """The service's side of the output of a worker process. Any thread may use it.

    Args:
        descriptor: of the memory, from `create_output`; it is closed by `close`.
    """

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._last: bytes | None = None
        self._lock = threading.Lock()

    def begin(self) -> None:
        """Forget what earlier calls have written."""
        with self._lock:
            if self._last is None:
                os.lseek(self._descriptor, 0, os.SEEK_SET)

    def read(self) -> bytes:
        """Return what was written since `begin`."""
        with self._lock:
            return self._read() if self._last is None else self._last

    def close(self) -> None:
        """Close the memory; what was written stays readable."""
        with self._lock:
            if self._last is None:
                self._last = self._read()
                os.close(self._descriptor)

    def _read(self) -> bytes:
        written = os.lseek(self._descriptor, 0, os.SEEK_CUR)  # of the worker: the two share one open file
        return os.pread(self._descriptor, min(written, MOST_OUTPUT), 0)


class JobOutput:
    """Output of a job, in whatever process it runs. Any thread may use it."""

    def __init__(self) -> None:
        self._ended = b""
        self._present: WorkerOutput | None = None
        self._is_over = False
        self._lock = threading.Lock()

    @contextmanager
    def collect(self, output: WorkerOutput) -> Iterator[None]:
        """Collect the output of a process while it runs the job; what it wrote before is forgotten."""
        output.begin()
        with self._lock:
            self._present = output
        try:
            yield
        finally:
            with self._lock:
                self._ended, self._present = self._ended + output.read(), None

    def end(self) -> None:
        """Note that the job has ended: half a line at the end is whole, though the process may not be given back yet."""
        self._is_over = True

    def text(self) -> str:
        """Return the whole lines that there are so far, without characters that steer a terminal."""
        with self._lock:
            content = self._ended + (b"" if self._present is None else self._present.read())
            is_running = self._present is not None and not self._is_over
        if is_running:
            content = content[: content.rfind(b"\n") + 1]
        elif content and not content.endswith(b"\n"):
            content += b"\n"
        text = _CONTROLS.sub("", content.decode("utf-8", "replace"))
        return f"{text}{_FULL}\n" if len(content) > _NEARLY_FULL and not is_running else text


def create_output() -> int:
    """Create the memory of a worker's output and return its descriptor."""
    return create_shared("pullfocus-output", MOST_OUTPUT)


class Redirection:
    """Sends the standard error of this process, a worker, to its output or to where it went before.

    Python's own, with logs and tracebacks, goes where it went before, to those who run the service.

    Args:
        descriptor: of the output's memory.
    """

    def __init__(self, descriptor: int) -> None:
        self._output = descriptor
        self._usual = os.dup(2)
        sys.stderr = os.fdopen(self._usual, "w", buffering=1, errors="backslashreplace", closefd=False)
        self._is_on = False

    def set(self, is_on: bool) -> None:
        """Send it to the output, or to where it went before."""
        if is_on != self._is_on:
            os.dup2(self._output if is_on else self._usual, 2)
            self._is_on = is_on


def write_line(text: str, at_s: float) -> None:
    """Write a line to standard error; it is lost where that is full.

    Args:
        text: of the line.
        at_s: time, s since 1970.
    """
    with suppress(OSError):
        os.write(2, log_line(text, at_s).encode("utf-8", "replace"))


def log_line(text: str, at_s: float) -> str:
    """Return a line of a log, with its time (UTC) and its end.

    Args:
        text: of the line; the ends of lines in it become spaces.
        at_s: time, s since 1970.
    """
    time = datetime.fromtimestamp(at_s, UTC).isoformat(timespec="milliseconds").removesuffix("+00:00")
    return f"{time}Z {' '.join(text.split())}\n"
