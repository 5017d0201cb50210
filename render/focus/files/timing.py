"""Frame rates as ratios of whole numbers, and SMPTE timecode."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

NTSC = Fraction(1000, 1001)
_SLACK = 1e-5
"""Relative. 23.976 and 24000/1001 are as near to each other as this; 24 and 24000/1001 are a hundred times farther apart."""

MAX_TIMECODE_RATE = 120
"""Greatest number of frames in a second of SMPTE timecode (its frames end at 119)."""

_DROPPED_A_MINUTE = {30: 2, 60: 4}
_MINUTES_A_DAY = 24 * 60


def rate_as_fraction(rate: float) -> Fraction:
    """A frame rate as a ratio: 23.976 is 24000/1001.

    Args:
        rate: in 1/s, above 0.
    """
    whole = round(rate)
    for exact in (Fraction(whole), math.ceil(rate) * NTSC):
        if exact > 0 and abs(rate / float(exact) - 1) < _SLACK:
            return exact
    return Fraction(rate).limit_denominator(1001)


def snapped_rate(rate: float) -> float:
    """A rate that was measured, without the noise of the measurement: 23.99999 is 24.

    Args:
        rate: in 1/s, above 0.
    """
    exact = float(rate_as_fraction(rate))
    return exact if abs(rate - exact) < _SLACK * exact else rate


@dataclass(frozen=True)
class Timecode:
    """SMPTE timecode (ST 12-1).

    Attributes:
        hours: 0 to 23.
        minutes: 0 to 59.
        seconds: 0 to 59.
        frames: 0 to one less than the rate, rounded up.
        drop_frame: whether two (at 30) or four (at 60) numbers are left out each minute that is no tenth one.
    """

    hours: int
    minutes: int
    seconds: int
    frames: int
    drop_frame: bool = False

    @classmethod
    def from_frame(cls, frame: int, rate: Fraction) -> Timecode:
        """Timecode of a frame, without dropped numbers; it wraps around after a day.

        Args:
            frame: 0 or more.
            rate: frames per second.
        """
        count = math.ceil(rate)
        seconds, frames = divmod(frame, count)
        minutes, seconds = divmod(seconds, 60)
        hours, minutes = divmod(minutes, 60)
        return cls(hours % 24, minutes, seconds, frames)

    def frame(self, rate: Fraction) -> int:
        """Frames since 00:00:00:00.

        Args:
            rate: frames per second.
        """
        count = math.ceil(rate)
        minutes = self.hours * 60 + self.minutes
        frames = (minutes * 60 + self.seconds) * count + self.frames
        dropped = _DROPPED_A_MINUTE.get(count, 0) if self.drop_frame else 0
        return frames - dropped * (minutes - minutes // 10)


def frames_a_day(rate: Fraction, *, drop_frame: bool) -> int:
    """Number of frames that timecode counts before it wraps around.

    Args:
        rate: frames per second.
        drop_frame: whether frame numbers are dropped (SMPTE drop-frame timecode).
    """
    count = math.ceil(rate)
    dropped = _DROPPED_A_MINUTE.get(count, 0) if drop_frame else 0
    return _MINUTES_A_DAY * 60 * count - dropped * (_MINUTES_A_DAY - _MINUTES_A_DAY // 10)
