"""F-numbers of a prescription: of its real beam, and of its paraxial pupil.

The f-number of a lens is its focal length over the diameter of the beam along the axis that gets through iris and rims:
``N = f / (2·h)``, h the height at which the real marginal ray of the d line enters, parallel to the axis. In a lens without
spherical aberration and coma that is ``1 / (2·sin u′)`` (Welford 1986, ch. 6). The paraxial pupil, the image of the iris by rays
close to the axis, gives another number where what stands before the iris has spherical aberration.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import Prescription
from render.optics.prescription.beams import axial_edge
from render.optics.prescription.paraxial import (
    entrance_pupil,
    focal_points,
    paraxial_system,
    stop_index,
)
from render.optics.prescription.tracing import trace_forward


def f_number(prescription: Prescription, stop_radius_mm: float, *, clip: bool = True) -> float:
    """F-number of the real beam that an iris lets through; infinite where no light gets through the rims.

    Args:
        prescription: with a stop; focused at infinity.
        stop_radius_mm: of the iris.
        clip: whether rims other than the iris block rays.

    Raises:
        InputError: no ray but the axis itself gets to the iris.
    """
    glass = prescription if clip else without_rims(prescription)
    height_mm = axial_edge(glass, -math.inf, stop_radius_mm, clip=clip).height_mm
    return focal_length_mm(prescription) / (2 * height_mm) if height_mm > 0 else math.inf


@lru_cache(maxsize=256)
def widest_f_number(prescription: Prescription) -> float:
    """F-number of the real beam with the iris wide open.

    Args:
        prescription: complete; focused at infinity.
    """
    return f_number(prescription, prescription.surfaces[stop_index(prescription)].semi_diameter_mm)


def iris_radius_mm(prescription: Prescription, f_stop: float) -> float:
    """Radius of the iris that the real marginal ray of an f-number grazes; infinite where that ray does not get to it.

    Args:
        prescription: with a stop, of whatever diameter; focused at infinity.
        f_stop: f-number.
    """
    stop = stop_index(prescription)
    point, direction = np.array([[0.0, marginal_height_mm(prescription, f_stop), 0.0]]), np.array([[0.0, 0.0, 1.0]])
    ray = trace_forward(without_rims(prescription), point, direction, clip=False, between=(0, stop + 1))
    radius = abs(float(ray.points_mm[stop, 0, 1]))
    return radius if math.isfinite(radius) else math.inf


def without_rims(prescription: Prescription) -> Prescription:
    """Prescription whose aspheres are known as far as their formula goes: with a rim, rays beyond it miss them."""
    surfaces = tuple(
        replace(surface, semi_diameter_mm=0.0) if surface.is_aspheric or surface.across else surface
        for surface in prescription.surfaces
    )
    return replace(prescription, surfaces=surfaces)


def marginal_height_mm(prescription: Prescription, f_stop: float) -> float:
    """Height at which the marginal ray of an f-number enters, parallel to the axis: ``f / (2·N)``."""
    return focal_length_mm(prescription) / (2 * f_stop)


def paraxial_f_number(prescription: Prescription, stop_radius_mm: float) -> float:
    """Focal length over the diameter of the paraxial entrance pupil."""
    system = paraxial_system(prescription)
    _, magnification = entrance_pupil(system, stop_index(prescription))
    return focal_length_mm(prescription) / (2 * stop_radius_mm * abs(magnification))


def working_f_number(
    prescription: Prescription, object_mm: float, stop_radius_mm: float, vertices_mm: DoubleArray
) -> float:
    """F-number as focused, ``1 / (2·sin u′)`` with u′ the angle of the real marginal ray behind the lens.

    Args:
        prescription: with a stop.
        object_mm: z of the object on the axis; minus infinity is infinity.
        stop_radius_mm: of the iris.
        vertices_mm: ``(n,)`` where the surfaces stand.

    Raises:
        InputError: no ray but the axis itself gets to the iris.
    """
    sine = axial_edge(prescription, object_mm, stop_radius_mm, vertices_mm).sine
    return 1 / (2 * sine) if sine > 0 else math.inf


def focal_length_mm(prescription: Prescription) -> float:
    """Effective focal length at the d line, mm."""
    return focal_points(paraxial_system(prescription), prescription.name)[0]
