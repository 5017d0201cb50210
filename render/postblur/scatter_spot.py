"""The picture of one point out of focus: the iris, as the lens's errors on the axis distort it, in the pixels of a target.

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

SIDES = (1, 2, 4, 8)
"""Sides of the squares of like pixels that are drawn as one splat."""
STEPS = 2
"""Tables to a pixel of the circle of confusion; between two their light is mixed."""
_RAYS = 1 << 16
_LEAST_RAYS = 2048
_RAYS_PER_PIXEL = 24.0
_LEAST_ERROR_PX = 0.25
"""Errors that send no ray farther than this off are left out: what is in focus stays sharp."""
_TURNS = 0.7548776662466927, 0.5698402909980532  # R2 sequence (Roberts 2018): each beginning of it is even


@dataclass(frozen=True, eq=False)
class Spot:
    """Rays of a point on the axis; x right, y down.

    Attributes:
        pupil: ``(n, 2)`` where they pass the pupil, over its radius.
        error_px: ``(n, 2)`` where they land in focus, in pixels; zeros for a lens without errors.
    """

    pupil: DoubleArray
    error_px: DoubleArray

    @property
    def has_errors(self) -> bool:
        """Whether a point in focus is no point."""
        return bool(self.error_px.any())

    @cached_property
    def error_reach_px(self) -> float:
        """Greatest distance, in pixels, at which light lands from the centre in focus."""
        return float(np.hypot(*self.error_px.T).max())

    @cached_property
    def moments(self) -> tuple[float, float, float]:
        """``(p, q, r)``: the spot of a circle of confusion c spreads light as an even disc of radius ``√(p·c² + q·c + r)``."""
        own, both, error = (
            2 * float((a * b).sum(axis=1).mean())
            for a, b in ((self.pupil, self.pupil), (self.pupil, self.error_px), (self.error_px, self.error_px))
        )
        return own, 2 * both, error

    def radius(self, c_px: DoubleArray) -> DoubleArray:
        """Radii of even discs that spread light as far."""
        p, q, r = self.moments
        return np.asarray(np.sqrt(np.maximum(p * c_px**2 + q * c_px + r, 0.0)))

    def reduced(self, shrink: int) -> Spot:
        """In pixels that are as many times larger."""
        return Spot(self.pupil, self.error_px / shrink)

    def lands(self, c_px: float) -> DoubleArray:
        """``(m, 2)`` pixels, for a signed circle of confusion: as many of the rays as its size asks for."""
        area = np.pi * float(self.radius(np.array(c_px))) ** 2
        count = int(np.clip(_RAYS_PER_PIXEL * area, _LEAST_RAYS, len(self.pupil)))
        return np.asarray(c_px * self.pupil[:count] + self.error_px[:count])


def spot_of(iris: IrisShape, squeeze: float, lens: AxisSpot | None = None) -> Spot:
    """The spot of a camera.

    Args:
        iris: with its blades, mask and weights.
        squeeze: of an anamorphic lens, whose spots are narrower by it.
        lens: where its rays land, None for one without errors.
    """
    index = np.arange(_RAYS)[:, None]
    stops = fill_iris(np.mod(0.5 + index * _TURNS, 1.0), iris) * [1.0, -1.0]
    narrowed = np.array([1 / squeeze, 1.0])
    ideal = Spot(stops * narrowed, np.zeros_like(stops))
    if lens is None:
        return ideal
    pupil, error_px = lens.rays(stops)
    if len(pupil) == 0:
        return ideal  # a lens that lets nothing through shows nothing to be blurred
    real = Spot(pupil * narrowed, error_px * narrowed)
    return real if np.abs(real.error_px).max() > _LEAST_ERROR_PX else Spot(real.pupil, np.zeros_like(real.pupil))


@dataclass(frozen=True, eq=False)
class SpotTables:
    """Spots in pixels, by the size of the circle of confusion in steps of 1 / `STEPS` pixels.

    Attributes:
        weights: ``(len(SIDES)·steps, side, side)`` float32: share of its light that a pixel sheds on each; then what squares of
            2, 4 and 8 pixels shed together, whose middle is the middle pixel's upper left corner. Each adds up to 1.
        reach: ``(len(SIDES)·steps,)`` how many pixels to the left of it and above hold light, at most.
    """

    weights: FloatArray
    reach: IntArray

    @property
    def steps(self) -> int:
        """Number of sizes."""
        return len(self.weights) // len(SIDES)

    @property
    def middle(self) -> int:
        """Row and column of the middle pixel."""
        return int(self.weights.shape[1]) // 2


def spot_tables(spot: Spot, most_px: float, *, behind: bool) -> SpotTables:
    """Tables up to a radius.

    Args:
        spot: of the camera, in pixels of the target.
        most_px: largest circle of confusion.
        behind: for what is behind the focus.
    """
    steps = int(np.ceil(most_px * STEPS)) + 2
    sign = 1.0 if behind else -1.0
    landed = [spot.lands(sign * step / STEPS) for step in range(steps)]
    middle = int(np.ceil(max(np.abs(places).max() for places in landed))) + 1 + SIDES[-1] // 2
    tables = [np.stack([_in_pixels(places, middle) for places in landed])]
    for side in SIDES[1:]:
        # squares of squares half as large: of pixels, those up and left of a corner and those that begin there
        tables.append(_doubled(tables[-1], (-1, 0) if side == 2 else (-side // 4, side // 4)))
    weights = np.concatenate(tables)
    weights /= weights.sum(axis=(1, 2), keepdims=True)
    lit = np.asarray(weights.max(axis=1) + weights.max(axis=2) > 0)
    index = np.arange(2 * middle + 1) - middle
    is_square = np.arange(len(weights)) >= steps
    off = np.where(is_square[:, None], np.where(index < 0, -index, index + 1), np.abs(index))
    reach = np.where(lit, off, 0).max(axis=1)
    return SpotTables(weights.astype(np.float32), reach.astype(np.int32))


def _in_pixels(places: DoubleArray, middle: int) -> DoubleArray:
    """``(n, n)`` share of places in pixels around the middle one's centre, each place a square of half a pixel."""
    side = 4 * middle + 4
    at = 2 * places + (2 * middle + 1.5)  # in half pixels, of which the middle pixel has two
    low = np.floor(at).astype(np.int64)
    part = at - low
    total = np.zeros(side * side)
    for right in (0, 1):
        for down in (0, 1):
            share = np.abs(1 - right - part[:, 0]) * np.abs(1 - down - part[:, 1])
            total += np.bincount((low[:, 1] + down) * side + low[:, 0] + right, share, side * side)
    halves = total.reshape(side, side)[1:-1, 1:-1]
    return np.asarray(halves.reshape(side // 2 - 1, 2, side // 2 - 1, 2).sum(axis=(1, 3)))


def _doubled(tables: DoubleArray, shifts: tuple[int, int]) -> DoubleArray:
    across = sum(np.roll(tables, shift, axis=2) for shift in shifts)
    return np.asarray(sum(np.roll(across, shift, axis=1) for shift in shifts))
