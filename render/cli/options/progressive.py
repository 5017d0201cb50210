"""Option of `pullfocus record` that writes pictures while they are refined."""

from __future__ import annotations

import argparse

from render.errors import SettingsError
from render.output import format_of


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the option, for `check_progressive`."""
    parser.add_argument(
        "--progressive",
        action="store_true",
        help="write a first picture at once and better ones over it, for a viewer that reloads the file; the last one is the"
        " same as without it",
    )


def check_progressive(arguments: argparse.Namespace) -> None:
    """Check the option against the others.

    Args:
        arguments: those of `record`.

    Raises:
        SettingsError: another option contradicts it.
    """
    if not arguments.progressive:
        return
    if format_of(arguments.out) == "exr":
        raise SettingsError(f"--progressive is for pictures to look at: OUT must be .png or .jpg, got {arguments.out}")
    for name in ("long_exposure", "contact_sheet"):
        if getattr(arguments, name):
            raise SettingsError(f"--progressive is for single frames: leave out --{name.replace('_', '-')}")
