"""Options of `pullfocus record` for the grade, in place of the shot's."""

from __future__ import annotations

import argparse
import re

from render.cli.console import print_message
from render.errors import SettingsError
from render.film.cdl import Cdl, read_cdl
from render.film.grade_choice import GradeChoice

_SPACES = {"disabled": "lin_rec709", "sRGB": "srgb_texture", "openColorIO": None}
"""Spaces of the picture by --colorCorrectionMode; None for the display and view of the grade."""
_SEPARATORS = re.compile(r"[,\s]+")
_WITHOUT_SATURATION, _WITH_SATURATION = 9, 10


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options, for `read_grade_choice`."""
    group = parser.add_argument_group("grade (PNG, JPEG and movies), in place of the shot's")
    group.add_argument("--display", metavar="NAME", help="display of the OpenColorIO configuration")
    group.add_argument("--view", metavar="NAME", help="view of the display")
    group.add_argument(
        "--look",
        metavar="NAMES",
        help="looks of the configuration, comma-separated; a leading - inverts; '' for none",
    )
    group.add_argument(
        "--cdl",
        metavar="FILE|NUMBERS",
        help="ASC CDL: a .cdl, .cc or .ccc file, FILE#ID for one of its corrections; or slope, offset and power of red, green"
        " and blue, with or without saturation: 9 or 10 comma-separated numbers",
    )
    group.add_argument(
        "--colorCorrectionMode",
        "-color",
        choices=tuple(_SPACES),
        help="openColorIO, the default: film and grade; sRGB: the light without either, encoded; disabled: not even encoded",
    )
    group.add_argument("--ocio-config", metavar="FILE|ocio://NAME", help="OpenColorIO configuration of these names")


def read_grade_choice(arguments: argparse.Namespace) -> GradeChoice | None:
    """Read the options; None where none of them is given.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: the CDL is not 9 or 10 numbers, or an option is empty, or has no effect for --colorCorrectionMode.
        InputError: the CDL file is missing or damaged.
    """
    for option, typed in (
        ("--display", arguments.display),
        ("--view", arguments.view),
        ("--ocio-config", arguments.ocio_config),
        ("--cdl", arguments.cdl),
    ):
        if typed is not None and not typed.strip():
            raise SettingsError(f"{option} is empty: name one, or leave it out for the shot's own")
    if arguments.look and not arguments.look.strip(" ,:|+-"):
        raise SettingsError(f"--look takes names of looks, or '' for none, got {arguments.look!r}")
    cdl = None if arguments.cdl is None else _read_cdl(arguments.cdl)
    space = _SPACES[arguments.colorCorrectionMode or "openColorIO"]
    given = _given(arguments)
    if space is not None and given:
        raise SettingsError(
            f"--colorCorrectionMode {arguments.colorCorrectionMode} leaves out film and grade: leave out {', '.join(given)}"
        )
    choice = GradeChoice(arguments.ocio_config, arguments.display, arguments.view, arguments.look, cdl, space)
    return None if choice == GradeChoice() else choice


def warn_of_unapplied(arguments: argparse.Namespace) -> None:
    """Warn of the options, and --film, that a scene-linear file does not show.

    Args:
        arguments: as `add_arguments` declares them, ``film`` and ``out``.
    """
    unapplied = _given(arguments) + ["--colorCorrectionMode"] * (arguments.colorCorrectionMode is not None)
    if unapplied and arguments.out.lower().endswith(".exr"):
        print_message(
            f"warning: an EXR file stays scene-linear: {', '.join(unapplied)} {'is' if len(unapplied) == 1 else 'are'} not"
            " applied, its header has them as the intended look"
        )


def _given(arguments: argparse.Namespace) -> list[str]:
    """Options of film and grade that are given."""
    options = ("film", "display", "view", "look", "cdl", "ocio_config")
    return [f"--{name.replace('_', '-')}" for name in options if getattr(arguments, name) is not None]


def _read_cdl(text: str) -> Cdl:
    """Read a CDL from its numbers, else from its file."""
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
    """Read a list of numbers; None where a part is no number."""
    try:
        return [float(part) for part in _SEPARATORS.split(text.strip())]
    except ValueError:
        return None
