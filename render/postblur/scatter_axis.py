"""On-axis spot of a lens, from a few rounded numbers, so that a focus pull keeps the same spot tables.

A symmetric lens has a profile there: over the radius of the pupil, how far from the centre light lands, and where it
passes the pupil. Both are odd polynomials, given by their values at a few radii. These values are rounded and the spot
is computed from them alone, so that a picture does not depend on what was drawn before it.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from render.model.arrays import DoubleArray
from render.trace.axis_rays import LensErrors, axis_key, open_axes, trace_axis_rays
from render.trace.lens_table import GridTable

LANDING_PX, PUPIL = 1 / 8, 1 / 256
"""Rounding steps of the landing point, in pixels, and of the pupil point, relative to the pupil's radius."""
ROUNDED_PX, ROUNDED_PUPIL = 0.15, 0.005
"""Greatest errors by rounding: of the landing point in focus, in pixels; of the pupil point, relative to its radius."""


class AxisSpot(Protocol):
    """Rays of a point on the axis."""

    @property
    def cache_key(self) -> Hashable:
        """Cache key: equal keys give equal spots."""
        ...

    def rays(self, stops: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
        """Pupil points ``(n, 2)``, relative to the pupil's radius, and landing points ``(n, 2)`` in pixels. Blocked
        rays are left out.

        Args:
            stops: ``(m, 2)`` points of the iris, of unit radius, x right and y down.
        """
        ...


def _odd_nodes(count: int) -> DoubleArray:
    """Chebyshev radii, from the edge inward: errors of the values there grow at most by a factor of 1.9 in between."""
    nodes = np.cos((2 * np.arange(count) + 1) * np.pi / (4 * count))
    return np.asarray(nodes / nodes[0])


def _odd_powers(radii: DoubleArray, count: int) -> DoubleArray:
    return np.asarray(radii[:, None] ** (2 * np.arange(count) + 1))


_LANDING_NODES, _PUPIL_NODES = _odd_nodes(4), _odd_nodes(3)  # as many as tables of polynomials have odd powers
_AROUND = np.linspace(0.0, 2 * np.pi, 12, endpoint=False) + 0.1
_SAMPLE = np.concatenate([r * np.stack([np.cos(_AROUND), np.sin(_AROUND)], axis=1) for r in (0.25, 0.5, 0.75, 0.95)])


@dataclass(frozen=True)
class SymmetricSpot:
    """Spot of a rotationally symmetric profile.

    Attributes:
        landing: distance from the centre at which light lands in focus, at the landing nodes, in steps of `LANDING_PX`.
        pupil: radius at which light passes the pupil, at the pupil nodes, in steps of `PUPIL`.
        opened: half axes of the open part of the iris, in steps of `PUPIL`.
    """

    landing: tuple[int, ...]
    pupil: tuple[int, ...]
    opened: tuple[int, int]

    @classmethod
    def from_errors(cls, errors: LensErrors, axes: DoubleArray) -> SymmetricSpot:
        """Profile of a polynomial table, with the half axes of its open part."""
        across, down = (int(value) for value in np.maximum(np.round(axes / PUPIL), 1))

        def profile(nodes: DoubleArray, which: int, step: float) -> tuple[int, ...]:
            along = np.stack([nodes, 0 * nodes], axis=1) * axes
            return tuple(int(value) for value in np.round(_in_pixels(errors, along)[which][:, 0] / step))

        landing, pupil = profile(_LANDING_NODES, 1, LANDING_PX), profile(_PUPIL_NODES, 0, PUPIL)
        return cls(landing, pupil, (across, down))

    @property
    def cache_key(self) -> Hashable:
        """See `AxisSpot`."""
        return self

    def rays(self, stops: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
        """See `AxisSpot`."""
        inner = stops / (np.array(self.opened) * PUPIL)
        radii = np.hypot(*inner.T)
        inner, radii = inner[radii <= 1 + 1e-6], radii[radii <= 1 + 1e-6]
        outward = inner / np.maximum(radii, 1e-12)[:, None]

        def on(nodes: DoubleArray, steps: tuple[int, ...], step: float) -> DoubleArray:
            powers = np.linalg.solve(_odd_powers(nodes, len(nodes)), np.array(steps, np.float64) * step)
            return np.asarray(outward * (_odd_powers(radii, len(nodes)) @ powers)[:, None])

        return on(_PUPIL_NODES, self.pupil, PUPIL), on(_LANDING_NODES, self.landing, LANDING_PX)


@dataclass(frozen=True, eq=False)
class ExactSpot:
    """Spot of any lens, straight from its table."""

    errors: LensErrors

    @property
    def cache_key(self) -> Hashable:
        """See `AxisSpot`: the part of the table that the axis depends on."""
        errors = self.errors
        return axis_key(errors.table), errors.pupil_m, errors.focal_px, errors.own_squeeze

    def rays(self, stops: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
        """See `AxisSpot`."""
        return _in_pixels(self.errors, stops)


def make_axis_spot(errors: LensErrors) -> AxisSpot:
    """Axis spot of a lens, rounded where that moves no ray by more than `ROUNDED_PX` and `ROUNDED_PUPIL`."""
    if isinstance(errors.table, GridTable):
        return ExactSpot(errors)
    axes = np.array(open_axes(errors.table), np.float64)
    rounded = SymmetricSpot.from_errors(errors, axes)
    stops = _SAMPLE * np.minimum(axes, np.array(rounded.opened) * PUPIL)
    pairs = zip(rounded.rays(stops), _in_pixels(errors, stops), (ROUNDED_PUPIL, ROUNDED_PX), strict=True)
    is_near = all(np.hypot(*(one - other).T).max() <= most for one, other, most in pairs)
    return rounded if is_near else ExactSpot(errors)


def _in_pixels(errors: LensErrors, stops: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    rays = trace_axis_rays(errors.table, stops)
    unsqueezed = np.array([errors.own_squeeze, 1.0])
    return rays.pupil_m / errors.pupil_m * unsqueezed, -errors.focal_px * rays.slope * unsqueezed
