"""A lens by its data sheet on its film."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray
from render.model.data_sheet import DataSheet
from render.optics.data_sheet import SheetErrors, seen_slopes, sheet_errors
from render.optics.glass import D_LINE_NM
from render.optics.report.film_rays import UPWARD, Beams, DistantBeams, even_grid, grid_beams

_LIGHT_SIDE = 64


@dataclass(frozen=True, eq=False)
class SheetRays:
    """Lens described by its data sheet as rendered (`render.optics.data_sheet`): its picture keeps its size when it focuses.

    Attributes:
        sheet: its measurements.
        focal_length_mm: of the lens.
        f_stop: above 0.
        focus_nearness_per_m: 1 over the focus distance.
    """

    sheet: DataSheet
    focal_length_mm: float
    f_stop: float
    focus_nearness_per_m: float

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
        return seen_slopes(self.sheet, heights_mm, self.focal_length_mm)

    def paraxial_height_mm(self, heights_mm: DoubleArray) -> DoubleArray:
        """Heights ``(k,)`` at which an ideal lens would show what this lens shows at the given heights."""
        return self.seen(heights_mm) * self.focal_length_mm

    def beams(
        self, places_mm: DoubleArray, pupil: DoubleArray, wavelength_nm: float, nearness_per_m: float | None = None
    ) -> Beams:
        """As `render.optics.report.film_rays.FilmRays.beams`."""
        places = np.asarray(places_mm, np.float64)
        heights = np.hypot(*places.T)
        errors = self._errors(heights)
        outward = np.where(heights[:, None] > 0, places / np.maximum(heights, 1e-300)[:, None], [0.0, 1.0])
        axes = np.stack([outward, outward[:, ::-1] * [-1.0, 1.0]], axis=1)  # rows: along the radius and across it
        turned = np.einsum("fkx,nx->fnk", axes, pupil)
        depth = 0.0 if nearness_per_m is None else nearness_per_m - self.focus_nearness_per_m
        defocus_mm = -(self.focal_length_mm**2) / (2 * self.f_stop) * depth / 1000
        lands = errors.landing_mm(turned, wavelength_nm) + defocus_mm * turned / errors.stretch[:, None]
        landing = places[:, None] + np.einsum("fkx,fnk->fnx", axes, lands)
        slopes = places[:, None] / self.focal_length_mm + np.asarray(pupil) / (2 * self.f_stop)
        is_open = np.maximum(errors.clearance(turned, 1), errors.clearance(turned, -1)) <= 0
        return Beams(landing, slopes, np.broadcast_to(errors.natural[:, None], is_open.shape), is_open)

    def light(self, heights_mm: DoubleArray, *, rims: bool = True) -> DoubleArray:
        """As `render.optics.report.film_rays.FilmRays.light`."""
        grid = even_grid(_LIGHT_SIDE)
        grid = grid[np.hypot(*grid.T) <= 1]
        places = np.stack([0 * heights_mm, heights_mm], axis=1)
        beams = self.beams(places, grid, D_LINE_NM)
        return np.asarray(np.where(beams.open | (not rims), beams.light, 0.0).mean(axis=1))

    def distant_beams(self, places_mm: DoubleArray, side: int, wavelength_nm: float) -> DistantBeams:
        """As `render.optics.report.film_rays.FilmRays.distant_beams`."""
        return grid_beams(self, places_mm, side, wavelength_nm)

    def _errors(self, heights_mm: DoubleArray) -> SheetErrors:
        return sheet_errors(self.sheet, heights_mm, focal_length_mm=self.focal_length_mm, f_stop=self.f_stop)
