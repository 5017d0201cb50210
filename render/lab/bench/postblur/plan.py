"""Plan of the bench of single-image blurs, and its arguments. Imports no OpenGL: the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import dataclass

from render.lab.bench.clock import Repeats
from render.model.frame_settings import FrameSettings

RADII = (3, 5, 7, 9, 13, 19, 27, 39, 57, 81)
AHEAD_FROM = 7
"""Pixels of radius from which on FLAG is to be ahead of the naive gather."""
FRAME = 40
"""Frame of the demo shot."""
F_STOP = 0.35
"""f-number of the generated scenes' cameras: wide open, so that small pictures have large circles of confusion."""
SUFFIXES = (".png", ".svg")


@dataclass(frozen=True)
class PostBlurPlan:
    """Plan of the measurements.

    Attributes:
        side: pixels of the square picture that is blurred for time.
        radii: radii of its blur in pixels.
        repeats: repetitions of the quick blurs; the naive gather is measured once where it is slow.
        picture: settings of the generated scenes, for the comparison of pictures.
        demo: settings of the demo shot; None leaves it out.
    """

    side: int
    radii: tuple[int, ...]
    repeats: Repeats
    picture: FrameSettings
    demo: FrameSettings | None


FULL = PostBlurPlan(
    side=384,
    radii=RADII,
    repeats=Repeats(5, most=9),
    picture=FrameSettings(320, 240, rays=144, tiled=False),
    demo=FrameSettings(320, 180, rays=144, tiled=False),
)
QUICK = PostBlurPlan(
    side=64,
    radii=(3, 7, 13, 19),
    repeats=Repeats(1, 1),
    picture=FrameSettings(96, 72, rays=16, supersample=3, tiled=False),
    demo=None,
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    parser.add_argument(
        "--json", metavar="FILE|-", help="write what was found for programs too; - in place of the tables"
    )
    parser.add_argument("--plot", metavar="FILE", help="draw time and memory against the radius: .png or .svg")
    parser.add_argument(
        "--quick", action="store_true", help="small pictures, few radii and no demo shot: does it all work"
    )


def plan_from_arguments(arguments: argparse.Namespace) -> PostBlurPlan:
    """Plan from the command line's arguments."""
    return QUICK if arguments.quick else FULL
