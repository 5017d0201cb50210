"""Plan of the focus bench, and its arguments. Imports no OpenGL, so that the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import replace

from render.model.frame_settings import FrameSettings

PICTURE = FrameSettings(800, 600, rays=100, layers=4, tiled=False)
"""Settings of the lens bench."""
POINT_COUNTS = (0, 1, 8, 32, 64)


def quick_picture() -> FrameSettings:
    """A look at whether it works."""
    return replace(PICTURE, width=160, height=120, rays=16)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    parser.add_argument(
        "--json", metavar="FILE|-", help="write what was found for programs too; - in place of the tables"
    )
    parser.add_argument("--quick", action="store_true", help="small pictures and few of them: does it all work")
