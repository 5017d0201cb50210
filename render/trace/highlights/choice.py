"""Choice of the highlights that are worth carrying, within a budget of connections."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from render.model.area import Area
from render.model.arrays import DoubleArray
from render.trace.highlights.chosen import pixels_seen

CONNECTIONS_PER_RAY = 0.25
"""Limit on the connections of a picture, relative to its rays. On two CPU cores a connection costs as much as one to three rays.
Measured over 0.04 to 0.64 (``tests/bench/RESULTS.md``), and chosen for 100 rays: where highlights cover the demo shot it
removes 40 % of the squared error that 0.08 leaves, and 0.64 would remove 10 to 20 % of the rest; with 25 rays, half of it."""
CELL_COST = 6.0
"""Connections that a cell of the pupil counts for: it evaluates the lens table, and is scattered."""


def choose_highlights(
    squares: DoubleArray,
    boxes: NDArray[np.float32],
    cells: NDArray[np.uint32],
    area: Area,
    most_connections: float,
) -> NDArray[np.int64]:
    """Choose highlights by the variance that each connection removes.

    A ray finds a texel of a layer with the probability a/A of its area in that of its circle of confusion, so that the sum of
    the variances of the A pixels is L²·a/N for N rays whatever the circle. Carrying it costs A connections, and carrying a group
    of texels costs no more.

    Args:
        squares: ``(n,)`` squared luminance over the surroundings, summed over the texels of each.
        boxes: ``(n, 4)`` first and last place of the blurred image, pixels; empty where the highlight cannot be carried.
        cells: ``(n,)`` cells of the pupil across and down by which it is scattered; 0 where it is joined to pixels.
        area: the picture.
        most_connections: limit on the sum of connections.

    Returns:
        ``(m,)`` their numbers in the list, ascending.
    """
    size = np.maximum(boxes[:, 2:] - boxes[:, :2], 0.0).astype(np.float64)
    seen = pixels_seen(boxes, area)
    pixels = np.prod(size, axis=1)
    is_seen, by_cells = (pixels > 0) & (seen > 0), CELL_COST * cells.astype(np.float64) ** 2
    cost, whole = np.where(cells > 0, by_cells, seen), np.where(cells > 0, by_cells, pixels)
    value = np.where(is_seen, squares / np.maximum(whole, 1.0), 0.0)
    order = np.argsort(-value, kind="stable")
    order = order[value[order] > 0]
    return np.sort(order[np.cumsum(cost[order]) <= most_connections])
