"""Arguments of the benches on the demo shot. Imports no OpenGL, so that the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from render.errors import SettingsError
from render.model.frame_settings import FrameSettings


def add_picture_arguments(parser: argparse.ArgumentParser, picture: FrameSettings) -> None:
    """Declare the arguments of a bench with this default picture."""
    parser.add_argument(
        "--json", metavar="FILE|-", help="write what was found for programs too; - in place of the tables"
    )
    parser.add_argument("--quick", action="store_true", help="a small picture, each measured once: does it all work")
    parser.add_argument(
        "--width", metavar="PX", type=int, help=f"of the picture, which is 16:9; without it {picture.width}"
    )


def add_before_argument(parser: argparse.ArgumentParser) -> None:
    """Declare the argument of benches that compare with another checkout."""
    parser.add_argument("--before", metavar="CHECKOUT", type=Path, help="measure this checkout of Pullfocus too")


def check_before(arguments: argparse.Namespace) -> None:
    """Check that the checkout to compare with is one.

    Raises:
        SettingsError: it is not.
    """
    if arguments.before is not None and not (arguments.before / "render" / "frame.py").is_file():
        raise SettingsError(f"--before must be a checkout of Pullfocus, but {arguments.before} has no render/frame.py")


def with_width(picture: FrameSettings, width: int | None) -> FrameSettings:
    """Picture settings with a requested width, 16:9; unchanged for None.

    Raises:
        SettingsError: it is too small or too large.
    """
    return picture if width is None else replace(picture, width=width, height=max(1, round(width * 9 / 16)))
