"""Floating focus: the way of several groups from infinity to the closest configuration of a lens.

Between configurations each group moves smoothly, and beyond them straight on, as on an extension tube. The film stands still.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import Prescription
from render.optics.prescription.monotone_curve import MonotoneCurve
from render.optics.prescription.surface_shape import clearance_mm

_STILL_MM = 1e-6
_FARTHEST = 10.0  # ways from infinity to the closest configuration that an end may be beyond it


@dataclass(frozen=True)
class MovingGroup:
    """Surfaces that move together to focus.

    Attributes:
        first: index of the first surface.
        last: index of the last one.
        travel_mm: from infinity to the closest configuration; negative toward the scene.
    """

    first: int
    last: int
    travel_mm: float


@dataclass(frozen=True, eq=False)
class FocusPath:
    """Way of the vertices; a place on it is the sum of the largest movements from infinity on, mm.

    Attributes:
        curve: places of the vertices ``(k, n)`` over the way, z from the film.
        prescription: whose surfaces they are.
    """

    curve: MonotoneCurve
    prescription: Prescription

    @classmethod
    def from_prescription(cls, prescription: Prescription) -> FocusPath | None:
        """Way of a lens whose configurations are those of one zoom position, infinity first; None where it has one alone."""
        rows = np.array([each.thicknesses_mm for each in prescription.configurations])
        if len(rows) < 2:
            return None
        places = -np.cumsum(rows[:, ::-1], axis=1)[:, ::-1]
        steps = np.abs(np.diff(places, axis=0)).max(axis=1)
        kept = [0, *(i + 1 for i in range(len(steps)) if steps[i] > _STILL_MM)]
        if len(kept) < 2:
            return None
        stations = np.concatenate([[0.0], np.cumsum(steps[steps > _STILL_MM])])
        return cls(MonotoneCurve.through(stations, places[kept]), prescription)

    def places(self, way_mm: float) -> DoubleArray:
        """z of the vertices ``(n,)`` from the film, mm, at a place on the way."""
        return self.curve.at(way_mm)

    def travel(self) -> tuple[float, float]:
        """Ends of the way: before infinity (at most 0) and past the closest configuration, mm.

        It ends where surfaces touch, or ten times as far beyond the configurations as these are apart.
        """
        last = float(self.curve.x[-1])
        return -self._spare(0.0, -1.0)[0], last + self._spare(last, 1.0)[0]

    def touching(self, at_near_end: bool) -> int | None:
        """Index of the surface that touches the next one, or the film, at an end of the way; None where none does."""
        return self._spare(float(self.curve.x[-1]), 1.0)[1] if at_near_end else self._spare(0.0, -1.0)[1]

    def groups(self) -> tuple[MovingGroup, ...]:
        """Groups that move between infinity and the closest configuration."""
        moves = self.curve.y[-1] - self.curve.y[0]
        starts = [0, *(i for i in range(1, len(moves)) if abs(moves[i] - moves[i - 1]) > 1000 * _STILL_MM)]
        runs = zip(starts, [*starts[1:], len(moves)], strict=True)
        found = [MovingGroup(start, end - 1, float(moves[start])) for start, end in runs]
        return tuple(group for group in found if abs(group.travel_mm) > 1000 * _STILL_MM)

    def _spare(self, end_mm: float, direction: float) -> tuple[float, int | None]:
        """Length of the straight way beyond an end, and the index of the surface that ends it by touching the next one."""
        surfaces, places = self.prescription.surfaces, self.places(end_mm)
        gaps, moves = np.diff([*places, 0.0]), self.places(end_mm + direction) - places
        closing = -np.diff([*moves, 0.0])
        spare, touching = _FARTHEST * float(self.curve.x[-1]), None
        for i in np.flatnonzero(closing > _STILL_MM):
            is_last = i == len(surfaces) - 1
            free = gaps[i] if is_last else clearance_mm(surfaces[i], surfaces[i + 1], float(gaps[i]))
            length = max(float(free), 0.0) / float(closing[i])
            if length < spare:
                spare, touching = length, int(i)
        return spare, touching
