"""NurbsPatch as polygons: rational B-spline surfaces, trimmed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from render.model.arrays import DoubleArray, FloatArray, LongArray
from render.stage.findings import FindingLog
from render.stage.geometry.nurbs import SplineBasis, even_knots, knot_places, spline_at
from render.stage.geometry.points_data import authored_normals, read_points, real_numbers, whole_numbers
from render.stage.geometry.polygons import BadGeometry, Polygons, Values, check_finite, merge_duplicates, sum_at, unit
from render.stage.geometry.primvars import as_rows
from render.stage.geometry.sampling import Blend, Sampling
from render.stage.geometry.trims import trim
from render.stage.values import number

ATTRIBUTES = (
    "points",
    "pointWeights",
    "normals",
    "primvars:normals",
    "uVertexCount",
    "uOrder",
    "uKnots",
    "uRange",
    "uForm",
    "vVertexCount",
    "vOrder",
    "vKnots",
    "vRange",
    "vForm",
    "trimCurve:counts",
    "trimCurve:orders",
    "trimCurve:vertexCounts",
    "trimCurve:knots",
    "trimCurve:ranges",
    "trimCurve:points",
)
"""Attributes that the shape of a patch follows, and may follow over time."""
MOST_ORDER = 16
_FINE = 16
"""Steps of each span, where they are not too many."""
_MOST_TERMS, _MOST_TRIMMED = 1 << 22, 1 << 15
"""Products of the basis at all points of a patch; points of a patch that is trimmed."""
_TRIM_STEPS, _MOST_LOOP_CORNERS = 16, 1 << 12
_NUDGE = 1e-4  # of a span, by which derivatives are taken


@dataclass(frozen=True, eq=False)
class _Direction:
    """Spline along one parameter.

    Attributes:
        count: number of control points.
        order: degree and one.
        knots: ``(count + order,)``.
        low: where the patch begins.
        high: where it ends.
        is_periodic: whether primvars that vary come round.
    """

    count: int
    order: int
    knots: DoubleArray
    low: float
    high: float
    is_periodic: bool

    @property
    def spans(self) -> int:
        """Number of spans."""
        return self.count - self.order + 1

    def at(self, places: DoubleArray) -> SplineBasis:
        """Basis at places ``(n,)``."""
        return spline_at(self.knots, self.count, self.order, np.clip(places, self.low, self.high))


def patch_polygons(prim: Usd.Prim, time: Usd.TimeCode, log: FindingLog) -> Polygons:
    """The polygons of a patch at a time, in its own space and units. They face along ∂/∂u × ∂/∂v where it is right-handed.

    Control points run along u first. Normals are those of the surface.

    Raises:
        BadGeometry: counts, knots or values do not fit; the message explains the fault.
    """
    patch = UsdGeom.NurbsPatch(prim)
    points = read_points(prim, time).astype(np.float64)
    check_finite(points)
    across, along = (int(number(prim.GetAttribute(f"{direction}VertexCount"), time)) for direction in "uv")
    if across < 1 or along < 1 or across * along != len(points):
        raise BadGeometry(f"it has {across} by {along} control points, but {len(points)} points")
    u, v = _direction(prim, "u", across, time, log), _direction(prim, "v", along, time, log)
    weights = real_numbers(patch.GetPointWeightsAttr(), time)
    if len(weights) not in (0, len(points)) or not (np.isfinite(weights).all() and (weights > 0).all()):
        raise BadGeometry("its pointWeights must be one for each point, finite and above 0")
    weights = weights if len(weights) else np.ones(len(points))
    places, corners, cells = _grid(u, v, _loops(prim, time))
    surface = _blend(u, v, places, weights)
    positions = surface.of(points)
    left_handed = patch.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded
    normals = _normals(u, v, places, weights, points, corners, positions)
    return Polygons(
        points=positions.astype(np.float32),
        counts=np.full(len(corners), corners.shape[1], np.int32),
        corners=corners.ravel().astype(np.int32),
        normals=_authored(prim, time, len(points), surface) or Values(-normals if left_handed else normals, "vertex"),
        left_handed=left_handed,
        sampling=Sampling(surface, _varying(u, v, places), np.arange(len(places)), cells),
    )


def _direction(prim: Usd.Prim, name: str, count: int, time: Usd.TimeCode, log: FindingLog) -> _Direction:
    order = int(number(prim.GetAttribute(f"{name}Order"), time))
    if not 2 <= order <= MOST_ORDER or count < order:
        most = f"at most {name}VertexCount"
        raise BadGeometry(f"its {name}Order must be from 2 to {MOST_ORDER} and {most}, got {order} and {count}")
    knots = real_numbers(prim.GetAttribute(f"{name}Knots"), time)
    if not len(knots):
        path = prim.GetPath()
        log.add("no_knots", path, f"{path} has no {name}Knots: even ones from the first to the last point are used")
        knots = even_knots(np.array([count], np.int32), np.array([order], np.int32))
    _check_knots(knots, count, order, f"{name}Knots")
    low, high = float(knots[order - 1]), float(knots[count])
    stated = prim.GetAttribute(f"{name}Range").Get(time)
    if stated is not None:
        low, high = max(low, float(stated[0])), min(high, float(stated[1]))
    if not low < high:
        raise BadGeometry(f"its {name}Range is empty: from {low:g} to {high:g}")
    form = prim.GetAttribute(f"{name}Form").Get(time)
    return _Direction(count, order, knots, low, high, form == UsdGeom.Tokens.periodic)


def _check_knots(knots: DoubleArray, count: int, order: int, name: str) -> None:
    if len(knots) != count + order or not np.isfinite(knots).all() or (np.diff(knots) < 0).any():
        raise BadGeometry(f"its {name} must be {count + order} finite numbers that do not decrease, got {len(knots)}")


def _grid(u: _Direction, v: _Direction, loops: Sequence[DoubleArray]) -> tuple[DoubleArray, LongArray, LongArray]:
    """Places ``(n, 2)`` on a patch, corners of its faces, and the segment of each face."""
    most = min(_MOST_TERMS // (u.order * v.order), _MOST_TRIMMED if loops else _MOST_TERMS)
    if u.spans * v.spans > most:
        raise BadGeometry(f"it has {u.spans * v.spans} spans, and at most {most} can be drawn")
    steps = int(np.clip(np.sqrt(most / (u.spans * v.spans)), 1, _FINE))
    across, along = (knot_places(each.knots, each.count, each.order, each.low, each.high, steps) for each in (u, v))
    places = np.stack([np.tile(across, len(along)), np.repeat(along, len(across))], axis=1)
    first = (np.arange(len(along) - 1)[:, None] * len(across) + np.arange(len(across) - 1)).ravel()
    quads = np.stack([first, first + 1, first + len(across) + 1, first + len(across)], axis=1)
    if loops:
        halves = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        left = trim(places, halves, loops)
        if not len(left.triangles):
            raise BadGeometry("its trim curves leave nothing of it")
        places, quads = left.places, left.triangles
    middle = places[quads].mean(axis=1)
    return places, quads.astype(np.int64), v.at(middle[:, 1]).span * u.spans + u.at(middle[:, 0]).span


def _blend(u: _Direction, v: _Direction, places: DoubleArray, weights: DoubleArray) -> Blend:
    """Shares of the control points at places ``(n, 2)``."""
    of_u, of_v = u.at(places[:, 0]), v.at(places[:, 1])
    index = (of_v.index[:, :, None] * u.count + of_u.index[:, None, :]).reshape(len(places), -1)
    shares = (of_v.basis[:, :, None] * of_u.basis[:, None, :]).reshape(len(places), -1) * weights[index]
    return Blend(index, shares / shares.sum(axis=1, keepdims=True))


def _varying(u: _Direction, v: _Direction, places: DoubleArray) -> Blend:
    """Shares of the corners of segments, along u first: one more than segments, unless they come round."""
    of_u, of_v = u.at(places[:, 0]), v.at(places[:, 1])
    ends = [each.spans + (not each.is_periodic) for each in (u, v)]
    column, row = ((of.span[:, None] + np.arange(2)) % count for of, count in zip((of_u, of_v), ends, strict=True))
    left, low = (np.stack([1 - of.share, of.share], axis=1) for of in (of_u, of_v))
    index = (row[:, :, None] * ends[0] + column[:, None, :]).reshape(len(places), -1)
    return Blend(index, (low[:, :, None] * left[:, None, :]).reshape(len(places), -1))


def _normals(
    u: _Direction,
    v: _Direction,
    places: DoubleArray,
    weights: DoubleArray,
    points: DoubleArray,
    corners: LongArray,
    positions: DoubleArray,
) -> FloatArray:
    """``(n, 3)`` normals of the surface; where it has none, as at poles, the mean of the faces around."""
    slopes = []
    for axis, each in enumerate((u, v)):
        step = _NUDGE * (each.high - each.low) / each.spans
        ends = [places.copy(), places.copy()]
        ends[1][:, axis] = np.minimum(places[:, axis] + step, each.high)
        ends[0][:, axis] = ends[1][:, axis] - step
        slopes.append(_blend(u, v, ends[1], weights).of(points) - _blend(u, v, ends[0], weights).of(points))
    normals = np.cross(slopes[0], slopes[1])
    size = np.linalg.norm(normals, axis=1)
    bound = np.linalg.norm(slopes[0], axis=1).max() * np.linalg.norm(slopes[1], axis=1).max()
    is_flat = ~(size > 1e-6 * bound)
    if is_flat.any():
        # By the diagonals, since at a pole two neighbouring corners are one.
        a, b, c, d = (positions[corners[:, i]] for i in (0, 1, 2, -1))
        _, same = merge_duplicates(positions.astype(np.float32))
        of_corners = np.repeat(np.cross(c - a, d - b), corners.shape[1], axis=0).astype(np.float32)
        around = sum_at(same[corners.ravel()], of_corners, int(same.max()) + 1)[same]
        normals[is_flat] = around[is_flat]
    return unit((normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)).astype(np.float32))


def _authored(prim: Usd.Prim, time: Usd.TimeCode, points: int, surface: Blend) -> Values | None:
    """Authored normals, one for each control point; others are left out."""
    found = authored_normals(prim, time)
    if found is None or found.interpolation not in ("vertex", "varying") or len(found.values) != points:
        return None
    return Values(surface.of(found.values).astype(np.float32), "vertex")


def _loops(prim: Usd.Prim, time: Usd.TimeCode) -> list[DoubleArray]:
    """Corners ``(k, 2)`` of each trim loop, in parameters."""
    patch = UsdGeom.NurbsPatch(prim)
    loops, orders, counts = (
        whole_numbers(attribute, time)
        for attribute in (
            patch.GetTrimCurveCountsAttr(),
            patch.GetTrimCurveOrdersAttr(),
            patch.GetTrimCurveVertexCountsAttr(),
        )
    )
    if not len(loops):
        return []
    knots = real_numbers(patch.GetTrimCurveKnotsAttr(), time)
    points = as_rows(patch.GetTrimCurvePointsAttr().Get(time), 3)
    ranges = as_rows(patch.GetTrimCurveRangesAttr().Get(time), 2)
    curves = int(loops.sum())
    fits = (loops > 0).all() and len(orders) == len(counts) == curves and (ranges is None or len(ranges) == curves)
    fits = fits and (orders >= 2).all() and (orders <= MOST_ORDER).all() and (counts >= orders).all()
    if not fits or points is None or len(points) != int(counts.sum()) or not (points[:, 2] > 0).all():
        raise BadGeometry("its trim curves contradict each other")
    if len(knots) != len(points) + int(orders.sum()):
        raise BadGeometry(f"its trim curves need {len(points) + int(orders.sum())} knots and have {len(knots)}")
    sampled, first, first_knot = [], 0, 0
    for place, (count, order) in enumerate(zip(counts.tolist(), orders.tolist(), strict=True)):
        own = knots[first_knot : first_knot + count + order]
        _check_knots(own, count, order, "trimCurve:knots")
        low, high = float(own[order - 1]), float(own[count])
        if ranges is not None:
            low, high = max(low, float(ranges[place, 0])), min(high, float(ranges[place, 1]))
        spline = spline_at(
            own, count, order, knot_places(own, count, order, low, high, 1 if order == 2 else _TRIM_STEPS)
        )
        homogeneous = Blend(first + spline.index, spline.basis).of(points.astype(np.float64))
        sampled.append(homogeneous[:, :2] / homogeneous[:, 2:])
        first, first_knot = first + count, first_knot + count + order
    if sum(map(len, sampled)) > _MOST_LOOP_CORNERS:
        raise BadGeometry(f"its trim curves have more than {_MOST_LOOP_CORNERS} steps")
    bounds = np.cumsum([0, *loops.tolist()])
    return [np.concatenate(sampled[bounds[i] : bounds[i + 1]]) for i in range(len(loops))]
