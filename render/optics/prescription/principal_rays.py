"""The rays through the middle of the stop: which place of the film shows which direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.tracing import trace_backward, trace_forward

_SAMPLES = 513
_STEEPEST_RAD = np.radians(85)


@dataclass(frozen=True, eq=False)
class PrincipalRays:
    """Chief rays of a focused lens at the d line, from the axis outward, on the side where the picture's height is positive.

    In object space each is ``pupil_mm + slopes·depth``, with depth counted from the entrance pupil toward the scene.

    Attributes:
        heights_mm: ``(n,)`` on the film, growing, as the upright picture has them.
        pupil_mm: ``(n,)`` where the ray crosses the plane of the paraxial entrance pupil: 0 but for the pupil's aberration.
        slopes: ``(n,)`` in object space.
    """

    heights_mm: DoubleArray
    pupil_mm: DoubleArray
    slopes: DoubleArray

    @property
    def last_height_mm(self) -> float:
        """Beyond it no chief ray gets through the glass, or the picture folds over."""
        return float(self.heights_mm[-1])

    def at(self, heights_mm: DoubleArray, nearness_per_mm: float) -> tuple[DoubleArray, DoubleArray]:
        """Where objects stand that are seen at heights of the picture.

        Args:
            heights_mm: ``(k,)``, not negative.
            nearness_per_mm: of the objects: 1 over their depth; 0 is infinity.

        Returns:
            ``(k,)`` the objects' slopes as seen from the centre of the entrance pupil, and ``(k,)`` pupil crossings.
        """
        crossing = np.interp(heights_mm, self.heights_mm, self.pupil_mm)
        return np.interp(heights_mm, self.heights_mm, self.slopes) + crossing * nearness_per_mm, crossing

    def stretch(self, heights_mm: DoubleArray, nearness_per_mm: float) -> DoubleArray:
        """``(k,)`` area in slopes over area on the film, 1/mm²: ``s·ds / (h·dh)``."""
        seen = self.slopes + self.pupil_mm * nearness_per_mm
        derivative = np.gradient(seen, self.heights_mm)
        ratio = np.divide(seen, self.heights_mm, out=derivative.copy(), where=self.heights_mm > 0)
        return np.interp(heights_mm, self.heights_mm, ratio * derivative)


def principal_rays(lens: FocusedLens) -> PrincipalRays:
    """Trace chief rays both ways from the middle of the stop, ever steeper, until one is lost or lands nearer to the axis.

    Args:
        lens: as focused.
    """
    slope = np.tan(np.linspace(0.0, _STEEPEST_RAD, _SAMPLES))
    directions = np.stack([0 * slope, slope, 1 + 0 * slope], axis=1) / np.sqrt(1 + slope**2)[:, None]
    points = np.tile([0.0, 0.0, float(lens.vertices_mm[lens.stop])], (_SAMPLES, 1))
    glass, placed, count = lens.prescription, lens.vertices_mm, len(lens.vertices_mm)
    # where the stop is a refracting surface, the rays start in the glass behind it; behind the last one there is only the film
    split = min(lens.stop + 1, count - 1)
    rear = trace_forward(glass, points, directions, vertices_mm=placed, clip=False, between=(split, count))
    front = trace_backward(glass, points, -directions, vertices_mm=placed, clip=False, between=(0, split))
    film = rear.at(lens.film_mm)[:, 1]
    # a lens of one surface, its stop, has nothing before that: its entrance pupil is the stop
    entering = front.at(lens.entrance_pupil_mm)[:, 1] if split else np.zeros(_SAMPLES)
    turned = -1.0 if film[1] < 0 else 1.0  # where a group turns the picture around between stop and film
    heights, crossing = turned * film, -turned * entering
    slopes = turned * front.directions[:, 1] / front.directions[:, 2]
    good = np.isfinite(heights) & np.isfinite(slopes)
    good[1:] &= (np.diff(heights) > 0) & (np.diff(slopes) > 0)
    last = len(good) if good.all() else int(np.argmin(good))
    return PrincipalRays(heights[:last], crossing[:last], slopes[:last])
