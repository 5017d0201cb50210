"""Ghosts: the light that two surfaces of a lens reflect on its way to the film (Hullin et al. 2011, "Physically-Based Real-Time
Lens Flare Rendering", section 3).

Light that one surface sends back toward the scene, and another in front of it forward again, arrives on the film as an image of
the iris, out of focus. Light is relative to that of the image itself: losses at the surfaces that both paths
share are left out, as in the picture.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.lens import Prescription, Surface
from render.optics.flare.coating import reflectance
from render.optics.glass import D_LINE_NM, refractive_index
from render.optics.prescription.diffraction import reduced_mm
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.surface_shape import intersect, slopes_at
from render.optics.prescription.tracing import refract

_SAME_INDEX = 1e-9


class GhostPath(NamedTuple):
    """Path of a ghost: the indices of the two reflecting surfaces.

    Attributes:
        rear: the first that light meets of the two ways back: it sends the light back toward the scene.
        front: sends it forward again.
    """

    rear: int
    front: int


@dataclass(frozen=True, eq=False)
class GhostRays:
    """Rays through a lens with two reflections.

    Attributes:
        film_mm: ``(n, 2)`` landing points on the film.
        stops: ``(n, k, 2)`` crossings of the stop, 1 or 3, in units of the iris's radius.
        rim: ``(n,)`` farthest from the axis that they met a surface, over its clear radius; above 1 its mount blocks the ray.
        light: ``(n,)`` share of the light that they bring over what would come straight through.
        arrives: ``(n,)`` whether they meet all surfaces and the film; of those that do not, the rest has no meaning.
    """

    film_mm: DoubleArray
    stops: DoubleArray
    rim: DoubleArray
    light: DoubleArray
    arrives: NDArray[np.bool_]


class _Step(NamedTuple):
    surface: int
    way: Literal["in", "off rear", "back", "off front", "out"]


def ghost_paths(prescription: Prescription) -> tuple[GhostPath, ...]:
    """Pairs of reflecting surfaces: those at which the refractive index changes."""
    mirrors = [i for i in range(len(prescription.surfaces)) if _reflects(prescription, i)]
    return tuple(GhostPath(rear, front) for rear in mirrors for front in mirrors if front < rear)


def trace_ghost(
    lens: FocusedLens,
    path: GhostPath,
    points_mm: DoubleArray,
    directions: DoubleArray,
    wavelength_nm: float | DoubleArray = D_LINE_NM,
    colours_nm: DoubleArray | None = None,
) -> GhostRays:
    """Trace rays from the scene to the film by way of two reflections. Rims do not stop rays; clearances are returned.

    Args:
        lens: as focused.
        path: the surfaces that reflect.
        points_mm: ``(n, 3)`` any point of each ray before the first surface, z as in `render.optics.prescription.tracing`.
        directions: ``(n, 3)`` unit vectors toward the film.
        wavelength_nm: of all rays, or ``(n,)`` of each.
        colours_nm: ``(k, n)`` wavelengths that a ray stands for, whose mean is reflected: coatings are not of one colour. By
            default its own.
    """
    count = len(points_mm)
    positions, headings = np.array(points_mm, np.float64), np.array(directions, np.float64)
    colours = np.atleast_2d(wavelength_nm) if colours_nm is None else colours_nm
    rim, light = np.zeros(count), np.ones((len(colours), count))
    stops = []
    for step in _steps(lens.prescription, path):
        surface = lens.prescription.surfaces[step.surface]
        vertex = np.array([0.0, 0.0, lens.vertices_mm[step.surface]])
        local, hit = intersect(surface, positions - vertex, headings)
        positions = np.where(hit[:, None], local + vertex, np.nan)
        if step.surface == lens.stop:
            stops.append(local[:, :2] / lens.stop_radius_mm)
        elif surface.semi_diameter_mm > 0:
            rim = np.maximum(rim, np.hypot(local[:, 0], local[:, 1]) / surface.semi_diameter_mm)
        headings, passed = _met(lens.prescription, path, step, local, headings, wavelength_nm, colours)
        light = light * passed
    with np.errstate(invalid="ignore", divide="ignore"):
        film = positions[:, :2] + (lens.film_mm - positions[:, 2:]) * headings[:, :2] / headings[:, 2:]
    mean = light.mean(axis=0)
    arrives = np.isfinite(film).all(axis=1) & np.isfinite(mean) & (headings[:, 2] > 0)
    return GhostRays(film, np.stack(stops, axis=1), rim, mean, np.asarray(arrives))


def _steps(prescription: Prescription, path: GhostPath) -> list[_Step]:
    """Surfaces in the order in which a ghost's light meets them."""
    before = [_Step(i, "in") for i in range(path.rear)]
    back = [_Step(i, "back") for i in range(path.rear - 1, path.front, -1)]
    behind = [_Step(i, "out") for i in range(path.front + 1, len(prescription.surfaces))]
    return [*before, _Step(path.rear, "off rear"), *back, _Step(path.front, "off front"), *behind]


def _met(
    prescription: Prescription,
    path: GhostPath,
    step: _Step,
    local: DoubleArray,
    headings: DoubleArray,
    wavelength_nm: float | DoubleArray,
    colours_nm: DoubleArray,
) -> tuple[DoubleArray, DoubleArray]:
    """Rays refracted or reflected at a surface: their directions, and their share of light, by colour or for all."""
    surface = prescription.surfaces[step.surface]
    front, behind = _indices(prescription, step.surface, wavelength_nm)
    before, after = (front, behind) if step.way in ("in", "off rear", "out") else (behind, front)
    is_mirror = step.way.startswith("off")
    # Losses on the way in are the image's own; only the surfaces between the two, passed twice more, count.
    is_twice_more = step.way in ("back", "out") and step.surface < path.rear
    share = np.ones(len(local))
    normal, cosine = np.zeros(0), share
    if is_mirror or is_twice_more:
        normal = _normals(surface, local)
        cosine = (normal * headings).sum(axis=1)
        share = reflectance(before, after, cosine, colours_nm, _coating_nm(prescription, step.surface))
    if is_mirror:
        return headings - 2 * cosine[:, None] * normal, share
    reduced = reduced_mm(wavelength_nm) / after if surface.phase else 0.0
    bent, refracted = refract(surface, local, headings, before / after, reduced)
    return np.where(refracted[:, None], bent, np.nan), 1 - share if is_twice_more else share


def _normals(surface: Surface, local: DoubleArray) -> DoubleArray:
    with np.errstate(invalid="ignore"):
        normal = np.concatenate([-slopes_at(surface, local[:, :2]), np.ones((len(local), 1))], axis=1)
        return np.asarray(normal / np.linalg.norm(normal, axis=1)[:, None])


def _is_glass(prescription: Prescription, index: int) -> bool:
    return abs(prescription.surfaces[index].glass.index - 1) > _SAME_INDEX if index >= 0 else False


def _indices(
    prescription: Prescription, index: int, wavelength_nm: float | DoubleArray
) -> tuple[float | DoubleArray, float | DoubleArray]:
    """Refractive index before a surface and behind it, as light on its way to the film meets them."""
    behind = refractive_index(prescription.surfaces[index].glass, wavelength_nm)
    front = refractive_index(prescription.surfaces[index - 1].glass, wavelength_nm) if index else np.ones_like(behind)
    return front, behind


def _reflects(prescription: Prescription, index: int) -> bool:
    front, behind = (np.asarray(n) for n in _indices(prescription, index, D_LINE_NM))
    return bool(np.abs(front - behind) > _SAME_INDEX)


def _coating_nm(prescription: Prescription, index: int) -> float:
    """Coating of a surface between glass and air, nm; a cemented surface has none."""
    is_cemented = _is_glass(prescription, index - 1) and _is_glass(prescription, index)
    return 0.0 if is_cemented else prescription.surfaces[index].coating_nm
