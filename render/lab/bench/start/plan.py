"""Plan of the start bench, and its arguments. Imports no OpenGL, so that the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

from render.errors import SettingsError

SHOTS = ("small", "demo")
FIRST_PIXEL_S = 1.2
"""Goal: longest time to the first pixel of the small shot with warm caches, by the median."""
WIDTHS, RUNS = (64, 160, 320), 5
"""Widths of the small shot's pictures; `FIRST_PIXEL_S` is for no particular one. The demo shot is drawn at the last."""
QUICK_WIDTHS, QUICK_RUNS = (64,), 1


@dataclass(frozen=True)
class StartPlan:
    """Plan of the measurements.

    Attributes:
        shots: names of the shots.
        widths: widths of the pictures in pixels.
        runs: runs with warm caches of each shot and checkout, after the first two.
        rounds: how often the caches are emptied and all runs made again.
        against: folder of another checkout that is measured too; None for none.
    """

    shots: tuple[str, ...] = SHOTS
    widths: tuple[int, ...] = WIDTHS
    runs: int = RUNS
    rounds: int = 1
    against: Path | None = None


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    parser.add_argument(
        "--json", metavar="FILE|-", help="write what was found for programs too; - in place of the table"
    )
    parser.add_argument(
        "--quick", action="store_true", help="the small shot, small, once cold and once warm: does it work"
    )
    parser.add_argument("--shot", metavar="NAME", choices=SHOTS, help=f"one of {', '.join(SHOTS)}; without it both")
    every = ", ".join(map(str, WIDTHS))
    parser.add_argument(
        "--width",
        metavar="PX",
        type=int,
        help=f"of the picture; without it {every} for the small shot, {WIDTHS[-1]} for the demo",
    )
    parser.add_argument(
        "--runs", metavar="N", type=int, help=f"with warm caches, after the first two; without it {RUNS}"
    )
    parser.add_argument(
        "--rounds", metavar="N", type=int, default=1, help="how often the caches are emptied and all runs made again"
    )
    parser.add_argument(
        "--against", metavar="DIR", type=Path, help="measure another checkout too, its runs between the others"
    )


def plan_from_arguments(arguments: argparse.Namespace) -> StartPlan:
    """Plan from the command line's arguments.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: a number is too small, or the folder holds no checkout.
    """
    shots = (arguments.shot,) if arguments.shot else SHOTS[:1] if arguments.quick else SHOTS
    widths = (arguments.width,) if arguments.width is not None else QUICK_WIDTHS if arguments.quick else WIDTHS
    runs = arguments.runs if arguments.runs is not None else QUICK_RUNS if arguments.quick else RUNS
    for name, value in (("--width", widths[0]), ("--runs", runs), ("--rounds", arguments.rounds)):
        if value < 1:
            raise SettingsError(f"{name} must be 1 or more, got {value}")
    against = None if arguments.against is None else arguments.against.resolve()
    if against is not None and not (against / "render" / "cli" / "main.py").is_file():
        raise SettingsError(f"--against takes the folder of a checkout, but {against} has no render/cli/main.py")
    return StartPlan(shots, widths, runs, arguments.rounds, against)
