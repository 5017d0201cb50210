"""Dense exact rays from a place of the film back through the lens: the light that the picture gathers there.

Directions are direction cosines l and m on the film, in the frame of the upright picture: right and up. An even share of their
disc is an even share of the light of a white scene (cos θ dΩ = dl dm).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.optics.glass import D_LINE_NM
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.outlines import clearance, is_mirrored
from render.optics.prescription.tracing import TracedRays, trace_backward

_COARSE, _SIDE = 48, 72
_ROOM, _GROWTH, _GROWINGS = 1.3, 1.6, 4
_SAME = 1e-9  # of a box's width: by which its sides differ, for rounding alone
_Pair = tuple[float, ...]


@dataclass(frozen=True, eq=False)
class FilmCone:
    """Rays on an even square grid of direction cosines around what is open.

    Attributes:
        cosines: ``(side·side, 2)``, a row of l after the other, m growing.
        cell: area that each ray stands for.
        side: of the grid.
        cover: ``(side·side,)`` share of each cell that stop and rims leave open.
        rays: as they leave the lens toward the scene, in the frame of the lens: the picture's turned around.
        half: ``(n,)`` the cells of these rays, of which the others are mirror images; None where each cell has its own.
    """

    cosines: DoubleArray
    cell: float
    side: int
    cover: DoubleArray
    rays: TracedRays
    half: NDArray[np.int64] | None = None

    def of_all(self, values: DoubleArray) -> DoubleArray:
        """Values ``(side·side,)`` of all cells from those of the rays."""
        return _whole(values, self.side, self.half).ravel()

    @property
    def light(self) -> float:
        """Projected solid angle of what is open."""
        return float(self.cover.sum() * self.cell)


@dataclass(frozen=True, eq=False)
class _Box:
    """Part of the plane of direction cosines."""

    low: DoubleArray
    high: DoubleArray

    def grid(self, side: int) -> DoubleArray:
        """Centres of ``side`` by ``side`` cells."""
        line = (np.arange(side) + 0.5) / side
        across, up = (low + (high - low) * line for low, high in zip(self.low, self.high, strict=True))
        return np.stack(np.meshgrid(across, up), axis=-1).reshape(-1, 2)

    def cell(self, side: int) -> float:
        """Area of a cell."""
        return float(np.prod((self.high - self.low) / side))

    def around(self, points: DoubleArray, side: int) -> _Box:
        """The box of cells around points of its grid, a cell of room on each side."""
        step = (self.high - self.low) / side
        return _Box(points.min(axis=0) - 1.5 * step, points.max(axis=0) + 1.5 * step)

    def grown(self) -> _Box:
        """A larger one about the same centre."""
        middle, half = (self.low + self.high) / 2, (self.high - self.low) / 2
        return _Box(middle - _GROWTH * half, middle + _GROWTH * half)


def film_cone(
    lens: FocusedLens, place_mm: DoubleArray, wavelength_nm: float = D_LINE_NM, *, rims: bool = True, side: int = _SIDE
) -> FilmCone | None:
    """Trace the rays that reach a place of the film.

    Args:
        lens: as focused.
        place_mm: ``(2,)`` the place, right and up in the upright picture on the film.
        wavelength_nm: of the light.
        rims: whether rims, openings and obscurations block light as well as the stop.
        side: of the grid.

    Returns:
        The rays, or None where it is dark.
    """
    found = next(
        filter(None, (_open_box(lens, place_mm, wavelength_nm, rims, box) for box in _boxes(lens, place_mm))), None
    )
    if found is None:
        return None
    cosines = found.grid(side)
    half = _mirrored_half(lens, place_mm, found, side)
    rays = _trace(lens, place_mm, cosines if half is None else cosines[half], wavelength_nm)
    clearance = _whole(_clearance(lens, rays, rims), side, half)
    return FilmCone(cosines, found.cell(side), side, _cover(clearance).ravel(), rays, half)


def _open_box(lens: FocusedLens, place_mm: DoubleArray, wavelength_nm: float, rims: bool, box: _Box) -> _Box | None:
    """Box around what is open within a box, which grows where that reaches its edge; None where nothing is open."""
    found = None
    for _ in range(_GROWINGS):
        ends = (tuple(part.tolist()) for part in (place_mm, box.low, box.high))
        is_open = _coarse_clearances(lens, *ends, wavelength_nm)[0 if rims else 1] <= 0
        if not is_open.any():
            return found
        found = box.around(box.grid(_COARSE)[is_open], _COARSE)
        if (found.low > box.low).all() and (found.high < box.high).all():
            break
        box = box.grown()
    return found


@lru_cache(maxsize=128)
def _coarse_clearances(
    lens: FocusedLens, place_mm: _Pair, low: _Pair, high: _Pair, wavelength_nm: float
) -> tuple[DoubleArray, DoubleArray]:
    """Clearances of a coarse grid over a box, with the rims and of the stop alone: light with and without rims needs both."""
    place, box = np.array(place_mm), _Box(np.array(low), np.array(high))
    half = _mirrored_half(lens, place, box, _COARSE)
    cosines = box.grid(_COARSE)
    rays = _trace(lens, place, cosines if half is None else cosines[half], wavelength_nm)
    clearances = [_whole(_clearance(lens, rays, rims), _COARSE, half).ravel() for rims in (True, False)]
    return clearances[0], clearances[1]


def _mirrored_half(lens: FocusedLens, place_mm: DoubleArray, box: _Box, side: int) -> NDArray[np.int64] | None:
    """Indices of the grid's right half where the left half is its mirror image; None where it is not."""
    width = box.high[0] - box.low[0]
    is_aside = not all(is_mirrored(outline, 0) for outline in lens.prescription.outlines)
    if place_mm[0] or is_aside or lens.prescription.is_anamorphic or abs(box.low[0] + box.high[0]) > _SAME * width:
        return None
    return np.arange(side * side).reshape(side, side)[:, side // 2 :].ravel()


def _whole(values: DoubleArray, side: int, half: NDArray[np.int64] | None) -> DoubleArray:
    """Values ``(side, side)`` of a grid from those of its right half."""
    if half is None:
        return values.reshape(side, side)
    right = values.reshape(side, -1)
    return np.concatenate([right[:, ::-1], right], axis=1)


def _boxes(lens: FocusedLens, place_mm: DoubleArray) -> list[_Box]:
    """Directions to the exit pupil of rays close to the axis, and to the rear surface, with room around them."""
    rear = _box_toward(
        place_mm, lens.film_mm - float(lens.vertices_mm[-1]), lens.prescription.surfaces[-1].semi_diameter_mm
    )
    away = lens.film_mm - lens.exit_pupil_mm
    return [_box_toward(place_mm, away, lens.exit_pupil_radius_mm), rear] if 0 < away < np.inf else [rear]


def _box_toward(place_mm: DoubleArray, away_mm: float, radius_mm: float) -> _Box:
    radius = _ROOM * radius_mm
    low, high = (place_mm + way * radius for way in (-1, 1))
    return _Box(low / np.hypot(low, away_mm), high / np.hypot(high, away_mm))


def _trace(lens: FocusedLens, place_mm: DoubleArray, cosines: DoubleArray, wavelength_nm: float) -> TracedRays:
    """Rays that arrive with the given cosines; the picture is turned around on the film, and the light goes the other way."""
    along = np.sqrt(np.maximum(1 - (cosines**2).sum(axis=1), 1e-6))
    directions = np.column_stack([cosines, -along])
    start = np.tile([*-place_mm, lens.film_mm], (len(cosines), 1))
    return trace_backward(lens.prescription, start, directions, wavelength_nm, vertices_mm=lens.vertices_mm, clip=False)


def _clearance(lens: FocusedLens, rays: TracedRays, rims: bool) -> DoubleArray:
    """Largest ``(r / half clear diameter)² − 1``, or clearance of openings and obscurations: above 0 the ray is blocked; NaN
    where it gets lost in the glass.
    """
    limits = np.array([surface.semi_diameter_mm if rims else np.inf for surface in lens.prescription.surfaces])
    limits[lens.stop] = lens.stop_radius_mm
    points = rays.points_mm[::-1, :, :2]
    met = (points**2).sum(axis=-1) / limits[:, None] ** 2 - 1
    for surface, places, stops in zip(lens.prescription.surfaces if rims else (), points, met, strict=False):
        if surface.opening is not None or surface.obscuration is not None:
            stops[:] = np.maximum(stops, clearance(surface, places))
    return np.asarray(np.where(rays.passes, met.max(axis=0), np.nan))


def _cover(clearance: DoubleArray) -> DoubleArray:
    """Share of each cell where the clearance, taken as linear, is at most 0; cells of lost rays are blocked."""
    steps = np.zeros_like(clearance)
    for axis in (0, 1):
        change = np.abs(np.diff(clearance, axis=axis))
        ends = [(1, 0) if axis == 0 else (0, 0), (0, 0) if axis == 0 else (1, 0)]
        before = np.pad(change, ends, constant_values=np.nan)
        behind = np.pad(change, [end[::-1] for end in ends], constant_values=np.nan)
        steps += np.nan_to_num(
            np.where(np.isnan(before), behind, np.where(np.isnan(behind), before, (before + behind) / 2))
        )
    return np.asarray(np.nan_to_num(np.clip(0.5 - clearance / np.maximum(steps, 1e-12), 0.0, 1.0)))
