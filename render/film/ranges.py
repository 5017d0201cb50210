"""How far a film's numbers may go: one rule for whoever takes a picture, looks into a shot or edits it."""

from __future__ import annotations

from dataclasses import dataclass

from render.errors import SettingsError
from render.film.curve import MAX_LOG_EXPOSURE
from render.film.halation import MAX_RADIUS_MM
from render.film.sensor import MAX_CLIP_STOPS, MAX_ISO, MIN_ISO
from usd_schemas import FilmData
from usd_schemas.binding import property_values

MAX_PUSH = 5.0
MAX_GRAIN = 100.0
"""Times the stock's own: nothing but grain is left."""
MAX_GRAIN_UM = 500.0
"""The coarsest grain: far beyond any film's, and a kernel of some hundred pixels."""


@dataclass(frozen=True)
class Range:
    """Numbers that a property may have.

    Attributes:
        least: of each of them.
        most: likewise.
        unit: behind the numbers in messages.
        zero: what 0 means, where it stands for no number and lies outside.
    """

    least: float
    most: float
    unit: str = ""
    zero: str = ""

    def holds(self, number: float) -> bool:
        """Whether a number is allowed; NaN never is."""
        return self.least <= number <= self.most or (number == 0 and self.zero != "")

    def __str__(self) -> str:
        span = f"from {self.least:g} to {self.most:g}{self.unit}"
        return f"{span}, or 0 for {self.zero}" if self.zero else span


_RELATIVE = Range(1e-3, 1e3)
RANGES: dict[str, Range] = {
    "film:speed": Range(MIN_ISO, MAX_ISO, " ISO", "the stock's or sensor's own"),
    "film:curve:middleGray": Range(-MAX_LOG_EXPOSURE, MAX_LOG_EXPOSURE, " of log10 exposure"),
    "film:grain:amount": Range(0.0, MAX_GRAIN),
    "film:grain:rms": Range(0.0, 1000.0, " thousandths of density"),
    "film:grain:size": Range(0.0, MAX_GRAIN_UM, " µm"),
    "film:halation:radius": Range(0.0, MAX_RADIUS_MM, " mm"),
    "film:resolution": Range(0, 1_000_000, " photosites"),
    "film:sensor:fullWell": Range(1.0, 1e9, " electrons"),
    "film:sensor:readNoise": Range(0.0, 1e6, " electrons"),
    "film:sensor:clip": Range(0.0, MAX_CLIP_STOPS, " stops"),
    "film:sensor:sensitivity": _RELATIVE,
}
"""By the names of USD's properties. The rest of a film is judged where several numbers make one thing: curves, light, CDL."""


def check_numbers(data: FilmData) -> None:
    """Refuse numbers that no film or sensor has.

    Args:
        data: at one time.

    Raises:
        SettingsError: one is out of its range, or no number; the message names it.
    """
    for name, value in property_values(data):
        allowed = RANGES.get(name)
        if allowed is None:
            continue
        numbers = value if isinstance(value, tuple) else (value,)
        if not all(map(allowed.holds, numbers)):
            got = ", ".join(f"{number:g}" for number in numbers)
            each = " each" if len(numbers) > 1 else ""
            raise SettingsError(f"{name} must be {allowed}{each}, got {got}", code="bad_film")
