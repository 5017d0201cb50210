"""Places on authored faces of triangles that are finer than those faces' fans, as on subdivision surfaces.

A *place* on a face of n corners is a point of the regular polygon whose corner k lies at ``(cos 2πk/n, sin 2πk/n)``. The fan of
triangles that the face is cut into covers this polygon, and so do the finer triangles, so that a place on one is a place on the
other: a focus point names a triangle of the authored face's fan.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray, FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class FacePlaces:
    """Places of triangles on their authored faces.

    Attributes:
        places: ``(m, 3, 2)`` place of each corner, in the order of barycentric coordinates.
        sizes: ``(m,)`` int32 corners of the face that each triangle is on; 0 for a triangle of a face's own fan.
    """

    places: FloatArray
    sizes: IntArray

    def pick(self, triangles: NDArray[np.bool_]) -> FacePlaces:
        """Return those of some triangles."""
        return FacePlaces(self.places[triangles], self.sizes[triangles])

    def to_fans(
        self, triangles: NDArray[np.integer], fans: IntArray, weights: DoubleArray
    ) -> tuple[IntArray, DoubleArray]:
        """Convert points of triangles to points of the fans of their authored faces.

        Args:
            triangles: ``(n,)``.
            fans: ``(n,)`` triangle of the fan, which holds where a triangle is one of a fan.
            weights: ``(n, 3)`` barycentric coordinates.

        Returns:
            ``(n,)`` triangle of the fan, and ``(n, 3)`` barycentric coordinates there.
        """
        fans, weights = fans.copy(), weights.copy()
        sizes = self.sizes[triangles]
        for size in np.unique(sizes[sizes > 0]).tolist():
            here = np.flatnonzero(sizes == size)
            places = np.einsum("nc,ncx->nx", weights[here], self.places[triangles[here]].astype(np.float64))
            fans[here], weights[here] = fans_of_places(places, size)
        return fans, weights


def polygon_corners(count: int) -> DoubleArray:
    """``(n, 2)`` corners of the regular polygon that stands for a face."""
    turn = 2 * np.pi * np.arange(count) / count
    return np.stack([np.cos(turn), np.sin(turn)], axis=1)


def place_in_fan(fan: int, weights: DoubleArray, count: int) -> DoubleArray:
    """Place ``(2,)`` of a point of a face's fan.

    Args:
        fan: triangle of the fan, less than ``count`` - 2.
        weights: ``(3,)`` barycentric coordinates.
        count: corners of the face.
    """
    return np.asarray(weights @ polygon_corners(count)[[0, fan + 1, fan + 2]])


def fans_of_places(places: DoubleArray, count: int) -> tuple[IntArray, DoubleArray]:
    """Triangles of a face's fan in which places lie, and the barycentric coordinates there.

    Args:
        places: ``(n, 2)``; what rounding has put outside is moved to the nearest triangle.
        count: corners of the face.

    Returns:
        ``(n,)`` and ``(n, 3)``.
    """
    corners = polygon_corners(count)
    from_first = places - corners[0]
    # Seen from the first corner, the others appear in order within half a turn.
    rays = corners[1:] - corners[0]
    angles = np.arctan2(rays[:, 1], rays[:, 0]) % (2 * np.pi)
    angle = np.arctan2(from_first[:, 1], from_first[:, 0]) % (2 * np.pi)
    fans = np.clip(np.searchsorted(angles, angle, side="right") - 1, 0, count - 3)
    triangles = corners[np.stack([np.zeros_like(fans), fans + 1, fans + 2], axis=1)]
    weights = np.maximum(barycentric(triangles, places), 0.0)
    return fans.astype(np.int32), weights / weights.sum(axis=1, keepdims=True)


def barycentric(triangles: DoubleArray, places: DoubleArray) -> DoubleArray:
    """Barycentric coordinates ``(n, 3)`` of places ``(n, 2)`` in triangles ``(n, 3, 2)``; a third each without area."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    double = _cross(b - a, c - a)
    safe = np.where(double == 0, 1.0, double)
    first, second = _cross(b - places, c - places) / safe, _cross(c - places, a - places) / safe
    weights = np.stack([first, second, 1 - first - second], axis=1)
    return np.where((double == 0)[:, None], 1 / 3, weights)


def _cross(one: DoubleArray, other: DoubleArray) -> DoubleArray:
    return np.asarray(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0])
