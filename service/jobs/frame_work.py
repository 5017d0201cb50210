"""Frames as executors draw them, and what becomes of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from render.errors import GraphicsError, OutputError, PullfocusError
from service.jobs.frame_logs import FrameLog
from service.picture.requests import DrawnFrame, FrameRequest
from service.workers.errors import End, UnfitError, WorkerDiedError
from service.workers.jobs import Client


@dataclass(frozen=True)
class FrameWork:
    """A frame to draw.

    Attributes:
        key: unique name of this attempt.
        request: the frame and its shot.
        formats: of its files.
        client: who it is drawn for.
        estimate_s: processor time that it is expected to take, s.
    """

    key: str
    request: FrameRequest
    formats: tuple[str, ...]
    client: Client
    estimate_s: float


class FrameError(Exception):
    """A frame that could not be drawn; the message is for people.

    Attributes:
        may_pass: whether another try may succeed.
    """

    def __init__(self, message: str, may_pass: bool) -> None:
        super().__init__(message, may_pass)
        self.message = message
        self.may_pass = may_pass

    def __str__(self) -> str:
        """Return the message."""
        return self.message


class LostFrameError(Exception):
    """The worker of a frame, or its scheduler, is gone: the frame itself may be drawn by another one."""


class Executor(Protocol):
    """Draws frames, on one machine or on many."""

    def places(self) -> Mapping[str, int]:
        """Return the workers that there are, and how many frames may be with each at a time."""
        ...

    async def draw(self, worker: str, work: FrameWork, log: FrameLog) -> DrawnFrame:
        """Draw a frame and return its files. Cancelling this ends the work.

        Args:
            worker: who draws it, of `places`.
            work: the frame.
            log: receives what the worker writes.

        Raises:
            FrameError: it could not be drawn.
            LostFrameError: the worker is gone.
            Exception: as `service.workers.lane.Lane.result`.
        """
        ...

    async def close(self) -> None:
        """Let go of the workers."""
        ...


def may_pass(error: Exception) -> bool:
    """Return whether another try may succeed where a frame could not be drawn."""
    if isinstance(error, FrameError):
        return error.may_pass
    if isinstance(error, PullfocusError):
        return isinstance(error, GraphicsError | OutputError)
    return not isinstance(error, UnfitError)


def end_of(error: Exception) -> End | None:
    """Return why the process ended that drew a frame; None where it did not."""
    return error.end if isinstance(error, WorkerDiedError) else None
