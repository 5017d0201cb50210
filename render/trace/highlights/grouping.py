"""Groups of neighbouring texels that are carried as one highlight, where they are small beside their blurred image or a pixel.

The circles of confusion of a lamp's texels are all as large, and there are four times as many in a picture of twice the size: to
carry each by itself would take sixteen times the connections. A group has the sum of its texels' light, at their centre, in a
square of the same variance.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray, IndexArray, LongArray
from render.trace.highlights.chosen import CARRIED

BLUR_PER_SIDE = 8.0
"""Least radius of a blurred image relative to the side of the groups in it; groups of half a pixel are never too large."""
MOST_SIDE = 8
"""Limit on the side of a group, layer pixels."""
MOST_PLACE = 1 << 16
"""Limit on the places of texels in the picture's frame, layer pixels."""
_WIDENED, _MARGIN_PX = 1.04, 2.0  # of boxes, by highlights/plan.comp
_ALIKE = 0.1
"""Relative difference of inverse depth within a group."""


def group_texels(
    layers: NDArray[np.uint32], plans: NDArray[np.void], luminance: DoubleArray, scale: float
) -> tuple[NDArray[np.void], IndexArray]:
    """Group texels.

    Args:
        layers: ``(n,)`` layer of each.
        plans: excess, box, front, cells, place and area of each; places are from 0 to `MOST_PLACE`.
        luminance: ``(n,)`` of their excess.
        scale: layer pixels per picture pixel.

    Returns:
        `CARRIED` of each group, and ``(n,)`` the group of each texel.
    """
    _, first, group = np.unique(_keys(layers, plans, scale), return_index=True, return_inverse=True)
    count, weights = len(first), np.maximum(luminance, 1e-30)
    total = np.bincount(group, weights, count)

    def mean(values: DoubleArray) -> DoubleArray:
        return np.asarray(np.bincount(group, weights * values, count) / total)

    carried = np.zeros(count, CARRIED)
    for channel in range(3):
        carried["excess"][:, channel] = np.bincount(group, plans["excess"][:, channel], count)
    carried["excess"][:, 3] = mean(plans["excess"][:, 3].astype(np.float64))
    variance = np.zeros(count)
    for axis in (0, 1):
        at = plans["place"][:, axis].astype(np.float64)
        centre = mean(at)
        carried["place"][:, axis] = centre
        variance += mean((at - centre[group]) ** 2) / 2
    carried["place"][:, 2] = _largest(plans["front"], group, count)
    carried["place"][:, 3] = np.sqrt(mean(plans["area"].astype(np.float64)) + 12 * variance)
    carried["cells"] = _largest(plans["cells"], group, count)
    for side in (0, 1):
        carried["box"][:, side] = -_largest(-plans["box"][:, side], group, count)
        carried["box"][:, 2 + side] = _largest(plans["box"][:, 2 + side], group, count)
    return carried, group


def _keys(layers: NDArray[np.uint32], plans: NDArray[np.void], scale: float) -> LongArray:
    """Numbers ``(n,)`` that are equal for the texels of a group: of one square and layer, and about as blurred."""
    places = np.floor(plans["place"]).astype(np.int64)
    half = np.min(plans["box"][:, 2:] - plans["box"][:, :2], axis=1).astype(np.float64) / 2
    radius = scale * np.maximum(half - _MARGIN_PX, 0.0) / _WIDENED
    half_pixel = max(1.0, scale / 2)
    level = np.log2(np.clip(radius / BLUR_PER_SIDE, min(half_pixel, MOST_SIDE), MOST_SIDE)).astype(np.int64)
    alike = np.floor(np.log(np.maximum(plans["excess"][:, 3], 1e-6)) / _ALIKE).astype(np.int64) + 200
    blur = np.minimum(2 * radius / (1 << level), 4095).astype(np.int64)
    key = places[:, 0] >> level
    for value, bits in (
        (places[:, 1] >> level, 16),
        (layers.astype(np.int64), 3),
        (level, 2),
        (blur, 12),
        (np.clip(alike, 0, 511), 9),
        ((plans["cells"] > 0).astype(np.int64), 1),
    ):
        key = key << bits | value
    return np.asarray(key, np.int64)


def _largest(values: NDArray[np.float32 | np.uint32], group: IndexArray, count: int) -> NDArray[np.float32 | np.uint32]:
    """Largest value of each group."""
    order = np.argsort(group, kind="stable")
    starts = np.searchsorted(group[order], np.arange(count))
    return np.asarray(np.maximum.reduceat(values[order], starts))
