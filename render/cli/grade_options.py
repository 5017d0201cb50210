"""The options of `record` that say how a picture is graded, in place of what the shot says."""

from __future__ import annotations

import argparse
import re

from render.cli.report import say
from render.errors import SettingsError
from render.film.cdl import Cdl, read_cdl
from render.film.grade_choice import GradeChoice

_SEPARATORS = re.compile(r"[,\s]+")
_WITHOUT_SATURATION, _WITH_SATURATION = 9, 10


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare them, for `asked_grade`."""
    group = parser.add_argument_group("how it is graded (PNG and JPEG), in place of what the shot says")
    group.add_argument("--display", metavar="NAME", help="display of the OpenColorIO configuration")
    group.add_argument("--view", metavar="NAME", help="view of the display")
    group.add_argument(
        "--look",
        metavar="NAMES",
        help="looks of the configuration, with commas between; - in front inverts; '' for none",
    )
    group.add_argument(
        "--cdl",
        metavar="FILE|NUMBERS",
        help="ASC CDL: a .cdl, .cc or .ccc file, FILE#ID for a correction of it; or slope, offset and power of red, green"
        " and blue, with or without the saturation: 9 or 10 numbers with commas between",
    )
    group.add_argument(
        "--ocio-config", metavar="FILE|ocio://NAME", help="OpenColorIO configuration that these names are of"
    )


def asked_grade(arguments: argparse.Namespace) -> GradeChoice | None:
    """What the options ask for; None where there is none of them.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: the CDL's numbers are none, or an option is empty.
        InputError: its file is missing or damaged.
    """
    for option, typed in (
        ("--display", arguments.display),
        ("--view", arguments.view),
        ("--ocio-config", arguments.ocio_config),
        ("--cdl", arguments.cdl),
    ):
        if typed is not None and not typed.strip():
            raise SettingsError(f"{option} is empty: name one, or leave it out for what the shot says")
    if arguments.look and not arguments.look.strip(" ,:|+-"):
        raise SettingsError(f"--look takes names of looks, or '' for none, got {arguments.look!r}")
    cdl = None if arguments.cdl is None else _cdl(arguments.cdl)
    choice = GradeChoice(arguments.ocio_config, arguments.display, arguments.view, arguments.look, cdl)
    return None if choice == GradeChoice() else choice


def warn_of_unseen(arguments: argparse.Namespace) -> None:
    """Say which of the options, and --film, a scene-linear file does not show.

    Args:
        arguments: as `add_arguments` declares them, ``film`` and ``out``.
    """
    options = ("film", "display", "view", "look", "cdl", "ocio_config")
    unseen = [f"--{name.replace('_', '-')}" for name in options if getattr(arguments, name) is not None]
    if unseen and arguments.out.lower().endswith(".exr"):
        say(
            f"warning: an EXR file stays scene-linear: {', '.join(unseen)} {'is' if len(unseen) == 1 else 'are'} not"
            " applied, its header says how it is meant to be shown"
        )


def _cdl(text: str) -> Cdl:
    """A CDL by its numbers, else by its file."""
    numbers = _numbers(text)
    if numbers is None:
        file, _, correction = text.rpartition("#") if "#" in text else (text, "", "")
        return read_cdl(file, correction)
    if len(numbers) not in (_WITHOUT_SATURATION, _WITH_SATURATION):
        raise SettingsError(
            "--cdl takes a file, or 9 numbers (slope, offset and power of red, green and blue) or 10 with the saturation; "
            f"got {len(numbers)}",
            code="bad_cdl",
        )
    slope, offset, power = ((numbers[i], numbers[i + 1], numbers[i + 2]) for i in (0, 3, 6))
    return Cdl(slope, offset, power, *numbers[_WITHOUT_SATURATION:])


def _numbers(text: str) -> list[float] | None:
    """The numbers of a list; None where it is none."""
    try:
        return [float(part) for part in _SEPARATORS.split(text.strip())]
    except ValueError:
        return None
