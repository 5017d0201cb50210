"""Beams of light that fill the iris: from a point on the axis, and from far off it.

Openings and obscurations take light out of a beam without making it narrower, as glass does that is not quite clear: they change
no f-number, and no beam here but in the choice of the best focus.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.errors import InputError
from render.model.arrays import DoubleArray
from render.model.lens import Prescription
from render.optics.glass import D_LINE_NM
from render.optics.prescription.outlines import without_outlines
from render.optics.prescription.paraxial import entrance_pupil, paraxial_system, stop_index, vertices
from render.optics.prescription.tracing import PASSES, TracedRays, trace_backward, trace_forward

_RINGS = 32
_TRIALS = 33
_ROUNDS = 4
_EDGE_TRIALS, _EDGE_ROUNDS = (
    1025,
    2,
)  # as fine as four rounds of 33, and a long row of rays costs hardly more than a short one
_RIM_ROUNDS = 5
_WIDEST_TRIAL = 1.6  # times the paraxial pupil: the aberrations of a pupil do not reach so far
_GRAZING = 1 + 1e-6  # the grazing ray is known to that
_STEEPEST_CHIEF = 2.0
_SECANTS = 12


@dataclass(frozen=True, eq=False)
class _AxialRays:
    """Rays in the y-z plane from a point on the axis, by their heights in the plane of the entrance pupil."""

    prescription: Prescription
    object_mm: float
    stop_radius_mm: float
    wavelength_nm: float
    vertices_mm: DoubleArray
    stop: int
    pupil_mm: float
    magnification: float
    outlined: Prescription

    @classmethod
    def make(
        cls,
        prescription: Prescription,
        object_mm: float,
        stop_radius_mm: float,
        wavelength_nm: float,
        vertices_mm: DoubleArray | None,
    ) -> _AxialRays:
        placed = vertices(prescription) if vertices_mm is None else vertices_mm
        stop = stop_index(prescription)
        pupil_mm, magnification = entrance_pupil(paraxial_system(prescription, wavelength_nm, placed), stop)
        plain = without_outlines(prescription)
        return cls(plain, object_mm, stop_radius_mm, wavelength_nm, placed, stop, pupil_mm, magnification, prescription)

    def trace(self, heights_mm: DoubleArray, end: int, clip: bool, *, outlined: bool = False) -> TracedRays:
        """Trace rays from the front up to surface ``end − 1``; without openings and obscurations, unless they are asked for."""
        points, directions = _rays_from_axis(self.object_mm, self.pupil_mm, heights_mm, float(self.vertices_mm[0]))
        return trace_forward(
            self.outlined if outlined else self.prescription,
            points,
            directions,
            self.wavelength_nm,
            vertices_mm=self.vertices_mm,
            stop_radius_mm=self.stop_radius_mm * _GRAZING,
            clip=clip,
            between=(0, end),
        )

    def grazing_mm(self) -> float:
        """Height of the ray that grazes the iris, or of the last one that gets to it, whatever rims say.

        Raises:
            InputError: no ray but the axis itself gets to the iris.
        """
        low, high, at_low, at_high = 0.0, _WIDEST_TRIAL * self.stop_radius_mm * abs(self.magnification), 0.0, np.inf
        for _ in range(_EDGE_ROUNDS):
            heights = np.linspace(low, high, _EDGE_TRIALS)
            met = np.abs(self.trace(heights, self.stop + 1, False).points_mm[self.stop, :, 1])
            inside = met <= self.stop_radius_mm
            outside = int(np.argmin(inside)) if not inside.all() else _EDGE_TRIALS - 1
            before = max(outside - 1, 0)
            low, high = float(heights[before]), float(heights[outside])
            at_low, at_high = float(met[before]), float(met[outside])
        if low == 0:
            lost = int(self.trace(np.array([high]), self.stop + 1, False).stopped_by[0])
            raise _dark(self.prescription, self.stop if lost == PASSES else lost)
        if at_low < self.stop_radius_mm < at_high:  # NaN, for a ray that is lost, is not beyond the iris
            low += (high - low) * (self.stop_radius_mm - at_low) / (at_high - at_low)
        return low

    def open_mm(self) -> float:
        """Height of the outermost ray up to which all get through iris and rims; 0 where the axis itself is blocked."""
        low, high, count = 0.0, self.grazing_mm(), len(self.prescription.surfaces)
        if self.trace(np.linspace(0.0, high, _TRIALS), count, True).passes.all():
            return high
        for _ in range(_RIM_ROUNDS):
            heights = np.linspace(low, high, _TRIALS)
            blocked = int(np.argmin(self.trace(heights, count, True).passes))
            low, high = float(heights[max(blocked - 1, 0)]), float(heights[blocked])
        return low


@dataclass(frozen=True)
class AxialEdge:
    """The marginal ray: the outermost one from a point on the axis that gets through.

    Attributes:
        height_mm: where it crosses the plane of the entrance pupil; 0 where no ray gets through.
        sine: of its angle to the axis behind the lens; 0 where no ray gets through.
    """

    height_mm: float
    sine: float


def axial_edge(
    prescription: Prescription,
    object_mm: float,
    stop_radius_mm: float,
    vertices_mm: DoubleArray | None = None,
    *,
    clip: bool = True,
) -> AxialEdge:
    """Find the marginal ray of a point on the axis, at the d line.

    Args:
        prescription: with a stop.
        object_mm: z of the point; minus infinity sends parallel light.
        stop_radius_mm: of the iris.
        vertices_mm: ``(k,)`` where the surfaces stand, if not where the thicknesses put them.
        clip: whether rims other than the iris block rays.

    Raises:
        InputError: no ray but the axis itself gets to the iris.
    """
    rays = _AxialRays.make(prescription, object_mm, stop_radius_mm, D_LINE_NM, vertices_mm)
    height_mm = rays.open_mm() if clip else rays.grazing_mm()
    if height_mm == 0:
        return AxialEdge(0.0, 0.0)
    sine = rays.trace(np.array([height_mm]), len(prescription.surfaces), False).directions[0, 1]
    return AxialEdge(height_mm, abs(float(np.nan_to_num(sine))))


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
    rays = _AxialRays.make(prescription, object_mm, stop_radius_mm, wavelength_nm, vertices_mm)
    return rays.trace(np.asarray(pupil_heights) * rays.grazing_mm(), len(prescription.surfaces), clip)


def best_focus_mm(
    prescription: Prescription, object_mm: float, stop_radius_mm: float, vertices_mm: DoubleArray | None = None
) -> float:
    """z where the beam from a point on the axis has the least root-mean-square radius, at the d line.

    The rays stand at the middles of rings of equal area on the entrance pupil, so that each carries the same light. What a
    rim cuts off does not count, nor what openings and obscurations stop above and below the axis.

    Raises:
        InputError: no ray gets through.
    """
    rings = np.sqrt((np.arange(_RINGS) + 0.5) / _RINGS)
    rays = _AxialRays.make(prescription, object_mm, stop_radius_mm, D_LINE_NM, vertices_mm)
    heights, count = rings * rays.grazing_mm(), len(prescription.surfaces)
    beam = rays.trace(heights, count, True)
    if not beam.passes.any():
        raise _dark(prescription, int(beam.stopped_by[0]))
    light = beam.passes.astype(np.float64)
    if prescription.outlines:
        both = np.array([rays.trace(side * heights, count, True, outlined=True).passes for side in (1, -1)])
        light = both.mean(axis=0) if both.any() else light
    last, slopes = beam.points_mm[-1][beam.passes], (beam.directions[:, 1] / beam.directions[:, 2])[beam.passes]
    crossing, light = last[:, 1] - last[:, 2] * slopes, light[beam.passes]
    return float(-np.sum(light * crossing * slopes) / np.sum(light * slopes * slopes))


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
