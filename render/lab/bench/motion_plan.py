"""Plan of the motion bench, and its arguments. Imports no OpenGL, so that the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import replace

from render.lab.bench.demo_plan import add_picture_arguments, with_width
from render.model.frame_settings import FrameSettings

PICTURE = FrameSettings(960, 540, motion=16)
"""Default settings of `record`, at sixteen moments."""
FRAME = 48
"""Frame of the demo shot in which both robots walk, the camera travels, and the focus goes from one to the other."""
COUNTS = (4, 16, 64)
"""Moments that velocities are measured at."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    add_picture_arguments(parser, PICTURE)


def asked_picture(arguments: argparse.Namespace) -> FrameSettings:
    """Picture settings from the command line's arguments.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: it is too small or too large.
    """
    picture = replace(PICTURE, width=128, height=72, rays=16, motion=4) if arguments.quick else PICTURE
    return with_width(picture, arguments.width)
