"""The beam of light that a point on the axis sends through a lens, and where it is sharpest."""

from __future__ import annotations

import numpy as np

from render.errors import InputError
from render.lens import DoubleArray, Prescription
from render.optics.glass import D_LINE_NM
from render.optics.paraxial import entrance_pupil, paraxial_system, stop_index, vertices
from render.optics.tracing import TracedRays, trace_forward

_RINGS = 32
_TRIALS = 33
_ROUNDS = 4
_WIDEST_TRIAL = 1.6  # times the paraxial pupil: the aberrations of a pupil do not reach so far


def axial_beam(
    prescription: Prescription,
    object_mm: float,
    pupil_heights: DoubleArray,
    stop_radius_mm: float,
    wavelength_nm: float = D_LINE_NM,
    *,
    vertices_mm: DoubleArray | None = None,
    clip: bool = True,
) -> TracedRays:
    """Rays in the y-z plane from a point on the axis, that fill the iris.

    Args:
        prescription: with a stop.
        object_mm: z of the point; minus infinity sends parallel light.
        pupil_heights: ``(n,)`` where the rays go through the entrance pupil: 0 its centre, 1 the ray that grazes the iris.
        stop_radius_mm: of the iris.
        wavelength_nm: of the light.
        vertices_mm: ``(k,)`` where the surfaces stand, if not where the thicknesses put them.
        clip: whether rims and iris stop rays.
    """
    placed = vertices(prescription) if vertices_mm is None else vertices_mm
    stop = stop_index(prescription)
    pupil_mm, magnification = entrance_pupil(paraxial_system(prescription, wavelength_nm, placed), stop)

    def traced(heights_mm: DoubleArray, end: int, clipped: bool) -> TracedRays:
        points, directions = _rays_from_axis(object_mm, pupil_mm, heights_mm, float(placed[0]))
        radius = stop_radius_mm * (1 + 1e-6)  # the grazing ray is known to that
        return trace_forward(
            prescription, points, directions, wavelength_nm,
            vertices_mm=placed, stop_radius_mm=radius, clip=clipped, between=(0, end),
        )  # fmt: skip

    low, high = 0.0, _WIDEST_TRIAL * stop_radius_mm * abs(magnification)
    for _ in range(_ROUNDS):
        heights = np.linspace(low, high, _TRIALS)
        inside = np.abs(traced(heights, stop + 1, False).points_mm[stop, :, 1]) <= stop_radius_mm
        last = int(np.argmin(inside)) - 1 if not inside.all() else _TRIALS - 2
        low, high = float(heights[max(last, 0)]), float(heights[max(last, 0) + 1])
    return traced(np.asarray(pupil_heights) * low, len(prescription.surfaces), clip)


def best_focus_mm(
    prescription: Prescription, object_mm: float, stop_radius_mm: float, vertices_mm: DoubleArray | None = None
) -> float:
    """z where the beam from a point on the axis has the least root-mean-square radius, at the d line.

    The rays stand at the middles of rings of equal area on the entrance pupil, so that each carries the same light. What a
    rim cuts off does not count.

    Raises:
        InputError: no ray gets through.
    """
    rings = np.sqrt((np.arange(_RINGS) + 0.5) / _RINGS)
    beam = axial_beam(prescription, object_mm, rings, stop_radius_mm, vertices_mm=vertices_mm)
    if not beam.passes.any():
        raise InputError(
            f"no light on the axis of {prescription.name or 'the lens'} comes through: surface {beam.stopped_by[0] + 1} stops it",
            code="bad_lens",
        )
    last, slopes = beam.points_mm[-1][beam.passes], (beam.directions[:, 1] / beam.directions[:, 2])[beam.passes]
    crossing = last[:, 1] - last[:, 2] * slopes
    return float(-np.sum(crossing * slopes) / np.sum(slopes * slopes))


def _rays_from_axis(
    object_mm: float, pupil_mm: float, heights_mm: DoubleArray, front_mm: float
) -> tuple[DoubleArray, DoubleArray]:
    """Points and unit directions of rays from a point on the axis to heights in the plane of the entrance pupil."""
    points, directions = np.zeros((len(heights_mm), 3)), np.zeros((len(heights_mm), 3))
    directions[:, 2] = 1
    if np.isfinite(object_mm):
        directions[:, 1] = heights_mm / (pupil_mm - object_mm)
        points[:, 1], points[:, 2] = directions[:, 1] * (front_mm - object_mm), front_mm
    else:
        points[:, 1], points[:, 2] = heights_mm, front_mm
    return points, directions / np.sqrt((directions**2).sum(1))[:, None]
