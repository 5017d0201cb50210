"""NURBS patches against closed forms: spheres, tori and sheets, their primvars, and what trim curves leave."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, Vt

from render.model.arrays import DoubleArray
from render.model.scene import Geometry
from render.stage import StageReader
from tests.render.kits.stages import T, new_stage, only_batch, read, set_primvar

CIRCLE = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
CIRCLE_WEIGHTS = [1, np.sqrt(0.5)] * 4 + [1]
CIRCLE_KNOTS = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]


def add_patch(
    stage: Usd.Stage,
    points: object,
    orders: tuple[int, int],
    counts: tuple[int, int],
    knots: tuple[list[float], list[float]],
    weights: object = None,
) -> UsdGeom.NurbsPatch:
    patch = UsdGeom.NurbsPatch.Define(stage, "/patch")
    patch.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(np.array(points, np.float32)))
    patch.CreateUOrderAttr(orders[0])
    patch.CreateVOrderAttr(orders[1])
    patch.CreateUVertexCountAttr(counts[0])
    patch.CreateVVertexCountAttr(counts[1])
    patch.CreateUKnotsAttr(knots[0])
    patch.CreateVKnotsAttr(knots[1])
    if weights is not None:
        patch.CreatePointWeightsAttr([float(weight) for weight in np.ravel(weights)])
    return patch


def add_turned(stage: Usd.Stage, profile: DoubleArray, weights: DoubleArray, order: int, knots: list[float]) -> None:
    """A profile ``(n, 2)`` of radius and height that is turned around the y axis, with u around it."""
    points = [[(r * x, y, -r * z) for x, z in CIRCLE] for r, y in profile]
    add_patch(
        stage,
        np.reshape(points, (-1, 3)),
        (3, order),
        (9, len(profile)),
        (CIRCLE_KNOTS, knots),
        np.outer(weights, CIRCLE_WEIGHTS),
    )


def sheet(stage: Usd.Stage) -> UsdGeom.NurbsPatch:
    """A flat sheet of 3 × 2 spans over (0, 3) × (0, 2), of order 2."""
    points = [(x, y, 0) for y in range(3) for x in range(4)]
    return add_patch(stage, points, (2, 2), (4, 3), ([0, 0, 1, 2, 3, 3], [0, 0, 1, 2, 2]))


def area(geometry: Geometry) -> float:
    a, b, c = (geometry.positions[geometry.triangles[:, i]].astype(np.float64) for i in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def test_a_rational_sphere_is_round() -> None:
    stage = new_stage()
    half = np.array([(0, -1), (1, -1), (1, 0), (1, 1), (0, 1)], np.float64)
    add_turned(stage, half, np.array(CIRCLE_WEIGHTS[:5]), 3, [0, 0, 0, 1, 1, 2, 2, 2])
    geometry = only_batch(read(stage)).geometry
    np.testing.assert_allclose(np.linalg.norm(geometry.positions, axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(geometry.normals, geometry.positions, atol=2e-2)  # the poles' are means
    inside = np.abs(geometry.positions[:, 1]) < 0.99
    np.testing.assert_allclose(geometry.normals[inside], geometry.positions[inside], atol=1e-3)
    assert area(geometry) == pytest.approx(4 * np.pi, rel=3e-3)


def test_a_bicubic_sheet_has_the_heights_of_its_spline() -> None:
    """Greville's abscissae as control points reproduce x and y, and their products the product."""
    stage = new_stage()
    knots = [0, 0, 0, 0, 1, 2.5, 4, 4, 4, 4]
    greville = [sum(knots[i + 1 : i + 4]) / 3 for i in range(6)]
    points = [(x, y, x * y) for y in greville for x in greville]
    add_patch(stage, points, (4, 4), (6, 6), (knots, knots))
    geometry = only_batch(read(stage)).geometry
    x, y, z = geometry.positions.T
    np.testing.assert_allclose(z, x * y, atol=1e-5)
    normals = np.stack([-y, -x, np.ones_like(x)], 1) / np.sqrt(1 + x**2 + y**2)[:, None]
    np.testing.assert_allclose(geometry.normals, normals, atol=1e-3)
    assert x.min() == 0
    assert x.max() == 4


def test_a_range_draws_a_part_and_orientation_turns_it() -> None:
    stage = new_stage()
    patch = sheet(stage)
    patch.CreateURangeAttr(Gf.Vec2d(0.5, 2.25))
    geometry = only_batch(read(stage)).geometry
    np.testing.assert_allclose([geometry.positions[:, 0].min(), geometry.positions[:, 0].max()], [0.5, 2.25])
    assert (geometry.normals[:, 2] == 1).all()
    patch.CreateOrientationAttr("leftHanded")
    assert (only_batch(read(stage)).geometry.normals[:, 2] == -1).all()


def test_primvars_belong_to_points_segments_and_their_corners() -> None:
    stage = new_stage()
    prim = sheet(stage).GetPrim()
    red = {
        "uniform": [number / 6 for number in range(6)],
        "varying": [x / 3 for y in range(3) for x in range(4)],
        "vertex": [x / 3 for y in range(3) for x in range(4)],
    }
    for interpolation, values in red.items():
        set_primvar(
            prim, "displayColor", T.Color3fArray, interpolation, [Gf.Vec3f(value, 0.5, 0.5) for value in values]
        )
        geometry = only_batch(read(stage)).geometry
        assert geometry.colors is not None
        middle = geometry.positions[geometry.triangles].mean(axis=1)
        found = geometry.colors[geometry.triangles].mean(axis=1)[:, 0]
        of_segments = (np.floor(middle[:, 1]) * 3 + np.floor(middle[:, 0])) / 6
        expected = of_segments if interpolation == "uniform" else middle[:, 0] / 3
        shown = np.argsort(expected)
        assert (np.diff(found[shown]) >= -1e-4).all(), interpolation


def trim(patch: UsdGeom.NurbsPatch, loops: list[list[tuple[float, float]]]) -> None:
    """Trim by circles given as their centre and radius; a negative radius runs clockwise."""
    points, knots = [], []
    for (x, y), (radius, _) in loops:
        ring = CIRCLE if radius > 0 else CIRCLE[::-1]
        size = abs(radius)
        points += [
            Gf.Vec3d((x + size * a) * w, (y + size * b) * w, w) for (a, b), w in zip(ring, CIRCLE_WEIGHTS, strict=True)
        ]
        knots += CIRCLE_KNOTS
    patch.CreateTrimCurveCountsAttr([1] * len(loops))
    patch.CreateTrimCurveOrdersAttr([3] * len(loops))
    patch.CreateTrimCurveVertexCountsAttr([9] * len(loops))
    patch.CreateTrimCurveKnotsAttr([float(knot) for knot in knots])
    patch.CreateTrimCurvePointsAttr(points)


@pytest.mark.parametrize(
    ("loops", "expected"),
    [
        ([[(1.5, 1), (0.8, 0)]], np.pi * 0.64),
        ([[(1.5, 1), (-0.8, 0)]], 6 - np.pi * 0.64),
        ([[(1.5, 1), (0.8, 0)], [(1.4, 1), (-0.3, 0)]], np.pi * (0.64 - 0.09)),
        ([[(1.5, 1), (-0.8, 0)], [(1.4, 1), (0.3, 0)]], np.pi * (0.64 - 0.09)),
        ([[(0.9, 1), (0.5, 0)], [(2.2, 1), (0.5, 0)]], np.pi * 0.5),
    ],
    ids=["disc", "hole", "ring", "ring the other way", "two discs"],
)
def test_trim_curves_leave_what_lies_to_their_left(loops: list, expected: float) -> None:
    stage = new_stage()
    patch = sheet(stage)
    trim(patch, loops)
    geometry = only_batch(read(stage)).geometry
    assert area(geometry) == pytest.approx(expected, rel=6e-3)
    (x, y), (radius, _) = loops[0]
    if radius > 0 and len(loops) == 1:
        reach = np.linalg.norm(geometry.positions[:, :2] - (x, y), axis=1)
        assert reach.max() == pytest.approx(radius, rel=5e-3)


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("uOrder", 1, "uOrder must be from 2 to 16"),
        ("vOrder", 4000, "vOrder must be from 2 to 16"),
        ("uVertexCount", 2_000_000_000, "2000000000 by 3 control points"),
        ("uKnots", [0, 0, 2, 1, 3, 3], "uKnots must be 6 finite numbers that do not decrease"),
        ("vKnots", [0, 0, 1, 2], "vKnots must be 5"),
        ("pointWeights", [0.0] * 12, "pointWeights must be"),
        ("uRange", Gf.Vec2d(2, 1), "uRange is empty"),
        ("trimCurve:counts", [7], "trim curves contradict"),
        ("points", [(0, 0, 0)] * 5, "5 points"),
    ],
)
def test_what_contradicts_itself_is_named(name: str, value: object, says: str) -> None:
    stage = new_stage()
    patch = sheet(stage)
    trim(patch, [[(1.5, 1), (0.8, 0)]])
    patch.CreatePointWeightsAttr([1.0] * 12)
    patch.CreateURangeAttr(Gf.Vec2d(0, 3))
    patch.GetPrim().GetAttribute(name).Set(value)
    reader = StageReader(stage)
    assert reader.read(0).batches == ()
    (finding,) = reader.findings
    assert finding.code == "bad_geometry"
    assert says in finding.message
