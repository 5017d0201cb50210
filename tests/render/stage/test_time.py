"""A change of time remakes what moves and nothing else; values are those of the asked time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Ts, Usd, UsdGeom, UsdLux, UsdShade, UsdVol

from render.model.scene import Batch, Scene
from render.stage import StageOptions, StageReader, open_stage
from tests.render.kits.stages import (
    ASSETS,
    QUAD_POINTS,
    add_material,
    add_mesh,
    bind,
    needs_assets,
    new_stage,
    only_batch,
    read,
    set_primvar,
    world_points,
)


def batch_of(scene: Scene, path: str) -> Batch:
    """The batch whose first triangle is of that prim."""
    return next(b for b in scene.batches if scene.prim_paths[b.geometry.prim_ids[0]] == path)


def test_what_stands_still_is_the_same_object() -> None:
    stage = new_stage()
    add_mesh(stage, "/still")
    add_mesh(stage, "/mover").AddTranslateOp().Set(Gf.Vec3d(0, 0, 0), 0)
    UsdGeom.Xformable(stage.GetPrimAtPath("/mover")).GetOrderedXformOps()[0].Set(Gf.Vec3d(10, 0, 0), 10)
    bend = add_mesh(stage, "/bend")
    bend.GetPointsAttr().Set([Gf.Vec3f(*p) for p in QUAD_POINTS], 0)
    bend.GetPointsAttr().Set([Gf.Vec3f(p[0], p[1], 5) for p in QUAD_POINTS], 10)
    reader = StageReader(stage)
    one, two = reader.read(0), reader.read(5)
    assert batch_of(one, "/still") is batch_of(two, "/still")
    mover, moved = batch_of(one, "/mover"), batch_of(two, "/mover")
    assert mover is not moved
    assert mover.geometry is moved.geometry
    assert mover.material is moved.material
    np.testing.assert_allclose(world_points(moved)[0], [5, 0, 0])
    bent = batch_of(two, "/bend")
    assert bent.geometry is not batch_of(one, "/bend").geometry
    assert bent.material is batch_of(one, "/bend").material
    np.testing.assert_allclose(world_points(bent)[:, 2], 2.5)
    assert reader.read(5) is two


def test_what_holds_still_for_a_while_is_the_same_object_too() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m")
    for time, height in ((0, 0), (10, 0), (20, 1)):
        mesh.GetPointsAttr().Set([Gf.Vec3f(p[0], p[1], height) for p in QUAD_POINTS], time)
    reader = StageReader(stage)
    assert reader.read(0).batches[0] is reader.read(7).batches[0]
    assert reader.read(7).batches[0] is not reader.read(15).batches[0]


def test_things_under_one_mover_are_one_draw() -> None:
    stage = new_stage(0.01)
    group = UsdGeom.Xform.Define(stage, "/group")
    group.AddRotateYOp().Set(0.0, 0)
    group.GetOrderedXformOps()[0].Set(90.0, 10)
    for i in range(5):
        add_mesh(stage, f"/group/m{i}").AddTranslateOp().Set(Gf.Vec3d(100 * i, 0, 0))
    reader = StageReader(stage)
    batch = only_batch(reader.read(0))
    np.testing.assert_allclose(world_points(batch)[:, 0].max(), 4.01, atol=1e-6)
    turned = only_batch(reader.read(10))
    assert turned.geometry is batch.geometry
    np.testing.assert_allclose(world_points(turned)[:, 2].min(), -4.01, atol=1e-6)


def test_a_scale_that_passes_through_zero_does_no_harm() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m")
    scale = mesh.AddScaleOp()
    scale.Set(Gf.Vec3f(0, 0, 0), 0)
    scale.Set(Gf.Vec3f(2, 2, 2), 10)
    reader = StageReader(stage)
    reader.read(0)
    assert world_points(only_batch(reader.read(10))).max() == pytest.approx(2)


def test_visibility_over_time_shows_and_hides() -> None:
    stage = new_stage()
    add_mesh(stage, "/always")
    UsdGeom.Xform.Define(stage, "/group")
    add_mesh(stage, "/group/blinks")
    visibility = UsdGeom.Imageable(stage.GetPrimAtPath("/group")).CreateVisibilityAttr()
    visibility.Set("invisible", 0)
    visibility.Set("inherited", 10)
    reader = StageReader(stage)
    hidden, shown = reader.read(0), reader.read(10)
    assert len(hidden.batches) == 1
    assert len(shown.batches) == 2
    assert hidden.batches[0] is shown.batches[0]
    assert reader.read(12).batches[1] is shown.batches[1]


def test_a_material_over_time_keeps_its_geometry() -> None:
    stage = new_stage()
    shader = add_material(stage, "/looks/a", roughness=0.5)
    glow = shader.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f)
    glow.Set(Gf.Vec3f(0, 0, 0), 0)
    glow.Set(Gf.Vec3f(1, 1, 1), 10)
    bind(add_mesh(stage, "/m").GetPrim(), "/looks/a")
    reader = StageReader(stage)
    dark, bright = only_batch(reader.read(0)), only_batch(reader.read(10))
    assert dark.geometry is bright.geometry
    assert dark.material.emissive == pytest.approx((0, 0, 0))
    assert bright.material.emissive == pytest.approx((1, 1, 1), abs=1e-3)
    assert only_batch(reader.read(12)) is bright


def test_a_colour_over_time() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m").GetPrim()
    primvar = set_primvar(mesh, "displayColor", Sdf.ValueTypeNames.Color3fArray, "constant", [Gf.Vec3f(0, 0, 0)])
    primvar.Set([Gf.Vec3f(0, 0, 0)], 0)
    primvar.Set([Gf.Vec3f(1, 1, 1)], 10)
    reader = StageReader(stage)
    assert only_batch(reader.read(0)).geometry.colors[0, 0] == pytest.approx(0)
    assert only_batch(reader.read(5)).geometry.colors[0, 0] == pytest.approx(0.5, abs=1e-3)


def test_splines_move_things() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m")
    turn = mesh.AddRotateZOp(UsdGeom.XformOp.PrecisionDouble)
    spline = Ts.Spline("double")
    for time, value in ((0.0, 0.0), (10.0, 90.0)):
        spline.SetKnot(Ts.Knot("double", time=time, value=value, nextInterp=Ts.InterpLinear))
    turn.GetAttr().SetSpline(spline)
    reader = StageReader(stage)
    reader.read(0)
    np.testing.assert_allclose(world_points(only_batch(reader.read(10)))[1], [0, 1, 0], atol=1e-6)


def test_value_clips_are_read_at_their_times(tmp_path: Path) -> None:
    for number, height in enumerate((1.0, 7.0)):
        clip = Usd.Stage.CreateNew(str(tmp_path / f"clip{number}.usda"))
        mesh = UsdGeom.Mesh.Define(clip, "/m")
        for time in (0, 9):
            mesh.CreatePointsAttr().Set([Gf.Vec3f(p[0], p[1], height) for p in QUAD_POINTS], number * 10 + time)
        clip.GetRootLayer().Save()
    manifest = Usd.Stage.CreateNew(str(tmp_path / "manifest.usda"))
    UsdGeom.Mesh.Define(manifest, "/m").CreatePointsAttr()
    manifest.GetRootLayer().Save()
    stage = Usd.Stage.CreateNew(str(tmp_path / "a.usda"))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    mesh = add_mesh(stage, "/m")
    mesh.GetPrim().RemoveProperty("points")
    clips = Usd.ClipsAPI(mesh.GetPrim())
    clips.SetClipAssetPaths([Sdf.AssetPath("./clip0.usda"), Sdf.AssetPath("./clip1.usda")])
    clips.SetClipManifestAssetPath(Sdf.AssetPath("./manifest.usda"))
    clips.SetClipPrimPath("/m")
    clips.SetClipActive([Gf.Vec2d(0, 0), Gf.Vec2d(10, 1)])
    clips.SetClipTimes([Gf.Vec2d(0, 0), Gf.Vec2d(20, 20)])
    stage.GetRootLayer().Save()
    reader = StageReader(open_stage(tmp_path / "a.usda", confined_to=tmp_path))
    assert world_points(only_batch(reader.read(5)))[0, 2] == 1
    assert world_points(only_batch(reader.read(15)))[0, 2] == 7


def test_an_edit_is_seen_and_a_camera_edit_remakes_nothing() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m")
    camera = UsdGeom.Camera.Define(stage, "/cam")
    reader = StageReader(stage)
    before = reader.read(0)
    camera.CreateFStopAttr(2.8)
    camera.GetPrim().CreateAttribute("mine", Sdf.ValueTypeNames.Float).Set(1.0)
    assert reader.read(0) is before
    mesh.GetPointsAttr().Set([Gf.Vec3f(p[0], p[1], 5) for p in QUAD_POINTS])
    after = reader.read(0)
    assert world_points(only_batch(after))[0, 2] == 5
    stage.RemovePrim("/m")
    assert reader.read(0).batches == ()


def test_lights_at_a_time() -> None:
    stage = new_stage()
    light = UsdLux.SphereLight.Define(stage, "/light")
    light.CreateIntensityAttr().Set(0.0, 0)
    light.GetIntensityAttr().Set(10.0, 10)
    reader = StageReader(stage)
    assert reader.read(5).lights[0].radiance == pytest.approx((5, 5, 5), rel=1e-3)


@pytest.mark.parametrize("where", ["static", "animated", "above", "instancer"])
def test_a_transform_that_is_not_finite_is_named_with_its_prim(where: str) -> None:
    stage = new_stage()
    culprit = "/group"
    group = UsdGeom.Xform.Define(stage, "/group")
    mesh = add_mesh(stage, "/group/m")
    nan = Gf.Vec3d(0, float("nan"), 0)
    if where == "static":
        mesh.AddTranslateOp().Set(nan)
        culprit = "/group/m"
    elif where == "animated":
        group.AddTranslateOp().Set(nan, 0)
    elif where == "above":
        group.AddTranslateOp().Set(nan)
    else:
        instancer = UsdGeom.PointInstancer.Define(stage, "/dots")
        instancer.CreatePrototypesRel().AddTarget("/group/m")
        instancer.CreateProtoIndicesAttr([0])
        instancer.CreatePositionsAttr([Gf.Vec3f(0, float("inf"), 0)])
        culprit = "/dots"
    reader = StageReader(stage)
    assert len(reader.read(0).batches) == (where == "instancer")  # its prototype stands on the stage, too
    assert {(finding.code, finding.path) for finding in reader.findings} == {("bad_transform", culprit)}


def test_an_empty_stage_is_an_empty_scene() -> None:
    scene = read(new_stage())
    assert (scene.batches, scene.lights, scene.dome) == ((), (), None)


def test_purpose_visibility_and_activation() -> None:
    stage = new_stage()
    for name, purpose in (("a", "default"), ("b", "render"), ("c", "proxy"), ("d", "guide")):
        add_mesh(stage, f"/{name}").CreatePurposeAttr(purpose)
    group = UsdGeom.Xform.Define(stage, "/proxies")
    group.CreatePurposeAttr("proxy")
    add_mesh(stage, "/proxies/e")
    add_mesh(stage, "/f").CreateVisibilityAttr("invisible")
    add_mesh(stage, "/g").GetPrim().SetActive(False)
    stage.CreateClassPrim("/h")
    add_mesh(stage, "/h/i")
    assert set(read(stage).prim_paths) == {"/a", "/b"}
    assert set(StageReader(stage, StageOptions(purposes=("proxy",))).read(0).prim_paths) == {"/c", "/proxies/e"}


def test_a_mask_leaves_out_everything_else() -> None:
    stage = new_stage()
    for path in ("/set/chair", "/set/table", "/cast/mara"):
        add_mesh(stage, path)
    UsdLux.SphereLight.Define(stage, "/lights/key")
    scene = StageReader(stage, StageOptions(mask=("/set/chair", "/cast"))).read(0)
    assert set(scene.prim_paths) == {"/set/chair", "/cast/mara"}
    assert scene.lights == ()


def test_what_cannot_be_drawn_is_reported() -> None:
    stage = new_stage()
    UsdVol.Volume.Define(stage, "/smoke")
    UsdShade.Material.Define(stage, "/looks")
    reader = StageReader(stage)
    reader.read(0)
    found = {(f.code, f.path) for f in reader.findings}
    assert found == {("unsupported_geometry", "/smoke")}


@needs_assets
def test_a_skeleton_bends_its_mesh_and_leaves_the_rest_alone() -> None:
    file = ASSETS / "ElephantWithMonochord" / "SoC-ElephantWithMonochord.usdc"
    reader = StageReader(open_stage(file))
    one, two = reader.read(0), reader.read(50)
    root = "/SoC_ElephantWithMonochord/Object/Elefant"
    assert batch_of(one, f"{root}_Monochord_Play/Monochord_Base") is batch_of(
        two, f"{root}_Monochord_Play/Monochord_Base"
    )
    before, after = (batch_of(scene, f"{root}/Elefant1").geometry for scene in (one, two))
    moved = np.linalg.norm(after.positions - before.positions, axis=1)
    size = np.ptp(before.positions, axis=0).max()
    assert 0.05 * size < moved.max() < size
    lengths = [
        np.linalg.norm(g.positions[g.triangles[:, 0]] - g.positions[g.triangles[:, 1]], axis=1).mean()
        for g in (before, after)
    ]
    assert lengths[1] == pytest.approx(lengths[0], rel=0.05)
    assert reader.findings == []
