"""Diffractive surfaces by the phase that they add: all light goes into one order.

The phase φ turns a ray as if its tangential part had a momentum more: n'·s' and n·s + (λ/2π)·∇φ are the same along the surface
(Welford 1986, ch. 5, on gratings; Wang et al. 1997, Optical Engineering 36, 3). It holds both ways along a ray.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.lens import Surface
from render.optics.prescription.surface_shape import slopes_at


def phase_at(surface: Surface, points: DoubleArray) -> DoubleArray:
    """Phase ``(n,)`` in radians that a surface adds at points ``(n, 2)``."""
    r2 = (points**2).sum(axis=-1)
    total = np.zeros_like(r2)
    for term in reversed(surface.phase):
        total = (total + term) * r2
    return np.asarray(total)


def phase_slopes(surface: Surface, points: DoubleArray) -> DoubleArray:
    """Derivatives ``(n, 2)`` of the phase by x and y, radians per mm."""
    r2 = (points**2).sum(axis=-1)
    total = np.zeros_like(r2)
    for power in range(len(surface.phase), 0, -1):
        total = total * r2 + power * surface.phase[power - 1]
    return np.asarray(2 * points * total[..., None])


def reduced_mm(wavelength_nm: float | DoubleArray) -> float | DoubleArray:
    """Wavelength over 2π, mm."""
    return wavelength_nm * (1e-6 / (2 * np.pi))


def power_per_mm(surface: Surface, wavelength_nm: float) -> float:
    """Power near the axis that a surface has by its phase: −(λ/π)·P_1."""
    return -2 * float(reduced_mm(wavelength_nm)) * surface.phase[0] if surface.phase else 0.0


def diffract(
    surface: Surface,
    local: DoubleArray,
    directions: DoubleArray,
    ratio: float | DoubleArray,
    reduced: float | DoubleArray,
) -> tuple[DoubleArray, NDArray[np.bool_]]:
    """Refract rays at a diffractive surface; arguments as of `render.optics.prescription.tracing.refract`.

    Args:
        surface: which the rays have met.
        local: ``(n, 3)`` where, relative to its vertex.
        directions: ``(n, 3)`` unit vectors.
        ratio: index that the rays come from over the one that they go into, ``()`` or ``(n,)``.
        reduced: wavelength in the medium that they go into, over 2π, mm, ``()`` or ``(n,)``.

    Returns:
        ``(n, 3)`` unit vectors, and ``(n,)`` whether the ray goes on: beyond that the order does not exist.
    """
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        slopes = slopes_at(surface, local[:, :2])
        normal = np.concatenate([-slopes, np.ones((len(slopes), 1))], axis=1)
        normal /= np.sqrt((normal**2).sum(axis=1))[:, None]
        going = directions * np.asarray(ratio)[..., None]
        going[:, :2] += np.asarray(reduced)[..., None] * phase_slopes(surface, local[:, :2])
        along = (going * normal).sum(axis=1)
        squared = 1 - (going**2).sum(axis=1) + along**2
        ahead = np.copysign(np.sqrt(squared), (directions * normal).sum(axis=1))
        return np.asarray(going + (ahead - along)[:, None] * normal), np.asarray(squared >= 0)
