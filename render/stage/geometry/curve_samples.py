"""Samples along curves: places, directions, and where they lie between the curves' points (UsdGeomBasisCurves and others)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from render.model.arrays import BoolArray, DoubleArray, IntArray, LongArray
from render.stage.geometry.nurbs import knot_places, spline_at
from render.stage.geometry.polygons import BadGeometry
from render.stage.geometry.sampling import Blend

_FINE, _COARSE = 24, 2
_FINE_SAMPLES = 1 << 17
"""Samples of a prim up to which each segment has `_FINE` steps."""
MOST_SAMPLES = 1 << 21
_LEAST_POINTS = {"linear": 2, "bezier": 4, "bspline": 4, "catmullRom": 4}
_POINTS_BETWEEN = {"linear": 1, "bezier": 3, "bspline": 1, "catmullRom": 1}


@dataclass(frozen=True, eq=False)
class CurveSamples:
    """Samples along all curves of a prim, one curve after another.

    Attributes:
        positions: ``(n, 3)`` in the prim's own space and units.
        directions: ``(n, 3)`` derivatives along the curve, of any length.
        vertex: where they lie between the prim's points.
        varying: where they lie between the ends of segments.
        curve: ``(n,)`` number of the curve of each sample.
        starts: ``(c + 1,)`` first sample of each curve, and the number of all.
        closed: ``(c,)`` whether the last sample of a curve is followed by its first.
        bends: whether curves have corners at the samples (linear ones).
    """

    positions: DoubleArray
    directions: DoubleArray
    vertex: Blend
    varying: Blend
    curve: LongArray
    starts: LongArray
    closed: BoolArray
    bends: bool = False

    @property
    def following(self) -> LongArray:
        """``(n,)`` the sample after each one; -1 behind the end of an open curve."""
        following = np.arange(1, len(self.positions) + 1)
        filled = np.diff(self.starts) > 0
        following[self.starts[1:][filled] - 1] = np.where(self.closed, self.starts[:-1], -1)[filled]
        return following


def check_curves(counts: IntArray, points: int) -> None:
    """Raise `BadGeometry` where the numbers of points of curves do not fit their points."""
    if (counts < 0).any():
        raise BadGeometry("curveVertexCounts has a negative count")
    if int(counts.sum(dtype=np.int64)) > points:
        raise BadGeometry(f"curveVertexCounts add up to {counts.sum(dtype=np.int64)}, but there are {points} points")


def sample_basis_curves(points: DoubleArray, counts: IntArray, basis: str, wrap: str) -> CurveSamples:
    """Sample linear or cubic curves.

    Args:
        points: ``(m, 3)`` control points.
        counts: ``(c,)`` number of them in each curve.
        basis: linear, bezier, bspline or catmullRom.
        wrap: nonperiodic, periodic or pinned.

    Raises:
        BadGeometry: basis or wrap are unknown, counts do not fit, or a curve has too few points.
    """
    if basis not in _LEAST_POINTS or wrap not in ("nonperiodic", "periodic", "pinned"):
        raise BadGeometry(f"its curves must be linear, bezier, bspline or catmullRom, got {basis}, {wrap}")
    check_curves(counts, len(points))
    pins = wrap == "pinned" and basis in ("bspline", "catmullRom")
    segments = _segments(counts.astype(np.int64), basis, closed=wrap == "periodic", pins=pins)
    steps = 1 if basis == "linear" else _steps(int(segments.sum()))
    closed = np.full(len(counts), wrap == "periodic")
    curve, segment, share, starts = _spread(segments, closed, steps)
    first_point, own_count = (np.cumsum(counts) - counts).astype(np.int64)[curve], counts.astype(np.int64)[curve]
    local = (segment * _POINTS_BETWEEN[basis] - pins)[:, None] + np.arange(2 if basis == "linear" else 4)
    weights, slopes = _WEIGHTS[basis](share)
    if pins:
        local, (weights, slopes) = _without_phantoms(local, own_count, weights, slopes)
    if wrap == "periodic":
        local %= own_count[:, None]
    vertex = Blend(first_point[:, None] + local, weights)
    return CurveSamples(
        vertex.of(points),
        Blend(vertex.index, slopes).of(points),
        vertex,
        _between_ends(curve, segment, share, segments, closed),
        curve,
        starts,
        closed,
        bends=basis == "linear",
    )


def sample_hermite_curves(points: DoubleArray, tangents: DoubleArray, counts: IntArray) -> CurveSamples:
    """Sample cubic curves through points with given tangents (UsdGeomHermiteCurves).

    Args:
        points: ``(m, 3)``.
        tangents: ``(m, 3)`` derivatives there.
        counts: ``(c,)`` number of points of each curve.

    Raises:
        BadGeometry: counts do not fit.
    """
    check_curves(counts, len(points))
    if len(tangents) != len(points):
        raise BadGeometry(f"it has {len(tangents)} tangents for {len(points)} points")
    segments, closed = (
        _segments(counts.astype(np.int64), "linear", closed=False, pins=False),
        np.zeros(len(counts), bool),
    )
    curve, segment, u, starts = _spread(segments, closed, _steps(int(segments.sum())))
    here = (np.cumsum(counts) - counts).astype(np.int64)[curve] + segment
    of_points = np.stack([(1 + 2 * u) * (1 - u) ** 2, u**2 * (3 - 2 * u), 6 * u * (u - 1), 6 * u * (1 - u)])
    of_tangents = np.stack([u * (1 - u) ** 2, u**2 * (u - 1), (1 - u) * (1 - 3 * u), u * (3 * u - 2)])
    places, slopes = (
        sum(
            weights[row + end][:, None] * rows[here + end]
            for end in (0, 1)
            for weights, rows in ((of_points, points), (of_tangents, tangents))
        )
        for row in (0, 2)
    )
    ends = Blend(here[:, None] + np.arange(2), np.stack([1 - u, u], axis=1))
    varying = _between_ends(curve, segment, u, segments, closed)
    return CurveSamples(places, slopes, ends, varying, curve, starts, closed)


def sample_nurbs_curves(
    points: DoubleArray,
    weights: DoubleArray,
    counts: IntArray,
    orders: IntArray,
    knots: DoubleArray,
    ranges: DoubleArray,
) -> CurveSamples:
    """Sample rational B-splines by de Boor's recurrence (Piegl & Tiller 1997, algorithm A2.2).

    Args:
        points: ``(m, 3)`` control points.
        weights: ``(m,)`` of the points.
        counts: ``(c,)`` number of points of each curve.
        orders: ``(c,)`` degree and one.
        knots: ``(sum of counts and orders,)``.
        ranges: ``(c, 2)`` part of each curve that is drawn; an empty array for all of it.

    Raises:
        BadGeometry: numbers do not fit, or knots decrease.
    """
    check_curves(counts, len(points))
    if len(orders) != len(counts) or len(weights) != len(points) or len(ranges) not in (0, len(counts)):
        raise BadGeometry(
            f"it has {len(orders)} orders, {len(ranges)} ranges and {len(weights)} weights for {len(counts)} curves"
        )
    if not len(counts):
        raise BadGeometry("it has no curves")
    if (orders < 2).any() or (orders > 16).any() or (counts < orders).any():
        raise BadGeometry("orders must be from 2 to 16, and no curve may have fewer points than its order")
    if len(knots) != int(counts.sum()) + int(orders.sum()) or not np.isfinite(knots).all():
        raise BadGeometry(f"it needs {int(counts.sum()) + int(orders.sum())} finite knots and has {len(knots)}")
    widest = int(orders.max(initial=2))
    rows: list[tuple[LongArray, DoubleArray, LongArray, DoubleArray]] = []
    first, first_knot = 0, 0
    for number, (count, order) in enumerate(zip(counts.tolist(), orders.tolist(), strict=True)):
        own = knots[first_knot : first_knot + count + order]
        if (np.diff(own) < 0).any():
            raise BadGeometry(f"the knots of curve {number} decrease")
        low, high = own[order - 1], own[count]
        if len(ranges):
            low, high = max(low, float(ranges[number, 0])), min(high, float(ranges[number, 1]))
        rows.append(_nurbs_rows(own, count, order, low, high, widest, first, _steps(int(counts.sum()))))
        first, first_knot = first + count, first_knot + count + order
    index, basis, span, share = (np.concatenate([row[part] for row in rows]) for part in range(4))
    starts = np.cumsum([0, *(len(row[0]) for row in rows)])
    curve = np.repeat(np.arange(len(rows)), np.diff(starts))
    rational = basis * weights[index]
    total = rational.sum(axis=1, keepdims=True)
    if not (np.isfinite(total) & (total > 0)).all():
        raise BadGeometry("its pointWeights must be finite and above 0")
    vertex = Blend(index, rational / total)
    positions = vertex.of(points)
    closed = np.zeros(len(counts), bool)
    varying = _between_ends(curve, span, share, (counts - orders + 1).astype(np.int64), closed)
    return CurveSamples(positions, _chords(positions, starts), vertex, varying, curve, starts, closed)


def _nurbs_rows(
    knots: DoubleArray, count: int, order: int, low: float, high: float, widest: int, first: int, steps: int
) -> tuple[LongArray, DoubleArray, LongArray, DoubleArray]:
    """Point indices and basis ``(n, widest)`` of one curve's samples, and the span and the share of it where each lies."""
    places = knot_places(knots, count, order, low, high, steps)
    spline = spline_at(knots, count, order, places)
    index = np.minimum(spline.index[:, :1] + np.arange(widest), count - 1)  # those past the order weigh nothing
    basis = np.zeros((len(places), widest))
    basis[:, :order] = spline.basis
    return first + index, basis, spline.span, spline.share


def _chords(positions: DoubleArray, starts: LongArray) -> DoubleArray:
    """``(n, 3)`` directions from the sample before to the one after, of the same curve."""
    rows = np.arange(len(positions))
    curve = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    before, after = np.maximum(rows - 1, starts[curve]), np.minimum(rows + 1, starts[curve + 1] - 1)
    chords: DoubleArray = positions[after] - positions[before]
    return chords


def _segments(counts: LongArray, basis: str, *, closed: bool, pins: bool) -> LongArray:
    """Number of segments of each curve; 0, so that it is not drawn, where it has too few points."""
    between = _POINTS_BETWEEN[basis]
    if closed:
        return np.where(counts >= max(3, between), counts // between, 0)
    least = 2 if pins else _LEAST_POINTS[basis]
    return np.where(counts >= least, (counts - (1 if pins else least)) // between + (0 if pins else 1), 0)


def _steps(segments: int) -> int:
    """Steps of each segment: fewer where there are many."""
    if segments * _COARSE > MOST_SAMPLES:
        raise BadGeometry(f"its curves have {segments} segments, and at most {MOST_SAMPLES // _COARSE} can be drawn")
    return int(np.clip(_FINE_SAMPLES // max(segments, 1), _COARSE, _FINE))


def _spread(segments: LongArray, closed: BoolArray, steps: int) -> tuple[LongArray, LongArray, DoubleArray, LongArray]:
    """Samples at even steps of segments: curve, segment and the share of it, and where each curve's begin."""
    own = np.where(segments > 0, segments * steps + ~closed, 0)
    starts = np.cumsum([0, *own])
    curve = np.repeat(np.arange(len(segments)), own)
    step = np.arange(starts[-1]) - starts[curve]
    segment = np.minimum(step // steps, segments[curve] - 1)
    return curve, segment, step / steps - segment, starts


def _between_ends(
    curve: LongArray, segment: LongArray, share: DoubleArray, segments: LongArray, closed: BoolArray
) -> Blend:
    """Where samples lie between the ends of segments, of which a closed curve has as many as segments, an open one one more."""
    ends = segments + ~closed
    first = np.cumsum(ends) - ends
    index = first[curve][:, None] + (segment[:, None] + np.arange(2)) % ends[curve][:, None]
    return Blend(index, np.stack([1 - share, share], axis=1))


def _without_phantoms(
    local: LongArray, count: LongArray, weights: DoubleArray, slopes: DoubleArray
) -> tuple[LongArray, tuple[DoubleArray, DoubleArray]]:
    """Rewrite weights of points beyond the ends of pinned curves, which mirror the second at the first, as those of real points.

    A point before the first is ``2·P0 - P1``, one after the last ``2·Pn - Pn-1``, so that the curve begins at its first point.
    """
    found = []
    for one in (weights.copy(), slopes.copy()):
        before = local[:, 0] < 0
        one[before, 1] += 2 * one[before, 0]
        one[before, 2] -= one[before, 0]
        one[before, 0] = 0
        after = local[:, 3] >= count
        one[after, 2] += 2 * one[after, 3]
        one[after, 1] -= one[after, 3]
        one[after, 3] = 0
        found.append(one)
    local = np.clip(local, 0, np.maximum(count - 1, 0)[:, None])
    return local, (found[0], found[1])


def _linear(u: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    one = np.ones_like(u)
    return np.stack([1 - u, u], axis=1), np.stack([-one, one], axis=1)


def _bezier(u: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    v = 1 - u
    slopes = [-3 * v * v, 3 * v * (v - 2 * u), 3 * u * (2 * v - u), 3 * u * u]
    return np.stack([v**3, 3 * u * v * v, 3 * u * u * v, u**3], axis=1), np.stack(slopes, axis=1)


def _bspline(u: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    v = 1 - u
    weights = [v**3, 3 * u**3 - 6 * u**2 + 4, 3 * v**3 - 6 * v**2 + 4, u**3]
    slopes = [-(v**2) / 2, (3 * u**2 - 4 * u) / 2, -(3 * v**2 - 4 * v) / 2, u**2 / 2]
    return np.stack(weights, axis=1) / 6, np.stack(slopes, axis=1)


def _catmull_rom(u: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    weights = [-(u**3) + 2 * u**2 - u, 3 * u**3 - 5 * u**2 + 2, -3 * u**3 + 4 * u**2 + u, u**3 - u**2]
    slopes = [-3 * u**2 + 4 * u - 1, 9 * u**2 - 10 * u, -9 * u**2 + 8 * u + 1, 3 * u**2 - 2 * u]
    return np.stack(weights, axis=1) / 2, np.stack(slopes, axis=1) / 2


_WEIGHTS: dict[str, Callable[[DoubleArray], tuple[DoubleArray, DoubleArray]]] = {
    "linear": _linear,
    "bezier": _bezier,
    "bspline": _bspline,
    "catmullRom": _catmull_rom,
}
"""Weights ``(n, k)`` of a segment's points at each share of it, and their derivatives."""
