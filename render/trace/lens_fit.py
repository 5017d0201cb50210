"""Rows of a `PolynomialTable`: least-squares polynomials over the pupil, and what bounds a row's rays.

A quantity that a mirror in the tangential plane leaves as it is (tangential errors, clearances, weights) is even in the sagittal
coordinate y, one that it turns around (sagittal errors) odd. Polynomials of total degree 7 in the pupil hold aberrations up to
the seventh order (Buchdahl 1954): for the lenses of the library a few micrometres on the film are left, wide open.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.scene import DoubleArray, FloatArray
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
_SLOPE_DEGREE, _PUPIL_DEGREE, _RIM_DEGREE, _WEIGHT_DEGREE = 7, 5, 4, 2


@dataclass(frozen=True)
class Region:
    """The ellipse on the stop, in units of its radius, that holds what is open for one field height.

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
        """``(n, 2)`` points of the stop for points of the unit disc."""
        return np.stack([self.centre + self.along * disc[:, 0], self.across * disc[:, 1]], axis=1)

    @property
    def area(self) -> float:
        """Over that of the whole stop."""
        return self.along * self.across


@dataclass(frozen=True, eq=False)
class NodeRays:
    """Rays of one field height and wavelength at the nodes of its pupil, tangential coordinate first.

    Attributes:
        slope: ``(n, 2)`` slope error.
        pupil_m: ``(n, 2)``.
        front: ``(n,)`` clearance, above 0 blocked.
        rear: likewise.
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

    def __init__(self, nodes: DoubleArray) -> None:
        """``nodes``: ``(n, 2)`` on the half disc y >= 0."""
        self.nodes = nodes
        bases = {
            SLOPE_T: even_basis(nodes, _SLOPE_DEGREE),
            SLOPE_S: odd_basis(nodes, _SLOPE_DEGREE),
            PUPIL_T: even_basis(nodes, _PUPIL_DEGREE),
            PUPIL_S: odd_basis(nodes, _PUPIL_DEGREE),
            FRONT_RIM: even_basis(nodes, _RIM_DEGREE),
            WEIGHT: even_basis(nodes, _WEIGHT_DEGREE),
        }
        bases[REAR_RIM] = bases[FRONT_RIM]
        self._bases = bases
        self._inverses = {place: np.linalg.pinv(basis) for place, basis in bases.items()}

    def row(self, rays: NodeRays, region: Region) -> FloatArray:
        """``(ROW_LENGTH,)`` of a field height; dark where too few rays get through to say anything."""
        row = np.zeros(ROW_LENGTH)
        if rays.passed.sum() < len(self.nodes) // 2:
            return row.astype(np.float32)
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
            coefficients = self._solved(place, value, rays.passed)
            row[place : place + len(coefficients)] = coefficients
        row[REGION : REGION + 4] = [region.centre, region.along, region.across, float(region.clipped)]
        row[BOUND : BOUND + 4] = self._bounds(rays, region)
        return row.astype(np.float32)

    def _solved(self, place: int, value: DoubleArray, passed: NDArray[np.bool_]) -> DoubleArray:
        if passed.all():
            return np.asarray(self._inverses[place] @ value)
        return np.asarray(np.linalg.lstsq(self._bases[place][passed], value[passed], rcond=None)[0])

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


def even_basis(points: DoubleArray, degree: int) -> DoubleArray:
    """``(n, terms)``: x⁰ to x^degree, then those times y² of a total degree no higher, then y⁴, ..."""
    x, y = points.T
    return np.stack([x**i * y**j for i, j in even_powers_of(degree)], axis=1)


def even_powers_of(degree: int) -> list[tuple[int, int]]:
    """Powers of x and y of each term of the even basis, in the rows' order."""
    return [(i, j) for j in range(0, degree + 1, 2) for i in range(degree - j + 1)]


def odd_basis(points: DoubleArray, degree: int) -> DoubleArray:
    """``(n, terms)``: y times the even terms of a degree less."""
    return np.asarray(points[:, 1:] * even_basis(points, degree - 1))


def pupil_nodes(count: int = 112, rim: int = 24) -> DoubleArray:
    """``(count + rim, 2)`` on the half disc y >= 0: a spiral that fills it evenly (Vogel 1979), and points on the rim."""
    index = np.arange(count) + 0.5
    radius, angle = np.sqrt(index / count), np.mod(index * np.pi * (3 - np.sqrt(5)), np.pi)
    radius, angle = np.append(radius, np.ones(rim)), np.append(angle, np.linspace(0, np.pi, rim))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
