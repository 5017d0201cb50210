"""Ghosts of bright sources: their positions in the picture and their brightness, as grids of rays.

For each source and path a grid of rays covers the part of the front lens that contributes, and lands on the film as a sheet,
which is folded where the light has a caustic. Positions on the film, crossings of the iris and distances from rims are
interpolated linearly between the rays (Hullin et al. 2011, section 3.2). A corner's light is that of the triangles around it
over their area, so that the whole sheet holds exactly the light that entered it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.optics.flare.ghosts import GhostPath, GhostRays, ghost_paths, trace_ghost
from render.optics.glass import D_LINE_NM
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.surface_shape import sag_mm
from render.optics.spectrum import Spectrum, band_nm

MAX_SLOPE = 4.5
"""Sources farther than 77 degrees from the axis do not count, as nothing is drawn there."""
_COARSE, _FINE = (25, 13), (33, 17)  # rays across the front lens, in the plane of the source and its half across
_REACH = 1.2  # relative to rim and iris: distance outside at which a ray's neighbours still matter
_TOGETHER = 96  # sheets traced at once: it bounds the memory
_POINT = 1e-18  # area in slopes: nothing is drawn smaller
CROSSINGS = 3
"""At most so often does a ghost's light cross the stop."""


@dataclass(frozen=True, eq=False)
class Source:
    """Bright source, seen from the centre of the entrance pupil.

    Attributes:
        slope: right and up over depth.
        irradiance: ``(3,)`` on the plane of the entrance pupil: on the axis, radiance times the area in slopes that has it.
        depth_m: may be infinite.
    """

    slope: tuple[float, float]
    irradiance: DoubleArray
    depth_m: float = float("inf")


@dataclass(frozen=True, eq=False)
class GhostSheets:
    """Sheets of one path: one for each source and wavelength that contributes.

    Attributes:
        slopes: ``(m, rows, columns, 2)`` right and up, where the light lies in the picture of the ideal lens.
        stops: ``(m, rows, columns, CROSSINGS, 2)`` where it crossed the iris (oriented as the bokeh), in units of its
            radius; 0 for crossings that there are not.
        rim: ``(m, rows, columns)`` nearest that it came to a rim: above 1 it is blocked.
        radiance: ``(m, rows, columns, 3)`` radiance in the picture, before iris and rims.
        whole: ``(m, rows - 1, columns - 1)`` meshes all of whose corners arrive.
    """

    slopes: DoubleArray
    stops: DoubleArray
    rim: DoubleArray
    radiance: DoubleArray
    whole: NDArray[np.bool_]


def ghost_sheets(
    lens: FocusedLens, sources: Sequence[Source], light: Spectrum, iris_share: float = 1.0, *, faintest: float = 0.0
) -> Iterator[GhostSheets]:
    """Compute the ghosts of sources, path by path.

    Args:
        lens: as focused.
        sources: bright sources.
        light: the wavelengths that are traced; each is reflected as all that it stands for.
        iris_share: of its circle that the iris lets through: the picture is exposed for that.
        faintest: radiance below which, on its mean, a sheet is left out.
    """
    seen = [source for source in sources if np.hypot(*source.slope) <= MAX_SLOPE and source.irradiance.max() > 0]
    if not seen:
        return
    for path in ghost_paths(lens.prescription):
        boxes = _boxes(lens, path, seen, iris_share, faintest)
        jobs = [(source, box, k) for source, box in boxes for k in range(len(light.wavelengths_nm))]
        for start in range(0, len(jobs), _TOGETHER):
            yield _sheets(lens, path, jobs[start : start + _TOGETHER], light, iris_share)


_Box = tuple[float, float, float]  # on the front plane, in mm: from and to in the source's plane, and to across it
_Job = tuple[Source, _Box, int]


def _boxes(
    lens: FocusedLens, path: GhostPath, sources: Sequence[Source], iris_share: float, faintest: float
) -> list[tuple[Source, _Box]]:
    """Boxes on the front lens by which a ghost's light enters, for the sources whose ghost is there and bright enough."""
    front, shape = lens.prescription.surfaces[0], (len(sources), _COARSE[1], _COARSE[0])
    deep = abs(float(sag_mm(front, front.semi_diameter_mm**2)))
    halves = [front.semi_diameter_mm + deep * float(np.hypot(*source.slope)) for source in sources]
    grids = np.stack([_grid((-half, half, half), _COARSE) for half in halves])
    rays = _trace(lens, path, grids, sources, np.full(len(sources), D_LINE_NM))
    may_pass = _may_pass(rays, shape)
    brightness = _mean_radiance(lens, rays, may_pass, grids, iris_share)
    boxes = []
    for source, grid, is_open, light in zip(sources, grids, may_pass, brightness, strict=True):
        if is_open.any() and light * float(source.irradiance.max()) >= faintest:
            rows, columns = np.nonzero(is_open)
            x, y = grid[0, :, 0], grid[:, 0, 1]
            box = float(x[columns.min()]), float(x[columns.max() + 1]), float(y[rows.max() + 1])
            boxes.append((source, box))
    return boxes


def _mean_radiance(
    lens: FocusedLens, rays: GhostRays, may_pass: NDArray[np.bool_], grids: DoubleArray, iris_share: float
) -> DoubleArray:
    """Mean radiance ``(m,)`` for an irradiance of 1, from a coarse sheet; infinite where no whole mesh arrives."""
    shape = grids.shape[:3]
    counted = _corners(rays.arrives.reshape(shape)).all(axis=0) & may_pass
    area = np.where(counted, mesh_areas((rays.film_mm / lens.image_scale_mm).reshape(*shape, 2)), 0.0).sum(axis=(1, 2))
    light = np.where(counted, _corners(np.where(rays.arrives, rays.light, 0.0).reshape(shape)).mean(axis=0), 0.0)
    entered = light.sum(axis=(1, 2)) * [_mesh_area(grid) for grid in grids] / _pupil_mm2(lens, iris_share)
    return np.where(counted.any(axis=(1, 2)), entered / np.maximum(area, _POINT), np.inf)


def _may_pass(rays: GhostRays, shape: tuple[int, int, int]) -> NDArray[np.bool_]:
    """Meshes ``(m, rows - 1, columns - 1)`` that iris and rims may pass light of."""
    arrives = rays.arrives.reshape(shape)
    rim = np.where(rays.arrives, rays.rim, np.inf).reshape(shape)
    passes = _corners(rim).min(axis=0) < _REACH
    for k in range(rays.stops.shape[1]):
        for axis in range(2):
            places = rays.stops[:, k, axis].reshape(shape)
            low = _corners(np.where(arrives, places, np.inf)).min(axis=0)
            high = _corners(np.where(arrives, places, -np.inf)).max(axis=0)
            passes &= (low < _REACH) & (high > -_REACH)
    return np.asarray(passes)


def _sheets(
    lens: FocusedLens, path: GhostPath, jobs: Sequence[_Job], light: Spectrum, iris_share: float
) -> GhostSheets:
    sources = [job[0] for job in jobs]
    grids = np.stack([_grid(box, _FINE) for _, box, _ in jobs])
    wavelengths = np.array([light.wavelengths_nm[k] for _, _, k in jobs])
    colours = np.array([band_nm(light, k) for _, _, k in jobs]).T
    rays = _trace(lens, path, grids, sources, wavelengths, colours)
    shape = (len(jobs), _FINE[1], _FINE[0])
    upright = np.sign(lens.first.entrance_pupil_magnification)
    places = np.zeros((*shape, CROSSINGS, 2))
    crossings = rays.stops.shape[1]
    places[..., :crossings, :] = upright * rays.stops.reshape(*shape, crossings, 2)
    flat = _whole_sheet(-rays.film_mm.reshape(*shape, 2) / lens.image_scale_mm)
    arrives = _mirror(rays.arrives.reshape(shape))
    brought = _mirror(np.where(rays.arrives, rays.light, 0.0).reshape(shape))
    whole = np.asarray(_corners(arrives).all(axis=0))
    entered = np.array([_mesh_area(grid) for grid in grids]) / _pupil_mm2(lens, iris_share)
    radiance = _over_area(flat, whole, entered) * brought
    colours = np.array([source.irradiance * light.rgb[k] for source, _, k in jobs])
    turns = np.array([np.arctan2(source.slope[1], source.slope[0]) for source in sources])
    return GhostSheets(
        slopes=_rotate(flat, turns),
        stops=_rotate(_whole_sheet(places), turns),
        rim=_mirror(np.where(rays.arrives, rays.rim, np.inf).reshape(shape)),
        radiance=radiance[..., None] * colours[:, None, None, :],
        whole=whole,
    )


def _grid(box: _Box, shape: tuple[int, int]) -> DoubleArray:
    """Points ``(rows, columns, 2)`` of the front plane, mm; x is toward the source and y across, from 0."""
    x, y = np.linspace(box[0], box[1], shape[0]), np.linspace(0.0, box[2], shape[1])
    return np.stack(np.meshgrid(x, y), axis=-1)


def _mesh_area(grid: DoubleArray) -> float:
    return float((grid[0, 1, 0] - grid[0, 0, 0]) * (grid[1, 0, 1] - grid[0, 0, 1]))


def _pupil_mm2(lens: FocusedLens, iris_share: float) -> float:
    """Area by which the image's own light enters."""
    return float(np.pi * lens.entrance_pupil_radius_mm**2 * iris_share)


def _trace(
    lens: FocusedLens,
    path: GhostPath,
    grids: DoubleArray,
    sources: Sequence[Source],
    wavelengths_nm: DoubleArray,
    colours_nm: DoubleArray | None = None,
) -> GhostRays:
    """Rays of grids ``(m, rows, columns, 2)``, each with its source turned onto +x, and the light that its distance gives."""
    count = grids.shape[1] * grids.shape[2]
    flat = grids.reshape(len(grids), count, 2)
    points = np.concatenate([flat, np.full((*flat.shape[:2], 1), lens.vertices_mm[0])], axis=-1)
    slopes = np.array([np.hypot(*source.slope) for source in sources])[:, None]
    depths = np.array([1000 * source.depth_m for source in sources])[:, None]
    with np.errstate(invalid="ignore"):
        ahead = depths + lens.vertices_mm[0] - lens.entrance_pupil_mm
        is_far = np.isinf(depths)
        across = np.where(is_far, -slopes, (points[..., 0] - slopes * depths) / ahead)
        along = np.where(is_far, 0.0, points[..., 1] / ahead)
        nearer = np.where(is_far, 1.0, (depths / ahead) ** 2 * ((1 + slopes**2) / (1 + across**2 + along**2)) ** 1.5)
    headings = np.stack([across, along, np.ones_like(across)], axis=-1)
    headings /= np.linalg.norm(headings, axis=-1, keepdims=True)
    rays = trace_ghost(
        lens,
        path,
        points.reshape(-1, 3),
        headings.reshape(-1, 3),
        np.repeat(wavelengths_nm, count),
        None if colours_nm is None else np.repeat(colours_nm, count, axis=1),
    )
    return GhostRays(rays.film_mm, rays.stops, rays.rim, rays.light * nearer.ravel(), rays.arrives)


def _mirror(half: NDArray[Any]) -> NDArray[Any]:
    """Mirror half a sheet of a value that is equal on both sides of the source's plane."""
    return np.concatenate([half[:, :0:-1], half], axis=1)


def _whole_sheet(half: DoubleArray) -> DoubleArray:
    """Mirror half a sheet of points, whose last axis is toward the source and across."""
    return np.concatenate([half[:, :0:-1] * [1.0, -1.0], half], axis=1)


def _rotate(places: DoubleArray, turns_rad: DoubleArray) -> DoubleArray:
    """Rotate points ``(m, ..., 2)`` from +x toward each source."""
    turns = turns_rad.reshape(-1, *([1] * (places.ndim - 2)))
    x, y = places[..., 0], places[..., 1]
    return np.stack([x * np.cos(turns) - y * np.sin(turns), x * np.sin(turns) + y * np.cos(turns)], axis=-1)


def _corners(values: NDArray[Any]) -> NDArray[Any]:
    """Corners ``(4, m, rows - 1, columns - 1)`` of the meshes: at it, beside, above, across."""
    return np.stack([values[:, :-1, :-1], values[:, :-1, 1:], values[:, 1:, :-1], values[:, 1:, 1:]])


def _triangles(places: DoubleArray) -> DoubleArray:
    """Signed areas ``(2, m, rows - 1, columns - 1)`` of a mesh's triangles: of its first three corners, and of its last
    three.
    """
    at, beside, above, across = _corners(places)
    return np.stack([_area(at, beside, above), _area(beside, across, above)])


def mesh_areas(places: DoubleArray) -> DoubleArray:
    """Areas ``(m, rows - 1, columns - 1)`` that the meshes of a sheet ``(m, rows, columns, 2)`` cover."""
    return np.asarray(np.abs(_triangles(places)).sum(axis=0))


def _area(a: DoubleArray, b: DoubleArray, c: DoubleArray) -> DoubleArray:
    first, second = b - a, c - a
    return np.asarray((first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]) / 2)


def _over_area(places: DoubleArray, whole: NDArray[np.bool_], entered: DoubleArray) -> DoubleArray:
    """Light ``(m, rows, columns)`` of the triangles around each corner over their area; ``entered`` is the light into a mesh."""
    light, area = np.zeros(places.shape[:3]), np.zeros(places.shape[:3])
    first, second = np.where(whole, np.abs(_triangles(places)), 0.0)
    half = np.where(whole, entered[:, None, None] / 2, 0.0)
    for total, parts in ((light, (half, half)), (area, (first, second))):
        total[:, :-1, :-1] += parts[0]
        total[:, :-1, 1:] += parts[0] + parts[1]
        total[:, 1:, :-1] += parts[0] + parts[1]
        total[:, 1:, 1:] += parts[1]
    return light / np.maximum(area, _POINT)
