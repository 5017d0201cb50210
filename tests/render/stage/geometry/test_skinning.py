"""Skeletons and blend shapes bend meshes, and carry their normals."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdSkel

from render.model.scene import Geometry
from render.stage import StageReader
from render.stage.findings import FindingLog
from render.stage.geometry.skinning import Skeletons
from tests.render.kits.skinned import CORNERS, STRIP, bent_strip
from tests.render.kits.stages import add_mesh, codes, only_batch, read, world_points


def test_points_go_with_their_joints_and_with_the_root() -> None:
    stage = bent_strip()
    reader = StageReader(stage)
    rest = world_points(only_batch(reader.read(0)))
    np.testing.assert_allclose(np.unique(rest[:, 1]), 0, atol=1e-6)
    bent = only_batch(reader.read(10))
    points = world_points(bent)
    # (2, 0) is one unit right of the joint at (1, 0), so a quarter turn puts it at (1, 1).
    tips = points[points[:, 1] > 0.5]
    np.testing.assert_allclose(np.unique(np.round(tips, 5), axis=0), [[1, 1, 49], [1, 1, 50]])


@pytest.mark.parametrize("normals", ["faceVarying", "vertex", ""])
def test_normals_are_carried_and_hard_edges_stay_hard(normals: str) -> None:
    reader = StageReader(bent_strip(normals))
    flat = only_batch(reader.read(0)).geometry
    np.testing.assert_allclose(flat.normals, np.tile([0, 1, 0], (len(flat.normals), 1)), atol=1e-6)
    bent = only_batch(reader.read(10)).geometry
    by_face = [bent.normals[bent.triangles[bent.face_ids == face]].reshape(-1, 3) for face in (0, 1)]
    if normals == "vertex":
        corner = np.array([-1, 1, 0]) / np.sqrt(2)
        np.testing.assert_allclose(by_face[0].max(axis=0)[1], 1, atol=1e-6)
        assert any(np.allclose(normal, corner, atol=1e-6) for normal in by_face[1])
    else:
        np.testing.assert_allclose(by_face[0], np.tile([0, 1, 0], (6, 1)), atol=1e-6)
        np.testing.assert_allclose(by_face[1], np.tile([-1, 0, 0], (6, 1)), atol=1e-6)


def at_corners(points: np.ndarray, geometry: Geometry) -> np.ndarray:
    """``(m, 3, 3)`` points of the strip at the corners of triangles."""
    fans = np.stack([0 * geometry.fan_ids, geometry.fan_ids + 1, geometry.fan_ids + 2], axis=1)
    return points[CORNERS].reshape(2, 4, 3)[geometry.face_ids[:, None], fans]


def add_lift(stage: Usd.Stage, *weights: float) -> UsdSkel.BlendShape:
    """A shape that lifts point 0 by 2, with its weights at times 0, 10 and so on."""
    mesh = stage.GetPrimAtPath("/rig/strip")
    shape = UsdSkel.BlendShape.Define(stage, "/rig/strip/lift")
    shape.CreateOffsetsAttr([Gf.Vec3f(0, 2, 0)])
    shape.CreatePointIndicesAttr([0])
    binding = UsdSkel.BindingAPI(mesh)
    binding.CreateBlendShapesAttr(["lift"])
    binding.CreateBlendShapeTargetsRel().SetTargets([shape.GetPath()])
    animation = UsdSkel.Animation(stage.GetPrimAtPath("/rig/animation"))
    animation.CreateBlendShapesAttr(["lift"])
    for number, weight in enumerate(weights):
        animation.CreateBlendShapeWeightsAttr().Set([weight], 10 * number)
    return shape


def test_blend_shapes_move_points() -> None:
    stage = bent_strip()
    add_lift(stage, 0.0, 1.0)
    reader = StageReader(stage)
    assert world_points(only_batch(reader.read(0)))[:, 1].max() == pytest.approx(0, abs=1e-6)
    lifted = world_points(only_batch(reader.read(10)))
    assert lifted[:, 1].max() == pytest.approx(2)
    assert reader.findings == []


@pytest.mark.parametrize(
    ("weight", "offset"), [(0.25, (2.5, 0, 0)), (0.5, (5, 0, 0)), (0.75, (2.5, 1, 0)), (1.5, (-5, 4, 0))]
)
def test_in_betweens_are_met_on_the_way(weight: float, offset: tuple[float, ...]) -> None:
    stage = bent_strip("vertex")
    shape = add_lift(stage, weight)
    shape.CreateNormalOffsetsAttr([Gf.Vec3f(1, 0, 0)])
    between = shape.CreateInbetween("half")
    between.SetWeight(0.5)
    between.SetOffsets([Gf.Vec3f(5, 0, 0)])
    between.SetNormalOffsets([Gf.Vec3f(0, 0, 3)])
    geometry = only_batch(read(stage, 0)).geometry
    moved = np.array(STRIP, np.float32)
    moved[0] += offset
    np.testing.assert_allclose(geometry.positions[geometry.triangles], at_corners(moved, geometry), atol=1e-6)
    half, full = offset[0] / 5, offset[1] / 2  # weights of the two
    normal = np.array([full, 1, 3 * half]) / np.linalg.norm([full, 1, 3 * half])
    here = np.linalg.norm(geometry.positions - moved[0], axis=1) < 1e-6
    np.testing.assert_allclose(geometry.normals[here], np.tile(normal, (here.sum(), 1)), atol=1e-5)
    np.testing.assert_allclose(geometry.normals[~here], np.tile([0, 1, 0], ((~here).sum(), 1)), atol=1e-6)


def test_normal_offsets_turn_with_the_skeleton() -> None:
    stage = bent_strip("faceVarying")
    shape = add_lift(stage, 1.0)
    shape.CreatePointIndicesAttr([2])  # of the half that turns
    shape.GetOffsetsAttr().Set([Gf.Vec3f(0)])
    shape.CreateNormalOffsetsAttr([Gf.Vec3f(1, 0, 0)])
    geometry = only_batch(read(stage, 10)).geometry
    here = np.linalg.norm(geometry.positions - [1, 1, 0], axis=1) < 1e-6
    np.testing.assert_allclose(geometry.normals[here], [np.array([-1, 1, 0]) / np.sqrt(2)], atol=1e-5)


@pytest.mark.parametrize("offsets", [[Gf.Vec3f(1, 0, 0)] * 2, [Gf.Vec3f(float("inf"), 0, 0)]])
def test_normal_offsets_that_do_not_fit_are_named(offsets: list[Gf.Vec3f]) -> None:
    stage = bent_strip("vertex")
    add_lift(stage, 1.0).CreateNormalOffsetsAttr(offsets)
    reader = StageReader(stage)
    assert np.isfinite(only_batch(reader.read(0)).geometry.normals).all()
    assert codes(reader) == {"bad_normals"}


@pytest.mark.parametrize("weight", [float("nan"), 1e30])
def test_absurd_weights_are_named(weight: float) -> None:
    stage = bent_strip()
    add_lift(stage, weight)
    reader = StageReader(stage)
    assert reader.read(0).triangle_count == 0
    assert codes(reader) == {"bad_geometry"}


@pytest.mark.parametrize("method", ["classicLinear", "dualQuaternion"])
def test_skinning_is_that_of_usdskel_with_scales(method: str) -> None:
    stage = bent_strip()
    mesh = stage.GetPrimAtPath("/rig/strip")
    binding = UsdSkel.BindingAPI(mesh)
    binding.CreateJointIndicesPrimvar(False, 2).Set([0, 1] * 6)
    binding.CreateJointWeightsPrimvar(False, 2).Set([1, 0, 0.5, 0.5, 0, 1, 1, 0, 0.5, 0.5, 0.25, 0.75])
    binding.CreateSkinningMethodAttr(method)
    UsdSkel.Animation(stage.GetPrimAtPath("/rig/animation")).GetScalesAttr().Set([Gf.Vec3h(1), Gf.Vec3h(2, 1, 0.5)])
    geometry = only_batch(read(stage, 10)).geometry
    some = np.array([5, 1])
    resting = UsdGeom.Mesh(mesh).GetPointsAttr().Get(10)
    bent = Skeletons(stage).bend_points(mesh, resting, Usd.TimeCode(10), FindingLog(), some)
    assert UsdSkel.BakeSkinning(UsdSkel.Root(stage.GetPrimAtPath("/rig")))
    baked = np.array(UsdGeom.Mesh(mesh).GetPointsAttr().Get(10))
    np.testing.assert_allclose(geometry.positions[geometry.triangles], at_corners(baked, geometry), atol=1e-5)
    np.testing.assert_allclose(bent, baked[some], atol=1e-6)


def test_dual_quaternions_keep_the_length_of_a_half_turned_point() -> None:
    """Points at the joint's axis half way between two turns lie on the circle, and not within it as the mean of matrices does."""
    stage = bent_strip()
    binding = UsdSkel.BindingAPI(stage.GetPrimAtPath("/rig/strip"))
    binding.CreateJointIndicesPrimvar(False, 2).Set([0, 1] * 6)
    binding.CreateJointWeightsPrimvar(False, 2).Set([0.5] * 12)
    for method, length in (("dualQuaternion", 1.0), ("classicLinear", np.sqrt(0.5))):
        binding.CreateSkinningMethodAttr(method)
        points = only_batch(read(stage, 10)).geometry.positions
        away = np.linalg.norm(points[np.abs(points[:, 2]) < 1e-6] - [1, 0, 0], axis=1)
        np.testing.assert_allclose(np.sort(away)[-2:], length, atol=1e-5)


def test_a_mesh_that_no_skeleton_binds_is_as_it_is() -> None:
    stage = bent_strip()
    add_mesh(stage, "/rig/prop")
    scene = read(stage, 10)
    prop = next(b for b in scene.batches if scene.prim_paths[b.geometry.prim_ids[0]] == "/rig/prop")
    np.testing.assert_allclose(world_points(prop)[:, 1].max(), 1)


def test_bad_skinning_is_reported_and_the_mesh_is_drawn_at_rest() -> None:
    stage = bent_strip()
    mesh = stage.GetPrimAtPath("/rig/strip")
    UsdSkel.BindingAPI(mesh).GetJointIndicesPrimvar().Set([0, 9])
    UsdGeom.PrimvarsAPI(mesh).GetPrimvar("skel:jointWeights").Set([1.0])
    reader = StageReader(stage)
    points = world_points(only_batch(reader.read(10)))
    np.testing.assert_allclose(points[:, 1], 0, atol=1e-6)
    assert [f.code for f in reader.findings] == ["skinning_failed"]
