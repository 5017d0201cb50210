"""Plan of the soak, and its arguments. Imports no OpenGL, so that the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import dataclass

from render.errors import SettingsError

EDITS, CHECK_EVERY = 10_000, 100
QUICK_EDITS, QUICK_CHECK_EVERY = 60, 20


@dataclass(frozen=True)
class SoakPlan:
    """Plan of the soak.

    Attributes:
        edits: number of edits.
        check_every: number of edits between two comparisons with a new renderer.
        seed: seed of the choice of edits.
    """

    edits: int
    check_every: int
    seed: int


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the soak's arguments."""
    parser.add_argument(
        "--json", metavar="FILE|-", help="write what was found for programs too; - in place of the table"
    )
    parser.add_argument("--quick", action="store_true", help=f"{QUICK_EDITS} edits: does it all work")
    parser.add_argument("--edits", type=int, metavar="N", help=f"how many; without it {EDITS:,}")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of what is edited")


def plan_from_arguments(arguments: argparse.Namespace) -> SoakPlan:
    """Plan from the command line's arguments.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: no edits are asked for.
    """
    edits = arguments.edits if arguments.edits is not None else QUICK_EDITS if arguments.quick else EDITS
    if edits < 1:
        raise SettingsError(f"--edits must be 1 or more, got {edits}")
    return SoakPlan(edits, QUICK_CHECK_EVERY if arguments.quick else CHECK_EVERY, arguments.seed)
