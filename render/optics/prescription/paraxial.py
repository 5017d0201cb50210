"""First-order optics of a prescription: focal length, principal planes, pupils, Petzval sum.

Light is traced close to the axis by ray-transfer matrices on ``(y, n·u)``: height and slope times index (Welford 1986, ch. 3).
Places are z in millimetres along the axis, growing from the scene to the film, 0 at the vertex of the front surface.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from render.errors import InputError
from render.model.arrays import DoubleArray
from render.model.lens import Prescription
from render.optics.glass import D_LINE_NM, refractive_index
from render.optics.prescription.diffraction import power_per_mm


@dataclass(frozen=True)
class FirstOrder:
    """First-order properties of a lens at one wavelength, in air.

    Attributes:
        focal_length_mm: effective focal length; positive where parallel light converges.
        back_focal_mm: from the vertex of the rear surface to the rear focal point.
        front_focal_mm: z of the front focal point.
        front_principal_mm: z of the front principal plane.
        rear_principal_mm: z of the rear principal plane.
        entrance_pupil_mm: z of the entrance pupil: the stop's image through what stands before it.
        entrance_pupil_magnification: diameter of the entrance pupil over that of the stop, negative where it is inverted.
        exit_pupil_mm: z of the exit pupil: the stop's image through what stands behind it; infinite for a telecentric lens.
        exit_pupil_magnification: diameter of the exit pupil over that of the stop.
        petzval_sum: in 1/mm; the Petzval surface has the radius ``−1/petzval_sum`` (Welford 1986, ch. 8).
        length_mm: from the vertex of the front surface to that of the rear one.
    """

    focal_length_mm: float
    back_focal_mm: float
    front_focal_mm: float
    front_principal_mm: float
    rear_principal_mm: float
    entrance_pupil_mm: float
    entrance_pupil_magnification: float
    exit_pupil_mm: float
    exit_pupil_magnification: float
    petzval_sum: float
    length_mm: float


@dataclass(frozen=True, eq=False)
class ParaxialSystem:
    """Paraxial system of a prescription at one wavelength.

    Attributes:
        curvatures: ``(n,)`` at the vertices, 1/mm.
        vertices_mm: ``(n,)`` z of the vertices.
        indices: ``(n + 1,)`` refractive index before the first surface and behind each.
        by_diffraction: ``(n,)`` power that each surface has by the phase that it adds, 1/mm.
    """

    curvatures: DoubleArray
    vertices_mm: DoubleArray
    indices: DoubleArray
    by_diffraction: DoubleArray

    @cached_property
    def powers(self) -> DoubleArray:
        """Power of each surface ``(n,)``, ``(n' − n)·c`` and that by diffraction, in 1/mm."""
        return self.by_refraction + self.by_diffraction

    @property
    def by_refraction(self) -> DoubleArray:
        """Power of each surface ``(n,)`` without its diffraction, which alone bends the image, in 1/mm."""
        return np.diff(self.indices) * self.curvatures


@dataclass(frozen=True, eq=False)
class ParaxialRay:
    """Paraxial ray.

    Attributes:
        heights_mm: ``(n,)`` at each surface.
        slopes: ``(n + 1,)`` dy/dz before the first surface and behind each.
    """

    heights_mm: DoubleArray
    slopes: DoubleArray


def vertices(prescription: Prescription) -> DoubleArray:
    """z of each surface's vertex ``(n,)``, mm, 0 at the front."""
    thicknesses = [surface.thickness_mm for surface in prescription.surfaces]
    return np.concatenate([[0.0], np.cumsum(thicknesses[:-1])])


def paraxial_system(
    prescription: Prescription, wavelength_nm: float = D_LINE_NM, vertices_mm: DoubleArray | None = None
) -> ParaxialSystem:
    """Make the paraxial system of a prescription.

    Args:
        prescription: need not be complete.
        wavelength_nm: of the light.
        vertices_mm: ``(n,)`` where the surfaces stand, if not where the thicknesses put them.
    """
    surfaces = prescription.surfaces
    return ParaxialSystem(
        np.array([1 / surface.radius_mm if surface.radius_mm else 0.0 for surface in surfaces]),
        vertices(prescription) if vertices_mm is None else vertices_mm,
        np.array([1.0, *(refractive_index(surface.glass, wavelength_nm) for surface in surfaces)]),
        np.array([power_per_mm(surface, wavelength_nm) for surface in surfaces]),
    )


def paraxial_ray(system: ParaxialSystem, z_mm: float, height_mm: float, slope: float) -> ParaxialRay:
    """Trace a ray near the axis that has the given height at ``z_mm`` and the given slope, in object space."""
    heights, slopes = np.empty(len(system.powers)), np.empty(len(system.powers) + 1)
    slopes[0], y, z = slope, height_mm, z_mm
    for i, (power, vertex) in enumerate(zip(system.powers, system.vertices_mm, strict=True)):
        y += (vertex - z) * slopes[i]
        heights[i], z = y, vertex
        slopes[i + 1] = (system.indices[i] * slopes[i] - power * y) / system.indices[i + 1]
    return ParaxialRay(heights, slopes)


def first_order(prescription: Prescription, wavelength_nm: float = D_LINE_NM) -> FirstOrder:
    """First-order properties of a lens in air.

    Args:
        prescription: one of its surfaces must be the stop; clear diameters and back focus may be missing.
        wavelength_nm: of the light.

    Raises:
        InputError: the prescription has no stop, or no focal length.
    """
    system = paraxial_system(prescription, wavelength_nm)
    stop = stop_index(prescription)
    focal, back, front = focal_points(system, prescription.name)
    length = float(system.vertices_mm[-1])
    entrance, entrance_scale = entrance_pupil(system, stop)
    exit_, exit_scale = exit_pupil(system, stop)
    return FirstOrder(
        focal_length_mm=focal,
        back_focal_mm=back,
        front_focal_mm=front,
        front_principal_mm=front + focal,
        rear_principal_mm=length + back - focal,
        entrance_pupil_mm=entrance,
        entrance_pupil_magnification=entrance_scale,
        exit_pupil_mm=exit_,
        exit_pupil_magnification=exit_scale,
        petzval_sum=float(np.sum(system.by_refraction / (system.indices[:-1] * system.indices[1:]))),
        length_mm=length,
    )


def stop_index(prescription: Prescription) -> int:
    """Index of the aperture stop.

    Raises:
        InputError: no surface is the stop.
    """
    for index, surface in enumerate(prescription.surfaces):
        if surface.is_stop:
            return index
    raise InputError(f"no surface of {prescription.name or 'the lens'} is its aperture stop", code="bad_lens")


def focal_points(system: ParaxialSystem, name: str = "") -> tuple[float, float, float]:
    """Focal length, back focal distance from the rear vertex, and z of the front focal point, all in mm.

    Raises:
        InputError: parallel light stays parallel.
    """
    (a, _), (c, d) = transfer(system, 0, len(system.powers))
    if abs(c) < 1e-12:
        raise InputError(
            f"{name or 'the lens'} has no focal length: parallel light leaves it parallel", code="bad_lens"
        )
    return -1 / c, -a / c, float(system.vertices_mm[0]) + d / c


def entrance_pupil(system: ParaxialSystem, stop: int) -> tuple[float, float]:
    """z of the entrance pupil in mm, and its diameter over that of the stop; infinite where no such image exists."""
    (a, b), _ = transfer(system, 0, stop, to_mm=float(system.vertices_mm[stop]))
    return (float(system.vertices_mm[0]) + b / a, 1 / a) if a else (np.inf, np.inf)


def exit_pupil(system: ParaxialSystem, stop: int) -> tuple[float, float]:
    """z of the exit pupil in mm, and its diameter over that of the stop; infinite where no such image exists."""
    (_, b), (_, d) = transfer(system, stop, len(system.powers))
    return (float(system.vertices_mm[-1]) - b / d, 1 / d) if d else (np.inf, np.inf)


def transfer(
    system: ParaxialSystem, start: int, end: int, to_mm: float | None = None
) -> tuple[tuple[float, float], ...]:
    """Ray-transfer matrix on ``(y, n·u)``, from just before surface ``start`` to just behind surface ``end − 1``.

    Args:
        system: the lens.
        start: first surface that refracts.
        end: one past the last surface that refracts.
        to_mm: goes on to this z behind the last surface.

    Returns:
        ``((a, b), (c, d))`` of determinant 1.
    """
    places, powers, indices = (array.tolist() for array in (system.vertices_mm, system.powers, system.indices))
    a, b, c, d, z = 1.0, 0.0, 0.0, 1.0, places[start]
    for i in range(start, end):
        step = (places[i] - z) / indices[i]
        a, b = a + step * c, b + step * d
        c, d = c - powers[i] * a, d - powers[i] * b
        z = places[i]
    if to_mm is not None:
        step = (to_mm - z) / indices[end]
        a, b = a + step * c, b + step * d
    return (a, b), (c, d)
