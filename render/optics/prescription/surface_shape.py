"""Shape of one lens surface: sag, slope, extent, and intersection with rays.

Places are relative to the surface's vertex, in millimetres, z along the axis toward the film; `render.model.lens` defines the
sag.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.lens import Surface

# A surface of unknown clear diameter ends at this slope (dz/dr): no useful ray meets it beyond.
_STEEPEST = 3.0
_RADII_MM = np.geomspace(1e-3, 1e4, 1401)
_NEWTON_STEPS = 60
_CONVERGED_MM = 1e-13


def curvature(surface: Surface) -> float:
    """Curvature at the vertex in 1/mm; 0 for a plane."""
    return 1 / surface.radius_mm if surface.radius_mm else 0.0


def curvature_across(surface: Surface) -> float:
    """Curvature at the vertex from side to side, 1/mm."""
    if surface.across is None:
        return curvature(surface)
    return 1 / surface.across.radius_mm if surface.across.radius_mm else 0.0


def sag_mm(surface: Surface, radius_squared: DoubleArray | float) -> DoubleArray:
    """Sag at the given squares of the distance from the axis (mm²); NaN beyond the conic's extent.

    Of a surface with two curves it is that from top to bottom.
    """
    r2 = np.asarray(radius_squared, np.float64)
    c = curvature(surface)
    with np.errstate(invalid="ignore"):
        sag = c * r2 / (1 + np.sqrt(1 - (1 + surface.conic) * c * c * r2))
    return np.asarray(sag + _polynomial(surface, r2))


def sag_gradient(surface: Surface, radius_squared: DoubleArray | float) -> DoubleArray:
    """Derivative of `sag_mm` by the *square* of the distance from the axis, 1/mm."""
    r2 = np.asarray(radius_squared, np.float64)
    c = curvature(surface)
    with np.errstate(invalid="ignore", divide="ignore"):
        gradient = c / (2 * np.sqrt(1 - (1 + surface.conic) * c * c * r2))
    return np.asarray(gradient + _polynomial_gradient(surface, r2))


def sag_at(surface: Surface, points: DoubleArray) -> DoubleArray:
    """Sag ``(n,)`` at points ``(n, 2)``, x across and y up; NaN beyond the conic's extent."""
    r2 = (points**2).sum(axis=-1)
    if surface.across is None:
        return sag_mm(surface, r2)
    curved, bent = _biconic(surface, points)
    with np.errstate(invalid="ignore"):
        sag = curved / (1 + np.sqrt(1 - bent))
    return np.asarray(sag + _polynomial(surface, r2))


def slopes_at(surface: Surface, points: DoubleArray) -> DoubleArray:
    """Derivatives ``(n, 2)`` of the sag by x and y: the normal is ``(−slope x, −slope y, 1)``."""
    r2 = (points**2).sum(axis=-1)
    if surface.across is None:
        return np.asarray(2 * points * sag_gradient(surface, r2)[..., None])
    curved, bent = (part[..., None] for part in _biconic(surface, points))
    curvatures, bends = _curves(surface)
    with np.errstate(invalid="ignore", divide="ignore"):
        root = np.sqrt(1 - bent)
        slopes = points * (2 * curvatures / (1 + root) + curved * bends / (root * (1 + root) ** 2))
    return np.asarray(slopes + 2 * points * _polynomial_gradient(surface, r2)[..., None])


def _polynomial(surface: Surface, r2: DoubleArray) -> DoubleArray:
    """Sum of the aspheric terms at squares of the distance from the axis."""
    total = np.zeros_like(r2)
    for power, coefficient in enumerate(surface.aspheric, start=2):
        total = total + coefficient * r2**power
    for power, coefficient in enumerate(surface.odd, start=1):
        total = total + coefficient * r2**power * np.sqrt(r2)
    return total


def _polynomial_gradient(surface: Surface, r2: DoubleArray) -> DoubleArray:
    """Derivative of `_polynomial` by the square of the distance from the axis."""
    total = np.zeros_like(r2)
    for power, coefficient in enumerate(surface.aspheric, start=2):
        total = total + power * coefficient * r2 ** (power - 1)
    for power, coefficient in enumerate(surface.odd, start=1):
        total = total + (power + 0.5) * coefficient * r2 ** (power - 1) * np.sqrt(r2)
    return total


def _biconic(surface: Surface, points: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """``cₓ·x² + c·y²`` and ``(1 + Kₓ)·cₓ²·x² + (1 + K)·c²·y²``."""
    curvatures, bends = _curves(surface)
    return np.asarray(points**2 @ curvatures), np.asarray(points**2 @ bends)


def _curves(surface: Surface) -> tuple[DoubleArray, DoubleArray]:
    """Curvatures c and bends ``(1 + K)·c²``, from side to side and from top to bottom."""
    curvatures = np.array([curvature_across(surface), curvature(surface)])
    across = surface.conic if surface.across is None else surface.across.conic
    return curvatures, (1 + np.array([across, surface.conic])) * curvatures**2


def conic_extent_mm(surface: Surface) -> float:
    """Distance from the axis to which the surface's conic goes all around; infinite for planes, parabolas and hyperbolas."""
    bend = float(_curves(surface)[1].max())
    return float(1 / np.sqrt(bend)) if bend > 0 else float("inf")


def extent_mm(surface: Surface) -> float:
    """Radius out to which the surface is known: its clear semi-diameter, else where it turns back or grows too steep."""
    if surface.semi_diameter_mm > 0:
        return surface.semi_diameter_mm
    if not surface.is_aspheric and surface.across is None:
        return conic_extent_mm(surface)
    radii = _RADII_MM[conic_extent_mm(surface) > _RADII_MM]
    steep = (np.abs([slopes_at(surface, radii[:, None] * way).sum(axis=1) for way in np.eye(2)]) > _STEEPEST).any(
        axis=0
    )
    return float(radii[steep.argmax()] if steep.any() else radii[-1])


def intersect(
    surface: Surface, positions: DoubleArray, directions: DoubleArray
) -> tuple[DoubleArray, NDArray[np.bool_]]:
    """Intersect rays with a surface, on the sheet that holds its vertex.

    Conics have a closed form (Welford 1986, ch. 4), in which the ray first goes to the plane of the vertex. With two curves or
    aspheric terms, Newton's method goes on from there, inside a bracket that bisection takes over whenever a step would leave it.

    Args:
        surface: in whose vertex the coordinates start.
        positions: ``(n, 3)`` a point on each ray, mm.
        directions: ``(n, 3)`` unit vectors, not across the axis.

    Returns:
        ``(n, 3)`` points and ``(n,)`` whether the ray meets the surface; points of those that do not are meaningless.
    """
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        on_plane = positions - (positions[:, 2] / directions[:, 2])[:, None] * directions
        if surface.across is not None:
            distance, hit = _general_distance(surface, on_plane, directions, np.zeros(len(positions)))
            return on_plane + distance[:, None] * directions, hit
        distance, hit = _conic_distance(surface, on_plane, directions)
        if surface.is_aspheric:
            distance, hit = _general_distance(surface, on_plane, directions, np.where(hit, distance, 0.0))
        return on_plane + distance[:, None] * directions, hit


def _conic_distance(
    surface: Surface, on_plane: DoubleArray, directions: DoubleArray
) -> tuple[DoubleArray, NDArray[np.bool_]]:
    """Distance from the vertex plane to the conic ``c·(x² + y² + (1 + K)·z²) = 2z``; the root nearest to the vertex."""
    c, along = curvature(surface), directions[:, 2]
    f = c * (on_plane[:, 0] ** 2 + on_plane[:, 1] ** 2)
    g = along - c * (directions[:, 0] * on_plane[:, 0] + directions[:, 1] * on_plane[:, 1])
    inside = g * g - c * (1 + surface.conic * along * along) * f
    distance = f / (g + np.sign(along) * np.sqrt(np.maximum(inside, 0)))
    on_sheet = 1 - (1 + surface.conic) * c * distance * along >= 0
    return distance, np.asarray((inside >= 0) & on_sheet & np.isfinite(distance))


def _general_distance(
    surface: Surface, on_plane: DoubleArray, directions: DoubleArray, start: DoubleArray
) -> tuple[DoubleArray, NDArray[np.bool_]]:
    """Distance from the vertex plane to the full surface, which goes on flat beyond its extent so that a root always exists."""
    widest = min(extent_mm(surface), conic_extent_mm(surface) * (1 - 1e-9))
    radii = np.linspace(0, widest, 257)[:, None]
    sags = np.concatenate([sag_at(surface, radii * way) for way in np.eye(2)])
    slack = 1 + float(np.ptp(sags))
    before, behind = (sags.min() - slack) / directions[:, 2], (sags.max() + slack) / directions[:, 2]
    distance = start
    for _ in range(_NEWTON_STEPS):
        points = on_plane + distance[:, None] * directions
        within = (
            points[:, :2] * np.minimum(widest / np.maximum(np.hypot(points[:, 0], points[:, 1]), 1e-300), 1)[:, None]
        )
        miss = points[:, 2] - sag_at(surface, within)
        behind, before = np.where(miss > 0, distance, behind), np.where(miss > 0, before, distance)
        if not (np.abs(miss) > _CONVERGED_MM).any():
            break
        across = (slopes_at(surface, within) * directions[:, :2]).sum(axis=1)
        step = distance - miss / (directions[:, 2] - across)
        stays = (step - before) * (step - behind) <= 0
        distance = np.where(stays, step, (before + behind) / 2)
    r2 = (on_plane + distance[:, None] * directions)[:, :2] ** 2
    return distance, np.asarray(np.isfinite(distance) & (r2.sum(1) <= widest**2 * (1 + 1e-6)))


def clearance_mm(front: Surface, behind: Surface, thickness_mm: float) -> float:
    """Least distance along the axis between two neighbours within their clear diameters; negative where they overlap.

    Where neither clear diameter is known, only the axis counts.
    """
    known = [surface.semi_diameter_mm for surface in (front, behind) if surface.semi_diameter_mm > 0]
    widest = min(*known, conic_extent_mm(front), conic_extent_mm(behind)) if known else 0.0
    angles = np.linspace(0, np.pi / 2, 1 if front.across is None and behind.across is None else 7)
    ways = np.stack([np.sin(angles), np.cos(angles)], axis=-1)[:, None, :]
    points = np.linspace(0, widest * (1 - 1e-9), 129)[:, None] * ways
    return float((thickness_mm + sag_at(behind, points) - sag_at(front, points)).min())
