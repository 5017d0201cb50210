"""Rays through a lens from first principles, in float64: what the fast tracers are held against.

Nothing here is shared with them but the data and the refractive indices. Rays find each surface as the root of a function
(`render.reference.lens_shape`), and Snell's law bends them, written for vectors. Places are ``(x, y, z)`` in
millimetres, z along the axis from the scene to the film; directions are unit vectors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from render.errors import InputError
from render.lens import AIR, Glass, Surface
from render.optics.glass import refractive_index
from render.reference.lens_shape import SurfaceShape
from render.scene import DoubleArray, IntArray

Toward = Literal["film", "scene"]
OPEN = -1


@dataclass(frozen=True, eq=False)
class TracedRays:
    """Rays behind the last surface that they met.

    Attributes:
        positions: ``(n, 3)`` mm, where each ray met its last surface: the one that blocked it, if one did.
        directions: ``(n, 3)`` unit vectors behind it; of blocked rays, before it.
        blocked_at: ``(n,)`` index of the surface that the ray did not pass, or `OPEN`: rim, stop or total reflection.
    """

    positions: DoubleArray
    directions: DoubleArray
    blocked_at: IntArray

    @property
    def passes(self) -> NDArray[np.bool_]:
        """``(n,)`` whether the ray got through."""
        return np.asarray(self.blocked_at == OPEN)

    def at(self, z_mm: float) -> DoubleArray:
        """``(n, 2)`` where the straight line of each ray crosses the plane at ``z_mm``; NaN for blocked rays."""
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
        toward: where the rays go.
        clip: whether rims and stop block. If not, surfaces go on for a quarter beyond their rims, and flat from there.
        medium: in front of the first surface.
        heights: for each surface a ``(h, w)`` map of millimetres toward the film that are added to it, or None. It covers the
            square around the clear aperture: texels stand at their centres, columns go along +x and row 0 is at +y; heights
            are bilinear between texels, slopes the bilinear central differences, so that the glass is smooth.

    Raises:
        InputError: a surface with a height map has no clear diameter.
    """
    _check_maps(surfaces, heights)
    positions, headings = np.array(origins, np.float64), np.array(directions, np.float64)
    blocked_at = np.full(len(positions), OPEN, np.int32)
    glasses = [medium, *(surface.glass for surface in surfaces)]
    order = range(len(surfaces)) if toward == "film" else range(len(surfaces))[::-1]
    alive = np.arange(len(positions))
    for i in order:
        shape = SurfaceShape.of(surfaces[i], None if heights is None else heights[i], clip=clip)
        vertex = np.array([0.0, 0.0, vertices_mm[i]])
        local = shape.meet(positions[alive] - vertex, headings[alive])
        positions[alive] = local + vertex
        front, behind = (refractive_index(glass, wavelength_nm) for glass in glasses[i : i + 2])
        ratio = front / behind if toward == "film" else behind / front
        bent, reflected = refract(headings[alive], shape.normals(local), ratio)
        lost = reflected | (shape.outside(local) if clip else False)
        blocked_at[alive[lost]] = i
        alive = alive[~lost]
        headings[alive] = bent[~lost]
    return TracedRays(positions, headings, blocked_at)


def refract(directions: DoubleArray, normals: DoubleArray, ratio: float) -> tuple[DoubleArray, NDArray[np.bool_]]:
    """Snell's law: the tangential part of ``n·d`` goes on unchanged, the normal part makes the length right again.

    Args:
        directions: ``(n, 3)`` unit vectors.
        normals: ``(n, 3)`` unit vectors, to either side.
        ratio: index that the rays come from over the one that they go into.

    Returns:
        ``(n, 3)`` unit vectors and ``(n,)`` whether the ray is totally reflected instead; its vector is meaningless.
    """
    along = np.einsum("ni,ni->n", directions, normals)
    tangential = ratio * (directions - along[:, None] * normals)
    left = 1.0 - np.einsum("ni,ni->n", tangential, tangential)
    inward = np.copysign(np.sqrt(np.maximum(left, 0.0)), along)
    return tangential + inward[:, None] * normals, left < 0


def _check_maps(surfaces: Sequence[Surface], heights: Sequence[DoubleArray | None] | None) -> None:
    for i, added in enumerate(heights or ()):
        if added is not None and surfaces[i].semi_diameter_mm <= 0:
            raise InputError(f"surface {i + 1} has a height map, so it must have a clear diameter that the map covers")
