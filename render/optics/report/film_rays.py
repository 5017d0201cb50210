"""Rays from points of the scene on a lens's film, by one interface for every lens model.

Places are millimetres on the film as the upright picture has them, right and up; depth along the light, from the film's plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray

UPWARD = np.array([0.0, 1.0])
"""Straight up in the picture: heights are measured there where all directions are the same."""


@dataclass(frozen=True, eq=False)
class Beams:
    """Light from a row of objects, through given points of the pupil.

    Attributes:
        landing_mm: ``(f, n, 2)`` where it meets the film; NaN where no ray gets there.
        slopes: ``(f, n, 2)`` change of that for a step along the light: converging light has them toward the pupil's other side.
        light: ``(f, n)`` illumination of the film that an even share of the stop gives, in units of the lens's own.
        open: ``(f, n)`` whether no rim blocks the ray.
    """

    landing_mm: DoubleArray
    slopes: DoubleArray
    light: DoubleArray
    open: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class DistantBeams:
    """Light of lights at infinity on a grid over the lens's opening.

    Attributes:
        pupil: ``(f, n, 2)`` points of the unit pupil, right and up.
        beams: their rays; ``light`` is for an even share of the grid.
    """

    pupil: DoubleArray
    beams: Beams


class FilmRays(Protocol):
    """A lens at one focus and f-number."""

    @property
    def toward(self) -> DoubleArray:
        """``(2,)`` unit vector, right and up, along which heights of the picture are measured."""
        ...

    @property
    def last_height_mm(self) -> float:
        """Beyond this height of the picture the lens shows nothing."""
        ...

    def seen(self, heights_mm: DoubleArray) -> DoubleArray:
        """``(k,)`` slope in object space of the chief ray to heights of the picture."""
        ...

    def paraxial_height_mm(self, heights_mm: DoubleArray) -> DoubleArray:
        """Heights ``(k,)`` at which an ideal lens would show what this lens shows at the given heights."""
        ...

    def beams(
        self, places_mm: DoubleArray, pupil: DoubleArray, wavelength_nm: float, nearness_per_m: float | None = None
    ) -> Beams:
        """Exact rays.

        Args:
            places_mm: ``(f, 2)`` of the picture; the objects stand where the chief ray at the d line from there leads.
            pupil: ``(n, 2)`` points of the unit pupil, right and up.
            wavelength_nm: of the light.
            nearness_per_m: 1 over the objects' depth; by default in the plane of focus.
        """
        ...

    def light(self, heights_mm: DoubleArray, *, rims: bool = True) -> DoubleArray:
        """Light ``(k,)`` of a white scene at heights of the picture through a round iris, in units of the lens's own.

        Args:
            heights_mm: ``(k,)``.
            rims: whether rims block light as well as the iris.
        """
        ...

    def distant_beams(self, places_mm: DoubleArray, side: int, wavelength_nm: float) -> DistantBeams:
        """Exact rays of lights at infinity, ``side²`` of them over what the lens lets through.

        Args:
            places_mm: ``(f, 2)`` of the picture, as `beams` has them.
            side: of the grid of rays.
            wavelength_nm: of the light.
        """
        ...


@dataclass(frozen=True, eq=False)
class SqueezedRays:
    """An anamorphic lens, its picture stretched back: the pupil and the errors are as many times narrower from side to side."""

    rays: FilmRays
    squeeze: float

    @property
    def toward(self) -> DoubleArray:
        """As without the squeeze."""
        return self.rays.toward

    @property
    def last_height_mm(self) -> float:
        """As without the squeeze."""
        return self.rays.last_height_mm

    def seen(self, heights_mm: DoubleArray) -> DoubleArray:
        """As without the squeeze."""
        return self.rays.seen(heights_mm)

    def paraxial_height_mm(self, heights_mm: DoubleArray) -> DoubleArray:
        """As without the squeeze."""
        return self.rays.paraxial_height_mm(heights_mm)

    def beams(
        self, places_mm: DoubleArray, pupil: DoubleArray, wavelength_nm: float, nearness_per_m: float | None = None
    ) -> Beams:
        """As `FilmRays.beams`."""
        return self._narrow(places_mm, self.rays.beams(places_mm, pupil, wavelength_nm, nearness_per_m))

    def light(self, heights_mm: DoubleArray, *, rims: bool = True) -> DoubleArray:
        """As without the squeeze."""
        return self.rays.light(heights_mm, rims=rims)

    def distant_beams(self, places_mm: DoubleArray, side: int, wavelength_nm: float) -> DistantBeams:
        """As `FilmRays.distant_beams`."""
        found = self.rays.distant_beams(places_mm, side, wavelength_nm)
        return DistantBeams(found.pupil, self._narrow(places_mm, found.beams))

    def _narrow(self, places_mm: DoubleArray, beams: Beams) -> Beams:
        narrowing = np.array([1 / self.squeeze, 1.0])
        place = places_mm[:, None, :]
        return Beams(place + (beams.landing_mm - place) * narrowing, beams.slopes * narrowing, beams.light, beams.open)


def even_grid(side: int) -> DoubleArray:
    """``(side², 2)`` centres of the cells of the square around the unit pupil, row 0 at the top."""
    line = (np.arange(side) + 0.5) / side * 2 - 1
    return np.stack(np.meshgrid(line, -line), axis=-1).reshape(-1, 2)


def grid_beams(rays: FilmRays, places_mm: DoubleArray, side: int, wavelength_nm: float) -> DistantBeams:
    """`FilmRays.distant_beams` of a lens without surfaces, whose pupil is the same everywhere."""
    grid = even_grid(side)
    grid = grid[np.hypot(*grid.T) <= 1]
    beams = rays.beams(places_mm, grid, wavelength_nm, 0.0)
    return DistantBeams(np.broadcast_to(grid, (len(places_mm), *grid.shape)), beams)
