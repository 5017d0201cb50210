"""Reduces dense samples to the few knots of a monotone cubic, so that a baked curve can be edited by hand.

The curve is piecewise cubic Hermite. Slopes at the knots come from the dense samples and are limited to three times the
lesser neighbouring secant, and to zero at turning points, which keeps each piece monotone (Fritsch and Carlson 1980,
"Monotone Piecewise Cubic Interpolation", section 4): between two knots the curve never overshoots them. Knots are put in
where the curve is farthest from a sample, until none is farther than the tolerance; needless ones are taken out again.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from usd_schemas.errors import SchemaError

Doubles = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Knots:
    """A piecewise cubic Hermite curve, level beyond its ends.

    Attributes:
        times: ``(k,)`` increasing.
        values: ``(k,)`` at the times.
        slopes: ``(k,)`` derivative by time.
    """

    times: Doubles
    values: Doubles
    slopes: Doubles

    def at(self, times: Doubles) -> Doubles:
        """The curve's values at ``(n,)`` times."""
        if len(self.times) == 1:
            return np.full(len(times), self.values[0])
        clipped = np.clip(times, self.times[0], self.times[-1])
        left = np.clip(np.searchsorted(self.times, clipped, side="right") - 1, 0, len(self.times) - 2)
        span = self.times[left + 1] - self.times[left]
        u = (clipped - self.times[left]) / span
        rise = self.values[left + 1] - self.values[left]
        start, end = self.slopes[left] * span, self.slopes[left + 1] * span
        # Hermite's form around the left knot: exact there, and at the right knot to rounding.
        return self.values[left] + u * (start + u * ((3 * rise - 2 * start - end) + u * (start + end - 2 * rise)))


def fit_knots(times: ArrayLike, values: ArrayLike, tolerance: ArrayLike = 0.0) -> Knots:
    """Fit a monotone cubic with few knots through dense samples.

    Args:
        times: ``(n,)`` strictly increasing.
        values: ``(n,)`` finite.
        tolerance: how far the curve may be from a sample, one for all or ``(n,)``; 0 makes every sample a knot unless it
            lies on the curve through the others. Both ends are always exact.

    Raises:
        SchemaError: there are no samples, or they are not finite, not as many as the times, or not in order of time.
    """
    t, v = checked_samples(times, values)
    allowed = np.broadcast_to(np.asarray(tolerance, np.float64), t.shape)
    slopes = _sample_slopes(t, v)

    chosen = np.array(sorted({0, len(t) - 1}))
    while len(worst := _worst_between(chosen, _excess(chosen, t, v, slopes, allowed))):
        chosen = np.union1d(chosen, worst)
    chosen = _without_needless(chosen, t, v, slopes, allowed)
    return _through(chosen, t, v, slopes)


def _through(chosen: Indices, t: Doubles, v: Doubles, slopes: Doubles) -> Knots:
    """The curve whose knots are the samples at ``(k,)`` indices."""
    return Knots(t[chosen], v[chosen], _limited(slopes[chosen], t[chosen], v[chosen]))


def _excess(chosen: Indices, t: Doubles, v: Doubles, slopes: Doubles, allowed: Doubles) -> Doubles:
    """Return each sample's distance from the curve beyond its tolerance; a knot has none."""
    excess: Doubles = np.abs(_through(chosen, t, v, slopes).at(t) - v) - allowed
    excess[chosen] = -np.inf
    return excess


def _without_needless(chosen: Indices, t: Doubles, v: Doubles, slopes: Doubles, allowed: Doubles) -> Indices:
    """Take out knots that the curve stays within its tolerance without.

    A knot's going changes the slopes of its two neighbours, and so two segments on either side; to know these, the third
    knot on either side is looked at as well.
    """
    kept = list(chosen)
    position = 1
    while position < len(kept) - 1:
        first, last = max(position - 3, 0), min(position + 3, len(kept) - 1)
        window = np.array(kept[first:position] + kept[position + 1 : last + 1])
        span = slice(window[0], window[-1] + 1)
        inner = slice(kept[max(position - 2, 0)] - span.start, kept[min(position + 2, len(kept) - 1)] + 1 - span.start)
        excess = _excess(window - span.start, t[span], v[span], slopes[span], allowed[span])[inner]
        if np.any(excess > 0):
            position += 1
        else:
            del kept[position]
    return np.array(kept)


def checked_samples(times: ArrayLike, values: ArrayLike) -> tuple[Doubles, Doubles]:
    """Times and values as arrays, if they make a curve.

    Raises:
        SchemaError: as `fit_knots`.
    """
    t, v = np.asarray(times, np.float64), np.asarray(values, np.float64)
    if t.ndim != 1 or t.shape != v.shape or len(t) == 0:
        raise SchemaError(f"a curve needs as many values as times, and at least one; got {v.shape} and {t.shape}")
    bad = np.flatnonzero(~(np.isfinite(t) & np.isfinite(v)))
    if len(bad):
        raise SchemaError(f"a curve needs finite values, got {v[bad[0]]} at time {t[bad[0]]}")
    unordered = np.flatnonzero(np.diff(t) <= 0)
    if len(unordered):
        first = unordered[0]
        raise SchemaError(f"a curve needs increasing times, got {t[first + 1]:g} after {t[first]:g}")
    return t, v


def _sample_slopes(t: Doubles, v: Doubles) -> Doubles:
    """Derivative at every sample: of the parabola through its neighbours, or of the end's straight line."""
    if len(t) == 1:
        return np.zeros(1)
    return np.gradient(v, t)


def _limited(slopes: Doubles, t: Doubles, v: Doubles) -> Doubles:
    """Limit slopes at knots so that each piece is monotone."""
    if len(t) == 1:
        return np.zeros(1)
    secant = np.diff(v) / np.diff(t)
    before, after = np.concatenate([secant[:1], secant]), np.concatenate([secant, secant[-1:]])
    turning = (before * after <= 0) | (slopes * before <= 0)
    most = 3.0 * np.minimum(np.abs(before), np.abs(after))
    return np.where(turning, 0.0, np.sign(slopes) * np.minimum(np.abs(slopes), most))


def _worst_between(index: Indices, excess: Doubles) -> Indices:
    """Index of the worst sample between each two knots, where one is beyond its tolerance."""
    worst = [left + 1 + int(np.argmax(excess[left + 1 : right])) for left, right in pairwise(index) if right - left > 1]
    return np.array([sample for sample in worst if excess[sample] > 0], np.intp)
