"""Patterns of the points bench: the product's, and others that could be in its place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.lab.bench.points.blue_noise import SIDE, blue_noise_ranks
from render.model.arrays import DoubleArray, IntArray
from render.optics.sampling import PATTERNS, pattern_mask, sample_points, square_to_disc
from render.optics.sobol import owen_sobol

BEFORE = "R2 x Halton, shifted"
"""The product's until November 2026."""
PRODUCT = "product"
_R2 = 1.0 / 1.32471795724474602596 ** np.arange(1, 3)  # Roberts 2018
_R4 = 1.0 / 1.16730397826141868426 ** np.arange(1, 5)


@dataclass(frozen=True)
class PointSet:
    """A way to place the rays of neighbouring pixels.

    Attributes:
        name: for the table.
        points: makes ``(patterns, n, 4)`` squared radii, turns, sensor x and y from n and a seed.
        mask: makes the pattern index ``(64, 64)`` of each pixel.
    """

    name: str
    points: Callable[[int, int], DoubleArray]
    mask: Callable[[], IntArray]


def point_sets() -> tuple[PointSet, ...]:
    """All patterns of the bench."""
    return (
        PointSet(
            "random", lambda rays, seed: np.random.default_rng(seed).random((PATTERNS, rays, 4)), _blue_noise_mask
        ),
        PointSet(BEFORE, _r2_halton, _blue_noise_mask),
        PointSet("Sobol, shifted", _sobol_shifted, _blue_noise_mask),
        PointSet("Sobol, XOR and turned", lambda rays, seed: _sobol_xor(rays, seed, is_turned=True), _blue_noise_mask),
        PointSet("Sobol, XOR", lambda rays, seed: _sobol_xor(rays, seed, is_turned=False), _blue_noise_mask),
        PointSet("Sobol, XOR, concentric", _sobol_xor_concentric, _blue_noise_mask),
        PointSet("Sobol, own scrambles", _sobol_own_scrambles, _blue_noise_mask),
        PointSet("runs, polar", _runs_polar, pattern_mask),
        PointSet("runs, pupil 0 2", lambda rays, seed: _runs(rays, seed, (0, 2, 1, 3)), pattern_mask),
        PointSet("runs, pupil 0 3", lambda rays, seed: _runs(rays, seed, (0, 3, 1, 2)), pattern_mask),
        PointSet("runs, pupil 1 2", lambda rays, seed: _runs(rays, seed, (1, 2, 0, 3)), pattern_mask),
        PointSet("runs, pupil 1 3", lambda rays, seed: _runs(rays, seed, (1, 3, 0, 2)), pattern_mask),
        PointSet("runs, pupil 2 3", lambda rays, seed: _runs(rays, seed, (2, 3, 0, 1)), pattern_mask),
        PointSet(PRODUCT, lambda rays, seed: sample_points(rays, seed, PATTERNS), pattern_mask),
    )


def _blue_noise_mask() -> IntArray:
    return np.asarray(blue_noise_ranks() * PATTERNS // SIDE**2, np.int32)


def _shifts() -> DoubleArray:
    """Shifts ``(patterns, 1, 4)``; the turn grows evenly, so that blue noise stays blue."""
    index = np.arange(PATTERNS)[:, None]
    shifts = np.mod(index * _R4, 1.0)
    shifts[:, 1] = index[:, 0] / PATTERNS
    return np.asarray(shifts[:, None])


def _r2_halton(rays: int, seed: int) -> DoubleArray:
    index = np.arange(rays)
    halton = np.stack([_radical_inverse(index, 2), _radical_inverse(index, 3)], axis=-1)
    start = 0.5 + seed * _R4[::-1]
    return np.asarray(np.mod(start + np.concatenate([index[:, None] * _R2, halton], axis=1) + _shifts(), 1.0))


def _sobol_shifted(rays: int, seed: int) -> DoubleArray:
    return np.asarray(np.mod(owen_sobol(rays, seed) + _shifts(), 1.0))


def _sobol_xor(rays: int, seed: int, *, is_turned: bool) -> DoubleArray:
    points = _digital_shifts(rays, seed)
    if is_turned:
        points[..., 1] = _sobol_shifted(rays, seed)[..., 1]
    return points


def _sobol_xor_concentric(rays: int, seed: int) -> DoubleArray:
    return _concentric(_digital_shifts(rays, seed))


def _digital_shifts(rays: int, seed: int) -> DoubleArray:
    words = (owen_sobol(rays, seed) * 2.0**32).astype(np.uint32)
    shifts = np.random.default_rng(seed).integers(0, 2**32, (PATTERNS, 1, 4)).astype(np.uint32)
    return np.asarray((words ^ shifts) * 2.0**-32)


def _sobol_own_scrambles(rays: int, seed: int) -> DoubleArray:
    return np.stack([owen_sobol(rays, seed * PATTERNS + pattern) for pattern in range(PATTERNS)])


def _runs_polar(rays: int, seed: int) -> DoubleArray:
    return owen_sobol(PATTERNS * rays, seed).reshape(PATTERNS, rays, 4)


def _runs(rays: int, seed: int, dimensions: tuple[int, ...]) -> DoubleArray:
    return _concentric(_runs_polar(rays, seed)[..., dimensions])


def _concentric(points: DoubleArray) -> DoubleArray:
    return np.concatenate([square_to_disc(points[..., :2]), points[..., 2:]], axis=-1)


def _radical_inverse(index: NDArray[np.int_], base: int) -> DoubleArray:
    """Radical inverse ``(n,)`` in [0, 1): the digits of ``index`` mirrored at the point."""
    left, inverse, place = np.array(index), np.zeros(len(index)), 1.0
    while left.any():
        place /= base
        inverse += place * (left % base)
        left //= base
    return inverse
