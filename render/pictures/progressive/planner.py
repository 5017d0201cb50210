"""Plans of previews: size and rays that fit the time, by the measured speed of earlier previews."""

from __future__ import annotations

from dataclasses import dataclass

GOOD_RAYS, ENOUGH_RAYS = 12, 64
"""Rays of the smallest previews, at least, and of any preview, at most: with more, few see a difference."""
SIZES = ((1.0, 32), (5 / 6, 13), (2 / 3, 9), (1 / 2, 7), (1 / 3, GOOD_RAYS))
"""Sizes of previews relative to the layers that they are traced through, each with the rays from which on it is closer to the
final picture than a smaller one that costs as much (measured on the demo shot: ``tests/bench/RESULTS.md``)."""
SOFTWARE_SIDE_PX, DEVICE_SIDE_PX = 480, 1920
"""Longer side of the layers that are peeled for previews, on a processor and on a graphics device."""
_FIXED_RAYS = 7  # rays that cost as much as the work done once for each pixel


@dataclass(frozen=True)
class PreviewPlan:
    """Size and rays of a preview.

    Attributes:
        width: pixels.
        height: pixels.
        rays: rays per pixel.
    """

    width: int
    height: int
    rays: int

    @property
    def work(self) -> int:
        """Cost of the preview, in rays."""
        return self.width * self.height * (self.rays + _FIXED_RAYS)


class PreviewPlanner:
    """Plans previews on one machine.

    Args:
        is_software: True where a processor draws.
    """

    def __init__(self, *, is_software: bool) -> None:
        self._side_px = SOFTWARE_SIDE_PX if is_software else DEVICE_SIDE_PX
        self._ray_ms = 3e-5 if is_software else 1e-6
        self._fixed_ms = 10.0 if is_software else 1.0
        self._pixel_blur_ms = 5e-4 if is_software else 1e-5

    def largest_size(self, width: int, height: int) -> tuple[int, int]:
        """Give width and height, in pixels, of the layers that are peeled for previews of a picture."""
        return self._scaled(width, height, 1.0)

    def plan(
        self, width: int, height: int, left_ms: float, least_ms: float = 0.0, most_rays: int = ENOUGH_RAYS
    ) -> PreviewPlan:
        """Choose the size and rays of a preview.

        Args:
            width: of the picture in pixels.
            height: likewise.
            left_ms: time for its rays, and for what is done before them.
            least_ms: time that its rays have even where nothing is left.
            most_rays: rays of the final picture.
        """
        most_rays = min(most_rays, ENOUGH_RAYS)
        left_ms = max(left_ms - self._fixed_ms, least_ms)
        for scale, least in SIZES:
            size = self._scaled(width, height, scale)
            rays = int(left_ms / self._ray_ms / (size[0] * size[1])) - _FIXED_RAYS
            if rays >= min(least, most_rays):
                break
        return PreviewPlan(*size, min(max(rays, least), most_rays))

    def learn(self, plan: PreviewPlan, took_ms: float, fixed_ms: float) -> None:
        """Adapt to the times that a preview's rays took, and what was done before them."""
        self._ray_ms += 0.3 * (took_ms / plan.work - self._ray_ms)
        self._fixed_ms += 0.3 * (fixed_ms - self._fixed_ms)

    def can_blur(self, width: int, height: int, left_ms: float) -> bool:
        """Tell whether a picture can be blurred in time.

        Args:
            width: of the picture in pixels.
            height: likewise.
            left_ms: time for its blur.
        """
        return self._pixel_blur_ms * width * height <= left_ms

    def learn_blur(self, width: int, height: int, took_ms: float) -> None:
        """Adapt to the time that a blur took."""
        self._pixel_blur_ms += 0.3 * (took_ms / (width * height) - self._pixel_blur_ms)

    def _scaled(self, width: int, height: int, scale: float) -> tuple[int, int]:
        scale *= min(1.0, self._side_px / max(width, height))
        return max(1, round(scale * width)), max(1, round(scale * height))
