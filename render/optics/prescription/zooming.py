"""Zoom: the groups of a lens at any focal length of its range, by the configurations of its file.

A prescription's configurations are positions of zoom, each focused at infinity and, maybe, nearer. Between the file's focal
lengths each space follows a smooth monotone curve over the logarithm of the focal length, as a cam does. Two unknowns, the place
on these curves and that of one compensating group, are solved so that focal length and focus at infinity are exact to first
order: a zoom whose configurations keep its focus keeps it all the way. One whose configurations do not is a vari-focal lens
(Kingslake 1989, on zoom lenses): its film stands where the file has it, and its focus drifts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import Configuration, Prescription
from render.optics.prescription.f_numbers import iris_radius_mm
from render.optics.prescription.monotone_curve import MonotoneCurve
from render.optics.prescription.paraxial import ParaxialSystem, focal_points, paraxial_system
from render.optics.prescription.validation import bad_lens, check_configurations

SHARP_BLUR_MM = 0.03
"""Blur on the film that counts as sharp when a zoom is pulled: the usual circle of confusion of 24 x 36 mm."""

_SAME_FOCAL_LENGTH = 0.005  # share: configurations that differ by less are one zoom position
_SAME_MM = 0.005  # files round to a hundredth
_AT_POSITION = 1e-4  # share of a focal length
_UNKNOWN_F_STOP = 4.0
_NEWTON_STEPS = 16
_SOLVED = 1e-10
_STEP_MM, _STEP = 1e-4, 1e-6
_BEYOND = 0.01  # logarithm of the focal length that compensation may go beyond an end of the range


@dataclass(frozen=True)
class ZoomPosition:
    """A position of zoom.

    Attributes:
        focal_length_mm: paraxial, focused at infinity.
        far: configuration at infinity, with the distance to the film that the file states or that was solved for.
        near: configurations focused nearer, by falling distance.
        focus_shift_mm: distance of the paraxial focus behind the film; 0 where the distance to the film was solved for.
    """

    focal_length_mm: float
    far: Configuration
    near: tuple[Configuration, ...]
    focus_shift_mm: float


@dataclass(frozen=True)
class Zoom:
    """Range of a zoom lens.

    Attributes:
        positions: of its file, by rising focal length; at least two.
        keeps_focus: whether focus holds as it is pulled; else it drifts.
        compensator: first and last surface of the group that is placed so that focus holds; None for the distance to the film.
    """

    positions: tuple[ZoomPosition, ...]
    keeps_focus: bool
    compensator: tuple[int, int] | None

    @property
    def shortest_mm(self) -> float:
        """Shortest focal length."""
        return self.positions[0].focal_length_mm

    @property
    def longest_mm(self) -> float:
        """Longest focal length."""
        return self.positions[-1].focal_length_mm

    @property
    def drift_mm(self) -> float:
        """Largest change of the focus behind the film between the positions of the file."""
        shifts = [position.focus_shift_mm for position in self.positions]
        return max(shifts) - min(shifts)

    def holds(self, focal_length_mm: float) -> bool:
        """Whether a focal length is within the range, but for rounding."""
        return self.shortest_mm * (1 - 1e-3) <= focal_length_mm <= self.longest_mm * (1 + 1e-3)


def zoom_of(prescription: Prescription) -> Zoom | None:
    """Zoom range of a lens; None where it has one focal length.

    Raises:
        InputError: no lens has such configurations.
    """
    positions = zoom_positions(prescription)
    return _zoom(prescription, positions) if len(positions) > 1 else None


def marked_close_focus_m(prescription: Prescription) -> float:
    """Nearest distance from the film that the configurations of every zoom position reach; 0 where they say none.

    Raises:
        InputError: no lens has such configurations.
    """
    nearest = [each.near[-1] for each in zoom_positions(prescription) if each.near]
    return max(((each.object_mm + sum(each.thicknesses_mm)) / 1000 for each in nearest), default=0.0)


def set_focal_length(prescription: Prescription, focal_length_mm: float) -> Prescription:
    """Set a lens to a focal length.

    Args:
        prescription: of any lens.
        focal_length_mm: beyond the range, the nearer end is taken. It does not matter to a lens without zoom.

    Returns:
        Lens of one zoom position, whose configurations are its way from infinity to its closest focus, if it has any. It has
        that focal length to first order, with notes.

    Raises:
        InputError: no lens has such configurations.
    """
    return _set_focal_length(prescription, focal_length_mm) if prescription.configurations else prescription


def in_first_position(prescription: Prescription) -> Prescription:
    """Set a lens to the zoom position that its surfaces stand at.

    Raises:
        InputError: no lens has such configurations.
    """
    if not prescription.configurations:
        return prescription
    far = next((each for each in prescription.configurations if math.isinf(each.object_mm)), None)
    if far is None:
        return replace(prescription, configurations=())
    focal_mm, _, _ = focal_points(_System.of(prescription).at(np.array(far.thicknesses_mm)), prescription.name)
    return _set_focal_length(prescription, focal_mm)


@lru_cache(maxsize=64)
def zoom_positions(prescription: Prescription) -> tuple[ZoomPosition, ...]:
    """Zoom positions of a lens by rising focal length: none without configurations, one for a lens without zoom.

    Raises:
        InputError: no lens has such configurations.
    """
    check_configurations(prescription)
    system, positions = _System.of(prescription), list[ZoomPosition]()
    for number, configuration in enumerate(prescription.configurations, 1):
        if math.isinf(configuration.object_mm):
            position = _position(prescription, system, configuration, number)
            if all(abs(p.focal_length_mm / position.focal_length_mm - 1) > _SAME_FOCAL_LENGTH for p in positions):
                positions.append(position)
    positions.sort(key=lambda position: position.focal_length_mm)
    near: list[list[Configuration]] = [[] for _ in positions]
    for configuration in prescription.configurations:
        if math.isfinite(configuration.object_mm) and positions:
            place = _place_of_near(configuration, positions)
            film_mm = configuration.thicknesses_mm[-1] or positions[place].far.thicknesses_mm[-1]
            near[place].append(replace(configuration, thicknesses_mm=(*configuration.thicknesses_mm[:-1], film_mm)))
    return tuple(
        replace(position, near=tuple(sorted(found, key=lambda each: -each.object_mm)))
        for position, found in zip(positions, near, strict=True)
    )


@dataclass(frozen=True, eq=False)
class _System:
    """Paraxial system of a lens whose thicknesses change."""

    system: ParaxialSystem
    name: str

    @classmethod
    def of(cls, prescription: Prescription) -> _System:
        return cls(paraxial_system(prescription), prescription.name)

    def at(self, thicknesses_mm: DoubleArray) -> ParaxialSystem:
        return replace(self.system, vertices_mm=np.concatenate([[0.0], np.cumsum(thicknesses_mm[:-1])]))

    def focus(self, thicknesses_mm: DoubleArray) -> tuple[float, float]:
        """Focal length, and distance of the focus behind the film."""
        focal, back, _ = focal_points(self.at(thicknesses_mm), self.name)
        return focal, back - float(thicknesses_mm[-1])


def _position(prescription: Prescription, system: _System, far: Configuration, number: int) -> ZoomPosition:
    focal, behind = system.focus(np.array(far.thicknesses_mm))
    film_mm = far.thicknesses_mm[-1]
    if focal <= 0 or behind + film_mm <= 0:
        what = f"focal length {focal:.4g} mm and back focal distance {behind + film_mm:.4g} mm"
        raise bad_lens(prescription, f"configuration {number} has the {what}, expected positive ones")
    if film_mm == 0:
        far, behind = replace(far, thicknesses_mm=(*far.thicknesses_mm[:-1], behind)), 0.0
    return ZoomPosition(focal, far, (), behind)


def _place_of_near(near: Configuration, positions: Sequence[ZoomPosition]) -> int:
    """Index of the zoom position that a close configuration belongs to.

    It is the one of its stated focal length; else that with which it shares most spaces, and among those the most alike.
    """
    if near.focal_length_mm > 0:
        stated = [p.far.focal_length_mm or p.focal_length_mm for p in positions]
        return int(np.argmin(np.abs(np.log(np.array(stated) / near.focal_length_mm))))
    differences = np.array(
        [np.abs(np.subtract(near.thicknesses_mm[:-1], p.far.thicknesses_mm[:-1])) for p in positions]
    )
    return int(np.lexsort((differences.sum(axis=1), (differences > _SAME_MM).sum(axis=1)))[0])


@lru_cache(maxsize=256)
def _zoom(prescription: Prescription, positions: tuple[ZoomPosition, ...]) -> Zoom:
    shifts = [position.focus_shift_mm for position in positions]
    blurs = [abs(shift) / _f_stop(prescription, p) for shift, p in zip(shifts, positions, strict=True)]
    return Zoom(positions, max(blurs) <= SHARP_BLUR_MM, _compensator(prescription, positions))


def _f_stop(prescription: Prescription, position: ZoomPosition) -> float:
    return position.far.f_stop or prescription.f_stop or _UNKNOWN_F_STOP


def _variable(positions: Sequence[ZoomPosition]) -> list[int]:
    """Indices of the spaces that change with zoom."""
    rows = np.array([position.far.thicknesses_mm for position in positions])
    return [int(i) for i in np.flatnonzero(np.ptp(rows, axis=0) > _SAME_MM)]


def _compensator(prescription: Prescription, positions: Sequence[ZoomPosition]) -> tuple[int, int] | None:
    """Group between two variable spaces that changes the focus the most for its travel; None for the distance to the film."""
    variable, last = _variable(positions), len(prescription.surfaces) - 1
    if last in variable or len(variable) < 2:
        return None
    system, groups = _System.of(prescription), [(a + 1, b) for a, b in pairwise(variable)]

    def least_effect(group: tuple[int, int]) -> float:
        effects = []
        for position in positions:
            gaps = np.array(position.far.thicknesses_mm)
            moved = system.focus(_moved(gaps, group, _STEP_MM))[1] - system.focus(gaps)[1]
            effects.append(abs(moved / _STEP_MM))
        return min(effects)

    return max(groups, key=least_effect)


def _moved(thicknesses_mm: DoubleArray, group: tuple[int, int], shift_mm: float) -> DoubleArray:
    moved = thicknesses_mm.copy()
    moved[group[0] - 1] += shift_mm
    moved[group[1]] -= shift_mm
    return moved


@lru_cache(maxsize=256)
def _set_focal_length(prescription: Prescription, focal_length_mm: float) -> Prescription:
    positions = zoom_positions(prescription)
    if not positions:
        return replace(prescription, configurations=())
    if len(positions) == 1:
        far, near, notes = positions[0].far, positions[0].near, prescription.notes
        if prescription.configurations[0].thicknesses_mm[-1] == 0 or prescription.surfaces[-1].thickness_mm == 0:
            notes = (*notes, f"The back focal distance of {far.thicknesses_mm[-1]:.4g} mm was solved for.")
        return _in_one_position(replace(prescription, notes=notes), far, near)
    zoom = _zoom(prescription, positions)
    x = np.log([position.focal_length_mm for position in positions])
    at = float(np.clip(math.log(focal_length_mm), x[0], x[-1]))
    far_mm = _solve(prescription, zoom, x, at)
    far = Configuration(tuple(far_mm.tolist()), focal_length_mm=math.exp(at))
    lens = _in_one_position(prescription, far, _near_at(positions, x, at, far_mm))
    lens = _with_iris(lens, prescription, positions, x, at)
    if not lens.configurations and lens.focus_group is None:
        lens = _with_front_focus(lens, positions)
    return replace(lens, notes=(*lens.notes, *_notes(zoom, focal_length_mm)))


def _in_one_position(prescription: Prescription, far: Configuration, near: tuple[Configuration, ...]) -> Prescription:
    surfaces = tuple(
        replace(surface, thickness_mm=thickness)
        for surface, thickness in zip(prescription.surfaces, far.thicknesses_mm, strict=True)
    )
    return replace(
        prescription,
        surfaces=surfaces,
        f_stop=far.f_stop or prescription.f_stop,
        configurations=(far, *near) if near else (),
    )


def _with_iris(
    lens: Prescription, prescription: Prescription, positions: Sequence[ZoomPosition], x: DoubleArray, at: float
) -> Prescription:
    """Lens with the iris, or the f-number, that the file's f-numbers make it have between their positions."""
    stated = [i for i, position in enumerate(positions) if position.far.f_stop > 0]
    if not stated:
        return lens
    f_stops = [positions[i].far.f_stop for i in stated]
    if any(surface.is_stop for surface in lens.surfaces):
        placed = [_in_one_position(prescription, positions[i].far, ()) for i in stated]
        radii_mm = [iris_radius_mm(each, f_stop) for each, f_stop in zip(placed, f_stops, strict=True)]
        if np.isfinite(radii_mm).all():
            radius_mm = float(np.interp(at, x[stated], radii_mm))
            surfaces = tuple(replace(s, semi_diameter_mm=radius_mm) if s.is_stop else s for s in lens.surfaces)
            return replace(lens, surfaces=surfaces, f_stop=0.0)
    return replace(lens, f_stop=float(np.interp(at, x[stated], f_stops)))


def _solve(prescription: Prescription, zoom: Zoom, x: DoubleArray, wanted: float) -> DoubleArray:
    """Thicknesses at infinity at a logarithm of the focal length, by Newton's method."""
    system, group = _System.of(prescription), zoom.compensator if zoom.keeps_focus else None
    curve = MonotoneCurve.through(x, np.array([position.far.thicknesses_mm for position in zoom.positions]))

    def spaces(unknowns: DoubleArray) -> DoubleArray:
        gaps = curve.at(float(unknowns[0]))
        return gaps if group is None else _moved(gaps, group, float(unknowns[1]))

    def misses(unknowns: DoubleArray) -> DoubleArray:
        focal, behind = system.focus(spaces(unknowns))
        return np.array([math.log(max(focal, 1e-9)) - wanted, 0.0 if group is None else behind])

    unknowns, steps = np.array([wanted, 0.0]), np.array([_STEP, _STEP_MM])
    for _ in range(_NEWTON_STEPS):
        missed = misses(unknowns)
        if np.abs(missed).max() < _SOLVED:
            break
        jacobian = np.array([(misses(unknowns + step) - missed) / step.sum() for step in np.diag(steps)]).T
        if group is None:
            jacobian[1, 1] = 1.0
        if abs(np.linalg.det(jacobian)) < 1e-12:
            break
        unknowns = unknowns - np.linalg.solve(jacobian, missed)
        unknowns[0] = np.clip(unknowns[0], x[0] - _BEYOND, x[-1] + _BEYOND)
    gaps = spaces(unknowns)
    if zoom.keeps_focus and group is None:
        gaps[-1] += system.focus(gaps)[1]
    return np.maximum(gaps, 0.0)


def _near_at(
    positions: Sequence[ZoomPosition], x: DoubleArray, at: float, far_mm: DoubleArray
) -> tuple[Configuration, ...]:
    """Close configurations at a zoom position: what the groups of the file's move, between its positions by shares."""
    known = [i for i, position in enumerate(positions) if position.near]
    count = min((len(positions[i].near) for i in known), default=0)
    found = []
    for which in range(-count, 0):
        near = [positions[i].near[which] for i in known]
        moves = [
            np.subtract(each.thicknesses_mm, positions[i].far.thicknesses_mm)
            for i, each in zip(known, near, strict=True)
        ]
        moved = [np.interp(at, x[known], column) for column in np.array(moves).T]
        object_mm = float(np.interp(at, x[known], [each.object_mm for each in near]))
        found.append(Configuration(tuple(np.maximum(far_mm + moved, 0.0).tolist()), object_mm, math.exp(at)))
    return tuple(found)


def _with_front_focus(lens: Prescription, positions: Sequence[ZoomPosition]) -> Prescription:
    """Lens that focuses by what stands before the first space that zooms."""
    first = _variable(positions)[0]
    if first == len(lens.surfaces) - 1:
        return lens
    note = f"The file does not say what moves to focus: surfaces 1 to {first + 1} do, as a zoom's front group does."
    return replace(lens, focus_group=(0, first), notes=(*lens.notes, note))


def _notes(zoom: Zoom, focal_length_mm: float) -> list[str]:
    """Sentences on focus when the zoom is pulled, and on a focal length beyond its range."""
    span = f"{zoom.shortest_mm:.4g} to {zoom.longest_mm:.4g} mm"
    if not zoom.keeps_focus:
        drift = f"zoomed through, its focus drifts by {zoom.drift_mm:.3g} mm at the film until it is focused again"
        notes = [f"It is a vari-focal lens of {span}: {drift}."]
    elif zoom.compensator is None:
        notes = [f"It zooms from {span} and keeps its focus: the distance to the film is set so."]
    else:
        first, last = zoom.compensator
        rounding = f"where the file's own places let it drift by {zoom.drift_mm:.2g} mm"
        notes = [
            f"It zooms from {span} and keeps its focus: surfaces {first + 1} to {last + 1} are placed so, {rounding}."
        ]
    if not zoom.holds(focal_length_mm):
        end = zoom.shortest_mm if focal_length_mm < zoom.shortest_mm else zoom.longest_mm
        notes.append(f"{focal_length_mm:.4g} mm is beyond its range: this is its position at {end:.4g} mm, scaled.")
    return notes
