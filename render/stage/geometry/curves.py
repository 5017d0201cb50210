"""BasisCurves, NurbsCurves and HermiteCurves as polygons: tubes, or ribbons where they have normals."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from render.model.arrays import DoubleArray, IntArray
from render.stage.findings import FindingLog
from render.stage.geometry.curve_samples import (
    CurveSamples,
    sample_basis_curves,
    sample_hermite_curves,
    sample_nurbs_curves,
)
from render.stage.geometry.nurbs import even_knots
from render.stage.geometry.points_data import (
    authored_normals,
    authored_widths,
    read_points,
    real_numbers,
    whole_numbers,
)
from render.stage.geometry.polygons import BadGeometry, Polygons, check_finite
from render.stage.geometry.primvars import as_rows
from render.stage.geometry.sampling import Sampling, sample_widths
from render.stage.geometry.tubes import make_ribbons, make_tubes

KINDS = ("BasisCurves", "NurbsCurves", "HermiteCurves")
ATTRIBUTES = [
    "points",
    "curveVertexCounts",
    "widths",
    "primvars:widths",
    "normals",
    "primvars:normals",
    "type",
    "basis",
    "wrap",
    "order",
    "knots",
    "ranges",
    "pointWeights",
    "tangents",
]
"""Attributes that the shape of curves follows, and may follow over time."""


def curve_polygons(prim: Usd.Prim, time: Usd.TimeCode, log: FindingLog) -> Polygons:
    """The polygons of curves at a time, in the prim's own space and units.

    Raises:
        BadGeometry: counts, knots or values do not fit; the message explains the fault.
    """
    samples = _samples(prim, time, log)
    if not len(samples.positions):
        raise BadGeometry("none of its curves has enough points")
    sampling = Sampling(samples.vertex, samples.varying, np.arange(len(samples.positions)), samples.curve)
    widths = sample_widths(authored_widths(prim, time, log), sampling, samples.curve)
    normals = authored_normals(prim, time)
    if normals is None:
        return make_tubes(samples, widths)
    facing = sampling.resample(normals)
    chosen = facing.values if facing.indices is None else facing.values[facing.indices]
    if facing.interpolation == "constant":
        chosen = np.repeat(chosen[:1], len(widths), axis=0)
    return make_ribbons(samples, widths, np.asarray(chosen, np.float64))


def _samples(prim: Usd.Prim, time: Usd.TimeCode, log: FindingLog) -> CurveSamples:
    points = read_points(prim, time).astype(np.float64)
    check_finite(points)
    counts = whole_numbers(UsdGeom.Curves(prim).GetCurveVertexCountsAttr(), time)
    if prim.IsA(UsdGeom.NurbsCurves):
        return _nurbs(prim, points, counts, time, log)
    if prim.IsA(UsdGeom.HermiteCurves):
        tangents = as_rows(UsdGeom.HermiteCurves(prim).GetTangentsAttr().Get(time), 3)
        samples = sample_hermite_curves(
            points, np.asarray(tangents if tangents is not None else (), np.float64), counts
        )
    else:
        curves = UsdGeom.BasisCurves(prim)
        is_linear = curves.GetTypeAttr().Get(time) == UsdGeom.Tokens.linear
        basis = "linear" if is_linear else str(curves.GetBasisAttr().Get(time))
        samples = sample_basis_curves(points, counts, basis, str(curves.GetWrapAttr().Get(time)))
    left_out = int((np.diff(samples.starts) == 0).sum())
    if left_out:
        path = prim.GetPath()
        log.add("short_curves", path, f"{left_out} curves of {path} are not drawn: they have too few points")
    return samples


def _nurbs(prim: Usd.Prim, points: DoubleArray, counts: IntArray, time: Usd.TimeCode, log: FindingLog) -> CurveSamples:
    curves = UsdGeom.NurbsCurves(prim)
    orders, knots = whole_numbers(curves.GetOrderAttr(), time), real_numbers(curves.GetKnotsAttr(), time)
    if not len(knots) and len(orders) == len(counts):
        path = prim.GetPath()
        log.add("no_knots", path, f"{path} has no knots: even ones from the first to the last point are used")
        knots = even_knots(counts, orders)
    weights = real_numbers(curves.GetPointWeightsAttr(), time)
    ranges = as_rows(curves.GetRangesAttr().Get(time), 2)
    try:
        return sample_nurbs_curves(
            points,
            weights if len(weights) else np.ones(len(points)),
            counts,
            orders,
            knots,
            np.asarray(ranges if ranges is not None else np.zeros((0, 2)), np.float64),
        )
    except BadGeometry as problem:
        samples = sample_basis_curves(points, counts, "linear", "nonperiodic")
        path = prim.GetPath()
        log.add("control_polygon", path, f"{path} is drawn as lines between its points: {problem}")
        return samples
