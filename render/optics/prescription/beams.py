"""Beams of light that fill the iris: from a point on the axis, and from far off it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.errors import InputError
from render.model.arrays import DoubleArray
from render.model.lens import Prescription
from render.optics.glass import D_LINE_NM
from render.optics.prescription.paraxial import entrance_pupil, paraxial_system, stop_index, vertices
from render.optics.prescription.tracing import PASSES, TracedRays, trace_backward, trace_forward

_RINGS = 32
_TRIALS = 33
_ROUNDS = 4
_WIDEST_TRIAL = 1.6  # times the paraxial pupil: the aberrations of a pupil do not reach so far
_GRAZING = 1 + 1e-6  # the grazing ray is known to that
_STEEPEST_CHIEF = 2.0
_SECANTS = 12


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
        pupil_heights: ``(n,)`` where the rays go through the entrance pupil: 0 its centre, 1 the ray that grazes the iris (or
            the last one that gets to it).
        stop_radius_mm: of the iris.
        wavelength_nm: of the light.
        vertices_mm: ``(k,)`` where the surfaces stand, if not where the thicknesses put them.
        clip: whether rims and iris stop rays.

    Raises:
        InputError: no ray but the axis itself gets to the iris.
    """
    placed = vertices(prescription) if vertices_mm is None else vertices_mm
    stop = stop_index(prescription)
    pupil_mm, magnification = entrance_pupil(paraxial_system(prescription, wavelength_nm, placed), stop)

    def traced(heights_mm: DoubleArray, end: int, clipped: bool) -> TracedRays:
        points, directions = _rays_from_axis(object_mm, pupil_mm, heights_mm, float(placed[0]))
        return trace_forward(
            prescription,
            points,
            directions,
            wavelength_nm,
            vertices_mm=placed,
            stop_radius_mm=stop_radius_mm * _GRAZING,
            clip=clipped,
            between=(0, end),
        )

    low, high = 0.0, _WIDEST_TRIAL * stop_radius_mm * abs(magnification)
    for _ in range(_ROUNDS):
        heights = np.linspace(low, high, _TRIALS)
        inside = np.abs(traced(heights, stop + 1, False).points_mm[stop, :, 1]) <= stop_radius_mm
        outside = int(np.argmin(inside)) if not inside.all() else _TRIALS - 1
        low, high = float(heights[max(outside - 1, 0)]), float(heights[outside])
    if low == 0:
        lost = int(traced(np.array([high]), stop + 1, False).stopped_by[0])
        raise _dark(prescription, stop if lost == PASSES else lost)
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
        raise _dark(prescription, int(beam.stopped_by[0]))
    last, slopes = beam.points_mm[-1][beam.passes], (beam.directions[:, 1] / beam.directions[:, 2])[beam.passes]
    crossing = last[:, 1] - last[:, 2] * slopes
    return float(-np.sum(crossing * slopes) / np.sum(slopes * slopes))


def _dark(prescription: Prescription, surface: int) -> InputError:
    what = f"no light from the axis comes through {prescription.name or 'the lens'}: surface {surface + 1} stops it"
    return InputError(what, code="bad_lens")


@dataclass(frozen=True, eq=False)
class ObliqueBeam:
    """Rays in the y-z plane from one far point off the axis; rims are ignored.

    Attributes:
        image_height_mm: where its chief ray meets the film, as a distance from the axis.
        slope: dy/dz of all its rays in object space.
        heights_mm: ``(k, n)`` at each surface, of each ray; NaN for rays that do not get through.
    """

    image_height_mm: float
    slope: float
    heights_mm: DoubleArray


def oblique_beam(prescription: Prescription, image_height_mm: float, stop_heights_mm: DoubleArray) -> ObliqueBeam:
    """The beam whose chief ray lands at an image height, or as near to it as light gets through the glass.

    Args:
        prescription: with a stop and a back focal distance.
        image_height_mm: distance from the axis on the film.
        stop_heights_mm: ``(n,)`` where the rays cross the plane of the stop's vertex; the chief ray does at 0.
    """
    chief = _chief_slope(prescription, image_height_mm)
    zero = np.zeros(1)
    _, target, landing = _through_stop(prescription, zero, zero + chief)
    slopes, before = np.full(len(stop_heights_mm), chief), np.full(len(stop_heights_mm), chief * (1 - 1e-3) - 1e-4)
    off_before = _through_stop(prescription, stop_heights_mm, before)[1] - target
    for _ in range(_SECANTS):  # all rays leave toward the same point: each has its own slope at the stop
        off = _through_stop(prescription, stop_heights_mm, slopes)[1] - target
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(off == off_before, 0.0, off * (slopes - before) / (off - off_before))
        before, off_before, slopes = slopes, off, slopes - step
    heights, _, _ = _through_stop(prescription, stop_heights_mm, slopes)
    return ObliqueBeam(float(abs(landing[0])), float(target[0]), heights)


def _chief_slope(prescription: Prescription, image_height_mm: float) -> float:
    """Slope at the stop's centre of the ray that lands at the height, or of the steepest that gets through."""
    low, high = 0.0, _STEEPEST_CHIEF
    for _ in range(_ROUNDS):
        slopes = np.linspace(low, high, _TRIALS)
        _, _, landing = _through_stop(prescription, np.zeros(_TRIALS), slopes)
        short = np.abs(landing) < image_height_mm  # NaN, for a ray that is lost, is not short
        beyond = int(np.argmin(short)) if not short.all() else _TRIALS - 1
        low, high = float(slopes[max(beyond - 1, 0)]), float(slopes[beyond])
    return low


def _through_stop(
    prescription: Prescription, stop_heights_mm: DoubleArray, slopes: DoubleArray
) -> tuple[DoubleArray, DoubleArray, DoubleArray]:
    """Trace rays both ways from the stop.

    Returns:
        ``(k, n)`` heights at each surface, ``(n,)`` slopes in object space, ``(n,)`` heights on the film; NaN for lost rays.
    """
    stop, placed = stop_index(prescription), vertices(prescription)
    count = len(prescription.surfaces)
    points = np.stack([0 * slopes, stop_heights_mm, placed[stop] + 0 * slopes], axis=1)
    directions = np.stack([0 * slopes, slopes, 1 + 0 * slopes], axis=1)
    directions /= np.sqrt(1 + slopes**2)[:, None]
    forward = trace_forward(prescription, points, directions, clip=False, between=(stop, count))
    backward = trace_backward(prescription, points, -directions, clip=False, between=(0, stop))
    heights = np.concatenate([backward.points_mm[::-1, :, 1], forward.points_mm[:, :, 1]])
    heights[:, ~(forward.passes & backward.passes)] = np.nan
    film = forward.at(float(placed[-1]) + prescription.surfaces[-1].thickness_mm)[:, 1]
    return heights, backward.directions[:, 1] / backward.directions[:, 2], np.where(backward.passes, film, np.nan)


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
