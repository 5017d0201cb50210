"""The option of `pullfocus record` that burns facts into graded pictures."""

from __future__ import annotations

import argparse
from datetime import date

from render.cli.options import shared
from render.errors import SettingsError
from render.model.burn_in import FACTS, BurnIn, read_facts
from render.output import format_of
from render.output.formats import movie_format_of

OF_THE_SERVICE = "revision"
"""A fact that only the service knows."""


def add_argument(parser: argparse.ArgumentParser) -> None:
    """Add the option, for `read_burn_in`."""
    known = ", ".join(fact for fact in FACTS if fact != OF_THE_SERVICE)
    parser.add_argument(
        "--burn-in",
        metavar="LIST",
        help=f"write facts into the corners of graded pictures and movies: {known}, or all of them (in metres)",
    )


def read_burn_in(arguments: argparse.Namespace) -> BurnIn | None:
    """Read the option; None where nothing is burnt in.

    Args:
        arguments: as `add_argument` declares them, and ``out``.

    Raises:
        SettingsError: there is no such fact, or the file holds light and no graded picture.
    """
    if arguments.burn_in is None:
        return None
    if movie_format_of(arguments.out) is None and not arguments.contact_sheet and format_of(arguments.out) == "exr":
        raise SettingsError(
            f"--burn-in writes into graded pictures (.png, .jpg) and movies, got {arguments.out}; an EXR file has the same"
            " facts in its header"
        )
    names = shared.split_words(arguments.burn_in)
    if not names:
        raise SettingsError(f"--burn-in takes facts such as frame,timecode,lens, or all, got {arguments.burn_in!r}")
    if names == ("all",):
        names = tuple(fact for fact in FACTS if fact not in (OF_THE_SERVICE, "focusFt"))
    if OF_THE_SERVICE in names:
        raise SettingsError("--burn-in knows no revision of a file: the service has those, and its renders take burnIn")
    return BurnIn(read_facts(names), day=date.today().isoformat())
