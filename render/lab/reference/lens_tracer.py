"""Reference tracer of rays through a lens, from first principles in float64, for tests of the fast tracers.

Nothing here is shared with them but the data and the refractive indices. Rays find each surface as the root of a function
(`render.lab.reference.lens_shape`), and Snell's law bends them, written for vectors. Places are ``(x, y, z)`` in
millimetres, z along the axis from the scene to the film; directions are unit vectors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from render.errors import InputError
from render.lab.reference.lens_shape import SurfaceShape
from render.model.arrays import DoubleArray, IntArray
from render.model.lens import AIR, Glass, Surface
from render.optics.glass import refractive_index

Toward = Literal["film", "scene"]
OPEN = -1
_AT_ONCE = 8192  # rays whose numbers fit a processor's cache


@dataclass(frozen=True, eq=False)
class TracedRays:
    """Rays behind the last surface that they met.

    Attributes:
        positions: ``(n, 3)`` mm, where each ray met its last surface: the one that blocked it, if one did.
        directions: ``(n, 3)`` unit vectors behind it; of blocked rays, before it.
        blocked_at: ``(n,)`` index of the surface that the ray did not pass, or `OPEN`: rim, stop, total reflection, or
            refraction that turns it around.
        beyond_rim: ``(n,)`` whether the ray met any surface beyond its rim; where rims do not block, it went on all the same.
    """

    positions: DoubleArray
    directions: DoubleArray
    blocked_at: IntArray
    beyond_rim: NDArray[np.bool_]

    @property
    def passes(self) -> NDArray[np.bool_]:
        """``(n,)`` whether the ray got through."""
        return np.asarray(self.blocked_at == OPEN)

    def at(self, z_mm: float) -> DoubleArray:
        """Points ``(n, 2)`` of each ray's line in the plane ``z_mm``; NaN for blocked rays."""
        slopes = self.directions[:, :2] / self.directions[:, 2:]
        crossing = self.positions[:, :2] + (z_mm - self.positions[:, 2:]) * slopes
        return np.where(self.passes[:, None], crossing, np.nan)


def trace(
    surfaces: Sequence[Surface],
    vertices_mm: DoubleArray,
    wavelength_nm: float,
    origins: DoubleArray,
    directions: DoubleArray,
    *,
    toward: Toward,
    clip: bool = True,
    medium: Glass = AIR,
    heights: Sequence[DoubleArray | None] | None = None,
) -> TracedRays:
    """Trace rays through all the surfaces in turn.

    Args:
        surfaces: from front to rear. A closed iris is a stop with a smaller ``semi_diameter_mm``.
        vertices_mm: ``(k,)`` z of each surface's vertex.
        wavelength_nm: of all rays.
        origins: ``(n, 3)`` before the first surface that the rays meet.
        directions: ``(n, 3)`` unit vectors; z positive toward the film, negative toward the scene.
        toward: direction of the rays.
        clip: whether rims and stop block. If not, surfaces go on for a quarter beyond their rims, and flat from there.
        medium: in front of the first surface.
        heights: for each surface a ``(h, w)`` map of millimetres toward the film that are added to it, or None. It covers the
            square around the clear aperture: texels stand at their centres, columns go along +x and row 0 is at +y; heights
            are bilinear between texels, slopes the bilinear central differences, so that the glass is smooth.

    Raises:
        InputError: a surface with a height map has no clear diameter.
    """
    _check_maps(surfaces, heights)
    glasses = [medium, *(surface.glass for surface in surfaces)]
    indices = [refractive_index(glass, wavelength_nm) for glass in glasses]
    steps = []
    for i, surface in enumerate(surfaces):
        shape = SurfaceShape.of(surface, None if heights is None else heights[i], clip=clip)
        ratio = indices[i] / indices[i + 1]
        steps.append(_Step(i, shape, float(vertices_mm[i]), ratio if toward == "film" else 1 / ratio))
    steps = steps if toward == "film" else steps[::-1]
    parts = [
        _through(steps, origins[first : first + _AT_ONCE].T, directions[first : first + _AT_ONCE].T, clip=clip)
        for first in range(0, max(len(origins), 1), _AT_ONCE)
    ]
    positions, headings, blocked_at, beyond_rim = (
        np.concatenate([part[k] for part in parts], axis=-1) for k in range(4)
    )
    return TracedRays(positions.T, headings.T, blocked_at, beyond_rim)


@dataclass(frozen=True, eq=False)
class _Step:
    """One surface on the way.

    Attributes:
        index: its number in the lens.
        shape: its form.
        vertex_mm: z of its vertex.
        ratio: index that rays come from over the one that they go into.
    """

    index: int
    shape: SurfaceShape
    vertex_mm: float
    ratio: float


def _through(
    steps: Sequence[_Step], origins: DoubleArray, directions: DoubleArray, *, clip: bool
) -> tuple[DoubleArray, DoubleArray, IntArray, NDArray[np.bool_]]:
    """Fields of `TracedRays`, with vectors as ``(3, n)``; for no more rays than fit a cache."""
    positions, headings = np.array(origins, np.float64), np.array(directions, np.float64)
    last, blocked_at = headings.copy(), np.full(positions.shape[1], OPEN, np.int32)
    beyond_rim = np.zeros(len(blocked_at), bool)
    for step in steps:
        positions[2] -= step.vertex_mm
        met = step.shape.meet(positions, headings)
        bent, reflected = refract(headings, step.shape.normals(met), step.ratio)
        lost = reflected | (bent[2] * headings[2] <= 0)
        outside = step.shape.outside(met)
        beyond_rim |= outside
        if clip:
            lost |= outside
        blocked_at[lost & (blocked_at == OPEN)] = step.index
        went_on = blocked_at == OPEN
        positions = np.where(went_on | lost, met, positions)
        positions[2] += step.vertex_mm
        last = np.where(went_on, bent, last)
        headings = np.where(went_on, bent, np.nan)  # a ray that was stopped meets nothing more
    return positions, last, blocked_at, beyond_rim


def refract(directions: DoubleArray, normals: DoubleArray, ratio: float) -> tuple[DoubleArray, NDArray[np.bool_]]:
    """Snell's law: the tangential part of ``n·d`` goes on unchanged, the normal part makes the length right again.

    Args:
        directions: ``(3, n)`` unit vectors.
        normals: ``(3, n)`` unit vectors, to either side.
        ratio: index that the rays come from over the one that they go into.

    Returns:
        ``(3, n)`` unit vectors and ``(n,)`` whether the ray is totally reflected instead; its vector is meaningless.
    """
    along = (directions * normals).sum(axis=0)
    tangential = ratio * (directions - along * normals)
    left = 1.0 - (tangential * tangential).sum(axis=0)
    inward = np.copysign(np.sqrt(np.maximum(left, 0.0)), along)
    return tangential + inward * normals, np.asarray(left < 0)


def _check_maps(surfaces: Sequence[Surface], heights: Sequence[DoubleArray | None] | None) -> None:
    for i, added in enumerate(heights or ()):
        if added is not None and surfaces[i].semi_diameter_mm <= 0:
            raise InputError(f"surface {i + 1} has a height map, so it must have a clear diameter that the map covers")
