"""Skeletons and blend shapes bend meshes, and carry their normals."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt

from render.stage import StageReader
from tests.render.kits.stages import add_mesh, new_stage, only_batch, read, set_primvar, world_points

# A strip along +X: its left half hangs on joint 0, its right half on joint 1 at x = 1.
STRIP = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 0, -1), (1, 0, -1), (2, 0, -1)]
CORNERS = [0, 1, 4, 3, 1, 2, 5, 4]


def bent_strip(normals: str = "") -> Usd.Stage:
    """A strip whose right half turns up by 90 degrees about its middle, from time 0 to time 10."""
    stage = new_stage()
    root = UsdSkel.Root.Define(stage, "/rig")
    root.AddTranslateOp().Set(Gf.Vec3d(0, 0, 50))
    skeleton = UsdSkel.Skeleton.Define(stage, "/rig/skeleton")
    joints = ["root", "root/tip"]
    rest = [Gf.Matrix4d(1), Gf.Matrix4d(1).SetTranslate(Gf.Vec3d(1, 0, 0))]
    skeleton.CreateJointsAttr(joints)
    skeleton.CreateBindTransformsAttr(rest)
    skeleton.CreateRestTransformsAttr(rest)
    animation = UsdSkel.Animation.Define(stage, "/rig/animation")
    animation.CreateJointsAttr(joints)
    still = Gf.Quatf(1, 0, 0, 0)
    turned = Gf.Quatf(Gf.Rotation(Gf.Vec3d(0, 0, 1), 90).GetQuat())
    animation.CreateTranslationsAttr([Gf.Vec3f(0, 0, 0), Gf.Vec3f(1, 0, 0)])
    animation.CreateScalesAttr([Gf.Vec3h(1, 1, 1)] * 2)
    animation.CreateRotationsAttr().Set(Vt.QuatfArray([still, still]), 0)
    animation.GetRotationsAttr().Set(Vt.QuatfArray([still, turned]), 10)
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets([animation.GetPath()])
    mesh = add_mesh(stage, "/rig/strip", STRIP, [4, 4], CORNERS)
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    binding.CreateJointIndicesPrimvar(False, 1).Set([0, 0, 1, 0, 0, 1])
    binding.CreateJointWeightsPrimvar(False, 1).Set([1.0] * 6)
    if normals:
        count = {"vertex": 6, "faceVarying": 8}[normals]
        set_primvar(mesh.GetPrim(), "normals", Sdf.ValueTypeNames.Normal3fArray, normals, [Gf.Vec3f(0, 1, 0)] * count)
    return stage


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


def test_blend_shapes_move_points() -> None:
    stage = bent_strip()
    mesh = stage.GetPrimAtPath("/rig/strip")
    shape = UsdSkel.BlendShape.Define(stage, "/rig/strip/lift")
    shape.CreateOffsetsAttr([Gf.Vec3f(0, 2, 0)])
    shape.CreatePointIndicesAttr([0])
    binding = UsdSkel.BindingAPI(mesh)
    binding.CreateBlendShapesAttr(["lift"])
    binding.CreateBlendShapeTargetsRel().SetTargets([shape.GetPath()])
    animation = UsdSkel.Animation(stage.GetPrimAtPath("/rig/animation"))
    animation.CreateBlendShapesAttr(["lift"])
    animation.CreateBlendShapeWeightsAttr().Set([0.0], 0)
    animation.GetBlendShapeWeightsAttr().Set([1.0], 10)
    reader = StageReader(stage)
    assert world_points(only_batch(reader.read(0)))[:, 1].max() == pytest.approx(0, abs=1e-6)
    lifted = world_points(only_batch(reader.read(10)))
    assert lifted[:, 1].max() == pytest.approx(2)
    assert reader.findings == []


def test_a_mesh_that_no_skeleton_binds_is_as_it_is() -> None:
    stage = bent_strip()
    add_mesh(stage, "/rig/prop")
    scene = read(stage, 10)
    prop = next(b for b in scene.batches if scene.prim_paths[b.geometry.prim_ids[0]] == "/rig/prop")
    np.testing.assert_allclose(world_points(prop)[:, 1].max(), 1)


def test_numbers_that_do_not_fit_are_reported_and_the_mesh_is_drawn_at_rest() -> None:
    stage = bent_strip()
    mesh = stage.GetPrimAtPath("/rig/strip")
    UsdSkel.BindingAPI(mesh).GetJointIndicesPrimvar().Set([0, 9])
    UsdGeom.PrimvarsAPI(mesh).GetPrimvar("skel:jointWeights").Set([1.0])
    reader = StageReader(stage)
    points = world_points(only_batch(reader.read(10)))
    np.testing.assert_allclose(points[:, 1], 0, atol=1e-6)
    assert [f.code for f in reader.findings] == ["skinning_failed"]
