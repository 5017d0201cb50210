"""`pullfocus demo`: the demo shot as USD files."""

from __future__ import annotations

import argparse
from pathlib import Path

from render.cli.console import print_json, print_message
from render.demo.shot import write_demo


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.set_defaults(run=run)
    parser.add_argument(
        "folder",
        metavar="DIR",
        type=Path,
        help="folder, created where it does not exist; files of the same names are replaced",
    )
    parser.add_argument("--json", action="store_true", help="print on standard output what was written")


def run(arguments: argparse.Namespace) -> None:
    """Write the demo shot and print how to render it.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        OutputError: it cannot be written.
    """
    stage = write_demo(arguments.folder)
    if arguments.json:
        print_json({"stage": str(stage)})
    else:
        print_message(f"the demo shot is {stage}; a frame of it: pullfocus record {stage} frame.png")
