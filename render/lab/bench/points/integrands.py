"""Integrands of the points bench: what a ray sees where the picture is hard to sample, over the pixel and the pupil.

A surface at one depth is seen at ``pixel offset + c·pupil point``, with c its circle of confusion in pixels.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from render.model.arrays import BoolArray, DoubleArray
from render.optics.sobol import owen_sobol

KINDS = ("edge", "corner", "light")
_TRUTH_POINTS = 1 << 16
_TRUTH_SEED = 2**31 - 1
_LEAST_SHARE = 0.002


@dataclass(frozen=True, eq=False)
class Integrand:
    """Function over squared radius, turn, sensor x and y.

    Attributes:
        kind: one of `KINDS`.
        is_lit: True for each of points ``(..., 4)`` whose ray meets light.
        share: mean over all rays.
    """

    kind: str
    is_lit: Callable[[DoubleArray], BoolArray]
    share: float


def make_integrands(count: int, seed: int = 3) -> list[Integrand]:
    """Make so many of each kind, at random: edges of a surface, corners of two surfaces at two depths, and small lights.

    Those that nearly all or hardly any rays meet are left out.
    """
    random = np.random.default_rng(seed)
    grid = owen_sobol(_TRUTH_POINTS, _TRUTH_SEED)
    made = []
    for kind, make in zip(KINDS, (_edge, _corner, _light), strict=True):
        for _ in range(count):
            is_lit = make(random)
            share = float(is_lit(grid).mean())
            if _LEAST_SHARE < share < 1 - _LEAST_SHARE:
                made.append(Integrand(kind, is_lit, share))
    return made


def _place(points: DoubleArray, coc_px: float) -> tuple[DoubleArray, DoubleArray]:
    radius, angle = coc_px * np.sqrt(points[..., 0]), 2 * np.pi * points[..., 1]
    return points[..., 2] - 0.5 + radius * np.cos(angle), points[..., 3] - 0.5 + radius * np.sin(angle)


def _edge(random: np.random.Generator, reach: float = 1.0) -> Callable[[DoubleArray], BoolArray]:
    angle, coc_px = random.uniform(0, 2 * np.pi), 2.0 ** random.uniform(-3, 5) * random.choice([-1.0, 1.0])
    normal = np.cos(angle), np.sin(angle)
    offset_px = reach * random.uniform(-1, 1) * (abs(coc_px) + 0.5 * (abs(normal[0]) + abs(normal[1])))

    def is_lit(points: DoubleArray) -> BoolArray:
        x, y = _place(points, coc_px)
        return np.asarray(normal[0] * x + normal[1] * y < offset_px)

    return is_lit


def _corner(random: np.random.Generator) -> Callable[[DoubleArray], BoolArray]:
    one, other = _edge(random, 0.5), _edge(random, 0.5)
    return lambda points: one(points) & other(points)


def _light(random: np.random.Generator) -> Callable[[DoubleArray], BoolArray]:
    coc_px = 2.0 ** random.uniform(-1, 5)
    angle, distance_px = random.uniform(0, 2 * np.pi), coc_px * np.sqrt(random.uniform())
    radius_px = max(0.5, coc_px * 2.0 ** random.uniform(-3, 0))

    def is_lit(points: DoubleArray) -> BoolArray:
        x, y = _place(points, coc_px)
        return np.asarray(np.hypot(x - distance_px * np.cos(angle), y - distance_px * np.sin(angle)) < radius_px)

    return is_lit
