"""Skeletons and blend shapes bend meshes, and carry their normals."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, UsdGeom, UsdSkel

from render.stage import StageReader
from tests.render.kits.skinned import bent_strip
from tests.render.kits.stages import add_mesh, only_batch, read, world_points


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


def test_bad_skinning_is_reported_and_the_mesh_is_drawn_at_rest() -> None:
    stage = bent_strip()
    mesh = stage.GetPrimAtPath("/rig/strip")
    UsdSkel.BindingAPI(mesh).GetJointIndicesPrimvar().Set([0, 9])
    UsdGeom.PrimvarsAPI(mesh).GetPrimvar("skel:jointWeights").Set([1.0])
    reader = StageReader(stage)
    points = world_points(only_batch(reader.read(10)))
    np.testing.assert_allclose(points[:, 1], 0, atol=1e-6)
    assert [f.code for f in reader.findings] == ["skinning_failed"]
