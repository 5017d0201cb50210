"""Rows of a `PolynomialTable`: least-squares polynomials over the pupil, and what bounds a row's rays.

A quantity that a mirror in the tangential plane leaves as it is (tangential errors, clearances, weights) is even in the sagittal
coordinate y, one that it turns around (sagittal errors) odd. Polynomials of total degree 7 in the pupil hold aberrations up to
the seventh order (Buchdahl 1954), which is enough for most lenses; fast ones with steep aspheres take up to the thirteenth.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray, IntArray
from render.trace.lens_table import (
    BOUND,
    FRONT_RIM,
    PUPIL_S,
    PUPIL_T,
    REAR_RIM,
    REGION,
    ROW_LENGTH,
    SLOPE_S,
    SLOPE_T,
    WEIGHT,
)

BOUND_MARGIN = 1.03
"""Bounds are taken over the nodes and enlarged by this, since rays pass between them."""
_RIM_DEGREE, _WEIGHT_DEGREE = 4, 2
_LIGHT_NODES = 4096


@dataclass(frozen=True)
class Degrees:
    """Total degrees of the polynomials of slope errors and pupil points."""

    slope: int
    pupil: int


FULL = Degrees(7, 5)
LOW = Degrees(5, 3)
SLOPE_DEGREES = (5, 7, 9, 11, 13)
"""Degrees of the slope errors' polynomials, cheapest first. Terms above 7 follow a row's other numbers."""


@dataclass(frozen=True)
class Region:
    """Ellipse on the stop, in units of its radius, around the open part for one field height.

    Attributes:
        centre: along the tangential axis.
        along: half axis along it.
        across: half axis across it.
        clipped: whether a rim other than the stop's blocks anything.
    """

    centre: float = 0.0
    along: float = 1.0
    across: float = 1.0
    clipped: bool = False

    def on_stop(self, disc: DoubleArray) -> DoubleArray:
        """Points ``(n, 2)`` of the stop for points of the unit disc."""
        return np.stack([self.centre + self.along * disc[:, 0], self.across * disc[:, 1]], axis=1)

    @property
    def area(self) -> float:
        """Area relative to that of the whole stop."""
        return self.along * self.across


@dataclass(frozen=True, eq=False)
class NodeRays:
    """Rays of one field height and wavelength at the nodes of its pupil, tangential coordinate first.

    Attributes:
        slope: ``(n, 2)`` slope error.
        pupil_m: ``(n, 2)``.
        front: ``(n,)`` clearance, above 0 blocked.
        rear: ``(n,)`` clearance behind the stop.
        weight: ``(n,)``.
        passed: ``(n,)`` whether the ray gets through, rims apart.
    """

    slope: DoubleArray
    pupil_m: DoubleArray
    front: DoubleArray
    rear: DoubleArray
    weight: DoubleArray
    passed: NDArray[np.bool_]


class PupilFit:
    """Fits rows to rays at fixed nodes of the unit disc."""

    def __init__(self, nodes: DoubleArray, degrees: Degrees = FULL) -> None:
        """Prepare the bases at ``nodes`` ``(n, 2)`` on the half disc y >= 0, with ``degrees`` of the polynomials."""
        self.nodes, self.degrees = nodes, degrees
        even, odd, slope, pupil = even_basis, odd_basis, degrees.slope, degrees.pupil
        along, across = _slope_places(slope)
        self._parts = {
            SLOPE_T: _Part(even(nodes, slope), along),
            SLOPE_S: _Part(odd(nodes, slope), across),
            PUPIL_T: _Part(even(nodes, pupil), PUPIL_T + _term_positions(pupil, FULL.pupil)),
            PUPIL_S: _Part(odd(nodes, pupil), PUPIL_S + _term_positions(pupil - 1, FULL.pupil - 1)),
            FRONT_RIM: _Part(even(nodes, _RIM_DEGREE), FRONT_RIM + _term_positions(_RIM_DEGREE, _RIM_DEGREE)),
            REAR_RIM: _Part(even(nodes, _RIM_DEGREE), REAR_RIM + _term_positions(_RIM_DEGREE, _RIM_DEGREE)),
            WEIGHT: _Part(even(nodes, _WEIGHT_DEGREE), WEIGHT + _term_positions(_WEIGHT_DEGREE, _WEIGHT_DEGREE)),
        }

    def row(self, rays: NodeRays, region: Region) -> DoubleArray:
        """Fit the row ``(row_length,)`` of a field height; dark where too few rays pass for a fit."""
        row = np.zeros(row_length(self.degrees.slope))
        if not self.is_lit(rays):
            return row
        values = {
            SLOPE_T: rays.slope[:, 0],
            SLOPE_S: rays.slope[:, 1],
            PUPIL_T: rays.pupil_m[:, 0],
            PUPIL_S: rays.pupil_m[:, 1],
            FRONT_RIM: rays.front,
            REAR_RIM: rays.rear,
            WEIGHT: rays.weight,
        }
        for place, value in values.items():
            part = self._parts[place]
            row[part.places] = part.solve(value, rays.passed)
        row[REGION : REGION + 4] = [region.centre, region.along, region.across, float(region.clipped)]
        row[BOUND : BOUND + 4] = self._bounds(rays, region)
        return row

    def is_lit(self, rays: NodeRays) -> bool:
        """Whether enough rays get through, rims apart, for a row."""
        return int(rays.passed.sum()) >= len(self.nodes) // 2

    def residual(self, rays: NodeRays) -> tuple[float, float]:
        """Largest error of the fitted slopes, and of the fitted pupil points in metres, of rays that no rim blocks."""
        seen = rays.passed & (rays.front <= 0) & (rays.rear <= 0)
        if not self.is_lit(rays) or not seen.any():
            return 0.0, 0.0
        errors = []
        for (tangential, sagittal), values in (((SLOPE_T, SLOPE_S), rays.slope), ((PUPIL_T, PUPIL_S), rays.pupil_m)):
            t, s = (
                self._parts[place].basis @ self._parts[place].solve(values[:, axis], rays.passed) - values[:, axis]
                for axis, place in enumerate((tangential, sagittal))
            )
            errors.append(float(np.hypot(t, s)[seen].max()))
        return errors[0], errors[1]

    def _bounds(self, rays: NodeRays, region: Region) -> list[float]:
        """Centre and radius of the slope errors, and of the pupil points, of the rays that pass."""
        on_stop = np.hypot(*region.on_stop(self.nodes).T)
        is_open = rays.passed & (rays.front <= 0) & (rays.rear <= 0) & (on_stop <= 1.0 + 1e-6)
        is_open = is_open if is_open.any() else rays.passed
        bounds = []
        for points in (rays.slope[is_open], rays.pupil_m[is_open]):
            centre = (points[:, 0].min() + points[:, 0].max()) / 2
            bounds += [centre, BOUND_MARGIN * np.hypot(points[:, 0] - centre, points[:, 1]).max()]
        return bounds


def mean_light(rows: DoubleArray) -> DoubleArray:
    """Mean weight ``(heights,)`` of each row's rays over its whole disc, blocked ones as 0."""
    nodes = pupil_nodes(_LIGHT_NODES, rim=0)
    weight = rows[:, WEIGHT : WEIGHT + 4] @ even_basis(nodes, _WEIGHT_DEGREE).T
    return np.asarray(np.where(open_rays(rows, nodes), np.maximum(weight, 0.0), 0.0).mean(axis=1))


def open_rays(rows: DoubleArray, nodes: DoubleArray) -> NDArray[np.bool_]:
    """Mask ``(heights, n)`` of rays that neither a rim nor the stop blocks, at nodes ``(n, 2)`` of their discs."""
    rims = even_basis(nodes, _RIM_DEGREE).T
    clearance = np.maximum(rows[:, FRONT_RIM:REAR_RIM] @ rims, rows[:, REAR_RIM:WEIGHT] @ rims)
    along = rows[:, REGION, None] + rows[:, REGION + 1, None] * nodes[:, 0]
    clearance = np.maximum(clearance, np.hypot(along, rows[:, REGION + 2, None] * nodes[:, 1]) - 1)
    return np.asarray((clearance <= 0) | (rows[:, REGION + 3, None] == 0))


def row_length(slope_degree: int) -> int:
    """Numbers of a row, a multiple of 4, whose slope errors have polynomials of that degree."""
    last = max(int(places.max()) for places in _slope_places(slope_degree))
    return max(ROW_LENGTH, -(-(last + 1) // 4) * 4)


def slope_errors(rows: DoubleArray, nodes: DoubleArray, slope_degree: int) -> DoubleArray:
    """Slope errors ``(heights, n, 2)`` of rows ``(heights, row_length)`` at nodes ``(n, 2)`` of their discs, tangential first."""
    along, across = _slope_places(slope_degree)
    tangential = rows[:, along] @ even_basis(nodes, slope_degree).T
    return np.stack([tangential, rows[:, across] @ odd_basis(nodes, slope_degree).T], axis=-1)


def _slope_places(degree: int) -> tuple[IntArray, IntArray]:
    """Places in a row of the terms of the tangential and the sagittal slope errors' bases."""
    places, beyond = [], ROW_LENGTH
    for start, highest, room in ((SLOPE_T, degree, FULL.slope), (SLOPE_S, degree - 1, FULL.slope - 1)):
        within, at = even_powers(room), []
        for power in even_powers(highest):
            if power in within:
                at.append(start + within.index(power))
            else:
                at.append(beyond)
                beyond += 1
        places.append(np.array(at, np.int32))
    return places[0], places[1]


class _Part:
    """Polynomial of one quantity: its basis at the nodes, and the positions of its coefficients in the row."""

    def __init__(self, basis: DoubleArray, places: IntArray) -> None:
        self.basis, self.places = basis, places
        self._inverse = np.linalg.pinv(basis)

    def solve(self, values: DoubleArray, passed: NDArray[np.bool_]) -> DoubleArray:
        """Least-squares coefficients over the rays that pass."""
        if passed.all():
            return np.asarray(self._inverse @ values)
        return np.asarray(np.linalg.lstsq(self.basis[passed], values[passed], rcond=None)[0])


def _term_positions(degree: int, full: int) -> IntArray:
    """Indices of an even basis's terms among those of the full one."""
    everything = even_powers(full)
    return np.array([everything.index(power) for power in even_powers(degree)], np.int32)


def even_basis(points: DoubleArray, degree: int) -> DoubleArray:
    """Basis ``(n, terms)``: x⁰ to x^degree, then those times y² of a total degree no higher, then y⁴, ..."""
    x, y = points.T
    return np.stack([x**i * y**j for i, j in even_powers(degree)], axis=1)


def even_powers(degree: int) -> list[tuple[int, int]]:
    """Powers of x and y of each term of the even basis, in the rows' order."""
    return [(i, j) for j in range(0, degree + 1, 2) for i in range(degree - j + 1)]


def odd_basis(points: DoubleArray, degree: int) -> DoubleArray:
    """Basis ``(n, terms)``: y times the even terms of a degree less."""
    return np.asarray(points[:, 1:] * even_basis(points, degree - 1))


def pupil_nodes(count: int = 112, rim: int = 24) -> DoubleArray:
    """Nodes ``(count + rim, 2)`` on the half disc y >= 0: an even spiral (Vogel 1979), and points on the rim."""
    index = np.arange(count) + 0.5
    radius, angle = np.sqrt(index / count), np.mod(index * np.pi * (3 - np.sqrt(5)), np.pi)
    radius, angle = np.append(radius, np.ones(rim)), np.append(angle, np.linspace(0, np.pi, rim))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
