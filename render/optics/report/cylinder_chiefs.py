"""Chief rays of a lens with cylinders to any place of its picture, which is stretched back by the nominal squeeze."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from render.model.arrays import DoubleArray
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.stop_rays import rays_from_film

_SAMPLES = 129
_STEEPEST = 4.0
_NUDGE_MM = 1e-3


@dataclass(frozen=True, eq=False)
class CylinderChiefs:
    """Exact rays through the middle of the stop.

    Attributes:
        lens: as focused.
        squeeze: by which the picture is stretched back.
        toward: ``(2,)`` unit vector, right and up, along which heights of the picture are measured.
    """

    lens: FocusedLens
    squeeze: float
    toward: DoubleArray

    @property
    def stretching(self) -> DoubleArray:
        """``(2,)`` picture over film."""
        return np.array([self.squeeze, 1.0])

    def at(self, places_mm: DoubleArray, nearness_per_mm: float) -> tuple[DoubleArray, DoubleArray]:
        """Directions of what is seen at places of the picture.

        Args:
            places_mm: ``(k, 2)``.
            nearness_per_mm: of the objects: 1 over their depth.

        Returns:
            ``(k, 2)`` the objects' slopes from the centre of the entrance pupil, and ``(k, 2)`` where the rays cross its plane,
            mm; NaN where no ray gets through.
        """
        film = -np.sign(self.lens.image_scale_mm) * places_mm / self.stretching
        rays = rays_from_film(self.lens, film, np.zeros_like(film))
        lost = ~rays.passed[:, None]
        crossing = np.where(lost, np.nan, rays.pupil_mm)
        return np.where(lost, np.nan, rays.slope) + crossing * nearness_per_mm, crossing

    def stretch(self, places_mm: DoubleArray, nearness_per_mm: float) -> DoubleArray:
        """``(k,)`` area in slopes over area of the picture, 1/mm²."""
        steps = [
            (self.at(places_mm + way, nearness_per_mm)[0] - self.at(places_mm - way, nearness_per_mm)[0])
            / (2 * _NUDGE_MM)
            for way in _NUDGE_MM * np.eye(2)
        ]
        return np.asarray(np.abs(np.linalg.det(np.stack(steps, axis=-1))))

    @cached_property
    def last_height_mm(self) -> float:
        """Beyond it no chief ray gets through the glass, or the picture folds over."""
        heights = np.linspace(0.0, _STEEPEST * abs(self.lens.image_scale_mm), _SAMPLES)
        seen = self.at(heights[:, None] * self.toward, 0.0)[0] @ self.toward
        grows = np.append(True, np.diff(seen) > 0)
        return float(heights[-1] if grows.all() else heights[max(int(np.argmin(grows)) - 1, 1)])
