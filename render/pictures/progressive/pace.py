"""How good a preview can be in the time there is, learnt from those before it."""

from __future__ import annotations

from dataclasses import dataclass

GOOD_RAYS, ENOUGH_RAYS = 12, 64
"""With fewer rays a smaller picture is better; more are seldom seen in a preview."""
SOFTWARE_SIDE_PX, DEVICE_SIDE_PX = 480, 1920
"""Longer side of what is peeled for previews, on a processor and on a graphics device."""
_SHARES = (1.0, 5 / 6, 2 / 3, 1 / 2, 1 / 3)  # of that, which a preview has: few, so that it does not flicker
_FIXED_RAYS = 7  # that what is done once for a pixel costs as much as


@dataclass(frozen=True)
class Plan:
    """What a preview is to be.

    Attributes:
        width: pixels.
        height: pixels.
        rays: for each.
    """

    width: int
    height: int
    rays: int

    @property
    def work(self) -> int:
        """Rays, and what costs as much as so many."""
        return self.width * self.height * (self.rays + _FIXED_RAYS)


class Pace:
    """Of one machine.

    Args:
        is_software: whether a processor draws.
    """

    def __init__(self, *, is_software: bool) -> None:
        self._side_px = SOFTWARE_SIDE_PX if is_software else DEVICE_SIDE_PX
        self._ms = 3e-5 if is_software else 1e-6  # of a unit of work
        self._blur_ms = 5e-4 if is_software else 1e-5  # of a pixel

    def largest(self, width: int, height: int) -> tuple[int, int]:
        """The width and height of what is peeled for previews of a picture, pixels."""
        return self._scaled(width, height, 1.0)

    def plan(self, width: int, height: int, left_ms: float) -> Plan:
        """The preview of a picture.

        Args:
            width: of the picture in pixels.
            height: likewise.
            left_ms: for its rays.
        """
        for share in _SHARES:
            size = self._scaled(width, height, share)
            rays = int(left_ms / self._ms / (size[0] * size[1])) - _FIXED_RAYS
            if rays >= GOOD_RAYS:
                return Plan(*size, min(rays, ENOUGH_RAYS))
        return Plan(*self._scaled(width, height, _SHARES[-1]), GOOD_RAYS)

    def learn(self, plan: Plan, took_ms: float) -> None:
        """Take note of what a preview's rays took."""
        self._ms += 0.3 * (took_ms / plan.work - self._ms)

    def can_blur(self, width: int, height: int, left_ms: float) -> bool:
        """Whether a picture can be blurred in its time.

        Args:
            width: of the picture in pixels.
            height: likewise.
            left_ms: for its blur.
        """
        return self._blur_ms * width * height <= left_ms

    def learn_blur(self, width: int, height: int, took_ms: float) -> None:
        """Take note of what it took to blur a picture."""
        self._blur_ms += 0.3 * (took_ms / (width * height) - self._blur_ms)

    def _scaled(self, width: int, height: int, share: float) -> tuple[int, int]:
        scale = share * min(1.0, self._side_px / max(width, height))
        return max(1, round(scale * width)), max(1, round(scale * height))
