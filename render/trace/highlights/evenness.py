"""Bounds of how much a grid table's rays change over the pupil, by which folds of blurred images are excluded."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from render.model.arrays import DoubleArray
from render.trace.lens_table import GridTable


@lru_cache(maxsize=1)  # live pictures ask for the same again and again
def grid_changes(table: GridTable) -> tuple[float, float, float]:
    """Bounds of the derivatives of a table's rays by the place on the unit disc, over all wavelengths, fields and open rays.

    Of a lens with cylinders they are those of the picture squeezed as the pupil is: evenness is a ratio of areas, which stays.

    Returns:
        Largest derivative of a slope error; largest difference of a pupil point's derivative from ``c`` times the identity,
        metres; and ``c``, metres. The size of a derivative is the root of the sum of its elements' squares.
    """
    side = table.rays.shape[2]
    line = np.linspace(-1, 1, side)
    used = (table.light[..., 1] <= 0) & (np.hypot(*np.meshgrid(line, line)) <= 1 + 2 / side)
    cells = used[..., :-1, :-1] & used[..., 1:, :-1] & used[..., :-1, 1:] & used[..., 1:, 1:]
    if not cells.any():
        return float("inf"), 0.0, 0.0
    rays = table.rays.astype(np.float64)
    right, down = np.diff(rays, axis=-2) * (side - 1) / 2, np.diff(rays, axis=-3) * (side - 1) / 2
    if table.mirrored:
        widened = down[..., :-1, 3][cells].mean() / right[..., :-1, :, 2][cells].mean()
        right[..., 0::2] *= widened
        down[..., 0::2] *= widened
    c = float((right[..., :-1, :, 2][cells].mean() + down[..., :-1, 3][cells].mean()) / 2)
    right[..., 2] -= c
    down[..., 3] -= c

    def largest(part: slice) -> float:
        across, along = _squares(right[..., part]), _squares(down[..., part])
        sums = np.maximum(across[..., :-1, :], across[..., 1:, :]) + np.maximum(along[..., :-1], along[..., 1:])
        return float(np.sqrt(sums[cells].max()))

    return largest(slice(0, 2)), largest(slice(2, 4)), c


def _squares(values: DoubleArray) -> DoubleArray:
    return np.asarray((values**2).sum(axis=-1))
