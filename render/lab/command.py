"""`pullfocus bench`: cost of the engines and their distance from the references, measured on this machine.

`render.cli` finds this command through the entry point group ``pullfocus.commands``, so that no product module imports the lab.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from importlib import import_module

from render.cli.parser import Parser
from render.lab.bench import film_plan, focus_plan, live_plan, motion_plan, plan
from render.lab.bench.importance import plan as importance_plan
from render.lab.bench.points import plan as points_plan
from render.lab.bench.postblur import plan as postblur_plan
from render.lab.bench.quality import plan as quality_plan
from render.lab.bench.scale import plan as scale_plan
from render.lab.bench.soak import plan as soak_plan
from render.lab.bench.start import plan as start_plan

_BENCHES = (
    ("lens", plan, "lens", "the lens engine: three scenes, and sweeps over rays, layers, aperture, surfaces"),
    (
        "quality",
        quality_plan,
        "quality.run",
        "quality: noise and bias of the lens engine against converged pictures, and its seconds; before and after a change",
    ),
    ("focus", focus_plan, "focus", "focusing: the solvers, and what a surface that is no plane costs"),
    ("film", film_plan, "film", "film and grade: on the device and on the processor, beside the frame itself"),
    (
        "motion",
        motion_plan,
        "motion",
        "motion: sixteen moments by velocities and by peeling each, beside the still frame",
    ),
    (
        "live",
        live_plan,
        "live",
        "live work: from a change to the first picture and to the last, of five kinds of drags",
    ),
    (
        "soak",
        soak_plan,
        "soak.run",
        "thousands of random edits of a small shot: no drift, no error, no growth of memory",
    ),
    (
        "postblur",
        postblur_plan,
        "postblur.run",
        "blurs of one picture: FLAG and the naive gather as the blur grows, and every engine's likeness",
    ),
    ("start", start_plan, "start.run", "starting: from a new process of `record` to its first pixel, cold and warm"),
    (
        "importance",
        importance_plan,
        "importance.run",
        "importance ordering: Fearing's experiments, beside the linear method",
    ),
    (
        "points",
        points_plan,
        "points.run",
        "sample patterns: errors over pixel and pupil of the product's and of others",
    ),
    (
        "scale",
        scale_plan,
        "scale.run",
        "large work: seconds and memory against triangles, prims, instances, lights and picture width",
    ),
)
"""Name, arguments, module in `render.lab.bench` that has its ``run``, and purpose of each bench."""


def bench(arguments: Sequence[str]) -> int:
    """Run a bench, and print and write its results.

    Args:
        arguments: as typed after ``pullfocus bench``.

    Returns:
        The exit status.

    Raises:
        SettingsError: a setting is out of range.
        GraphicsError: there is no device to draw on.
        OutputError: a file cannot be written.
    """
    typed = _parser().parse_args(arguments)
    import_module(f"render.lab.bench.{typed.module}").run(typed)  # imported late: it needs OpenGL
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = Parser(prog="pullfocus bench", description="Measure the engines on this machine against their references.")
    benches = parser.add_subparsers(title="benches", metavar="BENCH", required=True)
    for name, arguments, module, purpose in _BENCHES:
        one = benches.add_parser(name, help=purpose)
        one.set_defaults(module=module)
        arguments.add_arguments(one)
    return parser
