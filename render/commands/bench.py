"""`pullfocus bench`: what the engines cost and how near they come to the truth, measured here and now."""

from __future__ import annotations

import argparse
from functools import partial
from importlib import import_module
from typing import Any

from render.bench import (
    film_plan,
    focus_plan,
    importance_plan,
    live_plan,
    motion_plan,
    plan,
    postblur_plan,
    soak_plan,
)

_BENCHES = (
    ("lens", plan, "the lens engine: three scenes, and sweeps over rays, layers, aperture, surfaces"),
    ("focus", focus_plan, "focusing: the solvers, and what a surface that is no plane costs"),
    ("film", film_plan, "film and grade: on the device and on the processor, beside the frame itself"),
    ("motion", motion_plan, "motion: sixteen moments by velocities and by peeling each, beside the still frame"),
    ("live", live_plan, "live work: from a change to the first picture and to the last, of five kinds of drags"),
    ("soak", soak_plan, "thousands of random edits of a small shot: no drift, no error, no growth of memory"),
    (
        "postblur",
        postblur_plan,
        "blurs of one picture: FLAG and the naive gather as the blur grows, and every engine's likeness",
    ),
    ("importance", importance_plan, "importance ordering: Fearing's experiments, beside the linear method"),
)
"""Name, arguments and purpose of each; ``render.bench.NAME`` has its ``run``."""


def add_parser(commands: Any) -> None:
    """Declare the command's arguments."""
    parser = commands.add_parser("bench", help="measure the engines on this machine against their references")
    benches = parser.add_subparsers(title="benches", metavar="BENCH", required=True)
    for name, arguments, purpose in _BENCHES:
        bench = benches.add_parser(name, help=purpose)
        bench.set_defaults(run=partial(_run, name))
        arguments.add_arguments(bench)


def _run(name: str, arguments: argparse.Namespace) -> None:
    """Measure, and print and write what was found.

    Args:
        name: of the bench.
        arguments: as `add_parser` declares them.

    Raises:
        SettingsError: a setting is out of range.
        GraphicsError: there is no device to draw on.
        OutputError: a file cannot be written.
    """
    import_module(f"render.bench.{name}").run(arguments)  # not before it is asked for: it brings OpenGL with it
