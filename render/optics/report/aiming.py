"""Rays from points of the scene through points of the stop, whatever rims say: Newton's method on the exact tracer.

Off the axis the real entrance pupil moves, tilts and shrinks; so rays are not sent through the paraxial one, but to the stop.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.tracing import TracedRays, trace_forward

_STAGES = (0.0, 0.5, 1.0)  # from the chief ray out to the stop point, so that Newton's method always starts near
_STEPS = 8
_NUDGE = 1e-5  # of the entrance pupil's radius, for derivatives
_SOLVED = 1e-7  # of the stop's radius: how near to its point a ray passes


@dataclass(frozen=True, eq=False)
class Targets:
    """End points of the rays to be found.

    Attributes:
        slopes: ``(n, 2)`` direction of their object: right and up per step of depth, from the entrance pupil's centre.
        nearness_per_mm: 1 over its depth; 0 is infinity.
        stop_mm: ``(n, 2)`` where they cross the stop.
        pupil_mm: ``(n, 2)`` where the chief ray to that object crosses the plane of the entrance pupil.
        wavelength_nm: of their light.
    """

    slopes: DoubleArray
    nearness_per_mm: float
    stop_mm: DoubleArray
    pupil_mm: DoubleArray
    wavelength_nm: float


@dataclass(frozen=True, eq=False)
class AimedRays:
    """Rays that reach their targets, as they enter the lens.

    Attributes:
        points_mm: ``(n, 3)`` on the plane of the front vertex.
        directions: ``(n, 3)`` unit vectors toward the film.
        shrinking: ``(n,)`` area on the entrance pupil's plane over area on the stop.
        solved: ``(n,)`` whether the ray reaches its point on the stop.
    """

    points_mm: DoubleArray
    directions: DoubleArray
    shrinking: DoubleArray
    solved: NDArray[np.bool_]


def aim(lens: FocusedLens, targets: Targets) -> AimedRays:
    """Find the rays that connect objects with points of the stop.

    Args:
        lens: as focused.
        targets: what to connect.
    """
    pupil = targets.pupil_mm.copy()
    jacobian = np.tile(np.eye(2) / lens.first.entrance_pupil_magnification, (len(pupil), 1, 1))
    off = np.zeros_like(pupil)
    for stage, before in zip(_STAGES, (0.0, *_STAGES), strict=False):
        start = pupil + _correction(jacobian, targets.stop_mm * (stage - before))
        pupil, off, jacobian = _solve(lens, targets, pupil, start, targets.stop_mm * stage, jacobian)
    points, directions = _enter(lens, targets.nearness_per_mm, targets.slopes, pupil)
    with np.errstate(divide="ignore", invalid="ignore"):
        shrinking = 1 / np.abs(np.linalg.det(jacobian))
    return AimedRays(points, directions, shrinking, np.hypot(*off.T) <= _SOLVED * lens.stop_radius_mm)


def _solve(
    lens: FocusedLens,
    targets: Targets,
    good: DoubleArray,
    start: DoubleArray,
    wanted: DoubleArray,
    jacobian: DoubleArray,
) -> tuple[DoubleArray, DoubleArray, DoubleArray]:
    """Move pupil points until their rays meet the target points of the stop.

    Args:
        lens: as focused.
        targets: objects of the rays.
        good: ``(n, 2)`` pupil points whose rays get to the stop.
        start: ``(n, 2)`` pupil points to begin with.
        wanted: ``(n, 2)``.
        jacobian: ``(n, 2, 2)`` derivative of the point on the stop by that on the pupil.

    Returns:
        Pupil points, by how much they miss on the stop (NaN where the ray does not get there), and the derivative.
    """
    pupil, good, off, jacobian = start.copy(), good.copy(), np.full_like(start, np.nan), jacobian.copy()
    left = np.arange(len(pupil))
    for _ in range(_STEPS):
        met, derivative = _on_stop(lens, targets, pupil, left)
        off[left] = met - wanted[left]
        lost = ~(np.isfinite(met).all(axis=1) & np.isfinite(derivative).all(axis=(1, 2)))
        hit, gone = left[~lost], left[lost]
        jacobian[hit], good[hit] = derivative[~lost], pupil[hit]
        pupil[gone] = (pupil[gone] + good[gone]) / 2  # back toward where a ray got through
        moving = hit[np.hypot(*off[hit].T) > _SOLVED * lens.stop_radius_mm]
        pupil[moving] -= _correction(jacobian[moving], off[moving])
        left = np.concatenate([moving, gone])
        if not len(left):
            break
    return pupil, off, jacobian


def _on_stop(
    lens: FocusedLens, targets: Targets, pupil: DoubleArray, of: NDArray[np.int64]
) -> tuple[DoubleArray, DoubleArray]:
    """Where some of the rays meet the stop, ``(n, 2)``, and the derivatives by the point on the pupil, ``(n, 2, 2)``."""
    nudge, count = _NUDGE * lens.entrance_pupil_radius_mm, len(of)
    moved = np.concatenate([pupil[of], pupil[of] + [nudge, 0], pupil[of] + [0, nudge]])
    points, directions = _enter(lens, targets.nearness_per_mm, np.tile(targets.slopes[of], (3, 1)), moved)
    rays = trace_forward(
        lens.prescription,
        points,
        directions,
        targets.wavelength_nm,
        vertices_mm=lens.vertices_mm,
        clip=False,
        between=(0, lens.stop + 1),
    )
    met, by_x, by_y = rays.points_mm[lens.stop, :, :2].reshape(3, count, 2)
    return met, np.stack([by_x - met, by_y - met], axis=-1) / nudge


def _enter(
    lens: FocusedLens, nearness_per_mm: float, slopes: DoubleArray, pupil: DoubleArray
) -> tuple[DoubleArray, DoubleArray]:
    """Points on the plane of the front vertex, and unit directions, of rays from objects through points of the pupil's plane."""
    along = pupil * nearness_per_mm - slopes  # right and up for a step toward the film
    front = float(lens.vertices_mm[0])
    start = pupil + (front - lens.entrance_pupil_mm) * along
    points = np.concatenate([start, np.full((len(pupil), 1), front)], axis=1)
    directions = np.concatenate([along, np.ones((len(pupil), 1))], axis=1)
    return points, directions / np.sqrt((directions**2).sum(1))[:, None]


def trace_aimed(lens: FocusedLens, rays: AimedRays, wavelength_nm: float, *, clip: bool) -> TracedRays:
    """Trace aimed rays through the whole lens.

    Args:
        lens: as focused.
        rays: rays as they enter.
        wavelength_nm: of their light.
        clip: whether rims stop them, and the iris at its edge.
    """
    return trace_forward(
        lens.prescription,
        rays.points_mm,
        rays.directions,
        wavelength_nm,
        vertices_mm=lens.vertices_mm,
        stop_radius_mm=lens.stop_radius_mm * (1 + 10 * _SOLVED),
        clip=clip,
    )


def _correction(jacobian: DoubleArray, off: DoubleArray) -> DoubleArray:
    """``(n, 2)`` steps on the pupil that make up for misses on the stop, by Cramer's rule; 0 where there is none."""
    (a, b), (c, d) = jacobian.transpose(1, 2, 0)
    step = np.stack([d * off[:, 0] - b * off[:, 1], a * off[:, 1] - c * off[:, 0]], axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        step /= (a * d - b * c)[:, None]
    return np.where(np.isfinite(step), step, 0.0)
