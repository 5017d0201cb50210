"""Plan of the film bench, and its arguments. Imports no OpenGL, so that the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace

from render.film.settings import HalationSettings
from render.lab.bench.demo_plan import add_picture_arguments, with_width
from render.model.frame_settings import FrameSettings

PICTURE = FrameSettings(960, 540)
"""Default settings of `record`."""
FRAME = 40
"""Frame of the demo shot."""
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
    add_picture_arguments(parser, PICTURE)


def picture_from_arguments(arguments: argparse.Namespace) -> FrameSettings:
    """Picture settings from the command line's arguments.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: it is too small or too large.
    """
    picture = replace(PICTURE, width=160, height=90, rays=16) if arguments.quick else PICTURE
    return with_width(picture, arguments.width)
