"""Movies as the output of `pullfocus record`: options that make no sense for them."""

from __future__ import annotations

import argparse

from render.cli.options.shared import split_words
from render.errors import SettingsError
from render.output.formats import movie_format_of


def is_movie(arguments: argparse.Namespace) -> bool:
    """Return whether OUT is a movie, after the options were checked against that.

    Args:
        arguments: those of `record`.

    Raises:
        SettingsError: no such movie can be written, or an option contradicts it.
    """
    if arguments.products or movie_format_of(arguments.out) is None:
        return False
    if "#" in arguments.out:
        raise SettingsError(f"a movie is one file for all frames: leave out the # in {arguments.out!r}")
    ways = ("contact_sheet", "long_exposure", "progressive", "stereo")
    given = [f"--{name.replace('_', '-')}" for name in ways if getattr(arguments, name)]
    if split_words(arguments.aov) != ("color",):
        given.append("--aov")
    if given:
        raise SettingsError(f"a movie holds graded pictures of one camera: leave out {', '.join(given)}")
    return True
