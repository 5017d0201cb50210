"""Rays from places of the film through chosen points of the stop and out into the scene: Newton's method on the exact tracer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.optics.glass import D_LINE_NM
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.outlines import clearance
from render.optics.prescription.paraxial import paraxial_system, transfer
from render.optics.prescription.tracing import TracedRays, trace_backward

_STEPS = 6
_NUDGE = 0.02  # of the stop's radius, for derivatives
_MET = 1e-3  # of the stop's radius: how near to its point a ray passes


@dataclass(frozen=True, eq=False)
class StopRays:
    """Rays as they leave a lens; values of blocked rays are undefined.

    Attributes:
        slope: ``(n, 2)`` in object space, a step of x and y for one of depth.
        pupil_mm: ``(n, 2)`` where they cross the plane of the entrance pupil.
        front: ``(n,)`` clearance before the stop, (r / half clear diameter)² − 1 at its largest: above 0 a rim blocks.
        rear: the same behind the stop.
        passed: ``(n,)`` whether they get through at all, rims apart.
    """

    slope: DoubleArray
    pupil_mm: DoubleArray
    front: DoubleArray
    rear: DoubleArray
    passed: NDArray[np.bool_]


def rays_from_film(
    lens: FocusedLens, film_mm: DoubleArray, stops: DoubleArray, wavelength_nm: float = D_LINE_NM
) -> StopRays:
    """Trace the ray from each place of the film through the point of the stop beside it.

    Args:
        lens: as focused.
        film_mm: ``(n, 2)``.
        stops: ``(n, 2)`` in units of the stop's radius, in the same frame.
        wavelength_nm: of the light.
    """
    slopes, solved = _aim(lens, film_mm, stops * lens.stop_radius_mm, wavelength_nm)
    points, directions = _leave_film(lens, film_mm, slopes)
    rays = trace_backward(
        lens.prescription, points, directions, wavelength_nm, vertices_mm=lens.vertices_mm, clip=False
    )
    passed = rays.passes & solved
    with np.errstate(invalid="ignore"):
        leaving = -rays.directions[:, :2] / rays.directions[:, 2:]
    cleared = _clearance(lens, rays)
    behind = len(lens.vertices_mm) - 1 - lens.stop  # the rays meet the last surface first
    return StopRays(
        slope=np.where(passed[:, None], leaving, 0.0),
        pupil_mm=np.where(passed[:, None], rays.at(lens.entrance_pupil_mm), 0.0),
        front=np.where(passed, cleared[behind:].max(axis=0, initial=-1.0), 1.0),
        rear=np.where(passed, cleared[:behind].max(axis=0, initial=-1.0), 1.0),
        passed=passed,
    )


def _clearance(lens: FocusedLens, rays: TracedRays) -> DoubleArray:
    """``(k, n)`` of every surface in the order in which the rays met them; the iris is no rim here."""
    rims = np.array([surface.semi_diameter_mm for surface in lens.prescription.surfaces[::-1]])
    rims = np.where(rims > 0, rims, np.inf)
    rims[len(rims) - 1 - lens.stop] = np.inf
    cleared = (rays.points_mm[..., :2] ** 2).sum(axis=-1) / rims[:, None] ** 2 - 1
    for surface, points, stops in zip(lens.prescription.surfaces[::-1], rays.points_mm, cleared, strict=True):
        stops[:] = np.maximum(stops, clearance(surface, points[:, :2]))
    return np.asarray(cleared)


def _aim(
    lens: FocusedLens, film_mm: DoubleArray, stop_mm: DoubleArray, wavelength_nm: float
) -> tuple[DoubleArray, NDArray[np.bool_]]:
    """``(n, 2)`` slopes at the film, a step of x and y for one toward the scene, and whether rays meet their stop points."""
    system = paraxial_system(lens.prescription, wavelength_nm, lens.vertices_mm)
    (_, by_slope), (_, by_height) = transfer(system, lens.stop, len(lens.vertices_mm), to_mm=lens.film_mm)
    slopes = (stop_mm - by_height * film_mm) / by_slope
    nudge, count = _NUDGE * lens.stop_radius_mm / by_slope, len(film_mm)
    moved = np.repeat([[0.0, 0.0], [nudge, 0.0], [0.0, nudge]], count, axis=0)
    met, by_x, by_y = _on_stop(lens, np.tile(film_mm, (3, 1)), np.tile(slopes, (3, 1)) + moved, wavelength_nm).reshape(
        3, count, 2
    )
    dx, dy = (by_x - met) / nudge, (by_y - met) / nudge
    with np.errstate(divide="ignore", invalid="ignore"):
        for _ in range(_STEPS):  # the first derivative serves for all: the way from film to stop is nearly straight
            off = stop_mm - met
            det = dx[:, 0] * dy[:, 1] - dx[:, 1] * dy[:, 0]
            step = [off[:, 0] * dy[:, 1] - off[:, 1] * dy[:, 0], dx[:, 0] * off[:, 1] - dx[:, 1] * off[:, 0]]
            slopes = slopes + np.stack(step, axis=1) / det[:, None]
            met = _on_stop(lens, film_mm, slopes, wavelength_nm)
            if np.nanmax(np.abs(stop_mm - met), initial=0.0) < _MET * lens.stop_radius_mm / 10:
                break
        return slopes, np.hypot(*(stop_mm - met).T) < _MET * lens.stop_radius_mm


def _on_stop(lens: FocusedLens, film_mm: DoubleArray, slopes: DoubleArray, wavelength_nm: float) -> DoubleArray:
    """Points ``(n, 2)`` of rays from the film in the plane of the stop's vertex; NaN for rays that do not reach it."""
    points, directions = _leave_film(lens, film_mm, slopes)
    stop_mm, behind = float(lens.vertices_mm[lens.stop]), (lens.stop + 1, len(lens.vertices_mm))
    if behind[0] == behind[1]:
        return np.asarray(film_mm + slopes * (lens.film_mm - stop_mm))
    rays = trace_backward(
        lens.prescription,
        points,
        directions,
        wavelength_nm,
        vertices_mm=lens.vertices_mm,
        clip=False,
        between=behind,
    )
    return rays.at(stop_mm)


def _leave_film(lens: FocusedLens, film_mm: DoubleArray, slopes: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    points = np.concatenate([film_mm, np.full((len(film_mm), 1), lens.film_mm)], axis=1)
    directions = np.concatenate([slopes, np.full((len(slopes), 1), -1.0)], axis=1)
    return points, directions / np.sqrt((directions**2).sum(axis=1))[:, None]
