"""Cost of the focus solvers: processor seconds for many points over many frames."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from render.focus.best_stop import stops_for
from render.focus.points import FocusTargets
from render.focus.solve import solve_distances
from render.focus.tilt import fit_targets, limit_planes, tilts_and_swings
from render.model.arrays import DoubleArray
from render.model.lens_law import LensLaw

POINTS, FRAMES = 500, 1000
_REPEATS = 3
_FRAME_WIDTH = 0.72  # slopes: 36 mm of film behind 50 mm


@dataclass(frozen=True)
class SolverRow:
    """Cost of one solver.

    Attributes:
        solver: name of the solver.
        points: focus points in every frame.
        frames: frames solved together.
        seconds: processor seconds, all threads: the least of a few runs, since other load only adds.
    """

    solver: str
    points: int
    frames: int
    seconds: float


def measure_solvers(points: int = POINTS, frames: int = FRAMES) -> list[SolverRow]:
    """Time every solver on points of all kinds that move through the picture.

    Args:
        points: focus points.
        frames: frames of them.
    """
    targets = moving_points(points, frames)
    breathing = LensLaw.thin(np.full(frames, 50.0), 2.0, breathing=True)
    solvers: dict[str, Callable[[], object]] = {
        "one distance, thin lens": lambda: solve_distances(targets, 5.0, 1.25, near_priority=1.0, occluded="fade"),
        "one distance, lens with its own law": lambda: solve_distances(targets, 5.0, law=breathing, occluded="fade"),
        "focus and best stop": lambda: stops_for(targets, breathing, 0.03, occluded="fade"),
        "tilted plane, limited": lambda: _solve_tilt(targets),
    }
    return [SolverRow(name, points, frames, _seconds(solve)) for name, solve in solvers.items()]


def _solve_tilt(targets: FocusTargets) -> DoubleArray:
    """The planes with the points' shares found first, as a shot needs them."""
    shares = solve_distances(targets, 5.0, 1.25, occluded="fade").shares
    fits, target_w = fit_targets(targets, shares, 1.25)
    planes, _ = limit_planes(fits.planes, 50.0, 0.15, targets.slopes, target_w, shares)
    return tilts_and_swings(planes, 50.0)


def moving_points(points: int, frames: int) -> FocusTargets:
    """Half of them sharp, half soft, each on a path of its own; always the same ones.

    Args:
        points: number of points.
        frames: over which they move.
    """
    random = np.random.default_rng(4)
    turn = random.uniform(0, 2 * np.pi, points) + np.linspace(0, 2 * np.pi, frames)[:, None]
    slopes = np.stack([0.36 * np.sin(turn), 0.2 * np.cos(2 * turn + random.uniform(0, 6, points))], axis=-1)
    soft = np.arange(points) % 2 == 1
    return FocusTargets.from_columns(
        [f"point{i}" for i in range(points)],
        random.uniform(1, 30, points) * (1 + 0.3 * np.sin(turn)),
        kinds=["soft" if is_soft else "sharp" for is_soft in soft],
        slopes=slopes,
        weights=random.uniform(0.1, 2, points),
        blurs_mm=np.where(soft, random.uniform(0.01, 0.5, points), 0.0),
        visible=np.clip(0.5 + np.cos(3 * turn), 0, 1),
        frame_widths=_FRAME_WIDTH,
    )


def _seconds(work: Callable[[], object]) -> float:
    spent = []
    for _ in range(_REPEATS):
        began = time.process_time()
        work()
        spent.append(time.process_time() - began)
    return min(spent)
