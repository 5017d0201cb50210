"""Errors of the worker processes and their queues, other than those that the called function raises.

::

    WorkerError
    ├── QueueFullError        too many calls wait
    ├── SupersededError       a newer call of the same group replaced this one
    ├── StoppingError         the service is stopping
    ├── WorkerDiedError       the process ended during the call
    ├── WorkerTimeoutError    the process took too long and was ended
    └── WorkerFailedError     the function raised something that is no `PullfocusError`: a bug
"""

from __future__ import annotations

from typing import ClassVar


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
    """The worker process ended during the call; the next call starts another."""

    code = "worker_died"


class WorkerTimeoutError(WorkerError):
    """The worker process did not reply in time and was ended."""

    code = "timeout"


class WorkerFailedError(WorkerError):
    """The function raised something other than a `PullfocusError`: a bug. The worker lives on."""
