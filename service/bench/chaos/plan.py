"""Plan of the chaos bench, and its arguments. Imports little, so that the command line starts at once."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from typing import get_args

from render.errors import SettingsError
from render.lab.bench.bench import Bench
from service.bench.chaos.strikes import Strike

DATABASES = ("postgresql", "sqlite")


@dataclass(frozen=True)
class ChaosPlan:
    """Plan of the bench.

    Attributes:
        frames: of the render.
        workers: that join the scheduler.
        strikes: number of them, spread evenly over the frames.
        width: of the pictures, pixels.
        rays: per pixel.
        database: ``postgresql`` for a server of the bench's own, or ``sqlite``.
        disk_mb: size of the disk that fills, MiB.
        limit_s: time after which a render that has not ended is stuck, s.
        seed: of the order of strikes.
    """

    frames: int = 96
    workers: int = 2
    strikes: int = 24
    width: int = 320
    rays: int = 64
    database: str = DATABASES[0]
    disk_mb: int = 768
    limit_s: float = 3600.0
    seed: int = 1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    parser.add_argument(
        "--json", metavar="FILE|-", help="write what was found for programs too; - in place of the table"
    )
    parser.add_argument("--database", choices=DATABASES, default=DATABASES[0], help="kind of database (%(default)s)")
    for name, purpose in (
        ("frames", "of the render"),
        ("workers", "that draw"),
        ("strikes", f"such as {', '.join(get_args(Strike)[:3])}, spread over the frames"),
        ("width", "of the pictures, pixels"),
        ("rays", "per pixel"),
        ("seed", "of the order of strikes"),
    ):
        default = getattr(ChaosPlan, name)
        parser.add_argument(f"--{name}", metavar="N", type=int, default=default, help=f"{purpose} (%(default)s)")
    parser.add_argument(
        "--limit-seconds",
        metavar="S",
        type=float,
        default=ChaosPlan.limit_s,
        help="time after which the render counts as stuck (%(default)g)",
    )


def plan_from_arguments(arguments: argparse.Namespace) -> ChaosPlan:
    """Plan from the command line's arguments.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: a number is out of range.
    """
    limits: Sequence[tuple[str, int]] = (
        ("frames", 1000),
        ("workers", 8),
        ("strikes", 1000),
        ("width", 1920),
        ("rays", 1024),
    )
    for name, most in limits:
        if not 1 <= getattr(arguments, name) <= most:
            raise SettingsError(f"--{name} must be from 1 to {most:,}, got {getattr(arguments, name)}")
    if not 10 <= arguments.limit_seconds <= 86_400:
        raise SettingsError(f"--limit-seconds must be from 10 to 86,400, got {arguments.limit_seconds:g}")
    told = {name: getattr(arguments, name) for name in ("database", "seed", *(name for name, _ in limits))}
    return ChaosPlan(**told, limit_s=arguments.limit_seconds)


BENCH = Bench(
    "chaos",
    "a render while workers, scheduler, service and database are killed, the disk fills and the clock jumps",
    add_arguments,
    "service.bench.chaos.run",
)
"""Found through the entry point group ``pullfocus.benches``."""
