"""Characteristic curves: density against log10 exposure (Hurter, Driffield 1890), from knots or from toe, line, shoulder."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from render.errors import SettingsError
from render.model.arrays import DoubleArray, FloatArray
from usd_schemas.settings.tables import FILM_SETTINGS

Knots = tuple[tuple[float, float], ...]
"""(log10 exposure, density), log exposure increasing."""


MAX_LOG_EXPOSURE = FILM_SETTINGS["curve_middle_gray"].accepted.most
"""Greatest magnitude of a curve's log10 exposures: ten times any film's range, and within single precision."""
MAX_DENSITY = 20.0
"""Four times what any film reaches."""
MIN_STEP = 1e-10
"""Least step of log10 exposure between knots: slopes stay finite."""

# Pictures use a table of this many even steps: within 2e-6 of density of the cubic on any stock of the library.
_TABLE_STEPS = 4096
_STEPS = 32  # knots in each bend and on the line


@dataclass(frozen=True)
class Curve:
    """One layer's characteristic curve: knots joined by a monotone cubic, level beyond the ends.

    Attributes:
        knots: (log10 exposure, density), at least two; exposure increases by `MIN_STEP` or more, and density
            rises throughout or falls throughout (it may stay level).
        name: whose curve it is, for messages.

    Raises:
        SettingsError: the knots are fewer, are beyond `MAX_LOG_EXPOSURE` or `MAX_DENSITY`, or run backwards.
    """

    knots: Knots
    name: str = "the curve"

    def __post_init__(self) -> None:
        if len(self.knots) < 2:
            raise _bad(f"{self.name} needs at least 2 knots (log10 exposure, density), got {len(self.knots)}")
        for knot in self.knots:
            if not (abs(knot[0]) <= MAX_LOG_EXPOSURE and 0 <= knot[1] <= MAX_DENSITY):
                raise _bad(
                    f"{self.name} needs log10 exposures from {-MAX_LOG_EXPOSURE:g} to {MAX_LOG_EXPOSURE:g} and densities "
                    f"from 0 to {MAX_DENSITY:g}, got ({knot[0]:g}, {knot[1]:g})"
                )
        for before, after in pairwise(self.knots):
            if not after[0] - before[0] >= MIN_STEP:
                raise _bad(
                    f"log exposure of {self.name} must increase by at least {MIN_STEP:g}, "
                    f"got {after[0]:g} after {before[0]:g}"
                )
        rises = np.diff(self._densities)
        if (rises > 0).any() and (rises < 0).any():
            against = np.argmax(rises < 0 if rises.sum() > 0 else rises > 0)
            (x0, d0), (x1, d1) = self.knots[against : against + 2]
            raise _bad(
                f"{self.name} runs backwards: density must rise or fall throughout, "
                f"got {d0:g} at {x0:g} and {d1:g} at {x1:g}"
            )

    @property
    def rises(self) -> bool:
        """Whether density grows with exposure, as it does on a negative and on a print stock."""
        return self.knots[-1][1] > self.knots[0][1]

    @property
    def falls(self) -> bool:
        """Whether density shrinks with exposure, as it does on a reversal stock."""
        return self.knots[-1][1] < self.knots[0][1]

    @property
    def base(self) -> float:
        """Least density: of the base and its fog, or of a reversal stock's clear film."""
        return min(self.knots[0][1], self.knots[-1][1])

    @property
    def greatest(self) -> float:
        """Greatest density."""
        return max(self.knots[0][1], self.knots[-1][1])

    def density(self, log_exposure: ArrayLike) -> DoubleArray:
        """Density by the cubic itself, in double precision.

        Args:
            log_exposure: log10 exposure, any shape.

        Returns:
            Density, of the same shape.
        """
        x = np.clip(np.asarray(log_exposure, np.float64), self._exposures[0], self._exposures[-1])
        i = np.clip(np.searchsorted(self._exposures, x, side="right") - 1, 0, len(self.knots) - 2)
        step = np.diff(self._exposures)[i]
        t = (x - self._exposures[i]) / step
        here, there = self._densities[i], self._densities[i + 1]
        slope, next_slope = self._slopes[i] * step, self._slopes[i + 1] * step
        rise = there - here
        cubic: DoubleArray = here + t * (
            slope + t * (3 * rise - 2 * slope - next_slope + t * (slope + next_slope - 2 * rise))
        )
        return cubic

    def densities(self, log_exposure: FloatArray) -> FloatArray:
        """Density of a whole picture by table look-up, in single precision.

        Args:
            log_exposure: log10 exposure, any shape; infinities are the ends.

        Returns:
            Density, float32, of the same shape.
        """
        x, density = self._single_table
        place = np.asarray(log_exposure, np.float32) - np.float32(x[0])
        place *= np.float32((len(x) - 1) / (x[-1] - x[0]))
        np.clip(place, 0, len(x) - 1, out=place)
        step = np.minimum(place.astype(np.int32), len(x) - 2)
        place -= step
        here = density[step]
        place *= density[step + 1] - here
        place += here
        return place

    def exposure_at(self, density: float) -> float:
        """Log10 exposure at which the curve has a density: the middle of the stretch, where it is level there.

        Args:
            density: within the curve's range.

        Raises:
            SettingsError: the curve does not reach it.
        """
        if not self.base <= density <= self.greatest:
            raise _bad(f"{self.name} has densities from {self.base:g} to {self.greatest:g}, not {density:g}")
        x, d = self.table
        sign = 1.0 if self.rises else -1.0
        first, last = (np.searchsorted(sign * d, sign * density, side=side) for side in ("left", "right"))
        if last - first > 1:  # level there
            return float((x[first] + x[last - 1]) / 2)
        return float(np.interp(sign * density, sign * d, x))

    @cached_property
    def table(self) -> tuple[DoubleArray, DoubleArray]:
        """Log10 exposure at even steps, ``(n,)``, and density there, for look-ups of pictures."""
        x = np.linspace(self._exposures[0], self._exposures[-1], _TABLE_STEPS)
        return x, self.density(x)

    @cached_property
    def _single_table(self) -> tuple[DoubleArray, FloatArray]:
        x, density = self.table
        return x, density.astype(np.float32)

    @cached_property
    def _exposures(self) -> DoubleArray:
        return np.array([knot[0] for knot in self.knots], np.float64)

    @cached_property
    def _densities(self) -> DoubleArray:
        return np.array([knot[1] for knot in self.knots], np.float64)

    @cached_property
    def _slopes(self) -> DoubleArray:
        return _monotone_slopes(self._exposures, self._densities)


def parametric_knots(
    least: float, greatest: float, gamma: float, toe: float, shoulder: float, aim: float, name: str = "the curve"
) -> Knots:
    """Knots of a curve of toe, straight line and shoulder: each bend a parabola that joins level film and line without
    a kink.

    The line passes ``aim`` above the least density at log exposure 0. The toe is the bend at the least density, the
    shoulder that at the greatest, so on a reversal stock the toe is at great exposure.

    Args:
        least: density without exposure (for a reversal stock: with all of it).
        greatest: density that the curve ends at.
        gamma: slope of the line, density over log10 exposure; negative for a reversal stock.
        toe: log10 exposure from where the bend begins to where it is the line.
        shoulder: the same at the other end.
        aim: density above ``least`` at log exposure 0; half the curve's range where that is less.
        name: whose curve it is, for messages.

    Raises:
        SettingsError: a number is not finite, densities are out of order, gamma is 0, or the bends leave no straight line.
    """
    numbers = (least, greatest, gamma, toe, shoulder)
    if not all(map(math.isfinite, numbers)) or not 0 <= least < greatest or gamma == 0 or toe < 0 or shoulder < 0:
        raise _bad(
            f"{name} needs 0 <= least density < greatest density, a gamma other than 0, and toe and shoulder from 0 up; "
            f"got {least:g}, {greatest:g}, {gamma:g}, {toe:g}, {shoulder:g}"
        )
    steep, span = abs(gamma), greatest - least
    run = span / steep  # log exposure that the line alone would take
    if (toe + shoulder) / 2 > run:
        raise _bad(f"{name} has no room for a toe of {toe:g} and a shoulder of {shoulder:g}: its line is {run:g} long")
    t = np.linspace(0, 1, _STEPS + 1)
    # From where the line alone would leave the least density: the toe lies half before and half behind that.
    line = toe / 2 + t * (run - (toe + shoulder) / 2)
    up = np.concatenate([toe * (t - 0.5), line, run + shoulder * (t - 0.5)])
    density = np.concatenate(
        [least + steep * toe * t**2 / 2, least + steep * line, greatest - steep * shoulder * (1 - t) ** 2 / 2]
    )
    up, first = np.unique(up.round(9), return_index=True)
    exposure = math.copysign(1, gamma) * (up - min(aim, span / 2) / steep)
    pairs = sorted(zip(exposure.tolist(), density[first].tolist(), strict=True))
    return tuple(pairs)


def _monotone_slopes(x: DoubleArray, y: DoubleArray) -> DoubleArray:
    """Slopes at the knots with which the cubic overshoots none of them (Fritsch and Butland 1984; ends as Moler 2004, §3.4)."""
    h, d = np.diff(x), np.diff(y) / np.diff(x)
    if len(d) == 1:
        return np.repeat(d, 2)
    w1, w2 = 2 * h[1:] + h[:-1], h[1:] + 2 * h[:-1]
    # A level step, or one of 1e-300, makes a quotient infinite: the mean is then 0, as it must be.
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        harmonic = (w1 + w2) / (w1 / d[:-1] + w2 / d[1:])
    inner = np.where(d[:-1] * d[1:] > 0, harmonic, 0.0)
    return np.concatenate([[_end_slope(h[0], h[1], d[0], d[1])], inner, [_end_slope(h[-1], h[-2], d[-1], d[-2])]])


def _end_slope(h0: float, h1: float, d0: float, d1: float) -> float:
    slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1)
    if slope * d0 <= 0:
        return 0.0
    return 3 * d0 if d0 * d1 <= 0 and abs(slope) > 3 * abs(d0) else slope


def _bad(message: str) -> SettingsError:
    return SettingsError(message, code="bad_curve")
