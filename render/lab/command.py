"""`pullfocus bench`: cost of the engines and their distance from the references, measured on this machine.

`render.cli` finds this command through the entry point group ``pullfocus.commands``, so that no product module imports the lab.
Benches of packages that this one does not know, such as the service, are found through a group of their own.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from importlib import import_module, metadata

from render.cli.parser import Parser
from render.lab.bench import film_plan, focus_plan, live_plan, motion_plan, plan
from render.lab.bench.bench import Bench
from render.lab.bench.importance import plan as importance_plan
from render.lab.bench.points import plan as points_plan
from render.lab.bench.postblur import plan as postblur_plan
from render.lab.bench.quality import plan as quality_plan
from render.lab.bench.scale import plan as scale_plan
from render.lab.bench.soak import plan as soak_plan
from render.lab.bench.start import plan as start_plan

_BENCHES = (
    Bench(
        "lens",
        "the lens engine: three scenes, and sweeps over rays, layers, aperture, surfaces",
        plan.add_arguments,
        "render.lab.bench.lens",
    ),
    Bench(
        "quality",
        "quality: noise and bias of the lens engine against converged pictures, and its seconds; before and after a change",
        quality_plan.add_arguments,
        "render.lab.bench.quality.run",
    ),
    Bench(
        "focus",
        "focusing: the solvers, and what a surface that is no plane costs",
        focus_plan.add_arguments,
        "render.lab.bench.focus",
    ),
    Bench(
        "film",
        "film and grade: on the device and on the processor, beside the frame itself",
        film_plan.add_arguments,
        "render.lab.bench.film",
    ),
    Bench(
        "motion",
        "motion: sixteen moments by velocities and by peeling each, beside the still frame",
        motion_plan.add_arguments,
        "render.lab.bench.motion",
    ),
    Bench(
        "live",
        "live work: from a change to the first picture and to the last, of five kinds of drags",
        live_plan.add_arguments,
        "render.lab.bench.live",
    ),
    Bench(
        "soak",
        "thousands of random edits of a small shot: no drift, no error, no growth of memory",
        soak_plan.add_arguments,
        "render.lab.bench.soak.run",
    ),
    Bench(
        "postblur",
        "blurs of one picture: FLAG and the naive gather as the blur grows, and every engine's likeness",
        postblur_plan.add_arguments,
        "render.lab.bench.postblur.run",
    ),
    Bench(
        "start",
        "starting: from a new process of `record` to its first pixel, cold and warm",
        start_plan.add_arguments,
        "render.lab.bench.start.run",
    ),
    Bench(
        "importance",
        "importance ordering: Fearing's experiments, beside the linear method",
        importance_plan.add_arguments,
        "render.lab.bench.importance.run",
    ),
    Bench(
        "points",
        "sample patterns: errors over pixel and pupil of the product's and of others",
        points_plan.add_arguments,
        "render.lab.bench.points.run",
    ),
    Bench(
        "scale",
        "large work: seconds and memory against triangles, prims, instances, lights and picture width",
        scale_plan.add_arguments,
        "render.lab.bench.scale.run",
    ),
)
ENTRY_POINT_GROUP = "pullfocus.benches"
"""Entry points of benches in other packages, each a `Bench`."""


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
    import_module(typed.module).run(typed)
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = Parser(prog="pullfocus bench", description="Measure the engines on this machine against their references.")
    benches = parser.add_subparsers(title="benches", metavar="BENCH", required=True)
    added: list[Bench] = [entry.load() for entry in metadata.entry_points(group=ENTRY_POINT_GROUP)]
    for known in (*_BENCHES, *added):
        one = benches.add_parser(known.name, help=known.purpose)
        one.set_defaults(module=known.module)
        known.add_arguments(one)
    return parser
