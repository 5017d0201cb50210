"""How good a preview can be in the time there is, learnt from those before it."""

from __future__ import annotations

from dataclasses import dataclass

LEAST_RAYS, ENOUGH_RAYS = 6, 64
SOFTWARE_SIDE_PX, DEVICE_SIDE_PX = 480, 1920
"""Longer side of the first preview, on a processor and on a graphics device."""
_LEAST_SIDE_PX = 160
_FIXED_RAYS = 7  # that what is done once for a pixel costs as much as
_STEP = 1.5
_SLOW, _QUICK = 3, 12
"""Previews, one after the other, that are late until they become smaller, and that have rays to spare until they grow again."""


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


class Pace:
    """Of one machine. The size changes seldom: layers that are kept are lost with it.

    Args:
        is_software: whether a processor draws.
    """

    def __init__(self, *, is_software: bool) -> None:
        self._side_px = self._most_px = float(SOFTWARE_SIDE_PX if is_software else DEVICE_SIDE_PX)
        self._ms_of_ray = 3e-5 if is_software else 1e-6  # of one pixel
        self._late = self._early = 0

    def plan(self, width: int, height: int, left_ms: float) -> Plan:
        """The preview of a picture.

        Args:
            width: of the picture in pixels.
            height: likewise.
            left_ms: of its time, for its rays.
        """
        share = min(1.0, self._side_px / max(width, height))
        width, height = max(1, round(share * width)), max(1, round(share * height))
        fits = int(left_ms / (self._ms_of_ray * width * height)) - _FIXED_RAYS
        return Plan(width, height, min(max(fits, LEAST_RAYS), ENOUGH_RAYS))

    def learn(self, plan: Plan, took_ms: float, left_ms: float) -> None:
        """Take note of what a preview's rays took, and of what they had."""
        self._ms_of_ray += 0.5 * (took_ms / ((plan.rays + _FIXED_RAYS) * plan.width * plan.height) - self._ms_of_ray)
        self._late = self._late + 1 if took_ms > 1.5 * left_ms and plan.rays == LEAST_RAYS else 0
        self._early = self._early + 1 if left_ms > 3 * _STEP**2 * LEAST_RAYS / plan.rays * took_ms else 0
        if self._late >= _SLOW:
            self._late, self._side_px = 0, max(self._side_px / _STEP, _LEAST_SIDE_PX)
        elif self._early >= _QUICK and self._side_px < self._most_px:
            self._early, self._side_px = 0, min(self._side_px * _STEP, self._most_px)
