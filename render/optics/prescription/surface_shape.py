"""Shape of one lens surface: sag, slope, extent, and intersection with rays.

Places are relative to the surface's vertex, in millimetres, z along the axis toward the film; `render.model.lens` defines the
sag.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.lens import Across, Surface

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
    sag = _conic_sag(curvature(surface), surface.conic, r2)
    return np.asarray(sag + _aspheric_sag(surface, r2) if surface.is_aspheric and surface.torus != "across" else sag)


def sag_gradient(surface: Surface, radius_squared: DoubleArray | float) -> DoubleArray:
    """Derivative of `sag_mm` by the *square* of the distance from the axis, 1/mm."""
    r2 = np.asarray(radius_squared, np.float64)
    gradient = _conic_gradient(curvature(surface), surface.conic, r2)
    return np.asarray(gradient + _aspheric_gradient(surface, r2) if surface.is_aspheric else gradient)


def _conic_sag(c: float, conic: float, r2: DoubleArray) -> DoubleArray:
    with np.errstate(invalid="ignore"):
        return np.asarray(c * r2 / (1 + np.sqrt(1 - (1 + conic) * c * c * r2)))


def _conic_gradient(c: float, conic: float, r2: DoubleArray) -> DoubleArray:
    """Derivative of the sag by the square of the distance from the axis."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(c / (2 * np.sqrt(1 - (1 + conic) * c * c * r2)))


def _aspheric_sag(surface: Surface, r2: DoubleArray) -> DoubleArray:
    """Part of `sag_mm` that the aspheric terms add, by Horner's rule: powers of arrays are slow."""
    total = np.zeros_like(r2)
    for coefficient in reversed(surface.aspheric):
        total = (total + coefficient) * r2
    total = total * r2
    if surface.odd:
        total = total + np.sqrt(r2) * _horner(surface.odd, r2) * r2
    return total


def _aspheric_gradient(surface: Surface, r2: DoubleArray) -> DoubleArray:
    """Part of `sag_gradient` that the aspheric terms add."""
    total = np.zeros_like(r2)
    for power in range(len(surface.aspheric) + 1, 1, -1):
        total = (total + power * surface.aspheric[power - 2]) * r2
    if surface.odd:
        weighed = [(power + 0.5) * term for power, term in enumerate(surface.odd, start=1)]
        total = total + np.sqrt(r2) * _horner(weighed, r2)
    return total


def _horner(terms: Sequence[float], r2: DoubleArray) -> DoubleArray:
    """Sum of ``terms[i] * r2**i``."""
    total = np.zeros_like(r2)
    for term in reversed(terms):
        total = total * r2 + term
    return total


def sag_at(surface: Surface, points: DoubleArray) -> DoubleArray:
    """Sag ``(n,)`` at points ``(n, 2)``, x across and y up; NaN beyond the conic's extent."""
    r2 = (points**2).sum(axis=-1)
    if surface.across is None:
        return sag_mm(surface, r2)
    if surface.torus:
        return _torus(surface, points)[0]
    curved, bent = _biconic(surface, points)
    with np.errstate(invalid="ignore"):
        sag = curved / (1 + np.sqrt(1 - bent))
    return np.asarray(sag + _aspheric_sag(surface, r2) if surface.is_aspheric else sag)


def slopes_at(surface: Surface, points: DoubleArray) -> DoubleArray:
    """Derivatives ``(n, 2)`` of the sag by x and y: the normal is ``(−slope x, −slope y, 1)``."""
    r2 = (points**2).sum(axis=-1)
    if surface.across is None:
        return np.asarray(2 * points * sag_gradient(surface, r2)[..., None])
    if surface.torus:
        return _torus(surface, points)[1]
    curved, bent = _biconic(surface, points)
    curvatures, bends = _curves(surface)
    with np.errstate(invalid="ignore", divide="ignore"):
        root = np.sqrt(1 - bent)
        whole, part = 2 / (1 + root), curved / (root * (1 + root) ** 2)
        ratios = [whole * curvature + part * bend for curvature, bend in zip(curvatures, bends, strict=True)]
    if surface.is_aspheric:
        around = 2 * _aspheric_gradient(surface, r2)
        ratios = [ratio + around for ratio in ratios]
    return np.asarray(np.stack(ratios).T * points if points.ndim == 2 else np.stack(ratios, axis=-1) * points)


def _biconic(surface: Surface, points: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """``cₓ·x² + c·y²`` and ``(1 + Kₓ)·cₓ²·x² + (1 + K)·c²·y²``."""
    curvatures, bends = _curves(surface)
    return np.asarray(points**2 @ curvatures), np.asarray(points**2 @ bends)


def _curves(surface: Surface) -> tuple[DoubleArray, DoubleArray]:
    """Curvatures c and bends ``(1 + K)·c²``, from side to side and from top to bottom."""
    curvatures = np.array([curvature_across(surface), curvature(surface)])
    across = surface.conic if surface.across is None else surface.across.conic
    return curvatures, (1 + np.array([across, surface.conic])) * curvatures**2


def _torus(surface: Surface, points: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Sag ``(...)`` and slopes ``(..., 2)`` of a torus; NaN where it does not go."""
    curved, turned, c, conic, turn = _torus_curves(surface)
    along, beside = points[..., curved], points[..., turned]
    square = along * along
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        curve, gradient = _conic_sag(c, conic, square), _conic_gradient(c, conic, square)
        if surface.is_aspheric:
            curve, gradient = curve + _aspheric_sag(surface, square), gradient + _aspheric_gradient(surface, square)
        near = 1 - turn * curve  # share of the turn's radius that is left
        root = np.sqrt(np.where(near > 0, near * near - (turn * beside) ** 2, np.nan))
        slopes = np.empty(points.shape)
        slopes[..., curved], slopes[..., turned] = near / root * 2 * along * gradient, turn * beside / root
        return np.asarray(curve + turn * beside * beside / (near + root)), slopes


def _torus_curves(surface: Surface) -> tuple[int, int, float, float, float]:
    """Axis of the curve that is turned, and the other one; its curvature and conic constant; the turn's curvature."""
    across = surface.across or Across()
    if surface.torus == "across":
        return 0, 1, curvature_across(surface), across.conic, curvature(surface)
    return 1, 0, curvature(surface), surface.conic, curvature_across(surface)


@lru_cache(maxsize=512)
def _torus_extent_mm(surface: Surface) -> float:
    """Distance from the axis to which a torus goes all around."""
    angle = np.linspace(0, np.pi / 2, 91)
    ways = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    inside = np.isfinite(_torus(surface, _RADII_MM[:, None, None] * ways)[0]).all(axis=-1)
    if inside.all():
        return float("inf")
    first = int(inside.argmin())
    low, high = float(_RADII_MM[first - 1]) if first else 0.0, float(_RADII_MM[first])
    for _ in range(50):
        middle = (low + high) / 2
        goes_on = np.isfinite(_torus(surface, middle * ways)[0]).all()
        low, high = (middle, high) if goes_on else (low, middle)
    return low


def conic_extent_mm(surface: Surface) -> float:
    """Distance from the axis to which the surface's conic goes all around; infinite for planes, parabolas and hyperbolas."""
    if surface.torus:
        return _torus_extent_mm(surface)
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
    x, y, z = positions.T
    right, up, along = directions.T
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        back = z / along
        x, y = x - back * right, y - back * up
        if surface.across is not None:
            flat = _flat_meridian(surface)
            if flat is None:
                distance, hit = _general_distance(surface, (x, y), (right, up, along), np.zeros(len(x)))
            else:
                distance, hit = _cylinder_distance(surface, flat, (x, y), (right, up, along))
        else:
            distance, hit = _conic_distance(
                curvature(surface), surface.conic, x * x + y * y, right * x + up * y, along, 1.0
            )
            if surface.is_aspheric:
                start = np.where(hit, distance, 0.0)
                distance, hit = _general_distance(surface, (x, y), (right, up, along), start)
        return np.stack([x + distance * right, y + distance * up, distance * along]).T, hit


def _conic_distance(
    c: float,
    conic: float,
    height_squared: DoubleArray,
    outward: DoubleArray,
    along: DoubleArray,
    length: DoubleArray | float,
) -> tuple[DoubleArray, NDArray[np.bool_]]:
    """Distance from the vertex plane to the conic ``c·(x² + y² + (1 + K)·z²) = 2z``; the root nearest to the vertex.

    Args:
        c: curvature.
        conic: constant K.
        height_squared: ``(n,)`` x² + y² of the rays on the vertex plane.
        outward: ``(n,)`` product of those points and the rays' directions.
        along: ``(n,)`` directions' z.
        length: squared, of the directions: 1 but in a plane that they leave.
    """
    if not c:
        return np.zeros(len(along)), np.isfinite(height_squared)
    f, g = c * height_squared, along - c * outward
    bend = length + conic * along * along if conic else length
    inside = g * g - c * bend * f
    distance = f / (g + np.copysign(np.sqrt(np.maximum(inside, 0)), along))
    on_sheet = (1 + conic) * c * distance * along <= 1
    return distance, np.asarray((inside >= 0) & on_sheet & np.isfinite(distance))


def _flat_meridian(surface: Surface) -> int | None:
    """Axis along which a surface is straight, as a cylinder is: 0 from side to side; None for any other surface."""
    if surface.is_aspheric:
        return None
    if curvature_across(surface) == 0:
        return 0
    return 1 if curvature(surface) == 0 else None


def _cylinder_distance(
    surface: Surface, flat: int, on_plane: tuple[DoubleArray, DoubleArray], directions: tuple[DoubleArray, ...]
) -> tuple[DoubleArray, NDArray[np.bool_]]:
    """Distance from the vertex plane to a cylinder: that to a conic in the plane across it; it ends where others end too."""
    (x, y), (right, up, along) = on_plane, directions
    place, heading = (y, up) if flat == 0 else (x, right)
    across_conic = surface.conic if surface.across is None else surface.across.conic
    c, conic = (curvature(surface), surface.conic) if flat == 0 else (curvature_across(surface), across_conic)
    distance, hit = _conic_distance(c, conic, place * place, heading * place, along, heading**2 + along**2)
    widest = _reach(surface)[0]
    r2 = (x + distance * right) ** 2 + (y + distance * up) ** 2
    return distance, np.asarray(hit & (r2 <= widest**2 * (1 + 1e-6)))


@lru_cache(maxsize=512)
def _reach(surface: Surface) -> tuple[float, float, float]:
    """Radius within which a surface is known, and its least and its largest sag there."""
    widest = min(extent_mm(surface), conic_extent_mm(surface) * (1 - 1e-9))
    radii = np.linspace(0, widest, 257)[:, None]
    sags = np.concatenate([sag_at(surface, radii * way) for way in np.eye(2)])
    return widest, float(sags.min()), float(sags.max())


def _general_distance(
    surface: Surface, on_plane: tuple[DoubleArray, DoubleArray], directions: tuple[DoubleArray, ...], start: DoubleArray
) -> tuple[DoubleArray, NDArray[np.bool_]]:
    """Distance from the vertex plane to the full surface, which goes on flat beyond its extent so that a root always exists."""
    (x, y), (right, up, along) = on_plane, directions
    widest, lowest, highest = _reach(surface)
    slack = 1 + highest - lowest
    before, behind = (lowest - slack) / along, (highest + slack) / along
    distance = start
    for _ in range(_NEWTON_STEPS):
        points = np.stack([x + distance * right, y + distance * up])
        points *= np.minimum(widest / np.maximum(np.sqrt(points[0] ** 2 + points[1] ** 2), 1e-300), 1)
        miss = distance * along - sag_at(surface, points.T)
        beyond = miss > 0
        behind, before = np.where(beyond, distance, behind), np.where(beyond, before, distance)
        if not (np.abs(miss) > _CONVERGED_MM).any():
            break
        slope_right, slope_up = slopes_at(surface, points.T).T
        step = distance - miss / (along - (slope_right * right + slope_up * up))
        stays = (step - before) * (step - behind) <= 0
        distance = np.where(stays, step, (before + behind) / 2)
    r2 = (x + distance * right) ** 2 + (y + distance * up) ** 2
    return distance, np.asarray(np.isfinite(distance) & (r2 <= widest**2 * (1 + 1e-6)))


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
