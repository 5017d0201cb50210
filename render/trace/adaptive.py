"""Adaptive rays: first rays tell the error of each tile of 8x8 pixels, the others go where they lower the error most.

The error is that of the picture which a viewer sees, clipped and encoded by the sRGB curve: the first rays are traced in
two halves, whose encoded difference is twice the standard error of their mean. It is shared with the tiles around, since a
tile whose first rays found nothing bright may have missed it. Squared errors fall as n to the power of -5/4, as those of
stratified points do for a discontinuous function in four dimensions, pixel and pupil (Mitchell 1996, "Consequences of
Stratified Sampling in Graphics"), so that their sum is least for rays in proportion to the squared error to the power of
4/9.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from render.model.arrays import DoubleArray, FloatArray, IntArray
from render.model.limits import MAX_RAYS

TILE = 8
"""Side of a tile in pixels: the work group of ``trace/trace.comp``."""
FALL = 1.25
"""Power of the number of rays with which squared errors fall."""
_FIRST_SHARE, _LEAST_FIRST = 4, 16
_MOST_SHARE = 16
_MOST_GROWTH = 4
_LEAST_GROWTH = 1.25  # fewer rays more would hardly change a pixel, and cost a dispatch
_NEIGHBOURS = 0.5  # weight of the mean squared error around a tile
_BISECTIONS = 50

Values = TypeVar("Values", FloatArray, IntArray)


@dataclass(frozen=True)
class RayBudget:
    """Rays of a picture.

    Attributes:
        rays: mean of the rays per pixel, unless an error is asked for.
        noise: wanted standard error of each tile, encoded values from 0 to 1; 0 for none.
        exposure: factor on radiance before it is clipped at 1 and encoded.
    """

    rays: int
    noise: float = 0.0
    exposure: float = 1.0

    @property
    def first(self) -> int:
        """First rays of each pixel, in two halves: a power of two, which the points fill best."""
        wanted = max(_LEAST_FIRST, self.rays // _FIRST_SHARE)
        return 1 << (wanted - 1).bit_length()

    @property
    def most(self) -> int:
        """Most rays of a pixel: a power of two."""
        if self.noise > 0:
            return MAX_RAYS
        return min(MAX_RAYS, 1 << (_MOST_SHARE * self.rays - 1).bit_length())


def allocate(errors: DoubleArray, traced: IntArray, pixels: IntArray, budget: RayBudget) -> IntArray:
    """Choose the rays of each tile.

    Args:
        errors: ``(rows, columns)`` squared errors of the mean over the rays traced so far (`tile_errors`).
        traced: rays per pixel of each tile that were traced.
        pixels: pixels of each tile.
        budget: rays of the picture.

    Returns:
        Rays per pixel of each tile, those that were traced included. For a wanted error an even number, at most `_MOST_GROWTH`
        times as many, so that the error is estimated anew.
    """
    if budget.noise > 0:
        growth = np.minimum((errors / budget.noise**2) ** (1 / FALL), _MOST_GROWTH)
        wanted = np.where(errors > budget.noise**2, 2 * np.ceil(traced * growth / 2), traced)
        return np.asarray(np.minimum(wanted, budget.most), np.int32)
    weights = (errors * traced.astype(float) ** FALL) ** (1 / (1 + FALL))
    total = budget.rays * int(pixels.sum())
    if not weights.any():
        return np.maximum(traced, np.int32(budget.rays))

    def rays(scale: float) -> IntArray:
        wanted = np.minimum(scale * weights, budget.most).astype(np.int32)
        return np.where(wanted < _LEAST_GROWTH * traced, traced, wanted)

    low, high = 0.0, float(budget.most / weights[weights > 0].min())
    if (rays(high) * pixels).sum() <= total:
        return rays(high)
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        low, high = (middle, high) if (rays(middle) * pixels).sum() <= total else (low, middle)
    return rays(low)


def tile_errors(total: FloatArray, apart: FloatArray, traced: IntArray, exposure: float) -> DoubleArray:
    """Squared error of the mean over the rays of each pixel, for each tile; tiles around have a share in it.

    Args:
        total: ``(height, width, 4)`` sum of the radiance of the rays, premultiplied.
        apart: ``(height, width, 4)`` difference of the sums of two halves of the rays.
        traced: ``(rows, columns)`` rays per pixel of each tile.
        exposure: factor on radiance before it is clipped at 1 and encoded.

    Returns:
        ``(rows, columns)`` mean over pixels and channels, squared encoded values.
    """
    width = total.shape[1]
    begins = np.arange(0, width, TILE)
    own = np.empty(traced.shape)
    for row, counts in enumerate(traced):  # row by row, so that little memory is held
        lines = slice(row * TILE, (row + 1) * TILE)
        scale = (exposure / counts).astype(np.float32).repeat(TILE)[:width, None]
        one = _encode((total[lines, :, :3] + apart[lines, :, :3]) * scale)
        other = _encode((total[lines, :, :3] - apart[lines, :, :3]) * scale)
        squares = np.mean(((one - other) / 2).astype(np.float64) ** 2, axis=(0, 2))
        own[row] = np.add.reduceat(squares, begins) / np.minimum(width - begins, TILE)
    return np.maximum(own, _NEIGHBOURS * _mean_around(own))


def tile_pixels(width: int, height: int) -> IntArray:
    """Pixels ``(rows, columns)`` of each tile of an area; those at its right and lower edge may have fewer."""
    down = np.minimum(height - np.arange(0, height, TILE), TILE)
    across = np.minimum(width - np.arange(0, width, TILE), TILE)
    return np.asarray(down[:, None] * across, np.int32)


def over_pixels(tiles: Values, width: int, height: int) -> Values:
    """Values of tiles as ``(height, width, 1)`` of their pixels."""
    return tiles.repeat(TILE, axis=0).repeat(TILE, axis=1)[:height, :width, None]


def whole_stops(exposure: float) -> float:
    """Round a factor on radiance to a power of two, so that small changes of the exposure leave the rays as they are."""
    return float(2.0 ** np.round(np.log2(exposure))) if exposure > 0 else 1.0


def _mean_around(tiles: DoubleArray) -> DoubleArray:
    """Mean over the 3x3 tiles around each tile; beyond the edge they are repeated."""
    rows, columns = tiles.shape
    padded = np.pad(tiles, 1, mode="edge")
    return np.asarray(np.mean([padded[y : y + rows, x : x + columns] for y in range(3) for x in range(3)], axis=0))


def _encode(radiance: FloatArray) -> FloatArray:
    """Clip to [0, 1] and encode by the sRGB curve (IEC 61966-2-1)."""
    light = np.clip(radiance, 0.0, 1.0)
    return np.asarray(np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055), np.float32)
