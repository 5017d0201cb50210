"""Focus bench: time of the focus solvers, and cost of an expressive focal surface in the tracer.

pullfocus bench focus                      the tables and the goals
python -m render.lab.bench.focus --json -      the same where only numpy, pyrender and moderngl are installed
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, replace

import numpy as np

from render.errors import PullfocusError, SettingsError
from render.lab.bench.clock import Repeats, Spent
from render.lab.bench.focus_plan import PICTURE, POINT_COUNTS, add_arguments, quick_picture
from render.lab.bench.focus_solvers import SolverRow, measure_solvers
from render.lab.bench.progress import check_file, say
from render.lab.bench.results import Goal
from render.lab.bench.rig import LensRig
from render.lab.reference.bench_scenes import SCENES
from render.model.camera import Camera
from render.model.focal_surface import Controls, FocalPlane, FocalSurface
from render.model.frame_settings import FrameSettings
from render.optics.thin_lens import focus_w

SCENE = "statues"
GOAL_POINTS, GOAL_SHARE = 32, 0.15
GOAL_SOLVE_S = 1.0


@dataclass(frozen=True)
class SurfaceRow:
    """Cost of control points, in milliseconds.

    Attributes:
        points: number of control points; 0 is the lens's plane of focus.
        trace_ms: wall time of the tracing.
        trace_cpu_ms: processor time of the tracing, all threads.
        share: extra processor time, as a share of the plane's.
    """

    points: int
    trace_ms: float
    trace_cpu_ms: float
    share: float


@dataclass(frozen=True)
class FocusBench:
    """Results of the focus bench; the fields are the keys of its JSON.

    Attributes:
        device: name of the device.
        width: picture width in pixels.
        height: picture height in pixels.
        rays: rays per pixel.
        solvers: times of the solvers on one core, seconds.
        surfaces: times of the tracer.
        goals: goals and whether they are met.
    """

    device: str
    width: int
    height: int
    rays: int
    solvers: list[SolverRow]
    surfaces: list[SurfaceRow]
    goals: list[Goal]


def measure(picture: FrameSettings, repeats: Repeats) -> FocusBench:
    """Measure everything.

    Raises:
        GraphicsError: there is no device to draw on.
    """
    solvers = measure_solvers()
    with LensRig() as rig:
        scene, camera = SCENES[SCENE]()
        rig.load(scene, camera)
        rows = _surface_rows(rig, camera, picture, repeats)
        return FocusBench(
            rig.graphics.renderer, picture.width, picture.height, picture.rays, solvers, rows, _goals(solvers, rows)
        )


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the tables on standard output, and write the JSON.

    Args:
        arguments: as `render.lab.bench.focus_plan.add_arguments` declares them.

    Raises:
        GraphicsError: there is no device to draw on.
        OutputError: the file cannot be written.
    """
    check_file(arguments.json)
    picture = quick_picture() if arguments.quick else PICTURE
    result = measure(picture, Repeats(1, 1) if arguments.quick else Repeats(3))
    say(result, report(result), arguments.json)


def report(result: FocusBench) -> str:
    """The tables."""
    lines = ["solver                                  points  frames   seconds of one core"]
    lines += [f"{row.solver:38}  {row.points:6}  {row.frames:6}   {row.seconds:.3f}" for row in result.solvers]
    lines += ["", f"{result.device}; {result.width}x{result.height}, {result.rays} rays, {SCENE}"]
    lines += ["control points   trace ms (processor's)   on top of a plane"]
    lines += [
        f"{row.points:14}   {row.trace_ms:8.0f} ({row.trace_cpu_ms:.0f})   {row.share:+.1%}" for row in result.surfaces
    ]
    lines += [""] + [
        f"{'pass' if goal.holds else 'FAIL'}  {goal.goal} {goal.want:g}: {goal.got:.4g}" for goal in result.goals
    ]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Run as a module; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m render.lab.bench.focus", description="Measure focusing.")
    add_arguments(parser)
    try:
        run(parser.parse_args())
    except PullfocusError as error:
        print(f"{parser.prog}: {error.detail}", file=sys.stderr)
        return 2 if isinstance(error, SettingsError) else 1
    return 0


def _surface_rows(rig: LensRig, camera: Camera, picture: FrameSettings, repeats: Repeats) -> list[SurfaceRow]:
    """The same picture with ever more control points, all of which want the plane of focus: what differs is their cost."""
    rows: list[SurfaceRow] = []
    for points in POINT_COUNTS:
        spent = rig.trace(_with_points(camera, points), picture, repeats).stages["trace"]
        plane = rows[0].trace_cpu_ms if rows else spent.cpu_ms
        rows.append(_row(points, spent, plane))
    return rows


def _row(points: int, spent: Spent, plane_ms: float) -> SurfaceRow:
    return SurfaceRow(points, spent.wall_ms, spent.cpu_ms, spent.cpu_ms / plane_ms - 1)


def _with_points(camera: Camera, count: int) -> Camera:
    if count == 0:
        return camera
    half = 0.5 * np.array([camera.horizontal_aperture_mm, camera.vertical_aperture_mm]) / camera.focal_length_mm
    places = np.random.default_rng(count).uniform(-half, half, (count, 2))
    target_w = np.tile([focus_w(camera), 0.0], (count, 1))
    controls = Controls(places, target_w, np.ones(count), np.zeros(count))
    return replace(camera, focal_surface=FocalSurface(FocalPlane(focus_w(camera)), controls))


def _goals(solvers: list[SolverRow], surfaces: list[SurfaceRow]) -> list[Goal]:
    goals = [
        Goal(
            f"{row.solver}, {row.points} points over {row.frames} frames, seconds at most",
            GOAL_SOLVE_S,
            row.seconds,
            row.seconds <= GOAL_SOLVE_S,
        )
        for row in solvers
    ]
    for row in surfaces:
        if row.points == GOAL_POINTS:
            what = f"{GOAL_POINTS} control points, share of the tracing at most"
            goals.append(Goal(what, GOAL_SHARE, row.share, row.share <= GOAL_SHARE))
    return goals


if __name__ == "__main__":
    sys.exit(main())
