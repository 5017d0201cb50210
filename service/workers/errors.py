"""Errors of the worker processes and their queues, other than those that the called function raises.

::

    WorkerError
    ├── QueueFullError        too many calls wait
    ├── SupersededError       a newer call of the same group replaced this one, or its client has gone
    ├── StoppingError         the service is stopping
    ├── WorkerDiedError       the process ended during the call
    │   └── UnfitError        because of what it worked on
    └── WorkerFailedError     the function raised something that is no `PullfocusError`: a bug
"""

from __future__ import annotations

from typing import ClassVar, Literal

End = Literal[
    "memory", "crash", "cpu", "timeout", "disk", "threads", "unsafe", "killed", "cancelled", "stopping", "released"
]
"""Why a worker process ended: ``released`` where it was of no more use. `BLAMED` are those that the shot is to blame for."""
BLAMED: tuple[End, ...] = ("memory", "crash", "cpu", "timeout", "disk", "threads", "unsafe")


class WorkerError(Exception):
    """A call that a worker process did not complete; the message is one sentence.

    Attributes:
        code: short stable word for programs.
    """

    code: ClassVar[str] = "internal"


class QueueFullError(WorkerError):
    """Too many calls wait for the worker already."""

    code = "busy"


class SupersededError(WorkerError):
    """A newer call of the same group replaced this one."""

    code = "superseded"

    def __init__(self) -> None:
        super().__init__("A newer request of the same client took this one's place.")


class StoppingError(WorkerError):
    """The service is stopping."""

    code = "stopping"

    def __init__(self) -> None:
        super().__init__("The service is stopping.")


class WorkerDiedError(WorkerError):
    """The worker process ended during the call; the next call starts another.

    Attributes:
        end: why it ended.
    """

    code = "worker_died"

    def __init__(self, message: str, end: End = "crash") -> None:
        super().__init__(message)
        self.end = end


class UnfitError(WorkerDiedError):
    """The request ended the worker process: it crashed it, or took more memory, time or disk than a worker has."""

    code = "unfit"


class WorkerFailedError(WorkerError):
    """The function raised something other than a `PullfocusError`: a bug. The worker lives on."""
