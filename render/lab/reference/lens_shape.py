"""Lens surfaces as functions: sphere, asphere and height map alike are the zero of ``F(x, y, z) = z − S(x, y)``.

A ray finds it by Newton's method within a bracket that is sure to hold the root, bisected wherever a step would leave it. No
closed form for conics is used. Places are relative to the surface's vertex, in millimetres, z along the axis toward the film.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.lens import Surface

_SLACK_MM = 1e-6  # by which the slab that brackets a surface is wider than the surface
_RIM_SLACK = 1 + 1e-9  # a ray that grazes the rim passes
_CONVERGED_MM = 1e-13
_MAX_EXTENT_MM = 1e4
_STEEPEST = 10.0  # dz/dr at which an asphere without a clear diameter ends
_MAX_STEPS = 120
_MARCH_STEPS = 32
_MARGIN = 1.25  # share of the clear diameter to which a surface goes on where rims do not block


@dataclass(frozen=True, eq=False)
class SurfaceShape:
    """One surface as the function ``z = S(x, y)``, its vertex in the origin. Beyond its extent it goes on flat.

    Attributes:
        surface: the surface.
        extent_mm: distance from the axis to which it is followed: to its rim where rays are clipped, else a little farther.
        rim_mm: distance from the axis where it ends: its clear semi-diameter, or if that is unknown, where its formula ends.
        map: heights that are added, or None.
        lowest_mm: bound on S from below.
        highest_mm: bound on S from above.
        steepest: bound on its slope.
    """

    surface: Surface
    extent_mm: float
    rim_mm: float
    map: _HeightMap | None
    lowest_mm: float
    highest_mm: float
    steepest: float

    @classmethod
    def of(cls, surface: Surface, heights: DoubleArray | None, *, clip: bool) -> SurfaceShape:
        end = min(_formula_end_mm(surface), _MAX_EXTENT_MM)
        rim = min(end, surface.semi_diameter_mm or np.inf)
        end = rim if clip else min(end, rim * _MARGIN)
        added = None if heights is None else _HeightMap(np.asarray(heights, np.float64), surface.semi_diameter_mm)
        low, high, steepest = _bounds(surface, end, added)
        return cls(surface, end, rim, added, low, high, steepest)

    def at(self, x: DoubleArray, y: DoubleArray) -> tuple[DoubleArray, DoubleArray, DoubleArray]:
        """S, ∂S/∂x and ∂S/∂y."""
        r2 = x * x + y * y
        end = self.extent_mm**2
        sag, by_r2 = _sag(self.surface, np.minimum(r2, end))
        by_r2 = np.where(r2 <= end, by_r2, 0.0)
        if self.map is None:
            return sag, 2 * x * by_r2, 2 * y * by_r2
        added, map_x, map_y = self.map.at(x, y)
        return sag + added, 2 * x * by_r2 + map_x, 2 * y * by_r2 + map_y

    def normals(self, points: DoubleArray) -> DoubleArray:
        """``(3, n)`` unit normals toward the film."""
        _, gx, gy = self.at(points[0], points[1])
        length = np.sqrt(1 + gx * gx + gy * gy)
        return np.stack([-gx / length, -gy / length, 1 / length])

    def outside(self, points: DoubleArray) -> NDArray[np.bool_]:
        """``(n,)`` whether points of the surface lie beyond its rim."""
        return np.asarray(points[0] ** 2 + points[1] ** 2 > (self.rim_mm * _RIM_SLACK) ** 2)

    def meet(self, origins: DoubleArray, directions: DoubleArray) -> DoubleArray:
        """Points ``(3, n)`` where rays first meet the surface within its slab.

        F is of one sign where the ray enters the slab and of the other where it leaves it, so that there is a root.

        Args:
            origins: ``(3, n)``.
            directions: ``(3, n)`` unit vectors; those of NaN stay so.
        """
        origins = origins - origins[2] / directions[2] * directions
        low, high = (self.lowest_mm - _SLACK_MM) / directions[2], (self.highest_mm + _SLACK_MM) / directions[2]
        before, behind = np.minimum(low, high), np.maximum(low, high)
        across = np.sqrt(directions[0] ** 2 + directions[1] ** 2)
        many = np.flatnonzero(self.steepest * across >= np.abs(directions[2]))  # they could meet it more than once
        if len(many):
            before[many], behind[many] = self._first_change(
                origins[:, many], directions[:, many], before[many], behind[many]
            )
        return origins + self._root(origins, directions, before, behind) * directions

    def _first_change(
        self, origins: DoubleArray, directions: DoubleArray, before: DoubleArray, behind: DoubleArray
    ) -> tuple[DoubleArray, DoubleArray]:
        """The first of many small steps in which F changes its sign."""
        step = (behind - before) / _MARCH_STEPS
        start, end, found = before.copy(), behind.copy(), np.zeros(len(before), bool)
        for i in range(1, _MARCH_STEPS):
            at = before + i * step
            x, y, z = origins + at * directions
            passed = ~found & (np.sign(directions[2]) * (z - self.at(x, y)[0]) >= 0)
            end[passed], found = at[passed], found | passed
            start = np.where(found, start, at)
        return start, end

    def _root(
        self, origins: DoubleArray, directions: DoubleArray, before: DoubleArray, behind: DoubleArray
    ) -> DoubleArray:
        """Distance at which F is 0, within the bracket: Newton's method, and bisection where it leads out or dawdles."""
        forward = directions[2] > 0
        distance = np.clip(0.0, before, behind)
        for step in range(_MAX_STEPS):
            x, y, z = origins + distance * directions
            sag, gx, gy = self.at(x, y)
            miss = z - sag
            if not ((np.abs(miss) > _CONVERGED_MM) & (behind - before > _CONVERGED_MM)).any():
                break
            short = (miss < 0) == forward
            before, behind = np.where(short, distance, before), np.where(short, behind, distance)
            slope = directions[2] - gx * directions[0] - gy * directions[1]
            newton = distance - miss / np.where(slope == 0, np.inf, slope)
            stays = (newton >= before) & (newton <= behind) & (step % 8 != 7)
            distance = np.where(stays, newton, 0.5 * (before + behind))
        return np.asarray(distance)


@dataclass(frozen=True, eq=False)
class _HeightMap:
    """Heights over the square of half side ``half_mm`` around the axis; beyond it, those of its border."""

    heights: DoubleArray
    half_mm: float

    def at(self, x: DoubleArray, y: DoubleArray) -> tuple[DoubleArray, DoubleArray, DoubleArray]:
        """Height at places in mm, and its slopes: central differences, bilinear between texels."""
        padded = np.pad(self.heights, 1, mode="edge")
        texel_y, texel_x = (2 * self.half_mm / side for side in self.heights.shape)
        by_x = (padded[1:-1, 2:] - padded[1:-1, :-2]) / (2 * texel_x)
        by_y = (padded[:-2, 1:-1] - padded[2:, 1:-1]) / (2 * texel_y)
        height, slope_x, slope_y = (self._bilinear(image, x, y) for image in (self.heights, by_x, by_y))
        return height, slope_x, slope_y

    def _bilinear(self, image: DoubleArray, x: DoubleArray, y: DoubleArray) -> DoubleArray:
        rows, columns = image.shape
        column = np.clip((1 + x / self.half_mm) / 2 * columns - 0.5, 0, columns - 1)
        row = np.clip((1 - y / self.half_mm) / 2 * rows - 0.5, 0, rows - 1)
        i, j = row.astype(np.int64), column.astype(np.int64)
        below, right = np.minimum(i + 1, rows - 1), np.minimum(j + 1, columns - 1)
        upper = image[i, j] + (column - j) * (image[i, right] - image[i, j])
        lower = image[below, j] + (column - j) * (image[below, right] - image[below, j])
        return np.asarray(upper + (row - i) * (lower - upper))


def _sag(surface: Surface, r2: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """The sag of `render.model.lens` at squares of the distance from the axis, and its derivative by that square."""
    sag, by_r2 = np.zeros_like(r2), np.zeros_like(r2)
    if surface.radius_mm:
        c = 1 / surface.radius_mm
        root = np.sqrt(1 - (1 + surface.conic) * c * c * r2)
        sag, by_r2 = c * r2 / (1 + root), c / (2 * root)
    for power, coefficient in enumerate(surface.aspheric, start=2):
        sag = sag + coefficient * r2**power
        by_r2 = by_r2 + power * coefficient * r2 ** (power - 1)
    for power, coefficient in enumerate(surface.odd, start=1):
        sag = sag + coefficient * r2 ** (power + 0.5)
        by_r2 = by_r2 + (power + 0.5) * coefficient * r2 ** (power - 0.5)
    return sag, by_r2


def _formula_end_mm(surface: Surface) -> float:
    """Distance from the axis where a surface's conic turns back; of an asphere, where it grows too steep to be meant."""
    bend = (1 + surface.conic) / surface.radius_mm**2 if surface.radius_mm else 0.0
    end = (1 - 1e-9) / np.sqrt(bend) if bend > 0 else np.inf
    if not surface.is_aspheric:
        return float(end)
    r = np.geomspace(1e-3, min(end, _MAX_EXTENT_MM), 1025)
    steep = np.abs(2 * r * _sag(surface, r * r)[1]) > _STEEPEST
    return float(r[steep.argmax()] if steep.any() else end)


def _bounds(surface: Surface, end_mm: float, added: _HeightMap | None) -> tuple[float, float, float]:
    """Lowest and highest value and steepest slope of a surface out to a distance from the axis."""
    if not surface.radius_mm and not surface.is_aspheric and added is None:
        return 0.0, 0.0, 0.0
    r = np.linspace(0, end_mm, 1025)
    sag, by_r2 = _sag(surface, r * r)
    slope = np.abs(2 * r * by_r2)
    slack = (
        float(slope.max()) * end_mm / 2048 if surface.is_aspheric else 0.0
    )  # a conic is lowest and highest at its ends
    low, high, steepest = float(sag.min()) - slack, float(sag.max()) + slack, float(slope.max())
    if added is not None:
        low, high = low + float(added.heights.min()), high + float(added.heights.max())
        rise = max(float(np.abs(np.diff(added.heights, axis=axis)).max(initial=0.0)) for axis in (0, 1))
        steepest += 1.5 * rise * max(added.heights.shape) / (2 * added.half_mm)
    return low, high, steepest
