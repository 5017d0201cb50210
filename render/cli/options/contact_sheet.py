"""Options of `pullfocus record` that compare several pictures on one sheet."""

from __future__ import annotations

import argparse
from pathlib import Path

from render.cli.options.shared import split_words
from render.errors import SettingsError
from render.model.frame_spec import parse_frames
from render.pictures.contact_axes import AXES, EXAMPLES, Axis, parse_axes

SUFFIXES = (".png", ".svg")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options, for `read_axes`."""
    group = parser.add_argument_group("a contact sheet")
    group.add_argument(
        "--contact-sheet",
        metavar="WHAT=A,B,C",
        action="append",
        help=f"compare {', '.join(AXES)} in one labelled picture, a .png or .svg file: such as stock={EXAMPLES['stock']},"
        f" stop={EXAMPLES['stop']} or lens={EXAMPLES['lens']}; given twice, columns and rows",
    )


def read_axes(arguments: argparse.Namespace) -> tuple[Axis, ...] | None:
    """Read what is compared; None without --contact-sheet.

    Args:
        arguments: those of `record`.

    Raises:
        SettingsError: they cannot be read, or contradict each other.
        InputError: a lens file has no usable lens.
    """
    if arguments.contact_sheet is None:
        return None
    if Path(arguments.out).suffix.lower() not in SUFFIXES:
        raise SettingsError(f"a contact sheet is a {' or '.join(SUFFIXES)} file, got {arguments.out}")
    axes = parse_axes(arguments.contact_sheet)
    for option, name in (("film", "stock"), ("lens", "lens"), ("frames", "frame"), ("stop", "stop")):
        if getattr(arguments, option) is not None and any(axis.name == name for axis in axes):
            raise SettingsError(f"--{option} and a contact sheet of {name}s are one too many: leave out --{option}")
    if arguments.long_exposure is not None:
        raise SettingsError("a contact sheet has no long exposures: leave out --long-exposure")
    if split_words(arguments.aov) != ("color",):
        raise SettingsError("a contact sheet has pictures alone: leave out --aov")
    if arguments.frames is not None and len(parse_frames(arguments.frames)) > 1:
        raise SettingsError(
            f"a contact sheet is of one frame, got --frames {arguments.frames}; frames are compared by"
            f" --contact-sheet frame={EXAMPLES['frame']}"
        )
    return axes
