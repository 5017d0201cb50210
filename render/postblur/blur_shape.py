"""Blur shape of a point: the top and the bottom of the iris's image in each of its columns.

A point out of focus is spread evenly over the image of the iris, scaled by its circle of confusion. FLAG needs its
bounds column by column (Moersch & Hamilton 2014, section 3.2.2): the shape must be convex along columns and evenly
bright, but it need not be symmetric. A column may lie wholly above or below the shape's middle, as at a corner of a
turned iris.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass

import moderngl
import numpy as np

from render.gl.shaders import set_uniforms
from render.model.arrays import DoubleArray, FloatArray
from render.model.lens import IrisShape
from render.optics.iris import rim_radius

COLUMNS = 257
"""Columns at which the edges of the shape are tabulated."""
_RIM = 4096
_NEAR = 1e-9  # columns this near to a point of the rim hold it


@dataclass(frozen=True, eq=False)
class BlurShape:
    """The outline of a convex iris on the film, for a circle of confusion of radius 1.

    Attributes:
        edges: ``(COLUMNS, 2)`` float32: extent up and down from its middle line, at even steps from the left end of the shape to
            the right one, y down. One of the two is below 0 where a column does not cross the middle line.
        span: left and right end, below and above 0. Anamorphic squeeze moves them; the height stays within 1.
        is_symmetric: whether the extents up and down are equal everywhere.
    """

    edges: FloatArray
    span: tuple[float, float]
    is_symmetric: bool

    @property
    def wide(self) -> float:
        """Greatest distance from the middle to the left or right."""
        return max(-self.span[0], self.span[1])

    def set_uniforms(self, program: moderngl.ComputeShader) -> None:
        """Set the uniforms of ``layers/outline.glsl`` but for the texture."""
        heights = self.edges.sum(axis=1, dtype=np.float64)
        area = (heights.sum() - 0.5 * (heights[0] + heights[-1])) * (self.span[1] - self.span[0]) / (COLUMNS - 1)
        set_uniforms(program, span=self.span, unit_area=float(area))


def iris_key(iris: IrisShape) -> tuple[Hashable, ...]:
    """Cache key of an iris: equal keys are equal irises."""
    mask = None if iris.mask is None else (iris.mask.shape, iris.mask.tobytes())
    return iris.blades, iris.roundness, iris.rotation_rad, mask, iris.radial_weights


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
    span = float(x.min()), float(x.max())
    top, bottom = _edges(x, y, np.linspace(*span, COLUMNS))
    edges = np.stack([-top, bottom], axis=-1).astype(np.float32)
    return BlurShape(edges, span, bool(np.abs(top + bottom).max() < 2e-3))


def _edges(x: DoubleArray, y: DoubleArray, columns: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Least and greatest ``y`` of a closed outline in each column; ``columns`` are even steps over all of its ``x``."""
    begin, step = columns[0], columns[1] - columns[0]
    next_x, next_y = np.roll(x, -1), np.roll(y, -1)
    first = np.ceil((np.minimum(x, next_x) - _NEAR - begin) / step).astype(int)
    last = np.floor((np.maximum(x, next_x) + _NEAR - begin) / step).astype(int)
    least, most = np.full(len(columns), np.inf), np.full(len(columns), -np.inf)
    for ahead in range(int((last - first).max()) + 1):
        crossed = np.flatnonzero((first + ahead <= last) & (first + ahead >= 0) & (first + ahead < len(columns)))
        at = first[crossed] + ahead
        run = (next_x - x)[crossed]
        is_upright = np.abs(run) < _NEAR
        share = np.clip((columns[at] - x[crossed]) / np.where(is_upright, 1.0, run), 0.0, 1.0)
        rise = (next_y - y)[crossed]
        for part in (np.where(is_upright, 0.0, share), np.where(is_upright, 1.0, share)):
            np.minimum.at(least, at, y[crossed] + part * rise)
            np.maximum.at(most, at, y[crossed] + part * rise)
    return least, most
