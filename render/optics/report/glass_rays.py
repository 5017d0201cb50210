"""Lenses with surfaces on their film: exact rays from the scene through the stop."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.principal_rays import PrincipalRays, principal_rays
from render.optics.report.aiming import AimedRays, Targets, aim, trace_aimed
from render.optics.report.film_rays import Beams

_DEGREE = 10
_POWERS = [(i, j) for i in range(_DEGREE + 1) for j in range(_DEGREE + 1 - i)]
_NODES = 181
_GOLDEN_TURN = np.pi * (3 - np.sqrt(5))
_BATCH = 16384
_NEAR_RIM = 1.1
_BLOCKED_WEIGHT = 1e-3
_RIDGE = 1e-10
_FEWEST = 3  # nodes within the rims


class GlassRays:
    """A prescription at one focus and f-number."""

    def __init__(self, lens: FocusedLens, focus_nearness_per_m: float) -> None:
        """Take a focused lens and 1 over its focus distance."""
        self._lens, self._focus = lens, focus_nearness_per_m / 1000

    @cached_property
    def principal(self) -> PrincipalRays:
        """Its chief rays."""
        return principal_rays(self._lens)

    @property
    def last_height_mm(self) -> float:
        """Beyond it no chief ray gets through the glass."""
        return self.principal.last_height_mm

    def seen(self, heights_mm: DoubleArray) -> DoubleArray:
        """``(k,)`` slope in object space of the chief ray to heights of the picture."""
        return self.principal.at(heights_mm, 0.0)[0]

    def paraxial_height_mm(self, heights_mm: DoubleArray) -> DoubleArray:
        """Heights ``(k,)`` at which an ideal lens would show what this lens shows at the given heights, in the plane of
        focus.
        """
        return self.principal.at(heights_mm, self._focus)[0] * self._lens.image_scale_mm

    def beams(
        self, places_mm: DoubleArray, pupil: DoubleArray, wavelength_nm: float, nearness_per_m: float | None = None
    ) -> Beams:
        """As `render.optics.report.film_rays.FilmRays.beams`."""
        nearness = self._focus if nearness_per_m is None else nearness_per_m / 1000
        rays, wavelengths, stretch = self.aim(places_mm, pupil, wavelength_nm, nearness)
        traced = trace_aimed(self._lens, rays, wavelengths, clip=True)
        shape = (len(places_mm), len(pupil))
        with np.errstate(invalid="ignore", divide="ignore"):
            slopes = traced.directions[:, :2] / traced.directions[:, 2:]
        return Beams(
            -traced.at(self._lens.film_mm).reshape(*shape, 2),
            -slopes.reshape(*shape, 2),
            (rays.shrinking * rays.directions[:, 2] ** 4).reshape(shape) * stretch[:, None],
            (rays.solved & traced.passes).reshape(shape),
        )

    def many_beams(
        self, places_mm: DoubleArray, pupil: DoubleArray, wavelength_nm: float, nearness_per_m: float | None = None
    ) -> Beams:
        """As `render.optics.report.film_rays.FilmRays.many_beams`: heights at all rims are polynomials too, and cut there."""
        nearness = self._focus if nearness_per_m is None else nearness_per_m / 1000
        nodes = _nodes()
        rays, wavelengths, stretch = self.aim(places_mm, nodes, wavelength_nm, nearness)
        traced = trace_aimed(self._lens, rays, wavelengths, clip=False)
        with np.errstate(invalid="ignore", divide="ignore"):
            slopes = traced.directions[:, :2] / traced.directions[:, 2:]
        light = rays.shrinking * rays.directions[:, 2] ** 4
        rims = [i for i in range(len(traced.points_mm)) if i != self._lens.stop]
        at_rims = [traced.points_mm[i, :, :2] for i in rims]
        values = np.concatenate([traced.at(self._lens.film_mm), slopes, light[:, None], *at_rims], axis=1)
        semi_mm = np.array([self._lens.prescription.surfaces[i].semi_diameter_mm for i in rims])
        shape = (len(places_mm), len(nodes))
        fit = _fit(nodes, values.reshape(*shape, -1), (rays.solved & traced.passes).reshape(shape), semi_mm)
        got = np.concatenate([_monomials(part) @ fit for part in _batches(pupil)], axis=1)
        is_open = _reaches(got[..., 5:], semi_mm) <= 1
        light = np.maximum(np.nan_to_num(got[..., 4]), 0.0) * stretch[:, None]
        return Beams(-got[..., :2], -got[..., 2:4], light, np.asarray(is_open & np.isfinite(got[..., 0])))

    def aim(
        self, places_mm: DoubleArray, pupil: DoubleArray, wavelength_nm: float, nearness_per_mm: float
    ) -> tuple[AimedRays, DoubleArray, DoubleArray]:
        """Rays as they enter the lens that end at places of the picture; rims are ignored.

        Args:
            places_mm: ``(f, 2)``.
            pupil: ``(n, 2)``.
            wavelength_nm: wavelength of the light.
            nearness_per_mm: 1 over the depth of their object.

        Returns:
            The rays, by place and pupil point; their wavelengths; and ``(f,)`` area in slopes over area on the film, 1/mm².
        """
        heights = np.hypot(*np.asarray(places_mm).T)
        toward = np.divide(
            places_mm, heights[:, None], out=np.tile([0.0, 1.0], (len(heights), 1)), where=heights[:, None] > 0
        )
        slopes, crossing = self.principal.at(heights, nearness_per_mm)
        count = len(pupil)
        upright = np.sign(self._lens.first.entrance_pupil_magnification)
        wavelengths = np.full(len(heights) * count, wavelength_nm)
        targets = Targets(
            np.repeat(slopes[:, None] * toward, count, axis=0),
            nearness_per_mm,
            np.tile(upright * self._lens.stop_radius_mm * pupil, (len(heights), 1)),
            np.repeat(crossing[:, None] * toward, count, axis=0),
            wavelengths,
        )
        return aim(self._lens, targets), wavelengths, self.principal.stretch(heights, nearness_per_mm)


def _nodes() -> DoubleArray:
    """``(n, 2)`` points that fill the unit disc to its edge, denser toward it: a sunflower's seeds."""
    share = np.arange(_NODES) / (_NODES - 1)
    radius, angle = np.sin(np.pi / 2 * share**0.7), _GOLDEN_TURN * np.arange(_NODES)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def _fit(nodes: DoubleArray, values: DoubleArray, solved: NDArray[np.bool_], semi_mm: DoubleArray) -> DoubleArray:
    """``(f, terms, k)`` polynomials through values ``(f, n, k)`` at nodes by least squares; NaN where hardly a ray passes.

    What rims block by far hardly counts: it need only be known to stay blocked.
    """
    reach = _reaches(np.where(solved[..., None], values[..., 5:], np.inf), semi_mm)
    weights = np.where(solved, np.where(reach < _NEAR_RIM, 1.0, _BLOCKED_WEIGHT), 0.0)[..., None]
    basis = _monomials(nodes)
    normal = basis.T @ (weights * basis) + _RIDGE * np.eye(len(_POWERS))
    fit = np.linalg.solve(normal, basis.T @ (weights * np.where(solved[..., None], values, 0.0)))
    fit[(weights[..., 0] == 1).sum(axis=1) < _FEWEST] = np.nan
    return np.asarray(fit)


def _reaches(at_rims: DoubleArray, semi_mm: DoubleArray) -> DoubleArray:
    """Greatest relative radius ``(f, n)`` at which rays ``(f, n, 2 rims)`` meet a rim; 1 is the rim itself."""
    heights = np.linalg.norm(at_rims.reshape(*at_rims.shape[:2], -1, 2), axis=-1)
    return np.asarray((heights / semi_mm).max(axis=-1, initial=0.0))


def _monomials(points: DoubleArray) -> DoubleArray:
    powers = points[None] ** np.arange(_DEGREE + 1)[:, None, None]
    return np.stack([powers[i, :, 0] * powers[j, :, 1] for i, j in _POWERS], axis=1)


def _batches(points: DoubleArray) -> list[DoubleArray]:
    return [points[i : i + _BATCH] for i in range(0, len(points), _BATCH)]
