"""Check of the USD time codes that callers pass in."""

from __future__ import annotations

import math

from render.errors import SettingsError

DEFAULT_TIME = math.nan
"""USD's default time as a number, as ``Usd.TimeCode.Default().GetValue()`` has it. A shot can be read at it, but not keyed."""


def check_reading_time(time: float) -> float:
    """Return a time code that a shot can be read at: a finite one, or `DEFAULT_TIME`.

    Args:
        time: USD time code.

    Raises:
        SettingsError: it is infinite.
    """
    return time if math.isnan(time) else check_time(time)


def check_time(time: float) -> float:
    """Return a time code that is finite.

    Args:
        time: USD time code.

    Raises:
        SettingsError: it is not finite.
    """
    if not math.isfinite(time):
        raise SettingsError(f"a time must be a finite USD time code, but it is {time}", code="bad_time")
    return time
