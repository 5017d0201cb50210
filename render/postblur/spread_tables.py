"""Tables of weights for spreading the light of a point out of focus, one per step of the radius (Fearing 1995, section 4.2).

A circle of confusion is spread by the table of the nearest radius, so that a change below a step does not count. The step is
half a pixel up to a radius of 32, and a 64th of the radius beyond. Weights are multiples of 2 to the power of -20, and those of a
table add up to 1: no light is lost, and sums of them are exact (`render.postblur.linear`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Protocol

import moderngl
import numpy as np

from render.gl.limits import check_texture_array
from render.model.arrays import DoubleArray
from render.model.lens import IrisShape
from render.optics.iris import transmission
from render.postblur.blur_shape import iris_key

STEP_PX = 0.5
EVEN_STEPS = 64
"""Number of equal steps; later steps grow with the radius."""
MAX_RADIUS_PX = 96.0
"""Greatest distance to which light is spread, and larger circles are clamped: time grows with their area, and the tables' memory
even faster.
"""
WEIGHT_BITS = 20
EVEN_MOST_WEIGHT, MOST_WEIGHT = 16, 256
"""Powers of 2 above the sum of the weights of all pixels on one: of an even disc or a Gaussian, where it is at most 9, and of any
spread, where it is less than the number of tables.
"""
_ROWS = 4  # rows of a table in one texel


class Spread(Protocol):
    """Distribution of light over a circle of confusion. Equal spreads have equal tables."""

    @property
    def wide(self) -> float:
        """Greatest distance of any light from the middle, relative to the radius; 1 or more."""
        ...

    @property
    def most_weight(self) -> int:
        """Power of 2 above the sum of the weights of all pixels on one, whatever the radius of each."""
        ...

    def weights(self, radius_px: float, half: int) -> DoubleArray:
        """Weights ``(2·half + 1, 2·half + 1)`` of the pixels around the circle's middle, 0 or more; y down."""
        ...


@dataclass(frozen=True)
class Gaussian:
    """Gaussian within the circle, with half its radius as standard deviation, as in Fearing's tables (1995, section 6)."""

    wide: ClassVar[float] = 1.0
    most_weight: ClassVar[int] = EVEN_MOST_WEIGHT

    def weights(self, radius_px: float, half: int) -> DoubleArray:
        """See `Spread`."""
        squares = np.arange(-half, half + 1.0) ** 2
        distances = squares[:, None] + squares
        return np.where(distances <= (radius_px + 0.5) ** 2, np.exp(-2 * distances / radius_px**2), 0.0)


class IrisImage:
    """Image of the iris: its blades, mask and radial weights, integrated over each pixel.

    Args:
        iris: iris of the lens.
        is_behind: whether the point is behind the focus; its image is upside down to that of a point in front of it.
        squeeze: anamorphic squeeze, by which circles are narrower; below 1 they are wider.
    """

    def __init__(self, iris: IrisShape, *, is_behind: bool = True, squeeze: float = 1.0) -> None:
        self._iris, self._is_behind, self._squeeze = iris, is_behind, squeeze

    @cached_property
    def _summed(self) -> DoubleArray:
        """Sums of the image above and to the left; made when the first table is."""
        image = transmission(self._iris) if self._is_behind else transmission(self._iris)[::-1, ::-1]
        return np.asarray(np.pad(image, ((1, 0), (1, 0))).cumsum(axis=0).cumsum(axis=1))

    @property
    def wide(self) -> float:
        """See `Spread`."""
        return max(1.0, 1.0 / self._squeeze)

    @property
    def most_weight(self) -> int:
        """See `Spread`."""
        is_even = self._iris.mask is None and not self._iris.radial_weights
        return EVEN_MOST_WEIGHT if is_even else MOST_WEIGHT

    def weights(self, radius_px: float, half: int) -> DoubleArray:
        """See `Spread`."""
        edges = np.arange(-half - 0.5, half + 1.0) / radius_px
        last = len(self._summed) - 1
        rows, columns = (np.interp(edges * narrower, [-1.0, 1.0], [0.0, last]) for narrower in (1.0, self._squeeze))
        at = _interpolate_rows(_interpolate_rows(self._summed, rows).T, columns).T
        return np.maximum(np.diff(np.diff(at, axis=0), axis=1), 0.0)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, IrisImage) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    @property
    def _key(self) -> tuple[object, ...]:
        return (*iris_key(self._iris), self._is_behind, self._squeeze)


def _interpolate_rows(values: DoubleArray, rows: DoubleArray) -> DoubleArray:
    """Interpolate linearly between the rows of an array."""
    low = np.minimum(rows.astype(int), len(values) - 2)
    share = (rows - low)[:, None]
    return np.asarray((1 - share) * values[low] + share * values[low + 1])


def step_of(radius_px: float, step_px: float = STEP_PX) -> int:
    """Number of the table for a radius; 0 for a point."""
    even = int(min(radius_px, MAX_RADIUS_PX) / step_px + 0.5)
    return even if even <= EVEN_STEPS else int(EVEN_STEPS * (1 + np.log(even / EVEN_STEPS)) + 0.5)


def step_radius(step: int, step_px: float = STEP_PX) -> float:
    """Radius of a table in pixels."""
    return step_px * (step if step <= EVEN_STEPS else EVEN_STEPS * float(np.exp(step / EVEN_STEPS - 1)))


def make_table(spread: Spread, radius_px: float, half: int) -> DoubleArray:
    """Weights ``(2·half + 1, 2·half + 1)`` that add up to 1, in whole steps of 2 to the power of -`WEIGHT_BITS`."""
    weights = np.zeros((2 * half + 1, 2 * half + 1))
    if radius_px > 0:
        weights = spread.weights(radius_px, half)
    total = weights.sum()
    if total <= 0:
        weights[half, half] = total = 1.0
    exact = weights / total * 2.0**WEIGHT_BITS
    whole = np.floor(exact)
    # the largest remainders are rounded up; equal ones in random order, so that no side of an even disc is brighter
    among_equals = np.random.default_rng(0).permutation(whole.size)
    most = np.lexsort((among_equals, -np.round((exact - whole).ravel(), 6)))
    whole.flat[most[: int(2.0**WEIGHT_BITS - whole.sum())]] += 1
    return np.asarray(whole / 2.0**WEIGHT_BITS)


class SpreadTables:
    """Tables of a spread on the device, up to the needed radius.

    Args:
        ctx: the context.
        spread: spread to tabulate.
        most_px: largest radius needed.
        step_px: first step of the radius.
        with_differences: whether to add the differences between successive tables.

    Attributes:
        half: pixels from the middle of a table to its edge, where the weight is 0.
        count: number of tables.
        weights: RGBA32F array, a slice for each step, and after them one for each difference. Each texel holds the weights of
            four rows, from its own on; above a table are three rows more.
        wide: that of the spread.
        beyond_px: greatest distance beyond ``wide`` times its radius at which a table has weight.
        steps: RG32F, one texel for each multiple of the first step: the table's number and its radius.
    """

    def __init__(
        self,
        ctx: moderngl.Context,
        spread: Spread,
        most_px: float,
        step_px: float = STEP_PX,
        *,
        with_differences: bool = False,
    ) -> None:
        self.spread, self.step_px, self.wide = spread, step_px, spread.wide
        self.count = self._last_step(spread, most_px) + 1
        radii = [step_radius(step, step_px) for step in range(self.count)]
        self.half = int(np.ceil(radii[-1] * self.wide + 0.5)) + 1  # a rim of weight 0, for clamped look-ups
        side = 2 * self.half + 1
        slices = 2 * self.count - 1 if with_differences else self.count
        check_texture_array(ctx, (side, side + _ROWS - 1, slices), "the tables of blurs of this radius")
        packed = np.empty((slices, side + _ROWS - 1, side, _ROWS), np.float32)
        self.beyond_px = 0.0
        offsets = np.arange(-self.half, self.half + 1.0)
        distances = np.hypot(offsets[:, None], offsets)
        for step, radius in enumerate(radii):
            reach = radius * self.wide
            table = self._pad(make_table(spread, radius, min(int(np.ceil(reach + 0.5)), self.half)))
            self.beyond_px = max(self.beyond_px, float(distances[table > 0].max() - reach))
            rows = np.pad(table, ((_ROWS - 1, _ROWS - 1), (0, 0)))
            packed[step] = np.stack([rows[i : i + side + _ROWS - 1] for i in range(_ROWS)], axis=-1)
        if with_differences:
            np.subtract(packed[1 : self.count], packed[: self.count - 1], out=packed[self.count :])
        self.weights = ctx.texture_array((side, side + _ROWS - 1, slices), 4, packed.tobytes(), dtype="f4")
        even = [
            min(step_of(number * step_px, step_px), self.count - 1) for number in range(int(radii[-1] / step_px) + 2)
        ]
        steps = np.array([(step, radii[step]) for step in even], np.float32)
        self.steps = ctx.texture((len(steps), 1), 2, steps.tobytes(), dtype="f4")

    def _pad(self, table: DoubleArray) -> DoubleArray:
        return np.pad(table, self.half - len(table) // 2)

    def _last_step(self, spread: Spread, most_px: float) -> int:
        return step_of(min(most_px, MAX_RADIUS_PX / spread.wide), self.step_px)

    def cover(self, spread: Spread, most_px: float) -> bool:
        """True where these are the tables of a spread, up to a radius."""
        return self.spread == spread and self._last_step(spread, most_px) < self.count

    def release(self) -> None:
        """Release the memory."""
        for texture in (self.weights, self.steps):
            texture.release()
