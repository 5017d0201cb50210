"""Bins of inverse depth whose splats share a plane: so thin that a plane's blur is nearly that of each of its splats."""

from __future__ import annotations

import numpy as np

from render.model.arrays import DoubleArray

MOST_PLANES = 32
"""Limit on the planes of a picture; as in ``trace/splat_planes.glsl``."""
LEAST_PLANES = 8
"""Planes that a cloud is cut into at least, so that surfaces within it find their place between splats."""
STEP_PX = 1.0
"""Change of the radius of the circle of confusion within a bin, pixels of the picture, near the focus."""
STEP_SHARE = 0.25
"""The same relative to the radius, where that is more."""
_COARSER = 1.2


def bin_edges(w_range: tuple[float, float], focus_w: tuple[float, float], pupil_px: float) -> DoubleArray:
    """Edges ``(n + 1,)`` of bins, descending from the nearest inverse depth to the farthest, 1/m.

    Args:
        w_range: least and greatest inverse depth of the splats, 1/m.
        focus_w: least and greatest inverse depth that is in focus anywhere in the picture, 1/m.
        pupil_px: radius of the pupil times the focal length, px·m; 0 for a pinhole.
    """
    farthest, nearest = w_range
    if not nearest > farthest:
        return np.array([nearest, farthest])
    widest = (nearest - farthest) / LEAST_PLANES
    tolerance = 1.0
    while True:
        edges = [nearest]
        while edges[-1] > farthest and len(edges) <= MOST_PLANES:
            edges.append(edges[-1] - min(widest, _step(edges[-1], focus_w, pupil_px, tolerance)))
        if edges[-1] <= farthest + 1e-9 * widest:
            return np.array([*edges[:-1], farthest])
        tolerance *= _COARSER


def _step(w: float, focus_w: tuple[float, float], pupil_px: float, tolerance: float) -> float:
    """Width of the bin whose near edge is at ``w``, 1/m."""
    if pupil_px == 0:
        return np.inf
    step = 0.0
    for at in (w, w - tolerance * STEP_PX / pupil_px):
        blur_px = pupil_px * max(focus_w[0] - at, at - focus_w[1], 0.0)
        here = tolerance * max(STEP_PX, STEP_SHARE * blur_px) / pupil_px
        step = here if step == 0 else min(step, here)
    return step
