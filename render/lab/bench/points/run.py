"""The points bench: errors of sample patterns over pixel and pupil, at pixels and after a blur of neighbouring pixels.

Every pixel of a picture of 64x64 sees the same, and has the pattern that the mask says. The root mean square of the pixels'
errors is given in decibels against the patterns of before: what is below 0 is better.

pullfocus bench points
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np

from render.lab.bench.points.integrands import KINDS, Integrand, make_integrands
from render.lab.bench.points.patterns import BEFORE, PRODUCT, PointSet, point_sets
from render.lab.bench.points.plan import PointsPlan, plan_from_arguments
from render.lab.bench.progress import check_file, goal_lines, say
from render.lab.bench.results import Goal
from render.model.arrays import DoubleArray

BLURS = (1, 3, 5)
"""Sides in pixels of the squares over which pictures are averaged."""
GOAL_GAIN_DB = 1.0


@dataclass(frozen=True)
class PointsRow:
    """One pattern; decibels against the patterns of before, below 0 is better.

    Attributes:
        name: name of the pattern.
        edges_db: error of single pixels over edges, for each number of rays.
        kinds_db: for each side of `BLURS`, the mean over numbers of rays for each kind of integrand.
        blurs_db: for each side of `BLURS`, the mean over everything.
        mean_db: mean of these.
    """

    name: str
    edges_db: list[float]
    kinds_db: list[list[float]]
    blurs_db: list[float]
    mean_db: float


@dataclass(frozen=True)
class PointsBench:
    """Results of the points bench; the fields are the keys of its JSON.

    Attributes:
        rays: numbers of rays.
        kinds: kinds of integrands.
        blurs: sides of the squares over which pictures are averaged.
        rows: the patterns.
        goals: goals and whether they are met.
    """

    rays: list[int]
    kinds: list[str]
    blurs: list[int]
    rows: list[PointsRow]
    goals: list[Goal]


def measure(plan: PointsPlan) -> PointsBench:
    """Measure all patterns."""
    integrands = make_integrands(plan.integrands)
    errors = {points.name: _errors_db(points, integrands, plan) for points in point_sets()}
    rows = [_row(name, error - errors[BEFORE]) for name, error in errors.items()]
    return PointsBench(list(plan.rays), list(KINDS), list(BLURS), rows, _goals(rows))


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the table on standard output, and write the JSON.

    Args:
        arguments: as `render.lab.bench.points.plan.add_arguments` declares them.

    Raises:
        OutputError: the file cannot be written.
    """
    check_file(arguments.json)
    result = measure(plan_from_arguments(arguments))
    say(result, report(result), arguments.json)


def report(result: PointsBench) -> str:
    """The table."""
    lines = [
        f"Errors in decibels against {BEFORE}; below 0 is better.",
        "",
        f"{'':24}{'edges, by number of rays':{7 * len(result.rays)}}   mean over numbers of rays",
        f"{'pattern':24}{''.join(f'{rays:7d}' for rays in result.rays)}   {''.join(f'{kind:>8}' for kind in result.kinds)}"
        f"   {''.join(f'{blur:>6}x{blur}' for blur in result.blurs)}{'all':>8}",
    ]
    lines += [
        f"{row.name:24}{''.join(f'{db:7.2f}' for db in row.edges_db)}   {''.join(f'{db:8.2f}' for db in row.kinds_db[0])}"
        f"   {''.join(f'{db:8.2f}' for db in row.blurs_db)}{row.mean_db:8.2f}"
        for row in result.rows
    ]
    return "\n".join([*lines, "", *goal_lines(result.goals)]) + "\n"


def _errors_db(points: PointSet, integrands: list[Integrand], plan: PointsPlan) -> DoubleArray:
    """Root mean square errors ``(numbers of rays, kinds, blurs)``, dB."""
    mask = points.mask()
    squares = np.zeros((len(plan.rays), len(KINDS), len(BLURS)))
    for i, rays in enumerate(plan.rays):
        for seed in range(plan.seeds):
            pattern = points.points(rays, seed)
            for integrand in integrands:
                picture = (integrand.is_lit(pattern).mean(axis=1) - integrand.share)[mask]
                squares[i, KINDS.index(integrand.kind)] += [np.mean(_average(picture, side) ** 2) for side in BLURS]
    counts = [sum(integrand.kind == kind for integrand in integrands) * plan.seeds for kind in KINDS]
    return np.asarray(10 * np.log10(squares / np.array(counts)[:, None]))


def _average(picture: DoubleArray, side: int) -> DoubleArray:
    """Averages over the squares around each pixel of a picture that repeats."""
    steps = range(-(side // 2), side // 2 + 1)
    return np.asarray(np.mean([np.roll(picture, (y, x), axis=(0, 1)) for y in steps for x in steps], axis=0))


def _row(name: str, error_db: DoubleArray) -> PointsRow:
    by_kind, by_blur = error_db.mean(axis=0).T, error_db.mean(axis=(0, 1))
    return PointsRow(name, error_db[:, 0, 0].tolist(), by_kind.tolist(), by_blur.tolist(), float(by_blur.mean()))


def _goals(rows: list[PointsRow]) -> list[Goal]:
    product = next(row for row in rows if row.name == PRODUCT)
    rival = min((row for row in rows if row is not product), key=lambda row: row.mean_db)
    return [
        Goal(
            "mean gain over the patterns of before, dB, at least",
            GOAL_GAIN_DB,
            -product.mean_db,
            -product.mean_db >= GOAL_GAIN_DB,
        ),
        Goal(
            f"mean error against the best of the others ({rival.name}), dB, at most",
            0.0,
            product.mean_db - rival.mean_db,
            product.mean_db <= rival.mean_db,
        ),
    ]
