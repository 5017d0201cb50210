"""Plan of the service bench, and its arguments. Imports little, so that the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from typing import Literal, get_args

from render.errors import SettingsError
from render.lab.bench.bench import Bench

Drag = Literal["focus", "time", "mixed"]

VIEWERS, SECONDS, PHASE_S, WIDTH, RATE = 50, 20.0, 10.0, 480, 30.0
MOST_VIEWERS = 1000
MOST_WIDTH = 4096
"""Width of a 16:9 picture that the service renders with its default limits, pixels."""


@dataclass(frozen=True)
class LoadPlan:
    """Plan of the measurements.

    Attributes:
        viewers: live viewers who drag at the same time.
        seconds: time that they drag, s.
        phase_s: time of each of the three phases in which the delays of others are measured, s.
        width: of the viewers' pictures, pixels.
        rate: requests of each viewer a second.
        drag: what they drag; with `mixed` every other one drags the time.
        first: whether the service starts for the first time on its machine, with no shader compiled.
    """

    viewers: int = VIEWERS
    seconds: float = SECONDS
    phase_s: float = PHASE_S
    width: int = WIDTH
    rate: float = RATE
    drag: Drag = "focus"
    first: bool = False


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    parser.add_argument(
        "--json", metavar="FILE|-", help="write what was found for programs too; - in place of the table"
    )
    parser.add_argument(
        "--viewers", metavar="N", type=int, default=VIEWERS, help="live viewers who drag at the same time"
    )
    parser.add_argument("--seconds", metavar="S", type=float, default=SECONDS, help="time that they drag")
    parser.add_argument(
        "--phase", metavar="S", type=float, default=PHASE_S, help="time of each of three phases that measure delays"
    )
    parser.add_argument("--width", metavar="PX", type=int, default=WIDTH, help="of the viewers' pictures")
    parser.add_argument("--rate", metavar="N", type=float, default=RATE, help="requests of each viewer a second")
    parser.add_argument("--drag", choices=get_args(Drag), default="focus", help="what the viewers drag")
    parser.add_argument(
        "--first", action="store_true", help="measure the first start on a machine, with no shader compiled in advance"
    )


def plan_from_arguments(arguments: argparse.Namespace) -> LoadPlan:
    """Plan from the command line's arguments.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: a number is out of range.
    """
    if not 1 <= arguments.viewers <= MOST_VIEWERS:
        raise SettingsError(f"--viewers must be from 1 to {MOST_VIEWERS}, got {arguments.viewers}")
    if not 16 <= arguments.width <= MOST_WIDTH:
        raise SettingsError(f"--width must be from 16 to {MOST_WIDTH}, got {arguments.width}")
    for name, value in (("--seconds", arguments.seconds), ("--phase", arguments.phase), ("--rate", arguments.rate)):
        if not 0 < value <= 3600:
            raise SettingsError(f"{name} must be more than 0 and at most 3600, got {value:g}")
    return LoadPlan(
        arguments.viewers,
        arguments.seconds,
        arguments.phase,
        arguments.width,
        arguments.rate,
        arguments.drag,
        arguments.first,
    )


BENCH = Bench(
    "service",
    "the service: how fair it is to many live viewers, and how long one absurd request delays the others",
    add_arguments,
    "service.bench.run",
)
"""Found through the entry point group ``pullfocus.benches``."""
