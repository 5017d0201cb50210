"""Lenses with surfaces on their film: exact rays from the scene through the stop."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from render.model.arrays import DoubleArray
from render.optics.glass import refractive_index
from render.optics.prescription.diffraction import phase_at, reduced_mm
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.principal_rays import PrincipalRays, principal_rays
from render.optics.prescription.tracing import TracedRays, trace_forward
from render.optics.report.aiming import AimedRays, Targets, aim, trace_aimed
from render.optics.report.cylinder_chiefs import CylinderChiefs
from render.optics.report.film_cone import film_cone
from render.optics.report.film_rays import UPWARD, Beams, DistantBeams, even_grid
from render.optics.report.wavefront import Wavefront, fit_wavefront

_NODES = 181
_COARSE = 40
_WAVE_SIDE = 56
_GOLDEN_TURN = np.pi * (3 - np.sqrt(5))


class GlassRays:
    """A prescription at one focus and f-number."""

    def __init__(self, lens: FocusedLens, focus_nearness_per_m: float, cylinders: CylinderChiefs | None = None) -> None:
        """Take a focused lens and 1 over its focus distance; of one with cylinders, also its chief rays."""
        self._lens, self._focus, self._cylinders = lens, focus_nearness_per_m / 1000, cylinders
        self._stretching = np.ones(2) if cylinders is None else cylinders.stretching

    @cached_property
    def principal(self) -> PrincipalRays:
        """Its chief rays."""
        return principal_rays(self._lens)

    @property
    def has_cylinders(self) -> bool:
        """Whether its two meridians differ."""
        return self._cylinders is not None

    @property
    def toward(self) -> DoubleArray:
        """As `render.optics.report.film_rays.FilmRays.toward`."""
        return UPWARD if self._cylinders is None else self._cylinders.toward

    @property
    def last_height_mm(self) -> float:
        """Beyond it no chief ray gets through the glass."""
        return self.principal.last_height_mm if self._cylinders is None else self._cylinders.last_height_mm

    def seen(self, heights_mm: DoubleArray) -> DoubleArray:
        """``(k,)`` slope in object space of the chief ray to heights of the picture."""
        return self._slopes(heights_mm, 0.0)

    def paraxial_height_mm(self, heights_mm: DoubleArray) -> DoubleArray:
        """Heights ``(k,)`` at which an ideal lens would show what this lens shows at the given heights, in the plane of
        focus.
        """
        return self._slopes(heights_mm, self._focus) * self._lens.image_scale_mm

    def _slopes(self, heights_mm: DoubleArray, nearness_per_mm: float) -> DoubleArray:
        if self._cylinders is None:
            return self.principal.at(heights_mm, nearness_per_mm)[0]
        return np.asarray(np.hypot(*self._cylinders.at(heights_mm[:, None] * self.toward, nearness_per_mm)[0].T))

    def beams(
        self, places_mm: DoubleArray, pupil: DoubleArray, wavelength_nm: float, nearness_per_m: float | None = None
    ) -> Beams:
        """As `render.optics.report.film_rays.FilmRays.beams`."""
        nearness = self._focus if nearness_per_m is None else nearness_per_m / 1000
        rays, stretch = self.aim(places_mm, pupil, wavelength_nm, nearness)
        traced = trace_aimed(self._lens, rays, wavelength_nm, clip=True)
        shape = (len(places_mm), len(pupil))
        with np.errstate(invalid="ignore", divide="ignore"):
            slopes = traced.directions[:, :2] / traced.directions[:, 2:]
        return Beams(
            -traced.at(self._lens.film_mm).reshape(*shape, 2) * self._stretching,
            -slopes.reshape(*shape, 2) * self._stretching,
            (rays.shrinking * rays.directions[:, 2] ** 4).reshape(shape) * stretch[:, None],
            (rays.solved & traced.passes).reshape(shape),
        )

    def light(self, heights_mm: DoubleArray, *, rims: bool = True) -> DoubleArray:
        """As `render.optics.report.film_rays.FilmRays.light`: the projected solid angle that each place sees."""
        cones = [film_cone(self._lens, height * self.toward / self._stretching, rims=rims) for height in heights_mm]
        return np.array([0.0 if cone is None else cone.light for cone in cones])

    def distant_beams(self, places_mm: DoubleArray, side: int, wavelength_nm: float) -> DistantBeams:
        """As `render.optics.report.film_rays.FilmRays.distant_beams`."""
        slopes, _, stretch = self._chiefs(np.asarray(places_mm), 0.0)
        rays, _ = self.aim(places_mm, _nodes(), wavelength_nm, 0.0)
        found = []
        for i, (slope, points, solved) in enumerate(
            zip(slopes, *(part.reshape(len(slopes), _NODES, -1) for part in (rays.points_mm, rays.solved)), strict=True)
        ):
            direction = np.array([*-slope, 1.0]) / np.sqrt(1 + slope @ slope)
            entering = points[solved[:, 0], :2]
            if not len(entering):
                entering = points[:1, :2]
            box = _box_around(entering, len(entering) ** -0.5)
            coarse = _cells(*box, _COARSE)
            passing = coarse[self._enter(coarse, direction, wavelength_nm).passes]
            box = _box_around(passing, 1.5 / _COARSE) if len(passing) else box
            traced = self._enter(_cells(*box, side), direction, wavelength_nm)
            found.append((traced, np.prod(box[1] - box[0]) * direction[2] ** 4 * stretch[i]))
        with np.errstate(invalid="ignore", divide="ignore"):
            turned = [traced.directions[:, :2] / traced.directions[:, 2:] for traced, _ in found]
        upright = np.sign(self._lens.first.entrance_pupil_magnification)
        pupil = [upright / self._lens.stop_radius_mm * traced.points_mm[self._lens.stop, :, :2] for traced, _ in found]
        is_open = np.array([traced.passes for traced, _ in found])
        beams = Beams(
            -np.array([traced.at(self._lens.film_mm) for traced, _ in found]) * self._stretching,
            -np.array(turned) * self._stretching,
            np.array([np.full(side**2, light) for _, light in found]),
            is_open,
        )
        return DistantBeams(np.array(pupil), beams)

    def wavefront(self, height_mm: float, wavelength_nm: float) -> Wavefront | None:
        """The wavefront of an object in focus that the chief ray at the d line takes to a height of the picture.

        Args:
            height_mm: of the image.
            wavelength_nm: of the light.

        Returns:
            None where no light arrives.
        """
        cone = film_cone(self._lens, height_mm * UPWARD, wavelength_nm, side=_WAVE_SIDE)
        if cone is None or cone.light <= 0:
            return None
        slopes, _, _ = self._chiefs(height_mm * UPWARD[None], self._focus)
        path = self._path_mm(cone.rays, height_mm, slopes[0], wavelength_nm)
        return fit_wavefront(cone, cone.of_all(path), wavelength_nm)

    def _path_mm(self, rays: TracedRays, height_mm: float, slope: DoubleArray, wavelength_nm: float) -> DoubleArray:
        """Optical path ``(n,)`` from the object to the film, less that of all; rays go from film to scene."""
        lens = self._lens
        steps = np.diff(
            rays.points_mm, axis=0
        )  # from the last surface to the first; back where they cut into each other
        legs = np.copysign(np.linalg.norm(steps, axis=-1), -steps[..., 2])
        glasses = [surface.glass for surface in lens.prescription.surfaces[-2::-1]]
        path = sum(
            (leg * refractive_index(glass, wavelength_nm) for leg, glass in zip(legs, glasses, strict=True)),
            start=np.zeros(rays.points_mm.shape[1]),
        )
        for surface, points in zip(lens.prescription.surfaces[::-1], rays.points_mm, strict=True):
            if surface.phase:
                path = path + reduced_mm(wavelength_nm) * phase_at(surface, points[:, :2])
        met = rays.points_mm[-1] - [0.0, 0.0, lens.entrance_pupil_mm]
        toward = np.array([*slope, -1.0])
        if self._focus:
            object_mm = toward / self._focus
            path = path + np.linalg.norm(object_mm - met, axis=1) - np.linalg.norm(object_mm)
        else:
            path = path - met @ (toward / np.linalg.norm(toward))
        place = np.array([0.0, -height_mm, lens.film_mm])
        return np.asarray(path + np.linalg.norm(rays.points_mm[0] - place, axis=1))

    def _enter(self, points_mm: DoubleArray, direction: DoubleArray, wavelength_nm: float) -> TracedRays:
        """Trace parallel rays from points ``(n, 2)`` of the plane of the front vertex."""
        lens, count = self._lens, len(points_mm)
        return trace_forward(
            lens.prescription,
            np.column_stack([points_mm, np.full(count, lens.vertices_mm[0])]),
            np.tile(direction, (count, 1)),
            wavelength_nm,
            vertices_mm=lens.vertices_mm,
            stop_radius_mm=lens.stop_radius_mm,
        )

    def aim(
        self, places_mm: DoubleArray, pupil: DoubleArray, wavelength_nm: float, nearness_per_mm: float
    ) -> tuple[AimedRays, DoubleArray]:
        """Rays as they enter the lens that end at places of the picture; rims are ignored.

        Args:
            places_mm: ``(f, 2)``.
            pupil: ``(n, 2)``.
            wavelength_nm: wavelength of the light.
            nearness_per_mm: 1 over the depth of their object.

        Returns:
            The rays, by place and pupil point, and ``(f,)`` area in slopes over area on the film, 1/mm².
        """
        slopes, crossing, stretch = self._chiefs(np.asarray(places_mm), nearness_per_mm)
        places, count = len(places_mm), len(pupil)
        upright = np.sign(self._lens.first.entrance_pupil_magnification)
        targets = Targets(
            np.repeat(slopes, count, axis=0),
            nearness_per_mm,
            np.tile(upright * self._lens.stop_radius_mm * pupil, (places, 1)),
            np.repeat(crossing, count, axis=0),
            wavelength_nm,
        )
        return aim(self._lens, targets), stretch

    def _chiefs(self, places_mm: DoubleArray, nearness_per_mm: float) -> tuple[DoubleArray, DoubleArray, DoubleArray]:
        """Slopes ``(f, 2)`` and pupil crossings ``(f, 2)`` of chief rays, and ``(f,)`` area in slopes over area on the film."""
        if self._cylinders is not None:
            return *self._cylinders.at(places_mm, nearness_per_mm), self._cylinders.stretch(places_mm, nearness_per_mm)
        heights = np.hypot(*places_mm.T)
        toward = np.divide(
            places_mm, heights[:, None], out=np.tile(UPWARD, (len(heights), 1)), where=heights[:, None] > 0
        )
        slopes, crossing = self.principal.at(heights, nearness_per_mm)
        stretch = self.principal.stretch(heights, nearness_per_mm)
        return slopes[:, None] * toward, crossing[:, None] * toward, stretch


def _nodes() -> DoubleArray:
    """``(n, 2)`` points that fill the unit disc to its edge, denser toward it: a sunflower's seeds."""
    share = np.arange(_NODES) / (_NODES - 1)
    radius, angle = np.sin(np.pi / 2 * share**0.7), _GOLDEN_TURN * np.arange(_NODES)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def _box_around(points: DoubleArray, room: float) -> tuple[DoubleArray, DoubleArray]:
    """Corners of the box around points ``(n, 2)``, a share of its size larger on each side."""
    low, high = points.min(axis=0), points.max(axis=0)
    return low - room * (high - low) - 1e-9, high + room * (high - low) + 1e-9


def _cells(low: DoubleArray, high: DoubleArray, side: int) -> DoubleArray:
    return np.asarray((low + high) / 2 + (high - low) / 2 * even_grid(side))
