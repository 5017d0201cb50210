"""Plan of the lens bench, and its arguments. Imports no OpenGL, so that the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field, replace

from render.lab.bench.clock import Repeats
from render.lab.bench.lenses import BenchLens, bench_lenses
from render.lab.reference.bench_scenes import SCENES
from render.model.frame_settings import FrameSettings

PICTURE = FrameSettings(800, 600, rays=100, layers=4, tiled=False)
"""Settings that the goals are set for. The rays are those of the accumulation buffer: one pattern for all pixels."""
TABLE_REPEATS, SWEEP_REPEATS = Repeats(least=3), Repeats(least=1)
RUNS = 3
SWEPT = "statues"
"""Scene of the sweeps, if it is measured."""


@dataclass(frozen=True)
class Plan:
    """Plan of the measurements.

    Attributes:
        picture: settings of the table.
        repeats: repetitions of the table's pictures; times are medians.
        runs: runs of each row of the table, the reference included, whose ratios tell how much they vary.
        sweep_repeats: repetitions of the sweeps' pictures.
        rays: numbers of rays in their sweep.
        layers: numbers of layers in their sweep.
        f_stops: f-numbers in their sweep.
        lenses: lenses in their sweep.
    """

    picture: FrameSettings = PICTURE
    repeats: Repeats = TABLE_REPEATS
    runs: int = RUNS
    sweep_repeats: Repeats = SWEEP_REPEATS
    rays: tuple[int, ...] = (32, 64, 128, 256, 512, 1024)
    layers: tuple[int, ...] = (2, 3, 4, 5, 6, 7, 8)
    f_stops: tuple[float, ...] = (1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0)
    lenses: tuple[BenchLens, ...] = field(default_factory=bench_lenses)


def quick_plan() -> Plan:
    """A look at whether all of it works: small pictures, each measured once, and the ends of the sweeps."""
    return Plan(
        picture=replace(PICTURE, width=160, height=120, rays=16),
        repeats=Repeats(1, 1),
        runs=2,
        sweep_repeats=Repeats(1, 1),
        rays=(8, 32),
        layers=(2, 4, 8),
        f_stops=(1.4, 8.0),
        lenses=tuple(lens for lens in bench_lenses() if lens.surfaces in (0, 13)),
    )


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    parser.add_argument(
        "--json", metavar="FILE|-", help="write what was found for programs too; - in place of the tables"
    )
    parser.add_argument("--quick", action="store_true", help="small pictures and few of them: does it all work")
    parser.add_argument("--scene", metavar="NAME", choices=SCENES, help=f"one of {', '.join(SCENES)}; without it all")
    parser.add_argument(
        "--supersample", metavar="N", type=float, help="layer pixels per pixel; without it as many as suit the rays"
    )
    parser.add_argument("--rays", metavar="N", type=int, help=f"rays per pixel of the table; without it {PICTURE.rays}")


def plan_from_arguments(arguments: argparse.Namespace) -> Plan:
    """Plan from the command line's arguments.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: one is out of range.
    """
    plan = quick_plan() if arguments.quick else Plan()
    requested = {"supersample": arguments.supersample, "rays": arguments.rays}
    typed = {name: value for name, value in requested.items() if value is not None}
    return replace(plan, picture=replace(plan.picture, **typed))
