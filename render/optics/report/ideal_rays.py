"""Thin lenses on their film, ideal or with third-order errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import SeidelErrors
from render.optics.glass import D_LINE_NM
from render.optics.report.film_rays import UPWARD, Beams, DistantBeams, grid_beams

_MIDDLE_NM, _SPAN_NM = 562.5, 175.0  # colour errors are stated between 475 and 650 nm and taken as linear between


@dataclass(frozen=True, eq=False)
class ThinRays:
    """Thin lens as rendered: its picture keeps its size over focus, and is evenly lit.

    A ray through the point l of the pupil that ends at the place p of the picture comes, at inverse depth w, from the slope
    ``p + δ(l, p) + l·(w − w_f)``; δ is the gradient of the wavefront (`render.model.lens.SeidelErrors`).

    Attributes:
        focal_length_mm: of the lens.
        f_stop: 0 for a pinhole.
        focus_nearness_per_m: 1 over the focus distance.
        errors: None for an ideal lens.
    """

    focal_length_mm: float
    f_stop: float
    focus_nearness_per_m: float
    errors: SeidelErrors | None = None

    @property
    def toward(self) -> DoubleArray:
        """As `render.optics.report.film_rays.FilmRays.toward`."""
        return UPWARD

    @property
    def last_height_mm(self) -> float:
        """It shows everything before it."""
        return float("inf")

    def seen(self, heights_mm: DoubleArray) -> DoubleArray:
        """``(k,)`` slope in object space of the chief ray to heights of the picture."""
        places = np.stack([0 * heights_mm, heights_mm], axis=-1)[:, None, :]
        return np.asarray(heights_mm / self.focal_length_mm + self._error(places, np.zeros((1, 2)), D_LINE_NM)[:, 0, 1])

    def paraxial_height_mm(self, heights_mm: DoubleArray) -> DoubleArray:
        """Heights ``(k,)`` at which an ideal lens would show what this lens shows at the given heights."""
        return self.seen(heights_mm) * self.focal_length_mm

    def beams(
        self, places_mm: DoubleArray, pupil: DoubleArray, wavelength_nm: float, nearness_per_m: float | None = None
    ) -> Beams:
        """As `render.optics.report.film_rays.FilmRays.beams`."""
        radius_mm = self.focal_length_mm / (2 * self.f_stop) if self.f_stop else 0.0
        depth = (0.0 if nearness_per_m is None else nearness_per_m - self.focus_nearness_per_m) / 1000
        places = np.asarray(places_mm)[:, None, :]
        chief = self._error(places, np.zeros((1, 2)), D_LINE_NM)
        off = chief - self._error(places, pupil, wavelength_nm) - radius_mm * pupil * depth
        landing = places + self.focal_length_mm * off
        slopes = (places + radius_mm * pupil) / self.focal_length_mm
        shape = landing.shape[:2]
        return Beams(landing, np.broadcast_to(slopes, landing.shape), np.ones(shape), np.ones(shape, bool))

    def light(self, heights_mm: DoubleArray, *, rims: bool = True) -> DoubleArray:
        """As `render.optics.report.film_rays.FilmRays.light`: the same everywhere."""
        return np.ones(len(heights_mm))

    def distant_beams(self, places_mm: DoubleArray, side: int, wavelength_nm: float) -> DistantBeams:
        """As `render.optics.report.film_rays.FilmRays.distant_beams`."""
        return grid_beams(self, places_mm, side, wavelength_nm)

    def _error(self, places_mm: DoubleArray, pupil: DoubleArray, wavelength_nm: float) -> DoubleArray:
        """``(f, n, 2)`` slope in object space by which rays through points of the pupil ``(n, 2)`` are off."""
        e = self.errors
        if e is None or not self.f_stop:
            return np.zeros((len(places_mm), len(pupil), 2))
        u = pupil * (e.reference_f_stop / self.f_stop)
        image = -places_mm / e.reference_height_mm  # η, toward the image point: the film's picture is upside down
        along, u2, image2 = ((a * b).sum(-1, keepdims=True) for a, b in ((u, image), (u, u), (image, image)))
        gradient = (
            4 * e.w040 * u2 * u
            + e.w131 * (2 * along * u + u2 * image)
            + 2 * e.w222 * along * image
            + 2 * e.w220 * image2 * u
            + e.w311 * image2 * image
        )
        reference_mm = self.focal_length_mm / (2 * e.reference_f_stop)
        blueness = (_MIDDLE_NM - wavelength_nm) / _SPAN_NM
        later = blueness * e.axial_color_mm / self.focal_length_mm**2 * reference_mm * u
        larger = blueness * e.lateral_color_mm / self.focal_length_mm * image
        return np.asarray(later + larger - D_LINE_NM * 1e-6 / reference_mm * gradient)
