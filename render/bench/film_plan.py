"""What the film bench measures, and its arguments. Imports no OpenGL, so that the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace

from render.film.settings import HalationSettings
from render.frame_settings import FrameSettings

PICTURE = FrameSettings(960, 540)
"""What `record` makes where nothing else is said."""
FRAME = 40
"""Of the demo shot."""
HALATION, NO_HALATION = HalationSettings(amount=0.05, radius_mm=0.1), HalationSettings()


@dataclass(frozen=True)
class Finishing:
    """One way to finish a picture.

    Attributes:
        name: for the table.
        stock: of the library, with its grain; None for the grade alone.
        halation: of the film.
        digital: a sensor in place of film.
    """

    name: str
    stock: str | None = None
    halation: HalationSettings = NO_HALATION
    digital: bool = False


FINISHINGS = (
    Finishing("grade alone"),
    Finishing("sensor with noise", digital=True),
    Finishing("negative and print", "vision3_500t_5219"),
    Finishing("the same with halation", "vision3_500t_5219", HALATION),
    Finishing("reversal", "velvia_50"),
    Finishing("black and white", "double_x_5222"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    parser.add_argument(
        "--json", metavar="FILE|-", help="write what was found for programs too; - in place of the tables"
    )
    parser.add_argument("--quick", action="store_true", help="a small picture, each measured once: does it all work")
    parser.add_argument(
        "--width", metavar="PX", type=int, help=f"of the picture, which is 16:9; without it {PICTURE.width}"
    )


def asked_picture(arguments: argparse.Namespace) -> FrameSettings:
    """The picture that the arguments ask for.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: it is too small or too large.
    """
    picture = replace(PICTURE, width=160, height=90, rays=16) if arguments.quick else PICTURE
    if arguments.width is None:
        return picture
    return replace(picture, width=arguments.width, height=max(1, round(arguments.width * 9 / 16)))
