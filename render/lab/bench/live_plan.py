"""Plan of the live bench, and its arguments. Imports no OpenGL, so that the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace

from render.lab.bench.demo_plan import add_before_argument, add_picture_arguments, check_before, with_width
from render.model.frame_settings import FrameSettings

PICTURE = FrameSettings(960, 540)
"""Default settings of `record`."""
FRAME = 48
"""Frame of the demo shot where the drags begin."""
STEPS = 20
"""Pictures of a drag, before the hand rests."""
FIRST_MS = {"focus": 120.0, "aperture": 120.0, "time": 400.0}
"""After which the first picture of each drag is to be there, by its median."""
LOOK_MS = 30.0
"""Longest allowed time between two cancellation points, milliseconds."""
DRAGS = ("focus", "aperture", "time", "camera", "grade")


@dataclass(frozen=True)
class LivePlan:
    """Plan of the measurements.

    Attributes:
        picture: settings of the picture at rest.
        steps: number of pictures in each drag.
    """

    picture: FrameSettings
    steps: int


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    add_picture_arguments(parser, PICTURE)
    add_before_argument(parser)


def plan_from_arguments(arguments: argparse.Namespace) -> LivePlan:
    """Plan from the command line's arguments.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: the picture is too small or too large, or the checkout to compare with is none.
    """
    check_before(arguments)
    picture = replace(PICTURE, width=96, height=54, rays=8, supersample=1) if arguments.quick else PICTURE
    return LivePlan(with_width(picture, arguments.width), 3 if arguments.quick else STEPS)
