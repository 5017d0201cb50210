"""Requests for a worker process that needs neither USD nor GL."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass

from render.errors import StageError


class Tally:
    """A worker's state: counts what it was asked."""

    def __init__(self) -> None:
        self.asked = 0


@dataclass(frozen=True)
class Echo:
    """Answers with its word, and how many requests this worker has seen."""

    word: str = ""
    pause_s: float = 0.0

    def run(self, state: Tally) -> tuple[str, int]:
        time.sleep(self.pause_s)
        state.asked += 1
        return self.word, state.asked


@dataclass(frozen=True)
class Refuse:
    def run(self, state: Tally) -> None:
        raise StageError("set.usda is no USD stage", code="stage_unreadable", path="set.usda")


@dataclass(frozen=True)
class Fault:
    def run(self, state: Tally) -> None:
        raise ZeroDivisionError("a fault of the program")


@dataclass(frozen=True)
class Crash:
    """Ends the process as a driver's segmentation fault would: no exception, no goodbye."""

    def run(self, state: Tally) -> None:
        os._exit(139)


@dataclass(frozen=True)
class Unsendable:
    """Answers with what no pipe can carry."""

    def run(self, state: Tally) -> object:
        return lambda: None


@dataclass(frozen=True)
class ProcessId:
    def run(self, state: Tally) -> int:
        return os.getpid()
