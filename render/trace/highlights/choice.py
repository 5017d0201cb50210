"""Choice of the highlights that are worth carrying, within a budget of connections."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray

CONNECTIONS_PER_RAY = 0.08
"""Limit on the connections of a picture, relative to its rays: eight for each pixel at 100 rays."""
CELL_COST = 2.0
"""Connections that a cell of the pupil counts for: it evaluates the lens table about twice as often."""
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


@dataclass(frozen=True)
class HighlightChoice:
    """Highlights chosen to be carried.

    Attributes:
        numbers: ``(m,)`` their numbers in the list, ascending.
        connections: that each takes, ``(m,)``: pixels of its box within the picture, or what its cells count for.
    """

    numbers: NDArray[np.int64]
    connections: DoubleArray


def choose_highlights(
    excess: NDArray[np.float32],
    boxes: NDArray[np.float32],
    cells: NDArray[np.uint32],
    picture: tuple[int, int, int, int],
    most_connections: float,
) -> HighlightChoice:
    """Choose highlights by the variance that each connection removes.

    A ray finds a texel of a layer with the probability a/A of its area in that of its circle of confusion, so that the sum of
    the variances of the A pixels is L²·a/N for N rays whatever the circle. Carrying it costs A connections.

    Args:
        excess: ``(n, 3)`` radiance over the surroundings.
        boxes: ``(n, 4)`` first and last place of the blurred image, pixels; empty where the highlight cannot be carried.
        cells: ``(n,)`` cells of the pupil across and down by which it is scattered; 0 where it is joined to pixels.
        picture: left, top, right and bottom of the pixels that are made.
        most_connections: limit on the sum of connections.
    """
    size = np.maximum(boxes[:, 2:] - boxes[:, :2], 0.0).astype(np.float64)
    low, high = np.maximum(boxes[:, :2], picture[:2]), np.minimum(boxes[:, 2:], picture[2:])
    seen = np.prod(np.maximum(np.ceil(high) - np.floor(low), 0.0).astype(np.float64), axis=1)
    area = np.prod(size, axis=1)
    scattered, whole = (cells > 0) & (area > 0) & (seen > 0), CELL_COST * cells.astype(np.float64) ** 2
    area, seen = np.where(scattered, whole, area), np.where(scattered, whole, seen)
    value = np.where((area > 0) & (seen > 0), (excess @ _LUMINANCE) ** 2 / np.maximum(area, 1.0), 0.0)
    order = np.argsort(-value, kind="stable")
    order = order[value[order] > 0]
    order = order[np.cumsum(seen[order]) <= most_connections]
    numbers = np.sort(order)
    return HighlightChoice(numbers, seen[numbers])
