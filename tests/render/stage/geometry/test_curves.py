"""Curves are drawn as tubes and ribbons whose places, widths and primvars are those that USD defines."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, Vt

from render import colour
from render.stage import StageReader
from render.stage.geometry.curve_samples import (
    sample_basis_curves,
    sample_hermite_curves,
    sample_nurbs_curves,
)
from render.stage.geometry.nurbs import even_knots
from render.stage.geometry.tubes import make_tubes
from tests.render.kits.stages import T, codes, new_stage, only_batch, read, set_primvar, world_points

RANDOM = np.random.default_rng(7)
CAGE = RANDOM.uniform(-1, 1, (13, 3))
CUBE_ROOT = 1 / np.sqrt(2)


def counts(*numbers: int) -> np.ndarray:
    return np.array(numbers, np.int32)


def one(points: np.ndarray, basis: str, wrap: str = "nonperiodic"):
    return sample_basis_curves(np.asarray(points, float), counts(len(points)), basis, wrap)


def de_casteljau(points: np.ndarray, u: float) -> np.ndarray:
    while len(points) > 1:
        points = (1 - u) * points[:-1] + u * points[1:]
    return points[0]


def blossom(cage: np.ndarray, knots: np.ndarray, order: int, u: float) -> np.ndarray:
    """A B-spline's point by de Boor's algorithm on its points, in place of on its basis functions."""
    span = int(np.clip(np.searchsorted(knots, u, side="right") - 1, order - 1, len(cage) - 1))
    points = cage[span - order + 1 : span + 1].copy()
    for level in range(1, order):
        for j in range(order - 1, level - 1, -1):
            i = span - order + 1 + j
            share = (u - knots[i]) / (knots[i + order - level] - knots[i])
            points[j] = (1 - share) * points[j - 1] + share * points[j]
    return points[-1]


def test_bezier_curves_are_those_of_de_casteljau():
    samples = one(CAGE, "bezier")
    steps = (len(samples.positions) - 1) // 4
    for number, place in enumerate(samples.positions):
        segment = min(number // steps, 3)
        want = de_casteljau(CAGE[3 * segment : 3 * segment + 4], number / steps - segment)
        np.testing.assert_allclose(place, want, atol=1e-12)


def test_bsplines_meet_their_knots_where_they_should():
    samples = one(CAGE, "bspline")
    steps = (len(samples.positions) - 1) // (len(CAGE) - 3)
    np.testing.assert_allclose(samples.positions[::steps], (CAGE[:-2] + 4 * CAGE[1:-1] + CAGE[2:]) / 6, atol=1e-12)
    np.testing.assert_allclose(samples.directions[::steps], (CAGE[2:] - CAGE[:-2]) / 2, atol=1e-12)


def test_catmull_rom_curves_pass_their_points():
    samples = one(CAGE, "catmullRom")
    steps = (len(samples.positions) - 1) // (len(CAGE) - 3)
    np.testing.assert_allclose(samples.positions[::steps], CAGE[1:-1], atol=1e-12)


@pytest.mark.parametrize("basis", ["bspline", "catmullRom"])
@pytest.mark.parametrize("points", [2, 3, 4, 9])
def test_pinned_curves_begin_and_end_at_their_points(basis: str, points: int):
    samples = one(CAGE[:points], basis, "pinned")
    np.testing.assert_allclose(samples.positions[[0, -1]], CAGE[[0, points - 1]], atol=1e-12)


@pytest.mark.parametrize(("basis", "points"), [("linear", 5), ("bezier", 9), ("bspline", 5), ("catmullRom", 5)])
def test_periodic_curves_are_smooth_at_their_seam(basis: str, points: int):
    samples = one(CAGE[:points], basis, "periodic")
    assert samples.following[-1] == 0
    turned = one(np.roll(CAGE[:points], -3, axis=0), basis, "periodic")
    segments = points // 3 if basis == "bezier" else points
    steps = len(samples.positions) // segments
    moved = np.roll(samples.positions, -steps * (1 if basis == "bezier" else 3), axis=0)
    np.testing.assert_allclose(turned.positions, moved, atol=1e-12)


@pytest.mark.parametrize("basis", ["linear", "bezier", "bspline", "catmullRom"])
def test_directions_are_the_derivatives_of_places(basis: str):
    samples = one(CAGE, basis)
    last = samples.starts[1] - 1
    inside = slice(1, last)
    difference = samples.positions[2 : last + 1] - samples.positions[: last - 1]
    cosine = np.sum(difference * samples.directions[inside], axis=1)
    cosine /= np.linalg.norm(difference, axis=1) * np.linalg.norm(samples.directions[inside], axis=1)
    assert np.median(cosine) > (0.999 if basis != "linear" else 0.0)


def test_a_rational_quadratic_is_a_circle():
    ring = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)], float)
    points = np.concatenate([ring, np.zeros((9, 1))], axis=1)
    weights = np.where(np.arange(9) % 2, CUBE_ROOT, 1.0)
    knots = np.array([0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4], float)
    samples = sample_nurbs_curves(points, weights, counts(9), counts(3), knots, np.array([[0.0, 4.0]]))
    np.testing.assert_allclose(np.linalg.norm(samples.positions, axis=1), 1.0, atol=1e-12)
    half = sample_nurbs_curves(points, weights, counts(9), counts(3), knots, np.array([[0.0, 2.0]]))
    np.testing.assert_allclose(half.positions[-1], (-1, 0, 0), atol=1e-12)


@pytest.mark.parametrize("order", [2, 3, 4, 7])
def test_nurbs_are_those_of_de_boor(order: int):
    knots = even_knots(counts(13), counts(order))
    knots[order + 1] = knots[order]  # a knot that is there twice
    samples = sample_nurbs_curves(CAGE, np.ones(13), counts(13), counts(order), knots, np.zeros((0, 2)))
    spans = np.unique(knots)
    steps = (len(samples.positions) - 1) // (len(spans) - 1)
    places = np.interp(np.arange(len(samples.positions)) / steps, np.arange(len(spans)), spans)
    for u, place in list(zip(places, samples.positions, strict=True))[1:-1:5]:
        np.testing.assert_allclose(place, blossom(CAGE, knots, order, u), atol=1e-11)
    np.testing.assert_allclose(samples.positions[[0, -1]], CAGE[[0, -1]], atol=1e-12)


def test_hermite_curves_have_their_points_and_tangents():
    tangents = RANDOM.uniform(-1, 1, CAGE.shape)
    samples = sample_hermite_curves(CAGE, tangents, counts(len(CAGE)))
    steps = (len(samples.positions) - 1) // (len(CAGE) - 1)
    np.testing.assert_allclose(samples.positions[::steps], CAGE, atol=1e-12)
    np.testing.assert_allclose(samples.directions[::steps], tangents, atol=1e-12)
    bezier = np.array([CAGE[0], CAGE[0] + tangents[0] / 3, CAGE[1] - tangents[1] / 3, CAGE[1]])
    np.testing.assert_allclose(samples.positions[steps // 2], de_casteljau(bezier, (steps // 2) / steps), atol=1e-12)


def volume(points: np.ndarray, triangles: np.ndarray) -> float:
    corners = points[triangles]
    return float(np.sum(np.cross(corners[:, 0], corners[:, 1]) * corners[:, 2]) / 6)


def curves(stage: Usd.Stage, points: object, width: float = 0.2, **tokens: str) -> UsdGeom.BasisCurves:
    """One curve on a stage."""
    prim = UsdGeom.BasisCurves.Define(stage, "/curve")
    prim.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(np.asarray(points, np.float32)))
    prim.CreateCurveVertexCountsAttr([len(points)])
    prim.CreateWidthsAttr([width])
    for name, value in tokens.items():
        prim.GetPrim().GetAttribute(name).Set(value)
    return prim


def test_a_straight_tube_has_its_volume_and_faces_outward():
    stage = new_stage()
    curves(stage, [(0, 0, 0), (1, 2, 2)], width=0.5, type="linear")
    batch = only_batch(read(stage))
    # A prism of 24 sides whose perimeter is that of the circle.
    area = np.pi * 0.25**2 * (np.pi / 24) / np.tan(np.pi / 24)
    assert volume(world_points(batch), batch.geometry.triangles) == pytest.approx(3 * area, rel=1e-5)


def test_an_outline_has_the_width_of_the_tube():
    """Half a pixel where a tube is 80 pixels wide."""
    stage = new_stage()
    curves(stage, [(0, 0, 0), (0, 0, 5)], width=2.0, type="linear")
    ring = world_points(only_batch(read(stage)))[:, :2]
    angle = np.linspace(0, np.pi, 500)
    across = ring @ np.stack([np.cos(angle), np.sin(angle)])
    np.testing.assert_allclose(np.ptp(across, axis=0), 2.0, rtol=0.5 / 80)


def test_a_ring_is_closed_and_does_not_twist():
    angle = np.arange(64) * 2 * np.pi / 64
    knot = np.stack(
        [np.sin(angle) + 2 * np.sin(2 * angle), np.cos(angle) - 2 * np.cos(2 * angle), -np.sin(3 * angle)], axis=1
    )
    samples = one(knot, "catmullRom", "periodic")
    tube = make_tubes(samples, np.full(len(samples.positions), 0.1, np.float32))
    rings = (tube.points.reshape(len(samples.positions), -1, 3) - samples.positions[:, None]).astype(np.float64)
    spoke = rings[:, 0] / np.linalg.norm(rings[:, 0], axis=1, keepdims=True)
    turn = np.degrees(np.arccos(np.clip(np.sum(spoke * np.roll(spoke, -1, axis=0), axis=1), -1, 1)))
    assert turn.max() < 6  # less than half the angle between two sides, seam included
    edges = np.sort(np.stack([tube.corners.reshape(-1, 4), np.roll(tube.corners.reshape(-1, 4), -1, axis=1)], -1), -1)
    assert (np.unique(edges.reshape(-1, 2), axis=0, return_counts=True)[1] == 2).all()


def test_a_corner_keeps_the_width_beside_it():
    stage = new_stage()
    curves(stage, [(-2, 0, 0), (0, 0, 0), (0, 2, 0)], width=0.4, type="linear")
    points = world_points(only_batch(read(stage)))
    along = points[np.abs(points[:, 0]) < 0.4]
    radius = 0.2 * (np.pi / 24) / np.sin(np.pi / 24)
    assert along[:, 0].max() == pytest.approx(radius, rel=1e-3)
    assert points[:, 1].min() == pytest.approx(-radius, rel=1e-3)


def test_a_ribbon_faces_its_normals_and_has_two_sides():
    stage = new_stage()
    curve = curves(stage, [(0, 0, 0), (3, 0, 0)], width=0.5, type="linear")
    curve.CreateNormalsAttr([Gf.Vec3f(0.3, 1, 0)])
    curve.SetNormalsInterpolation("constant")
    batch = only_batch(read(stage, cull_backfaces=True))
    points = world_points(batch)
    np.testing.assert_allclose(np.ptp(points, axis=0), (3, 0, 0.5), atol=1e-6)
    np.testing.assert_allclose(batch.geometry.normals, [(0, 1, 0)] * 4, atol=1e-6)
    assert batch.double_sided
    assert batch.geometry.triangles.shape == (2, 3)


@pytest.mark.parametrize(
    ("interpolation", "values", "ends"),
    [
        ("constant", [0.5], (0.5, 0.5)),
        ("uniform", [0.25], (0.25, 0.25)),
        ("varying", [0, 1], (0, 1)),
        ("vertex", [0, 0.25, 0.75, 1], (0, 1)),
    ],
)
def test_primvars_of_curves_are_blended_like_their_points(interpolation: str, values: list, ends: tuple):
    stage = new_stage()
    curve = curves(stage, [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)], type="cubic", basis="bezier")
    grey = [Gf.Vec3f(value) for value in values]
    set_primvar(curve.GetPrim(), "displayColor", T.Color3fArray, interpolation, grey)
    geometry = only_batch(read(stage)).geometry
    assert geometry.colors is not None
    share = geometry.positions[:, 0] / 3
    want = ends[0] + (ends[1] - ends[0]) * share
    if interpolation == "vertex":  # a Bezier curve with values 0, 1/4, 3/4, 1
        want = 3 * share * (1 - share) ** 2 / 4 + 9 * share**2 * (1 - share) / 4 + share**3
    shown = colour.to_working(np.repeat(want[:, None], 3, axis=1).astype(np.float32))
    np.testing.assert_allclose(geometry.colors[:, :3], shown, atol=1e-5)


def test_widths_change_along_a_curve():
    stage = new_stage()
    curve = curves(stage, [(0, 0, 0), (4, 0, 0)], type="linear")
    curve.CreateWidthsAttr([0.2, 1.0])
    curve.SetWidthsInterpolation("varying")
    points = world_points(only_batch(read(stage)))
    factor = (np.pi / 24) / np.sin(np.pi / 24)
    for end, width in ((0, 0.2), (4, 1.0)):
        ring = points[np.abs(points[:, 0] - end) < 1e-5]
        np.testing.assert_allclose(np.hypot(ring[:, 1], ring[:, 2]), factor * width / 2, rtol=1e-5)


def test_moving_curves_are_read_at_each_time():
    stage = new_stage()
    curve = curves(stage, [(0, 0, 0), (1, 0, 0)], type="linear")
    curve.GetPointsAttr().Set(Vt.Vec3fArray([(0, 0, 0), (1, 0, 0)]), 1)
    curve.GetPointsAttr().Set(Vt.Vec3fArray([(0, 5, 0), (1, 5, 0)]), 2)
    reader = StageReader(stage)
    heights = [world_points(only_batch(reader.read(time)))[:, 1].mean() for time in (1.0, 1.5, 2.0)]
    np.testing.assert_allclose(heights, (0, 2.5, 5), atol=1e-5)


WRONG = {
    "negative": {"curveVertexCounts": [-2]},
    "too many": {"curveVertexCounts": [3]},
    "vast": {"curveVertexCounts": [2**31 - 1, 2**31 - 1]},
    "no points": {"points": Vt.Vec3fArray()},
    "not finite": {"points": Vt.Vec3fArray([(0, 0, float("nan")), (1, 0, 0)])},
    "far": {"points": Vt.Vec3fArray([(0, 0, 0), (1e30, 0, 0)])},
    "too short": {"type": "cubic"},
    "basis": {"type": "cubic", "basis": "hermite"},
    "wrap": {"wrap": "twice"},
    "bad indices": {"primvars:widths": Vt.FloatArray([0.1, 0.2]), "primvars:widths:indices": Vt.IntArray([0, 7])},
    "bad widths": {"widths": Vt.FloatArray([float("inf")])},
}


@pytest.mark.parametrize("wrong", WRONG)
def test_curves_that_contradict_themselves_are_named(wrong: str):
    stage = new_stage()
    prim = curves(stage, [(0, 0, 0), (1, 0, 0)], type="linear").GetPrim()
    if wrong == "bad indices":
        set_primvar(prim, "widths", T.FloatArray, "vertex", [1.0]).SetIndices([0])
    for name, value in WRONG[wrong].items():
        prim.GetAttribute(name).Set(value)
    reader = StageReader(stage)
    assert not reader.read(0.0).batches
    assert "bad_geometry" in codes(reader)


@pytest.mark.parametrize(
    "wrong",
    [
        {"order": [1]},
        {"order": [5]},
        {"order": [2, 2]},
        {"knots": [0.0, 0.0, 1.0]},
        {"knots": [0.0, 0, 2, 1, 3, 3, 3, 3]},
        {"pointWeights": [1.0, -4.0, 1.0, 1.0]},
        {"pointWeights": [1.0]},
        {"ranges": [Gf.Vec2d(0, 1), Gf.Vec2d(0, 1)]},
    ],
)
def test_nurbs_that_contradict_themselves_are_lines(wrong: dict):
    """As in Storm: tubes along the lines between their points."""
    stage = new_stage()
    prim = UsdGeom.NurbsCurves.Define(stage, "/curve")
    prim.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
    prim.CreateCurveVertexCountsAttr([4])
    prim.CreateOrderAttr([4])
    prim.CreateWidthsAttr([0.1])
    reader = StageReader(stage)
    assert len(reader.read(0.0).batches) == 1
    assert codes(reader) == {"no_knots"}
    for name, value in wrong.items():
        prim.GetPrim().GetAttribute(name).Set(value)
    reader = StageReader(stage)
    points = world_points(only_batch(reader.read(0.0)))
    along = np.clip(points, 0, 1)
    off = [np.hypot(points[:, 1] - at, points[:, 2]) for at in (0, 1)]
    off.append(np.hypot(points[:, 0] - 1, points[:, 2]))
    assert np.min(off, axis=0).max() < 0.06
    assert np.abs(points - along)[:, :2].max() < 0.06
    assert "control_polygon" in codes(reader)


def test_short_curves_are_left_out_and_named():
    stage = new_stage()
    curve = curves(stage, [(0, 0, 0), (1, 0, 0), (2, 0, 0)], type="linear")
    curve.CreateCurveVertexCountsAttr([1, 2])
    reader = StageReader(stage)
    points = world_points(only_batch(reader.read(0.0)))
    assert points[:, 0].min() == pytest.approx(1, abs=1e-6)
    assert codes(reader) == {"short_curves"}


@pytest.mark.parametrize("interpolation", ["uniform", "constant"])
def test_normals_of_ribbons_may_have_indices(interpolation: str):
    stage = new_stage()
    curve = curves(stage, [(0, 0, 0), (1, 0, 0), (0, 0, 5), (1, 0, 5)], type="linear")
    curve.CreateCurveVertexCountsAttr([2, 2])
    normals = [Gf.Vec3f(0, 0, 1), Gf.Vec3f(0, 1, 0)]
    indices = [1, 0] if interpolation == "uniform" else [1]
    set_primvar(curve.GetPrim(), "normals", T.Normal3fArray, interpolation, normals).SetIndices(indices)
    geometry = only_batch(read(stage)).geometry
    first = geometry.positions[:, 2] < 2
    np.testing.assert_allclose(geometry.normals[first], [(0, 1, 0)] * first.sum(), atol=1e-6)
    second = (0, 0, 1) if interpolation == "uniform" else (0, 1, 0)
    np.testing.assert_allclose(geometry.normals[~first], [second] * (~first).sum(), atol=1e-6)
