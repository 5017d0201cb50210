"""Shutter: exposure of the film over time and place, as plain data.

The times at which it opens and closes belong to the camera; the way it opens and the order of the lines are here.

Each place of the picture is exposed from ``open + delay`` to ``close + delay``, where the delay grows along the way that the
shutter or the readout travels. Over that time the shutter lets through what its efficiency curve says: the slit of a focal plane
shutter and the lines of a sensor open and close at once, the blades of a leaf shutter do not.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from render.errors import SettingsError
from render.model.arrays import DoubleArray

ShutterKind = Literal["global", "rolling", "focalPlane", "leaf"]
Direction = Literal["down", "up", "left", "right"]
_INSTANT = 1e-9  # time codes, or share of the delay: what is shorter has no parts that rounding could tell apart
_STEPS = 64  # a moment's share of an efficiency curve is summed over so many steps


@dataclass(frozen=True)
class Shutter:
    """Motion of a shutter.

    Attributes:
        kind: ``global`` and ``leaf`` expose the whole picture at once, ``rolling`` and ``focalPlane`` line after line.
        direction: direction in which lines are exposed, in the picture as it is seen.
        travel: from the first line's opening to the last one's, in time codes.
        efficiency: how much light passes over the time that a place is exposed, at even steps from its opening to its closing,
            joined by straight lines; empty for all of it at all times.
    """

    kind: ShutterKind = "global"
    direction: Direction = "down"
    travel: float = 0.0
    efficiency: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        """Check the numbers.

        Raises:
            SettingsError: the travel is negative, or the efficiency lets nothing through or is negative.
        """
        if not 0 <= self.travel < np.inf:
            raise SettingsError(f"the travel time of a shutter must be 0 or more, got {self.travel:g}")
        curve = np.array(self.efficiency, np.float64)
        if len(curve) and not (np.isfinite(curve).all() and (curve >= 0).all() and curve.any()):
            raise SettingsError(
                "the efficiency of a shutter must be numbers of 0 or more, and let light through at some time"
            )

    @property
    def delay(self) -> float:
        """From the opening at the first place to that at the last, in time codes; 0 where all are bared at once."""
        return self.travel if self.kind in ("rolling", "focalPlane") else 0.0


GLOBAL_SHUTTER = Shutter()


def moments(opens: float, closes: float, shutter: Shutter, count: int) -> DoubleArray:
    """Times at which to look, in the middle of even parts of all the time at which any place is exposed.

    Args:
        opens: when the first place opens, in time codes from the frame's own.
        closes: when the first place closes.
        shutter: the shutter.
        count: of moments.

    Returns:
        ``(count,)`` rising, in time codes from the frame's own.

    Raises:
        SettingsError: the shutter closes before it opens.
    """
    if not closes >= opens:
        raise SettingsError(
            f"a shutter cannot close before it opens: it opens at {opens:g} and closes at {closes:g}",
            code="bad_shutter",
        )
    return opens + (closes + shutter.delay - opens) * (np.arange(count) + 0.5) / count


def shares(opens: float, closes: float, shutter: Shutter, count: int, width: int, height: int) -> DoubleArray:
    """Share of each place's exposure that falls in the part of the time around each of `moments`.

    Args:
        opens: as in `moments`.
        closes: as in `moments`.
        shutter: its travel and efficiency.
        count: number of moments.
        width: picture width in pixels.
        height: picture height in pixels.

    Returns:
        ``(count, height, 1)`` or ``(count, 1, width)``, or ``(count, 1, 1)`` where all places are alike; adds up to 1 over the
        moments at every place.
    """
    delay = _delays(shutter, width, height)
    ends = opens + (closes + shutter.delay - opens) * np.arange(count + 1) / count
    if closes - opens <= _INSTANT * max(1.0, abs(opens), shutter.delay):
        nearest = np.abs(moments(opens, closes, shutter, count)[:, None, None] - (opens + delay)).argmin(axis=0)
        return np.asarray(np.arange(count)[:, None, None] == nearest, np.float64)
    through = (ends[:, None, None] - opens - delay) / (closes - opens)
    passed = np.diff(_passed(shutter, np.clip(through, 0.0, 1.0)), axis=0)
    return np.asarray(passed / passed.sum(axis=0))


def moments_per_pixel(parts: NDArray[np.float32 | np.float64]) -> int:
    """Count the moments at which the longest-exposed pixel is exposed: few where lines are exposed one after the other.

    Args:
        parts: `shares`.
    """
    return int(np.count_nonzero(parts, axis=0).max())


def _delays(shutter: Shutter, width: int, height: int) -> DoubleArray:
    """``(height, 1)``, ``(1, width)`` or ``(1, 1)`` when places open after the first."""
    if shutter.delay == 0:
        return np.zeros((1, 1))
    count = height if shutter.direction in ("down", "up") else width
    along = (np.arange(count) + 0.5) / count * shutter.delay
    if shutter.direction in ("up", "left"):
        along = along[::-1]
    return along[:, None] if shutter.direction in ("down", "up") else along[None]


def _passed(shutter: Shutter, through: DoubleArray) -> DoubleArray:
    """Share of a place's light that has passed after a share of its exposure time, both 0 to 1."""
    if len(shutter.efficiency) < 2:
        return through
    steps = np.linspace(0.0, 1.0, _STEPS * (len(shutter.efficiency) - 1) + 1)
    level = np.interp(steps, np.linspace(0.0, 1.0, len(shutter.efficiency)), shutter.efficiency)
    total = np.concatenate([[0.0], np.cumsum((level[1:] + level[:-1]) / 2)])
    return np.asarray(np.interp(through, steps, total / total[-1]))
