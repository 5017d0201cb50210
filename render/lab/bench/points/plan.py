"""Plan of the points bench, and its arguments. Imports no OpenGL, so that the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import dataclass


@dataclass(frozen=True)
class PointsPlan:
    """Plan of the measurements.

    Attributes:
        rays: numbers of rays per pixel.
        integrands: number of integrands of each kind.
        seeds: number of seeds of each pattern.
    """

    rays: tuple[int, ...] = (16, 25, 36, 64, 100, 144, 256)
    integrands: int = 60
    seeds: int = 3


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    parser.add_argument(
        "--json", metavar="FILE|-", help="write what was found for programs too; - in place of the table"
    )
    parser.add_argument(
        "--quick", action="store_true", help="few integrands and small numbers of rays: does it all work"
    )


def plan_from_arguments(arguments: argparse.Namespace) -> PointsPlan:
    """Plan from the command line's arguments."""
    return PointsPlan((16, 25), integrands=4, seeds=1) if arguments.quick else PointsPlan()
