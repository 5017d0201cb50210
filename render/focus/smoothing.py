"""Smoothing over time that is exact at keys and never overshoots, and fades in place of switches.

A value is replaced by its mean over a window around its time, weighted by Hann's bell. The window has the requested width, but
never reaches beyond a key or an end of the shot: toward one it narrows, and there it closes. Three things follow.

- At keys and at both ends the result is the value itself.
- Between two keys the result lies between the least and the greatest value there.
- The times ``t + h(t)·u`` in a window never run backwards in t, as ``|h'| ≤ 1``: where the values rise between
  two keys, so does the result. Nothing rings.

A window reaches half its width ahead and back, so a frame depends on no more of the shot than that.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from render.errors import SettingsError
from render.model.arrays import DoubleArray

_LEAST_NODES, _MOST_NODES = 16, 512


def smooth(times_s: ArrayLike, values: ArrayLike, time_s: ArrayLike, *, exact_at_s: ArrayLike = ()) -> DoubleArray:
    """Smooth values over time (see the head of this module).

    Args:
        times_s: ``(n,)`` rising.
        values: ``(n, ...)``, joined by straight lines; each column is smoothed by itself.
        time_s: width of the window, 0 for none; one, or ``(n,)`` where it changes over time.
        exact_at_s: ``(k,)`` times at which the result is the value itself, in any order: of the keys that say a value. A key
            that holds and then jumps is no such time, as the jump could not be smoothed.

    Returns:
        ``(n, ...)``.

    Raises:
        SettingsError: times do not rise, values are not finite or not as many, or a width is negative.
    """
    t, v = check_samples(times_s, values)
    stops = np.concatenate([t[[0, -1]], np.ravel(np.asarray(exact_at_s, np.float64))])
    return _mean_around(t, v, _half_widths(t, time_s, stops))


def fade_weights(
    on: ArrayLike, times_s: ArrayLike, time_s: ArrayLike, *, usable: NDArray[np.bool_] | None = None
) -> DoubleArray:
    """Weights, 0 to 1, of points that are switched on and off over time, crossfaded so that no switch pops.

    A switch becomes a crossing as long as ``time_s`` with the switch in its middle; before the shot and after it the switches
    stay as they are at its ends. So of two points of which one goes off as the other goes on, the sum stays 1 and the focus
    goes over from one to the other. From one frame to the next a point changes by at most
    ``2 · (time between them) / time_s``, however fast it is switched.

    A point that has no place, or none in front of the camera, cannot count at all: where ``usable`` is False the answer is
    0, and the crossing is over by then. `points_share` is the points' share of the focus then.

    Args:
        on: ``(n, k)`` switches, or shares from 0 to 1 such as the visible share of a point.
        times_s: ``(n,)`` rising.
        time_s: length of a crossing, 0 to switch at once; one, or ``(n,)``.
        usable: ``(n, k)``; None where all can count at all times.

    Returns:
        ``(n, k)``: 1 counts in full.

    Raises:
        SettingsError: as `smooth`, or a share is not from 0 to 1.
    """
    t, shares = check_samples(times_s, on)
    if shares.size and not (shares.min() >= 0 and shares.max() <= 1):
        raise SettingsError("points are switched by shares from 0 to 1", code="bad_focus_point")
    if usable is not None:
        shares = np.where(usable & (_away_from(~usable, t) >= _clearance(t, time_s)), shares, 0.0)
    fades = np.clip(_mean_around(t, shares, _half_widths(t, time_s, np.empty(0))), 0.0, 1.0)
    return fades if usable is None else np.where(usable, fades, 0.0)


def points_share(fades: DoubleArray) -> DoubleArray:
    """Share of the focus that the points hold; the camera's own focus holds the rest, so that the last point does not pop.

    Args:
        fades: ``(n, k)`` of `fade_weights`.

    Returns:
        ``(n,)``: the sum over the points, at most 1.
    """
    return np.asarray(np.minimum(fades.sum(axis=1), 1.0))


def check_samples(times_s: ArrayLike, values: ArrayLike) -> tuple[DoubleArray, DoubleArray]:
    """Times ``(n,)`` and values ``(n, ...)`` as arrays.

    Raises:
        SettingsError: there are none, times do not rise, or values are not finite or not as many.
    """
    t, v = np.asarray(times_s, np.float64), np.asarray(values, np.float64)
    if t.ndim != 1 or len(t) == 0 or not np.isfinite(t).all() or (np.diff(t) <= 0).any():
        raise SettingsError(
            "the times of a focus must be finite and rise, and there must be at least one", code="bad_frames"
        )
    if v.ndim == 0 or len(v) != len(t):
        raise SettingsError(f"a focus over {len(t)} times needs as many values, got shape {v.shape}", code="bad_curve")
    bad = np.argwhere(~np.isfinite(v))
    if len(bad):
        raise SettingsError(f"a focus must be finite at all times, but is not at {t[bad[0, 0]]:g} s", code="bad_curve")
    return t, v


def over_time(what: str, value: ArrayLike, times_s: DoubleArray) -> DoubleArray:
    """Column ``(n,)`` of a setting that is one number or one per time.

    Raises:
        SettingsError: there are not as many as times, or one is negative or not finite.
    """
    each = np.asarray(value, np.float64)
    if each.shape not in ((), times_s.shape):
        raise SettingsError(f"the {what} must be one number or {len(times_s)}, got shape {each.shape}")
    if not (np.isfinite(each).all() and (each >= 0).all()):
        raise SettingsError(f"the {what} must be finite and 0 or more, but the least is {each.min():g}")
    return np.broadcast_to(each, times_s.shape)


def _half_widths(t: DoubleArray, time_s: ArrayLike, stops: DoubleArray) -> DoubleArray:
    """Half widths ``(n,)`` of the windows: not beyond a stop, and changing no faster than time."""
    half = over_time("time of smoothing", time_s, t) / 2
    if len(stops):
        stops = np.unique(stops)
        after = np.searchsorted(stops, t).clip(max=len(stops) - 1)
        half = np.minimum(half, np.minimum(np.abs(t - stops[np.maximum(after - 1, 0)]), np.abs(t - stops[after])))
    half = np.minimum(half, np.minimum.accumulate(half - t) + t)
    half = np.minimum(half, np.minimum.accumulate((half + t)[::-1])[::-1] - t)
    return np.maximum(half, 0.0)


def _mean_around(t: DoubleArray, v: DoubleArray, half: DoubleArray) -> DoubleArray:
    """Means of ``(n, ...)`` over windows of half widths ``(n,)``; beyond the ends the values are constant."""
    if len(t) == 1 or half.max() <= 0:
        return v.copy()
    count = int(np.clip(4 * math.ceil(half.max() / np.diff(t).min()), _LEAST_NODES, _MOST_NODES))
    nodes = (2 * np.arange(count) + 1) / count - 1
    bell = 1 + np.cos(np.pi * nodes)
    away = np.zeros_like(v)  # mean of differences from the value: a constant stays exact
    for node, share in zip(nodes, bell / bell.sum(), strict=True):
        away += share * (_between(t, v, t + half * node) - v)
    closed = (half <= 0).reshape(-1, *[1] * (v.ndim - 1))
    return np.where(closed, v, v + away)


def _between(t: DoubleArray, v: DoubleArray, at: DoubleArray) -> DoubleArray:
    """Interpolate linearly at times ``(m,)``."""
    left = np.searchsorted(t, at, side="right").clip(1, len(t) - 1) - 1
    share = ((at - t[left]) / (t[left + 1] - t[left])).clip(0.0, 1.0).reshape(-1, *[1] * (v.ndim - 1))
    return np.asarray(v[left] + share * (v[left + 1] - v[left]))


def _away_from(marked: NDArray[np.bool_], t: DoubleArray) -> DoubleArray:
    """Seconds ``(n, k)`` to the nearest marked time of each column; infinite without marked times."""
    times = t[:, None]
    last = np.maximum.accumulate(np.where(marked, times, -np.inf), axis=0)
    following = np.minimum.accumulate(np.where(marked, times, np.inf)[::-1], axis=0)[::-1]
    return np.asarray(np.minimum(times - last, following - times))


def _clearance(t: DoubleArray, time_s: ArrayLike) -> DoubleArray:
    """Distance ``(n, 1)`` in time from an unusable time at which a crossing must be over."""
    half = over_time("time of smoothing", time_s, t).max() / 2
    step_s = np.diff(t).max(initial=0.0)  # switches are joined by straight lines, which reach one step farther
    return np.full((len(t), 1), half + step_s if half > 0 else 0.0)
