"""Spot of a point out of focus: the image of the iris, distorted by the lens's errors on the axis, in target pixels.

Kyaw (2013, section 7.3) draws the image of the iris over each circle of confusion and modulates it with the point spread of
spherical aberration. Here both are one: rays through the iris, as densely as it lets light through, land where the lens sends
them. A point at inverse depth w lands, through the point X of the pupil, off by

    c·X/R − f·δ(X)        c = f·R·(w_f − w) the signed circle of confusion, δ the lens's error of slope

so that a rim that is bright behind the focus is soft before it, and the iris stands upside down there.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from render.model.arrays import DoubleArray, FloatArray, IntArray
from render.model.lens import IrisShape
from render.optics.iris import fill_iris
from render.postblur.scatter_axis import AxisSpot

SQUARE_SIDES = (1, 2, 4, 8)
"""Sides of the squares of like pixels that are drawn as one splat."""
STEPS = 2
"""Tables per pixel of the circle of confusion; light between two is interpolated."""
_RAYS = 1 << 16
_LEAST_RAYS = 2048
_RAYS_PER_PIXEL = 24.0
_LEAST_ERROR_PX = 0.25
"""Error below which all errors are ignored: points in focus stay sharp."""
_TURNS = 0.7548776662466927, 0.5698402909980532  # R2 sequence (Roberts 2018): every prefix is evenly distributed


@dataclass(frozen=True, eq=False)
class Spot:
    """Rays of a point on the axis; x right, y down.

    Attributes:
        pupil: ``(n, 2)`` points where they pass the pupil, relative to its radius.
        error_px: ``(n, 2)`` points where they land in focus, in pixels; zeros for a lens without errors.
    """

    pupil: DoubleArray
    error_px: DoubleArray

    @property
    def has_errors(self) -> bool:
        """Whether a point in focus is spread."""
        return bool(self.error_px.any())

    @cached_property
    def error_reach_px(self) -> float:
        """Greatest distance, in pixels, at which light lands from the centre in focus."""
        return float(np.hypot(*self.error_px.T).max())

    @cached_property
    def moments(self) -> tuple[float, float, float]:
        """Moments ``(p, q, r)``: the spot of a circle of confusion c has the spread of an even disc of radius ``√(p·c²
        + q·c + r)``.
        """
        own, both, error = (
            2 * float((a * b).sum(axis=1).mean())
            for a, b in ((self.pupil, self.pupil), (self.pupil, self.error_px), (self.error_px, self.error_px))
        )
        return own, 2 * both, error

    def radius(self, c_px: DoubleArray) -> DoubleArray:
        """Radius of the even disc with the same spread."""
        p, q, r = self.moments
        return np.asarray(np.sqrt(np.maximum(p * c_px**2 + q * c_px + r, 0.0)))

    def reduce(self, shrink: int) -> Spot:
        """Spot in pixels that are ``shrink`` times larger."""
        return Spot(self.pupil, self.error_px / shrink)

    def ray_positions(self, c_px: float) -> DoubleArray:
        """Landing points ``(m, 2)`` in pixels for a signed circle of confusion; the number of rays grows with its area."""
        area = np.pi * float(self.radius(np.array(c_px))) ** 2
        count = int(np.clip(_RAYS_PER_PIXEL * area, _LEAST_RAYS, len(self.pupil)))
        return np.asarray(c_px * self.pupil[:count] + self.error_px[:count])


def make_camera_spot(iris: IrisShape, squeeze: float, lens: AxisSpot | None = None) -> Spot:
    """Spot of a camera's lens.

    Args:
        iris: iris with its blades, mask and weights.
        squeeze: anamorphic squeeze, by which spots are narrower.
        lens: spot of the lens on its axis; None for a lens without errors.
    """
    index = np.arange(_RAYS)[:, None]
    stops = fill_iris(np.mod(0.5 + index * _TURNS, 1.0), iris) * [1.0, -1.0]
    narrowed = np.array([1 / squeeze, 1.0])
    ideal = Spot(stops * narrowed, np.zeros_like(stops))
    if lens is None:
        return ideal
    pupil, error_px = lens.rays(stops)
    if len(pupil) == 0:
        return ideal  # a lens that passes no light has nothing to blur
    real = Spot(pupil * narrowed, error_px * narrowed)
    return real if np.abs(real.error_px).max() > _LEAST_ERROR_PX else Spot(real.pupil, np.zeros_like(real.pupil))


@dataclass(frozen=True, eq=False)
class SpotTables:
    """Spots in pixels, by the size of the circle of confusion in steps of 1 / `STEPS` pixels.

    Attributes:
        weights: ``(len(SQUARE_SIDES)·steps, side, side)`` float32: share of a pixel's light on
            each pixel; then that of squares of 2, 4 and 8 pixels, centred on the middle pixel's upper left corner. Sums are 1.
        reach: ``(len(SQUARE_SIDES)·steps,)`` greatest number of pixels to the left and above that get light.
    """

    weights: FloatArray
    reach: IntArray

    @property
    def steps(self) -> int:
        """Number of sizes."""
        return len(self.weights) // len(SQUARE_SIDES)

    @property
    def middle(self) -> int:
        """Row and column of the middle pixel."""
        return int(self.weights.shape[1]) // 2


def make_spot_tables(spot: Spot, most_px: float, *, behind: bool) -> SpotTables:
    """Tables for circles of confusion up to a radius.

    Args:
        spot: spot of the camera, in pixels of the target.
        most_px: largest circle of confusion.
        behind: whether the tables are for the far field.
    """
    steps = int(np.ceil(most_px * STEPS)) + 2
    sign = 1.0 if behind else -1.0
    positions = [spot.ray_positions(sign * step / STEPS) for step in range(steps)]
    middle = int(np.ceil(max(np.abs(places).max() for places in positions))) + 1 + SQUARE_SIDES[-1] // 2
    tables = [np.stack([_in_pixels(places, middle) for places in positions])]
    for side in SQUARE_SIDES[1:]:
        # a square is four squares of half its side
        tables.append(_double(tables[-1], (-1, 0) if side == 2 else (-side // 4, side // 4)))
    weights = np.concatenate(tables)
    weights /= weights.sum(axis=(1, 2), keepdims=True)
    lit = np.asarray(weights.max(axis=1) + weights.max(axis=2) > 0)
    index = np.arange(2 * middle + 1) - middle
    is_square = np.arange(len(weights)) >= steps
    off = np.where(is_square[:, None], np.where(index < 0, -index, index + 1), np.abs(index))
    reach = np.where(lit, off, 0).max(axis=1)
    return SpotTables(weights.astype(np.float32), reach.astype(np.int32))


def _in_pixels(places: DoubleArray, middle: int) -> DoubleArray:
    """Shares ``(n, n)`` of the points in pixels around the middle one's centre; each point is a square of half a pixel."""
    side = 4 * middle + 4
    at = 2 * places + (2 * middle + 1.5)  # in half pixels
    low = np.floor(at).astype(np.int64)
    part = at - low
    total = np.zeros(side * side)
    for right in (0, 1):
        for down in (0, 1):
            share = np.abs(1 - right - part[:, 0]) * np.abs(1 - down - part[:, 1])
            total += np.bincount((low[:, 1] + down) * side + low[:, 0] + right, share, side * side)
    halves = total.reshape(side, side)[1:-1, 1:-1]
    return np.asarray(halves.reshape(side // 2 - 1, 2, side // 2 - 1, 2).sum(axis=(1, 3)))


def _double(tables: DoubleArray, shifts: tuple[int, int]) -> DoubleArray:
    across = sum(np.roll(tables, shift, axis=2) for shift in shifts)
    return np.asarray(sum(np.roll(across, shift, axis=1) for shift in shifts))
