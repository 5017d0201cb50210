"""Plan of the jobs bench, and its arguments. Imports little, so that the command line starts at once."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass

from render.errors import SettingsError
from render.lab.bench.bench import Bench

MOST_RENDERS = 1900
"""Renders of one sender that a queue takes, less some for the events."""
MOST_FRAMES = 10_000
MOST_WORKERS = 64
CLIENTS = (1, 4)
"""Clients that send requests at the same time, in turn."""


@dataclass(frozen=True)
class JobsPlan:
    """Plan of the measurements.

    Attributes:
        renders: that are in the queue.
        frames: of each of them.
        workers: numbers of workers, one after the other.
        frame_s: times that a worker sleeps for a frame, s, one after the other.
        seconds: time that each number of workers is expected to take, s.
        readers: of events, within the process and as many over HTTP.
        seed: of where readers begin and are cut off.
    """

    renders: int = 1000
    frames: int = 100
    workers: Sequence[int] = (1, 2, 4, 8)
    frame_s: Sequence[float] = (0.5, 2.0)
    seconds: float = 30.0
    readers: int = 6
    seed: int = 1

    def drawn_frames(self, workers: int, frame_s: float) -> int:
        """Return how many frames some workers draw: as many each, in about the time of the plan.

        Args:
            workers: how many.
            frame_s: time for a frame, s.
        """
        return workers * max(1, round(self.seconds / frame_s))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    parser.add_argument(
        "--json", metavar="FILE|-", help="write what was found for programs too; - in place of the table"
    )
    parser.add_argument(
        "--database",
        metavar="URL",
        default="",
        help="an empty PostgreSQL database, whose events are left there; without it SQLite",
    )
    parser.add_argument("--renders", metavar="N", type=int, default=JobsPlan.renders, help="that are in the queue")
    parser.add_argument("--frames", metavar="N", type=int, default=JobsPlan.frames, help="of each render")
    parser.add_argument(
        "--workers", metavar="N", type=int, nargs="+", default=JobsPlan.workers, help="numbers of workers"
    )
    parser.add_argument(
        "--frame-seconds",
        metavar="S",
        type=float,
        nargs="+",
        default=JobsPlan.frame_s,
        help="times that a worker sleeps for a frame",
    )
    parser.add_argument(
        "--seconds", metavar="S", type=float, default=JobsPlan.seconds, help="time for each number of workers"
    )
    parser.add_argument("--readers", metavar="N", type=int, default=JobsPlan.readers, help="readers of events")
    parser.add_argument(
        "--seed", metavar="N", type=int, default=JobsPlan.seed, help="of where readers begin and are cut off"
    )


def plan_from_arguments(arguments: argparse.Namespace) -> JobsPlan:
    """Plan from the command line's arguments.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: a number is out of range.
    """
    numbers = [
        ("--renders", arguments.renders, MOST_RENDERS),
        ("--frames", arguments.frames, MOST_FRAMES),
        ("--readers", arguments.readers, 30),
        *(("--workers", workers, MOST_WORKERS) for workers in arguments.workers),
    ]
    for name, number, most in numbers:
        if not 1 <= number <= most:
            raise SettingsError(f"{name} must be from 1 to {most:,}, got {number}")
    for name, value in (
        ("--seconds", arguments.seconds),
        *(("--frame-seconds", frame_s) for frame_s in arguments.frame_seconds),
    ):
        if not 0.01 <= value <= 3600:
            raise SettingsError(f"{name} must be from 0.01 to 3600, got {value:g}")
    return JobsPlan(
        arguments.renders,
        arguments.frames,
        tuple(arguments.workers),
        tuple(arguments.frame_seconds),
        arguments.seconds,
        arguments.readers,
        arguments.seed,
    )


BENCH = Bench(
    "jobs",
    "renders: requests about a queue of a thousand, how well workers are kept busy, and events that are missed or doubled",
    add_arguments,
    "service.bench.jobs.run",
)
"""Found through the entry point group ``pullfocus.benches``."""
