"""Blue noise by void and cluster (Ulichney 1993, "The void-and-cluster method for dither array generation")."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from render.model.arrays import BoolArray, DoubleArray, IntArray

SIDE = 64
_SPREAD_PX = 1.5
_FIRST_SHARE = 0.1


@lru_cache(maxsize=1)
def blue_noise_ranks() -> IntArray:
    """``(64, 64)`` int32: each number from 0 to 4095 once, so that those below any bound are spread evenly; it tiles the plane.

    The method has three phases: spread a few first points evenly; rank them by taking away the tightest clusters; then fill the
    largest voids, one after another (its last phase, the same seen from the other half, changes nothing with this energy).
    """
    kernel = _wrapped_gaussian()
    chosen = _spread_first_points(kernel)
    ranks = np.zeros((SIDE, SIDE), np.int32)
    left, energy = chosen.copy(), _energy(chosen, kernel)
    for rank in range(int(chosen.sum()) - 1, -1, -1):
        at = _extreme(np.where(left, energy, -np.inf))
        left[at], ranks[at] = False, rank
        energy -= _move(kernel, at)
    energy = _energy(chosen, kernel)
    for rank in range(int(chosen.sum()), SIDE * SIDE):
        at = _extreme(np.where(chosen, -np.inf, -energy))
        chosen[at], ranks[at] = True, rank
        energy += _move(kernel, at)
    return ranks


def _spread_first_points(kernel: DoubleArray) -> BoolArray:
    """Move the tightest point into the largest void until that changes nothing."""
    index = np.arange(SIDE * SIDE)
    chosen: BoolArray = (np.mod(index * 0.6180339887498949, 1.0) < _FIRST_SHARE).reshape(SIDE, SIDE)
    energy = _energy(chosen, kernel)
    while True:
        tight = _extreme(np.where(chosen, energy, -np.inf))
        chosen[tight] = False
        energy -= _move(kernel, tight)
        void = _extreme(np.where(chosen, -np.inf, -energy))
        chosen[void] = True
        energy += _move(kernel, void)
        if void == tight:
            return chosen


def _wrapped_gaussian() -> DoubleArray:
    offset = np.minimum(np.arange(SIDE), SIDE - np.arange(SIDE))
    line = np.exp(-0.5 * (offset / _SPREAD_PX) ** 2)
    return np.asarray(line[:, None] * line)


def _energy(chosen: BoolArray, kernel: DoubleArray) -> DoubleArray:
    return np.asarray(np.fft.irfft2(np.fft.rfft2(chosen) * np.fft.rfft2(kernel), s=kernel.shape))


def _move(kernel: DoubleArray, at: tuple[int, int]) -> DoubleArray:
    return np.roll(kernel, at, axis=(0, 1))


def _extreme(values: DoubleArray) -> tuple[int, int]:
    y, x = np.unravel_index(int(np.argmax(values)), values.shape)
    return int(y), int(x)
