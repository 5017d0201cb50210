"""Native instances and point instancers stand where USD says, and a pick can tell them apart."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Sdf, UsdGeom

from render import colour
from render.frame import FrameRenderer
from render.model.camera import Camera
from render.model.scene import Batch, Scene
from render.stage import StageReader
from tests.render.kits.stages import (
    add_material,
    add_mesh,
    bind,
    instancer,
    new_stage,
    only_batch,
    read,
    set_primvar,
    two_instances,
    world_points,
)


def origins(batch: Batch) -> list[tuple[float, ...]]:
    """Where each instance's first vertex is, rounded."""
    return [tuple(np.round(world_points(batch, i)[0], 5).tolist()) for i in range(len(batch.poses))]


def picked_as(scene: Scene, batch: Batch) -> list[str]:
    assert batch.instance_prim_ids is not None
    return [scene.prim_paths[i] for i in batch.instance_prim_ids]


def test_native_instances_share_geometry_and_pick_by_their_own_paths() -> None:
    stage = new_stage()
    two_instances(stage)
    scene = read(stage)
    batch = only_batch(scene)
    assert origins(batch) == [(0, 0, 0), (10, 0, 0)]
    assert picked_as(scene, batch) == ["/i0/geo/grid", "/i1/geo/grid"]
    assert batch.instance_numbers is None
    assert scene.triangle_count == 2 * 2 * 80 * 80


def test_small_instances_are_copied_into_one_draw() -> None:
    stage = new_stage()
    add_mesh(stage, "/_proto/quad")
    stage.GetPrimAtPath("/_proto").SetSpecifier(Sdf.SpecifierClass)
    for number in range(50):
        prim = UsdGeom.Xform.Define(stage, f"/i{number}")
        prim.GetPrim().GetReferences().AddInternalReference("/_proto")
        prim.GetPrim().SetInstanceable(True)
        prim.AddTranslateOp().Set(Gf.Vec3d(number, 0, 0))
    scene = read(stage)
    batch = only_batch(scene)
    assert len(batch.poses) == 1
    assert {scene.prim_paths[i] for i in batch.geometry.prim_ids} == {f"/i{i}/quad" for i in range(50)}


def test_an_instance_may_wear_what_its_place_says() -> None:
    stage = new_stage()
    two_instances(stage)
    add_material(stage, "/looks/a", roughness=0.2)
    bind(stage.GetPrimAtPath("/i1"), "/looks/a")
    assert {batch.material.name for batch in read(stage).batches} == {"", "/looks/a"}


def test_an_instance_may_inherit_another_colour() -> None:
    stage = new_stage()
    two_instances(stage)
    set_primvar(stage.GetPrimAtPath("/i1"), "displayColor", Sdf.ValueTypeNames.Color3fArray, "constant", [(1, 0, 0)])
    scene = read(stage)
    colors = np.concatenate([batch.geometry.colors for batch in scene.batches])
    red = np.isclose(colors[:, :3], colour.rgb_to_working((1, 0, 0)), atol=1e-5).all(axis=1)
    assert red.sum() == len(colors) / 2


def test_instances_may_move_and_mirror() -> None:
    stage = new_stage()
    two_instances(stage)
    moves = UsdGeom.Xformable(stage.GetPrimAtPath("/i1"))
    moves.GetOrderedXformOps()[0].Set(Gf.Vec3d(10, 0, 0), 0)
    moves.GetOrderedXformOps()[0].Set(Gf.Vec3d(10, 5, 0), 5)
    UsdGeom.Xformable(stage.GetPrimAtPath("/i0")).AddScaleOp().Set(Gf.Vec3f(-1, 1, 1))
    reader = StageReader(stage)
    one, two = reader.read(0), reader.read(5)
    batch = only_batch(two)
    assert batch.geometry is only_batch(one).geometry
    assert origins(batch) == [(0, 0, 0), (10, 5, 0)]
    assert np.linalg.det(batch.poses[:, :3, :3]).tolist() == [-1, 1]


@pytest.mark.gl
@pytest.mark.parametrize("mirror", [1, -1])
@pytest.mark.parametrize("kind", ["still", "moving", "native", "points"])
def test_what_is_mirrored_shows_its_outside_wherever_it_is_drawn(
    renderer: FrameRenderer, kind: str, mirror: int
) -> None:
    """A one-sided square that faces +Z is seen from there and not from behind, mirrored or not, where backs are culled."""
    stage = new_stage()
    if kind == "native":
        two_instances(stage)
        place = UsdGeom.Xformable(stage.GetPrimAtPath("/i0"))
    elif kind == "points":
        add_mesh(stage, "/dots/a")
        place = instancer(stage, "/dots", ["/dots/a"], [0])
    else:
        place = add_mesh(stage, "/m")
    scale = place.AddScaleOp()
    scale.Set(Gf.Vec3f(mirror, 1, 1))
    if kind == "moving":
        scale.Set(Gf.Vec3f(mirror, 2, 1), 10)
        scale.Set(Gf.Vec3f(mirror, 1, 1), 0)
    scene = read(stage, cull_backfaces=True)
    before, behind = np.eye(4), np.diag([-1.0, 1, -1, 1])
    before[:3, 3], behind[:3, 3] = [0.4 * mirror, 0.3, 5], [0.4 * mirror, 0.3, -5]
    hits = [renderer.pick(scene, Camera(pose), 32, 32, 16.5, 16.5) for pose in (before, behind)]
    assert hits[0] is not None
    assert hits[1] is None
    np.testing.assert_allclose(hits[0].position_m[:2], [0.4 * mirror, 0.3], atol=0.2)


def test_a_point_instancer_draws_prototypes_and_numbers_instances() -> None:
    stage = new_stage()
    dots = instancer(stage, "/dots", ["/dots/a", "/dots/b"], [0, 1, 0, 1])
    dots.CreateScalesAttr([Gf.Vec3f(2)] * 4)
    turn = Gf.Rotation(Gf.Vec3d(0, 0, 1), 90).GetQuat()
    dots.CreateOrientationsAttr([Gf.Quath(turn)] * 4)
    dots.AddTranslateOp().Set(Gf.Vec3d(0, 0, 100))
    add_mesh(stage, "/dots/a").AddTranslateOp().Set(Gf.Vec3d(1, 0, 0))
    UsdGeom.Xform.Define(stage, "/dots/b")
    add_mesh(stage, "/dots/b/inner").AddTranslateOp().Set(Gf.Vec3d(0, 3, 0))
    scene = read(stage)
    a, b = sorted(scene.batches, key=lambda batch: scene.prim_paths[batch.geometry.prim_ids[0]])
    # Local (1, 0, 0) is scaled by 2 and turned to (0, 2, 0); local (0, 3, 0) comes to (-6, 0, 0).
    np.testing.assert_allclose(origins(a), [(0, 2, 100), (20, 2, 100)], atol=2e-2)
    np.testing.assert_allclose(origins(b), [(4, 0, 100), (24, 0, 100)], atol=2e-2)
    assert a.instance_numbers is not None
    assert b.instance_numbers is not None
    assert (a.instance_numbers.tolist(), b.instance_numbers.tolist()) == ([0, 2], [1, 3])
    assert picked_as(scene, a) == ["/dots", "/dots"]
    assert scene.prim_paths[b.geometry.prim_ids[0]] == "/dots/b/inner"


def test_hidden_instances_are_not_drawn_and_others_keep_their_ids() -> None:
    stage = new_stage()
    add_mesh(stage, "/dots/a")
    dots = instancer(stage, "/dots", ["/dots/a"], [0] * 5)
    dots.CreateIdsAttr([100, 101, 102, 103, 104])
    dots.CreateInvisibleIdsAttr([101])
    dots.DeactivateId(103)
    batch = only_batch(read(stage))
    assert batch.instance_numbers is not None
    assert batch.instance_numbers.tolist() == [100, 102, 104]


def test_instances_that_come_and_go_over_time() -> None:
    stage = new_stage()
    add_mesh(stage, "/dots/a")
    dots = instancer(stage, "/dots", ["/dots/a"], [0] * 3)
    dots.CreateIdsAttr([0, 1, 2])
    dots.CreateInvisibleIdsAttr().Set([0], 0)
    dots.GetInvisibleIdsAttr().Set([], 10)
    reader = StageReader(stage)
    assert len(only_batch(reader.read(0)).poses) == 2
    assert len(only_batch(reader.read(10)).poses) == 3
    assert only_batch(reader.read(0)).geometry is only_batch(reader.read(10)).geometry


def test_velocities_carry_instances_between_samples() -> None:
    stage = new_stage()
    stage.SetTimeCodesPerSecond(24)
    add_mesh(stage, "/dots/a")
    dots = instancer(stage, "/dots", ["/dots/a"], [0])
    dots.GetPositionsAttr().Set([Gf.Vec3f(1, 0, 0)], 0)
    dots.CreateVelocitiesAttr().Set([Gf.Vec3f(48, 0, 0)], 0)
    reader = StageReader(stage)
    assert origins(only_batch(reader.read(0))) == [(1, 0, 0)]
    assert origins(only_batch(reader.read(12)))[0][0] == pytest.approx(25)


@pytest.mark.parametrize(("indices", "positions"), [(2, 4), (4, 2)])
def test_lists_of_unlike_length_draw_the_instances_in_both(indices: int, positions: int) -> None:
    stage = new_stage()
    add_mesh(stage, "/dots/a")
    dots = instancer(stage, "/dots", ["/dots/a"], [0] * indices)
    dots.GetPositionsAttr().Set([Gf.Vec3f(3 * i, 0, 0) for i in range(positions)])
    dots.CreateScalesAttr([Gf.Vec3f(2)] * 4)
    reader = StageReader(stage)
    batch = only_batch(reader.read(0))
    assert origins(batch) == [(0, 0, 0), (3, 0, 0)]
    assert batch.poses[1, 0, 0] == pytest.approx(2), "scales that are there for both are used"
    assert [finding.code for finding in reader.findings] == ["bad_instances"]


def test_velocities_carry_instances_of_short_lists() -> None:
    stage = new_stage()
    stage.SetTimeCodesPerSecond(24)
    add_mesh(stage, "/dots/a")
    dots = instancer(stage, "/dots", ["/dots/a"], [0])
    dots.GetPositionsAttr().Set([Gf.Vec3f(1, 0, 0), Gf.Vec3f(5, 0, 0)], 0)
    dots.CreateVelocitiesAttr().Set([Gf.Vec3f(48, 0, 0), Gf.Vec3f(0, 0, 0)], 0)
    assert origins(only_batch(StageReader(stage).read(12)))[0][0] == pytest.approx(25)


def test_short_lists_are_not_blended_with_those_of_other_length() -> None:
    """USD holds a list until the next sample where that one has another length: other particles may be in its places."""
    stage = new_stage()
    add_mesh(stage, "/dots/a")
    dots = instancer(stage, "/dots", ["/dots/a"], [0, 0])
    dots.GetPositionsAttr().Clear()
    dots.GetPositionsAttr().Set([Gf.Vec3f(3 * i, 0, 0) for i in range(4)], 0)
    dots.GetPositionsAttr().Set([Gf.Vec3f(100, 0, 0)] * 3, 10)
    reader = StageReader(stage)
    assert origins(only_batch(reader.read(5))) == [(0, 0, 0), (3, 0, 0)]
    dots.GetPositionsAttr().Set([Gf.Vec3f(100 + 3 * i, 0, 0) for i in range(4)], 10)
    assert origins(only_batch(reader.read(5))) == [(50, 0, 0), (53, 0, 0)]


def test_prototypes_that_are_overs_or_elsewhere_are_drawn_once() -> None:
    stage = new_stage()
    add_mesh(stage, "/library/a")
    stage.GetPrimAtPath("/library").SetSpecifier(Sdf.SpecifierOver)
    stage.GetPrimAtPath("/library/a").SetSpecifier(Sdf.SpecifierOver)
    instancer(stage, "/dots", ["/library/a"], [0, 0])
    assert len(only_batch(read(stage)).poses) == 2


def test_nested_instancers_multiply() -> None:
    stage = new_stage()
    add_mesh(stage, "/outer/inner/a")
    inner = instancer(stage, "/outer/inner", ["/outer/inner/a"], [0, 0, 0])
    inner.AddTranslateOp().Set(Gf.Vec3d(0, 7, 0))
    outer = instancer(stage, "/outer", ["/outer/inner"], [0, 0])
    outer.GetPositionsAttr().Set([Gf.Vec3f(0, 0, 0), Gf.Vec3f(0, 0, 100)])
    scene = read(stage)
    batch = only_batch(scene)
    assert batch.instance_numbers is not None
    assert batch.instance_numbers.tolist() == [0, 1, 2, 3, 4, 5]
    assert origins(batch)[5] == (20, 7, 100)
    assert set(picked_as(scene, batch)) == {"/outer"}


def test_an_instancer_in_a_native_instance() -> None:
    stage = new_stage()
    add_mesh(stage, "/_proto/dots/a")
    instancer(stage, "/_proto/dots", ["/_proto/dots/a"], [0, 0])
    stage.GetPrimAtPath("/_proto").SetSpecifier(Sdf.SpecifierClass)
    for number in range(2):
        prim = UsdGeom.Xform.Define(stage, f"/i{number}")
        prim.GetPrim().GetReferences().AddInternalReference("/_proto")
        prim.GetPrim().SetInstanceable(True)
        prim.AddTranslateOp().Set(Gf.Vec3d(0, number, 0))
    scene = read(stage)
    where = sorted((picked_as(scene, b)[i], origins(b)[i]) for b in scene.batches for i in range(len(b.poses)))
    assert where == [
        ("/i0/dots", (0, 0, 0)),
        ("/i0/dots", (10, 0, 0)),
        ("/i1/dots", (0, 1, 0)),
        ("/i1/dots", (10, 1, 0)),
    ]


def test_a_missing_prototype_is_reported() -> None:
    stage = new_stage()
    add_mesh(stage, "/dots/a")
    instancer(stage, "/dots", ["/dots/a", "/dots/gone"], [0, 1])
    reader = StageReader(stage)
    assert len(only_batch(reader.read(0)).poses) == 1
    assert [(f.code, f.path) for f in reader.findings] == [("missing_prototype", "/dots/gone")]
