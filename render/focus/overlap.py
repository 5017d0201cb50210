"""Overlap of soft and sharp points on the screen: the sharp ones win.

An object that must be soft and one that must be sharp at the same place of the picture contradict each other. Lee, Eisemann &
Seidel (2010, section 5.2) let the influence of such points end with distance. Here a soft point i keeps of its weight
within the reach r (`OVERLAP_FRAME_WIDTHS`), for every sharp point j at distance d on the screen,

    1 − min(1, a_j / a_i) · (1 − (d / r)²)²       for d < r, and all of it from there on,

with a the points' weights. On top of a sharp point of at least its weight it has none left; away from it, it gains it back
smoothly; and a sharp point that fades out gives it back smoothly too.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import BoolArray, DoubleArray

Indices = NDArray[np.intp]

OVERLAP_FRAME_WIDTHS = 0.05
"""Radius of a sharp point's influence on soft points: a face in a medium shot."""

_CACHED = 1 << 16
"""Pairs processed together, about, so that they stay in the processor's cache."""

_FAR_SLOPE = 1e3  # slopes beyond are clamped to this, which brings no points nearer to each other
_ROUNDING = 1e-5


def overlap_shares(
    slopes: DoubleArray, reaches: DoubleArray, weights: DoubleArray, soft: BoolArray, sharp: BoolArray
) -> DoubleArray:
    """Share of their weight that soft points keep beside sharp ones.

    Args:
        slopes: ``(n, k, 2)`` places of k points in n frames; a point that has none (NaN) overlaps nothing.
        reaches: ``(n, k)`` of each point, in slopes, above 0.
        weights: ``(n, k)``.
        soft: ``(k,)`` which points must be soft.
        sharp: ``(n, k)`` which count as sharp.

    Returns:
        ``(n, k)`` from 0 to 1; 1 for points that are not soft.
    """
    kept = np.ones(weights.shape)
    candidates = sharp & np.isfinite(slopes).all(axis=-1)
    if not candidates.any():
        return kept
    frames, points = np.nonzero((weights > 0) & soft & np.isfinite(slopes).all(axis=-1))
    x, y = slopes[frames, points].T
    reach, own = reaches[frames, points], weights[frames, points]
    sharps = np.nonzero(candidates)
    keys = _key(sharps[0], slopes[*sharps, 0])
    order = np.argsort(keys, kind="stable")
    sharp_x, sharp_y, other = slopes[*sharps, 0][order], slopes[*sharps, 1][order], weights[sharps][order]
    first = np.searchsorted(keys[order], _key(frames, x - reach - _ROUNDING), side="left")
    last = np.searchsorted(keys[order], _key(frames, x + reach + _ROUNDING), side="right")
    for part, near, owners in _pair_blocks(first, last):
        d2 = (x[part][owners] - sharp_x[near]) ** 2 + (y[part][owners] - sharp_y[near]) ** 2
        inside = 1 - d2 / (reach[part] ** 2)[owners]
        close = np.flatnonzero(inside > 0)
        owners, near = owners[close], near[close]
        lost = np.minimum(1.0, other[near] / own[part][owners]) * inside[close] ** 2
        with np.errstate(divide="ignore"):
            logs = np.bincount(owners, np.log(np.maximum(1 - lost, 0.0)), minlength=part.stop - part.start)
        kept[frames[part], points[part]] = np.exp(logs)
    return kept


def _key(frames: Indices, x: DoubleArray) -> DoubleArray:
    """Numbers that rise with the frame, and in a frame with x."""
    return np.asarray(frames * (4 * _FAR_SLOPE) + np.clip(x, -_FAR_SLOPE, _FAR_SLOPE))


def _pair_blocks(first: Indices, last: Indices) -> Iterator[tuple[slice, Indices, Indices]]:
    """Pairs of each of m owners with all from its ``first`` to before its ``last``, a part of the owners at a time.

    Yields:
        The part, whom each pair is with, and whose it is, counted from the part's start.
    """
    ends = np.cumsum(last - first)
    total = int(ends[-1]) if len(ends) else 0
    cuts = np.searchsorted(ends, np.arange(_CACHED, total, _CACHED)) + 1
    bounds = np.unique([0, *cuts.tolist(), len(ends)]).tolist()
    for start, stop in pairwise(bounds):
        part = slice(start, stop)
        sizes = last[part] - first[part]
        owners = np.repeat(np.arange(stop - start), sizes)
        before = np.cumsum(sizes) - sizes
        yield part, np.arange(len(owners)) + (first[part] - before)[owners], owners
