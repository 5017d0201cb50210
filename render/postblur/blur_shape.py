"""Blur shape of a point: the extent of the iris's image up and down in each of its columns.

A point out of focus is spread evenly over the image of the iris, scaled by its circle of confusion. FLAG needs its
bounds column by column (Moersch & Hamilton 2014, section 3.2.2): the shape must be convex along columns and evenly
bright, but it need not be symmetric.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray, FloatArray
from render.model.lens import IrisShape
from render.optics.iris import rim_radius

COLUMNS = 257
"""Columns at which the edges of the shape are tabulated."""
_RIM = 4096
AREA_STEPS = 8
"""Radii per pixel at which the area of the shape is tabulated."""


@dataclass(frozen=True, eq=False)
class BlurShape:
    """The outline of a convex iris on the film, for a circle of confusion of radius 1.

    Attributes:
        edges: ``(COLUMNS, 2)`` float32: extent up and down from its middle line, at columns from -1 to 1, y down.
        is_symmetric: whether the extents up and down are equal everywhere.
    """

    edges: FloatArray
    is_symmetric: bool

    def reach(self, x: DoubleArray) -> DoubleArray:
        """Extents ``(..., 2)`` up and down at columns ``x``; 0 outside the shape."""
        columns = np.linspace(-1.0, 1.0, COLUMNS)
        inside = np.abs(x) < 1.0
        return np.stack([np.where(inside, np.interp(x, columns, side), 0.0) for side in self.edges.T], axis=-1)

    def areas(self, most_px: float) -> FloatArray:
        """Area of the shape in pixels, for circles of confusion of radius 0, 1/`AREA_STEPS`, ... pixels.

        Each pixel counts by the share with which the blur covers it, so that no light is lost.
        """
        radii = np.arange(int(np.ceil(most_px * AREA_STEPS)) + 2) / AREA_STEPS
        offsets = np.arange(-int(np.ceil(most_px)) - 1, int(np.ceil(most_px)) + 2)
        with np.errstate(divide="ignore", invalid="ignore"):
            at = np.nan_to_num(offsets / radii[:, None], nan=0.0, posinf=2.0, neginf=-2.0)
        heights = self.reach(at).sum(axis=-1) * radii[:, None]
        return np.asarray(heights.sum(axis=1), np.float32)


def make_blur_shape(iris: IrisShape, *, behind: bool, squeeze: float = 1.0) -> BlurShape:
    """Make the blur shape of an iris.

    Args:
        iris: its blades, roundness and rotation are used; masks and radial weights are not, since the blur is even.
        behind: whether the point is behind the focus, where rays have not crossed: its image is upside down to a near point's.
        squeeze: anamorphic squeeze, by which blurs are narrower.
    """
    angle = 2 * np.pi * np.arange(_RIM) / _RIM
    radius = rim_radius(angle - iris.rotation_rad, iris)
    turned = 1.0 if behind else -1.0
    x, y = turned / squeeze * radius * np.cos(angle), -turned * radius * np.sin(angle)
    columns = np.linspace(-1.0, 1.0, COLUMNS)
    up, down = (np.maximum(_edge(x, side * y, columns), 0.0) for side in (-1.0, 1.0))
    edges = np.stack([up, down], axis=-1).astype(np.float32)
    return BlurShape(edges, bool(np.abs(up - down).max() < 2e-3))


def _edge(x: DoubleArray, y: DoubleArray, columns: DoubleArray) -> DoubleArray:
    """Largest ``y`` of an outline over each column; 0 beside it."""
    steps = np.round(x, 9)
    # along an upright edge from its lower end to its upper one, which the columns beside it begin with
    order = np.lexsort((np.where(x < 0, y, -y), steps))
    upper = order[y[order] >= -1e-12]
    if len(upper) < 2:
        return np.zeros_like(columns)
    found = np.interp(columns, steps[upper], y[upper])
    found[(columns < x.min()) | (columns > x.max())] = 0.0
    return np.asarray(found)
