"""Seidel sums: a lens's errors to third order, surface by surface, from two paraxial rays (Welford 1986, ch. 8 and 10).

They say which surface makes which error, and how the errors grow with the aperture and the field; for pictures, rays are traced.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import Prescription, Surface
from render.optics.glass import C_LINE_NM, F_LINE_NM
from render.optics.prescription.paraxial import (
    ParaxialRay,
    ParaxialSystem,
    entrance_pupil,
    focal_points,
    paraxial_ray,
    paraxial_system,
    stop_index,
)
from render.optics.prescription.surface_shape import curvature


@dataclass(frozen=True, eq=False)
class SeidelSums:
    """Each surface's share of the errors of a lens focused at infinity, as optical path in mm; a lens's error is the sum.

    With ρ the pupil's radius and η the image height, both 1 at their fullest, and φ the angle from the tangential plane, the
    wavefront is ``W = S_I/8·ρ⁴ + S_II/2·η·ρ³·cos φ + S_III/2·η²·ρ²·cos² φ + (S_III + S_IV)/4·η²·ρ² + S_V/2·η³·ρ·cos φ``.

    Attributes:
        spherical: ``(n,)`` S_I.
        coma: ``(n,)`` S_II.
        astigmatism: ``(n,)`` S_III.
        petzval: ``(n,)`` S_IV, field curvature.
        distortion: ``(n,)`` S_V.
        axial_colour: ``(n,)`` C_I, between the lines F and C.
        lateral_colour: ``(n,)`` C_II, lateral colour.
    """

    spherical: DoubleArray
    coma: DoubleArray
    astigmatism: DoubleArray
    petzval: DoubleArray
    distortion: DoubleArray
    axial_colour: DoubleArray
    lateral_colour: DoubleArray


def seidel_sums(prescription: Prescription, f_stop: float, image_height_mm: float) -> SeidelSums:
    """The Seidel sums of a lens focused at infinity, at the d line.

    Args:
        prescription: with a stop.
        f_stop: at whose pupil's edge the sums hold.
        image_height_mm: for which they hold; paraxial, positive.

    Raises:
        InputError: the prescription has no stop, or no focal length.
    """
    system = paraxial_system(prescription)
    focal_mm = focal_points(system, prescription.name)[0]
    pupil_mm, _ = entrance_pupil(system, stop_index(prescription))
    marginal = paraxial_ray(system, pupil_mm, focal_mm / (2 * f_stop), 0.0)
    chief = paraxial_ray(system, pupil_mm, 0.0, image_height_mm / focal_mm)
    lines = (paraxial_system(prescription, line).indices for line in (F_LINE_NM, C_LINE_NM))
    return third_order(system, marginal, chief, fourth_power_terms(prescription.surfaces), np.subtract(*lines))


def third_order(
    system: ParaxialSystem,
    marginal: ParaxialRay,
    chief: ParaxialRay,
    departures: DoubleArray,
    dispersions: DoubleArray,
) -> SeidelSums:
    """The sums from a marginal and a chief ray.

    Args:
        system: the lens, at the d line.
        marginal: ray from the axial object point by the edge of the pupil.
        chief: ray from the edge of the field by the middle of the pupil.
        departures: ``(n,)`` of `fourth_power_terms`.
        dispersions: ``(n + 1,)`` index at the F line less that at the C line, before the first surface and behind each.
    """
    n, c, y, y_chief = system.indices, system.curvatures, marginal.heights_mm, chief.heights_mm
    a = n[:-1] * (marginal.slopes[:-1] + y * c)  # refraction invariants n·i of the two rays
    b = n[:-1] * (chief.slopes[:-1] + y_chief * c)
    lagrange = a * y_chief - b * y
    bend, step, step_squared = np.diff(marginal.slopes / n), np.diff(1 / n), np.diff(1 / n**2)
    colour = np.diff(dispersions / n)
    aspheric = 8 * departures * np.diff(n)
    return SeidelSums(
        spherical=-a * a * y * bend + aspheric * y**4,
        coma=-a * b * y * bend + aspheric * y**3 * y_chief,
        astigmatism=-b * b * y * bend + aspheric * y**2 * y_chief**2,
        petzval=-(lagrange**2) * c * step,
        # (b/a)·(S_III + S_IV), written so that it holds where a is 0
        distortion=-b * (b * b * y * step_squared - c * step * y_chief * (b * y - lagrange))
        + aspheric * y * y_chief**3,
        axial_colour=a * y * colour,
        lateral_colour=b * y * colour,
    )


def fourth_power_terms(surfaces: tuple[Surface, ...]) -> DoubleArray:
    """``(n,)`` coefficient of r⁴ by which each surface departs from the sphere that touches its vertex, 1/mm³.

    Third-order theory has no place for odd powers; they are left out.
    """
    own = [s.aspheric[0] if s.aspheric and s.torus != "across" else 0.0 for s in surfaces]
    terms = [s.conic * curvature(s) ** 3 / 8 + term for s, term in zip(surfaces, own, strict=True)]
    return np.array(terms)
