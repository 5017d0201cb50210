"""`pullfocus splats`: a captured set of Gaussian splats as a USD layer."""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from render.cli.console import print_message
from render.errors import SettingsError
from render.files import check_writable
from render.shot.splats import read_ply, write_splats
from render.shot.splats.layer import PRIM, UP_AXES

_SUFFIXES = (".usd", ".usda", ".usdc")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.set_defaults(run=run)
    parser.add_argument("cloud", metavar="CLOUD.ply", type=Path, help="splats as programs that fit them write them")
    parser.add_argument("layer", metavar="OUT.usdc", type=Path, help="USD layer to write, to be referenced by shots")
    parser.add_argument(
        "--up",
        choices=UP_AXES,
        default="-y",
        help="direction of the capture that is up; without it -y, as of most programs",
    )
    parser.add_argument(
        "--scale",
        metavar="M",
        type=float,
        default=1.0,
        help="length of the capture's unit in metres (1): most have any",
    )


def run(arguments: argparse.Namespace) -> None:
    """Read the splats and write the layer.

    Raises:
        SettingsError: the layer's name has another ending, or the scale is no length.
        InputError: the file of splats cannot be used.
        OutputError: the layer cannot be written.
    """
    if arguments.layer.suffix not in _SUFFIXES:
        raise SettingsError(f"splats are written as {', '.join(_SUFFIXES)}, got {arguments.layer}")
    if not (math.isfinite(arguments.scale) and arguments.scale > 0):
        raise SettingsError(f"--scale must be a length in metres above 0, got {arguments.scale:g}")
    check_writable(arguments.layer)
    splats = read_ply(arguments.cloud)
    write_splats(arguments.layer, splats, up=arguments.up, metres=arguments.scale)
    if splats.unusable:
        print_message(f"pullfocus: {splats.unusable:,} splats are left out: their numbers are not finite")
    print(f"{arguments.layer}: {len(splats.positions):,} splats at {PRIM}")
