"""Rays from points of the film through points of the stop and out of a lens: Newton's method on the independent tracer.

Rims do not hinder the search, but beyond a quarter more than their clear diameter surfaces are flat. A ray that would have to
pass out there is not found; it is blocked by a rim in any case.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from render.lab.reference.lens_tracer import TracedRays, trace
from render.model.arrays import DoubleArray
from render.model.lens import Glass, HeightField, Surface
from render.optics.prescription.focusing import FocusedLens

_STAGES = 6  # from the axis out to the film point, so that Newton's method always starts near
_STEPS = 5
_LAST_STEPS = 12
_NUDGE = 1e-6  # of the slope, for derivatives
_LONGEST_STEP = 0.3  # of the slope
_SOLVED = 1e-8  # of the stop's radius: how near to its point a ray passes
_NEAR = 1e-2  # the same, where it is on the way to another


@dataclass(frozen=True, eq=False)
class Aim:
    """Rays that reach their points on the stop, as they leave the film.

    Attributes:
        slopes: ``(n, 2)`` x and y for a step of -z, on the film's side.
        jacobian: ``(n, 2, 2)`` derivative of the point on the stop by the slope, mm.
        solved: ``(n,)`` whether the ray passes its target point on the stop.
    """

    slopes: DoubleArray
    jacobian: DoubleArray
    solved: NDArray[np.bool_]


class AimedLens:
    """A focused lens at one wavelength, seen from its film."""

    def __init__(self, lens: FocusedLens, wavelength_nm: float, field: HeightField | None = None) -> None:
        """Take the lens apart at its stop; ``field`` is added to its first and last surface beside the stop."""
        surfaces, self._lens, self._wavelength_nm = lens.prescription.surfaces, lens, wavelength_nm
        stop, heights = lens.stop, _heights(surfaces, field)
        # the iris itself is not to block a ray that is aimed at its edge
        iris = replace(surfaces[stop], semi_diameter_mm=lens.stop_radius_mm * (1 + 1e-4))
        self._front, self._front_heights = (*surfaces[:stop], iris), heights[: stop + 1]
        self._rear, self._rear_heights = surfaces[stop + 1 :], heights[stop + 1 :]
        self._medium: Glass = surfaces[stop].glass

    def aim(self, film_mm: DoubleArray, stop_mm: DoubleArray) -> Aim:
        """Find the ray from each point ``(n, 2)`` of the film through the point ``(n, 2)`` of the stop, whatever rims say."""
        on_film, on_slope = self._near_axis()
        slopes = (stop_mm - on_film * film_mm) / on_slope / _STAGES
        jacobian, solved = np.zeros((len(film_mm), 2, 2)), np.zeros(len(film_mm), bool)
        for stage in range(1, _STAGES + 1):
            share, last = stage / _STAGES, stage == _STAGES
            slopes *= stage / max(stage - 1, 1)
            left = np.arange(len(film_mm))
            for _ in range(_LAST_STEPS if last else _STEPS):
                off, jacobian[left] = self._miss(share * film_mm[left], share * stop_mm[left], slopes[left])
                near = np.hypot(*off.T) <= (_SOLVED if last else _NEAR) * self._lens.stop_radius_mm
                if last:
                    solved[left[near]] = True
                left, off = left[~near], off[~near]
                if not len(left):
                    break
                slopes[left] -= _limit(undone(jacobian[left], off))
        return Aim(slopes, jacobian, solved)

    def on_stop(self, rear: TracedRays) -> DoubleArray:
        """Points ``(n, 2)`` of rays from the film in the plane of the stop; rims are ignored; NaN for rays that do not
        reach it.
        """
        return rear.at(float(self._lens.vertices_mm[self._lens.stop]))

    def out(self, rear: TracedRays) -> tuple[TracedRays, NDArray[np.bool_]]:
        """Rays from behind the stop, on through it into the scene, and which of them no rim of the whole lens blocks."""
        stop = self._lens.stop
        front = trace(
            self._front, self._lens.vertices_mm[: stop + 1], self._wavelength_nm, rear.positions, rear.directions,
            toward="scene", heights=self._front_heights,
        )  # fmt: skip
        return front, front.passes & rear.passes & ~rear.beyond_rim

    def from_film(self, film_mm: DoubleArray, slopes: DoubleArray) -> TracedRays:
        """Rays from points ``(n, 2)`` of the film through what stands behind the stop, whatever rims say."""
        origins = np.concatenate([film_mm, np.full((len(film_mm), 1), self._lens.film_mm)], axis=1)
        directions = np.concatenate([slopes, -np.ones((len(slopes), 1))], axis=1)
        directions /= np.sqrt((directions**2).sum(axis=1, keepdims=True))
        return trace(
            self._rear, self._lens.vertices_mm[self._lens.stop + 1 :], self._wavelength_nm, origins, directions,
            toward="scene", clip=False, medium=self._medium, heights=self._rear_heights,
        )  # fmt: skip

    def _miss(self, film_mm: DoubleArray, stop_mm: DoubleArray, slopes: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
        """Misses ``(n, 2)`` of rays on the stop, mm, and their derivative by the slope."""
        met, by_x, by_y = (
            self.on_stop(self.from_film(film_mm, slopes + _NUDGE * np.array(nudge)))
            for nudge in ((0, 0), (1, 0), (0, 1))
        )
        return met - stop_mm, np.stack([by_x - met, by_y - met], axis=-1) / _NUDGE

    def _near_axis(self) -> tuple[float, float]:
        """Derivatives of the point on the stop, near the axis: by the height on the film (mm), and by the slope."""
        small = 1e-4
        met = self.on_stop(self.from_film(small * np.array([[1.0, 0], [0, 0]]), small * np.array([[0.0, 0], [1, 0]])))
        return float(met[0, 0]) / small, float(met[1, 0]) / small


def _heights(surfaces: tuple[Surface, ...], field: HeightField | None) -> list[DoubleArray | None]:
    """The height map of each surface."""
    heights: list[DoubleArray | None] = [None] * len(surfaces)
    if field is not None:
        glass = [i for i, surface in enumerate(surfaces) if not surface.is_stop]
        heights[glass[0]], heights[glass[-1]] = field.front, field.back
    return heights


def undone(jacobian: DoubleArray, off: DoubleArray) -> DoubleArray:
    """The slopes ``(n, 2)`` that undo a miss, by Cramer's rule; NaN for a ray that does not react."""
    (a, b), (c, d) = jacobian.transpose(1, 2, 0)
    step = np.stack([d * off[:, 0] - b * off[:, 1], a * off[:, 1] - c * off[:, 0]], axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        step /= (a * d - b * c)[:, None]
    return np.where(np.isfinite(step), step, np.nan)


def _limit(step: DoubleArray) -> DoubleArray:
    """The step, no longer than Newton's method can be trusted with."""
    length = np.sqrt((step**2).sum(axis=1, keepdims=True))
    return np.asarray(step * np.minimum(1.0, _LONGEST_STEP / np.maximum(length, 1e-30)))
