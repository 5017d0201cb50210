"""Focusing mechanism of a lens: the glass that moves, its travel, and its position for an object distance.

The film stays where it is with the lens focused at infinity. For any position of the moving glass, the film has one image in
object space to first order; focusing finds the position at which that image lies at the object distance.

A *shift* is along z in mm: negative toward the scene. Where several groups move each in its own way, it is a place on that way,
from 0 at infinity upward (`render.optics.prescription.focus_path`). *Nearness* is one over the distance from the entrance pupil,
1/mm.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from render.errors import SettingsError
from render.model.arrays import DoubleArray
from render.model.lens import Prescription
from render.optics.prescription.beams import best_focus_mm
from render.optics.prescription.focus_path import FocusPath
from render.optics.prescription.paraxial import (
    ParaxialSystem,
    entrance_pupil,
    paraxial_system,
    stop_index,
    transfer,
    vertices,
)
from render.optics.prescription.surface_shape import clearance_mm

_PLACES = 33  # samples on either side of rest: the solved function is a polynomial of low degree
LONGEST_WAY = 2.0
"""Focal lengths that a group with nothing before it can move toward the scene."""

_BISECTIONS = 60
_SETTLED_MM = 1e-9
_ROUNDS = 20
_NO_POLE = 1e-3  # miss at a zero; it changes sign through infinity where the entrance pupil passes it
_SHARP = 1e-8  # spread on the film over that in the pupil


@dataclass(frozen=True)
class FilmThroughLens:
    """View of the film from object space, to first order: ``y = lift·h + scale·u`` is where a ray ends on the film that
    passes the entrance pupil at height h with slope u.

    Attributes:
        lift: 0 for a lens focused at infinity.
        scale_mm: the focal length for a lens focused at infinity.
        pupil_depth_mm: distance from the front vertex to the entrance pupil.
    """

    lift: float
    scale_mm: float
    pupil_depth_mm: float

    def miss(self, nearness: float) -> float:
        """Defocus of an object of that nearness: the spread of its rays on the film over that in the pupil; 0 where it
        is sharp.
        """
        return self.lift + nearness * self.scale_mm

    @property
    def nearness(self) -> float | None:
        """Nearness of the plane that is sharp; None where none is before the lens."""
        if abs(self.lift) < _SHARP:
            return 0.0
        if self.scale_mm <= 0 or self.lift > 0 or -self.lift * self.pupil_depth_mm >= self.scale_mm:
            return None
        return -self.lift / self.scale_mm


@dataclass(frozen=True, eq=False)
class FocusMechanism:
    """Focusing mechanism of a lens.

    Attributes:
        prescription: focused at infinity.
        system: its paraxial system at the d line.
        film_mm: z of the film.
        moving: first and last surface that move, without a path.
        stop: index of the aperture stop.
        path: of several groups; None where one moves.
    """

    prescription: Prescription
    system: ParaxialSystem
    film_mm: float
    moving: tuple[int, int]
    stop: int
    path: FocusPath | None

    @classmethod
    def from_prescription(cls, prescription: Prescription) -> FocusMechanism:
        """Mechanism of a complete prescription."""
        last = len(prescription.surfaces) - 1
        film_mm = float(vertices(prescription)[-1]) + prescription.surfaces[-1].thickness_mm
        moving = prescription.focus_group or (0, last)
        path = FocusPath.from_prescription(prescription)
        return cls(prescription, paraxial_system(prescription), film_mm, moving, stop_index(prescription), path)

    @property
    def whole(self) -> bool:
        """Whether the whole lens moves as one."""
        return self.path is None and self.moving == (0, len(self.system.powers) - 1)

    def shifted_vertices(self, shift_mm: float) -> DoubleArray:
        """z of the vertices ``(n,)``, mm, with the moving glass shifted."""
        if self.path is not None:
            return self.film_mm + self.path.places(shift_mm)
        moved = self.system.vertices_mm.copy()
        moved[self.moving[0] : self.moving[1] + 1] += shift_mm
        return moved

    def film_through_lens(self, shift_mm: float) -> FilmThroughLens:
        """View of the film from object space, with the moving glass shifted by ``shift_mm``."""
        system = replace(self.system, vertices_mm=self.shifted_vertices(shift_mm))
        (lift, scale), _ = transfer(system, 0, len(system.powers), to_mm=self.film_mm)
        depth = entrance_pupil(system, self.stop)[0] - float(system.vertices_mm[0])
        return FilmThroughLens(lift, scale - lift * depth, depth)

    def paraxial_shift(self, nearness: float) -> float:
        """Shift that makes an object sharp to first order.

        Raises:
            SettingsError: the lens does not reach so near.
        """
        return self._shift_of_whole(nearness) if self.whole else self._shift_of_group(nearness)

    def spot_shift(self, nearness: float, shift_mm: float, stop_radius_mm: float) -> float:
        """Shift that brings the least spot of an object on the axis onto the film, by secants from the paraxial shift.

        (Where the least spot changes its size as the group moves, the very smallest spot on the film belongs to a place that
        differs from this one by that change's share: below a thousandth of the spot in any lens seen.)
        """
        low, high = self.travel()
        previous, shift = shift_mm + 1e-3, shift_mm
        miss_before, miss = (self._spot_miss(nearness, at, stop_radius_mm) for at in (previous, shift))
        for _ in range(_ROUNDS):
            if abs(miss) < _SETTLED_MM or miss == miss_before:
                break
            step = miss * (shift - previous) / (miss - miss_before)
            previous, miss_before, shift = shift, miss, float(np.clip(shift - step, low, high))
            miss = self._spot_miss(nearness, shift, stop_radius_mm)
        return shift

    def _spot_miss(self, nearness: float, shift_mm: float, stop_radius_mm: float) -> float:
        moved = self.shifted_vertices(shift_mm)
        pupil = float(moved[0]) + self.film_through_lens(shift_mm).pupil_depth_mm
        object_mm = pupil - 1 / nearness if nearness else -np.inf
        return best_focus_mm(self.prescription, object_mm, stop_radius_mm, moved) - self.film_mm

    def _shift_of_whole(self, nearness: float) -> float:
        """Shift in closed form: the distance between film and image is linear in the shift."""
        rest, ahead = self.film_through_lens(0.0), self.film_through_lens(-1.0)
        slope, slope_at_infinity = rest.miss(nearness) - ahead.miss(nearness), rest.lift - ahead.lift
        if nearness * rest.pupil_depth_mm >= 1 or slope / slope_at_infinity < 1e-6:
            focal_point_mm = (1 - slope / slope_at_infinity) / nearness  # before the entrance pupil
            before_lens_mm = focal_point_mm - rest.pupil_depth_mm
            if before_lens_mm <= 0:
                raise self._too_near(nearness, 1 / rest.pupil_depth_mm, "where surface 1 of the lens stands")
            where = (
                f"{before_lens_mm:.3g} mm before surface 1: nearer than the front focal point it makes no real image"
            )
            raise self._too_near(nearness, 1 / focal_point_mm, where)
        return -rest.miss(nearness) / slope

    def _shift_of_group(self, nearness: float) -> float:
        low, high = self.travel()
        if abs(self.film_through_lens(0.0).miss(nearness)) < _SHARP:
            return 0.0
        for end in sorted((low, high), key=abs) if self.path is None else (high, low):
            shifts, seen = self._seen_up_to(end)
            misses = np.array([film.miss(nearness) for film in seen])
            for i in np.flatnonzero(misses[:-1] * misses[1:] <= 0):
                if seen[i].nearness is not None or seen[i + 1].nearness is not None:
                    shift = self._bisect(nearness, float(shifts[i]), float(shifts[i + 1]))
                    if abs(self.film_through_lens(shift).miss(nearness)) < _NO_POLE:
                        return shift
        raise self._out_of_reach(nearness, low, high)

    def _seen_up_to(self, end: float) -> tuple[DoubleArray, list[FilmThroughLens]]:
        """Samples of the way to an end of the travel, which are the same for every object."""
        found = self._sampled.get(end)
        if found is None:
            shifts = np.linspace(0.0, end, _PLACES)
            found = self._sampled[end] = shifts, [self.film_through_lens(float(shift)) for shift in shifts]
        return found

    @cached_property
    def _sampled(self) -> dict[float, tuple[DoubleArray, list[FilmThroughLens]]]:
        return {}

    def _bisect(self, nearness: float, start: float, end: float) -> float:
        sign = np.sign(self.film_through_lens(end).miss(nearness))
        for _ in range(_BISECTIONS):
            middle = (start + end) / 2
            if np.sign(self.film_through_lens(middle).miss(nearness)) == sign:
                end = middle
            else:
                start = middle
        return (start + end) / 2

    def travel(self) -> tuple[float, float]:
        """Ends of the travel, mm: of a group toward the scene (at most 0) and toward the film (at least 0); or of the path."""
        if self.path is not None:
            return self.path.travel()
        surfaces, (first, last) = self.prescription.surfaces, self.moving
        focal_mm = 1 / abs(float(transfer(self.system, 0, len(surfaces))[1][0]))
        front, behind = LONGEST_WAY * focal_mm, surfaces[last].thickness_mm
        if self.whole:
            front = np.inf
        if first > 0:
            front = clearance_mm(surfaces[first - 1], surfaces[first], surfaces[first - 1].thickness_mm)
        if last < len(surfaces) - 1:
            behind = clearance_mm(surfaces[last], surfaces[last + 1], surfaces[last].thickness_mm)
        return -max(front, 0.0), max(behind, 0.0)

    def _out_of_reach(self, nearness: float, low: float, high: float) -> SettingsError:
        """Error with the range that the group reaches, and the reason for its end."""
        first, last = self.moving
        what = f"surfaces {first + 1} to {last + 1}" if self.path is None else "its groups"
        shifts = np.linspace(low, high, 2 * _PLACES)
        reached = {shift: seen for shift in shifts if (seen := self.film_through_lens(shift).nearness) is not None}
        if not reached:
            return self._refusal(nearness, f"wherever {what} are moved, no object is sharp")
        if not any(reached.values()):
            return self._refusal(nearness, f"moving {what} leaves it sharp at infinity")
        shift = max(reached, key=lambda shift: reached[shift])
        if nearness < reached[shift]:
            return self._refusal(nearness, f"the farthest that it reaches is {_metres(min(reached.values()))}")
        front = None
        if shift in (low, high):
            front = self._touching(at_high_end=shift == high)
        if front is not None:
            neighbour = f"surface {front + 1}" if front < len(self.system.powers) else "the film"
            return self._too_near(nearness, reached[shift], f"where surface {front} and {neighbour} touch")
        return self._too_near(nearness, reached[shift], f"with {what} moved by {shift:.4g} mm")

    def _touching(self, at_high_end: bool) -> int | None:
        """Number, from 1, of the surface that touches the next one, or the film, at an end of the travel."""
        if self.path is None:
            return self.moving[1] + 1 if at_high_end else self.moving[0]
        front = self.path.touching(at_high_end)
        return None if front is None else front + 1

    def _too_near(self, nearness: float, nearest: float, reason: str) -> SettingsError:
        return self._refusal(nearness, f"the nearest that it reaches is {_metres(nearest)}, {reason}")

    def _refusal(self, nearness: float, why: str) -> SettingsError:
        name = self.prescription.name or "the lens"
        return SettingsError(f"{name} cannot focus at {_metres(nearness)}: {why}", code="focus_out_of_reach")


def _metres(nearness: float) -> str:
    return f"{0.001 / nearness:.4g} m" if nearness > 0 else "infinity"
