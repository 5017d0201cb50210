"""Check of the USD time codes that callers pass in."""

from __future__ import annotations

import math

from render.errors import SettingsError


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
