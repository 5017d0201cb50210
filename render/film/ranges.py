"""Check of film numbers against the ranges that the settings declare."""

from __future__ import annotations

from render.errors import SettingsError
from usd_schemas.binding import property_values
from usd_schemas.settings import FilmData
from usd_schemas.settings.setting import settings_of

_RANGES = {item.usd: item.accepts for item in settings_of(FilmData) if item.accepts is not None}
"""Ranges by USD property name. Curves, light and CDL are checked where their numbers are combined."""


def check_numbers(data: FilmData) -> None:
    """Refuse numbers that no film or sensor has.

    Args:
        data: at one time.

    Raises:
        SettingsError: one is out of its range, or no number; the message names it.
    """
    for name, value in property_values(data):
        allowed = _RANGES.get(name)
        if allowed is None:
            continue
        numbers = value if isinstance(value, tuple) else (value,)
        if not all(map(allowed.holds, numbers)):
            got = ", ".join(f"{number:g}" for number in numbers)
            each = " each" if len(numbers) > 1 else ""
            raise SettingsError(f"{name} must be {allowed}{each}, got {got}", code="bad_film")
