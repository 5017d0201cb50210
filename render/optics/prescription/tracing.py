"""Rays through a prescription, by exact refraction at each surface; float64, many rays at once, from either side.

Places are ``(x, y, z)`` in millimetres, z along the axis from the scene to the film, 0 at the vertex of the front surface unless
the vertices are given. Directions are unit vectors: z positive for light on its way to the film.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.lens import Prescription, Surface
from render.optics.glass import D_LINE_NM, refractive_index
from render.optics.prescription.diffraction import diffract, reduced_mm
from render.optics.prescription.outlines import clearance
from render.optics.prescription.paraxial import vertices
from render.optics.prescription.surface_shape import intersect, slopes_at

PASSES = -1
_RIM_SLACK = 1 + 1e-9


class Fate(IntEnum):
    """Outcome of tracing a ray."""

    PASSES = 0
    BLOCKED = 1  # by the rim of a surface, its opening or its obscuration, or by the stop
    MISSES = 2  # the surface, which has no rim to be blocked by
    REFLECTED = 3  # totally: glass to air at too flat an angle, or an order of diffraction that does not exist there


@dataclass(frozen=True, eq=False)
class TracedRays:
    """Rays behind the surfaces that they were traced through.

    Attributes:
        points_mm: ``(k, n, 3)`` where each ray met each of the k surfaces, in the order it met them; NaN once it was stopped.
            Where it was blocked or reflected is still there.
        directions: ``(n, 3)`` of the rays that leave; NaN for those that were stopped.
        stopped_by: ``(n,)`` index of the surface that stopped the ray, `PASSES` where none did.
        fates: ``(n,)`` each a `Fate`.
    """

    points_mm: DoubleArray
    directions: DoubleArray
    stopped_by: NDArray[np.int64]
    fates: NDArray[np.uint8]

    @property
    def passes(self) -> NDArray[np.bool_]:
        """``(n,)`` whether the ray came through."""
        return np.asarray(self.stopped_by == PASSES)

    def at(self, z_mm: float) -> DoubleArray:
        """Points ``(n, 2)`` of the leaving rays in the plane ``z_mm``; NaN for stopped rays."""
        last = self.points_mm[-1]
        with np.errstate(divide="ignore", invalid="ignore"):
            slopes = self.directions[:, :2] / self.directions[:, 2:]
        return np.asarray(last[:, :2] + (z_mm - last[:, 2:]) * slopes)


def trace_forward(
    prescription: Prescription,
    points_mm: DoubleArray,
    directions: DoubleArray,
    wavelength_nm: float | DoubleArray = D_LINE_NM,
    *,
    vertices_mm: DoubleArray | None = None,
    stop_radius_mm: float | None = None,
    clip: bool = True,
    between: tuple[int, int] | None = None,
) -> TracedRays:
    """Trace rays from the scene toward the film.

    Args:
        prescription: the lens.
        points_mm: ``(n, 3)`` any point on each ray before the first surface.
        directions: ``(n, 3)`` unit vectors with positive z.
        wavelength_nm: of all rays, or ``(n,)`` of each.
        vertices_mm: ``(k,)`` where the surfaces stand, if not where the thicknesses put them.
        stop_radius_mm: of the closed iris; by default as wide as the prescription has it.
        clip: whether rims, iris, openings and obscurations stop rays. A surface without a clear diameter has no rim.
        between: first surface, and one past the last, for rays that begin or end inside the lens. By default all.
    """
    order = range(*(between or (0, len(prescription.surfaces))))
    placed = vertices(prescription) if vertices_mm is None else vertices_mm
    radius = stop_radius_mm
    return _trace(prescription, points_mm, directions, wavelength_nm, placed, radius, clip, order, forward=True)


def trace_backward(
    prescription: Prescription,
    points_mm: DoubleArray,
    directions: DoubleArray,
    wavelength_nm: float | DoubleArray = D_LINE_NM,
    *,
    vertices_mm: DoubleArray | None = None,
    stop_radius_mm: float | None = None,
    clip: bool = True,
    between: tuple[int, int] | None = None,
) -> TracedRays:
    """Trace rays from the film toward the scene: as `trace_forward`, with points behind the last surface and z negative."""
    order = range(*(between or (0, len(prescription.surfaces))))[::-1]
    placed = vertices(prescription) if vertices_mm is None else vertices_mm
    radius = stop_radius_mm
    return _trace(prescription, points_mm, directions, wavelength_nm, placed, radius, clip, order, forward=False)


def _trace(
    prescription: Prescription,
    points_mm: DoubleArray,
    directions: DoubleArray,
    wavelength_nm: float | DoubleArray,
    vertices_mm: DoubleArray,
    stop_radius_mm: float | None,
    clip: bool,
    order: Iterable[int],
    *,
    forward: bool,
) -> TracedRays:
    # columns are contiguous: a coordinate of all rays is one run of memory
    positions, headings = np.array(points_mm, np.float64, order="F"), np.array(directions, np.float64, order="F")
    order = tuple(order)
    fates = np.zeros(len(positions), np.uint8)
    stopped_by = np.full(len(positions), PASSES)
    met = np.empty((len(order), 3, len(positions)))
    for found, i in zip(met, order, strict=True):
        surface = prescription.surfaces[i]
        before, behind = _indices_around(prescription, i, wavelength_nm, forward)
        positions[:, 2] -= vertices_mm[i]
        local, hit = intersect(surface, positions, headings)
        rim = _rim_mm(surface, stop_radius_mm) if clip else np.inf
        reduced = reduced_mm(wavelength_nm) / behind if surface.phase else 0.0
        headings, refracted = refract(surface, local, headings, before / behind, reduced)
        fate = _fate(local, hit, refracted, rim)
        if clip and (surface.opening is not None or surface.obscuration is not None):
            fate[hit & (clearance(surface, local[:, :2]) > 0)] = Fate.BLOCKED
        newly = (fate != Fate.PASSES) & (stopped_by == PASSES)
        if newly.any():
            stopped_by[newly], fates[newly] = i, fate[newly]
            headings[newly] = np.nan
        local[:, 2] += vertices_mm[i]
        lost = ~hit | (fates == Fate.MISSES)
        if lost.any():
            local[lost] = np.nan
        positions, found[:] = local, local.T
    return TracedRays(met.transpose(0, 2, 1), headings, stopped_by, fates)


def _rim_mm(surface: Surface, stop_radius_mm: float | None) -> float:
    """Radius from the axis within which a surface lets light pass."""
    rim = surface.semi_diameter_mm if surface.semi_diameter_mm > 0 else np.inf
    return min(rim, stop_radius_mm) if surface.is_stop and stop_radius_mm is not None else rim


def _indices_around(
    prescription: Prescription, index: int, wavelength_nm: float | DoubleArray, forward: bool
) -> tuple[float | DoubleArray, float | DoubleArray]:
    """Refractive indices before and behind a surface, along the ray."""
    behind = refractive_index(prescription.surfaces[index].glass, wavelength_nm)
    front = refractive_index(prescription.surfaces[index - 1].glass, wavelength_nm) if index else np.ones_like(behind)
    return (front, behind) if forward else (behind, front)


def _fate(local: DoubleArray, hit: NDArray[np.bool_], refracted: NDArray[np.bool_], rim_mm: float) -> NDArray[np.uint8]:
    """A ray that misses a surface which has a rim hits what holds the rim."""
    fate = np.where(refracted, np.uint8(Fate.PASSES), np.uint8(Fate.REFLECTED))
    if not np.isfinite(rim_mm):
        fate[~hit] = Fate.MISSES
        return fate
    outside = local[:, 0] ** 2 + local[:, 1] ** 2 > (rim_mm * _RIM_SLACK) ** 2
    fate[outside | ~hit] = Fate.BLOCKED
    return fate


def refract(
    surface: Surface,
    local: DoubleArray,
    directions: DoubleArray,
    ratio: float | DoubleArray,
    reduced: float | DoubleArray = 0.0,
) -> tuple[DoubleArray, NDArray[np.bool_]]:
    """Snell's law in vector form (Welford 1986, ch. 4).

    Args:
        surface: which the rays have met.
        local: ``(n, 3)`` where, relative to its vertex.
        directions: ``(n, 3)`` unit vectors.
        ratio: index that the rays come from over the one that they go into, ``()`` or ``(n,)``.
        reduced: wavelength in the medium that they go into, over 2π, mm, for a diffractive surface.

    Returns:
        ``(n, 3)`` unit vectors, and ``(n,)`` whether the ray is refracted rather than totally reflected.
    """
    if surface.phase:
        return diffract(surface, local, directions, ratio, reduced)
    if np.ndim(ratio) == 0 and ratio == 1:
        return directions, np.ones(len(directions), bool)
    right, up, along = directions.T
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        slope_right, slope_up = slopes_at(surface, local[:, :2]).T
        shortening = 1 / np.sqrt(1 + slope_right * slope_right + slope_up * slope_up)
        incidence = shortening * (along - slope_right * right - slope_up * up)
        squared = 1 - ratio * ratio * (1 - incidence * incidence)
        bent = shortening * (np.copysign(np.sqrt(squared), incidence) - ratio * incidence)
        leaving = np.stack([ratio * right - bent * slope_right, ratio * up - bent * slope_up, ratio * along + bent])
        return leaving.T, squared >= 0
