"""Requests for a worker process that needs neither USD nor GL."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
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


@dataclass(frozen=True)
class Refine:
    """Shows its word with 0, 1, 2 and so on, each after so many pieces of work, and then runs ``ending``."""

    word: str = ""
    shows: int = 3
    pieces: int = 1
    piece_s: float = 0.005
    ending: object = None

    def stream(self, state: Tally, is_stale: Callable[[], bool]) -> Iterator[tuple[str, int]]:
        for number in range(self.shows):
            for _ in range(self.pieces):
                if is_stale():
                    return
                time.sleep(self.piece_s)
            yield self.word, number
        if self.ending is not None:
            self.ending.run(state)
