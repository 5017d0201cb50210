"""Plan of the live bench, and its arguments. Imports no OpenGL, so that the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace

from render.errors import SettingsError
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
        focus_maps: whether pictures come with focus maps, as they do while the page shows what is sharp.
    """

    picture: FrameSettings
    steps: int
    focus_maps: bool = False


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    add_picture_arguments(parser, PICTURE)
    parser.add_argument(
        "--focus-maps", action="store_true", help="pictures with focus maps, as while the page shows what is sharp"
    )
    add_before_argument(parser)


def plan_from_arguments(arguments: argparse.Namespace) -> LivePlan:
    """Plan from the command line's arguments.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: the picture is too small or too large, the checkout to compare with is none, or there is one and focus
            maps are asked for.
    """
    check_before(arguments)
    if arguments.focus_maps and arguments.before is not None:
        raise SettingsError("--focus-maps does not go with --before, whose checkout may have none")
    picture = replace(PICTURE, width=96, height=54, rays=8, supersample=1) if arguments.quick else PICTURE
    steps = 3 if arguments.quick else STEPS
    return LivePlan(with_width(picture, arguments.width), steps, arguments.focus_maps)
