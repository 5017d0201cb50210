"""RenderSettings and RenderPass prims that the caller chooses, in place of what the stage names."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdRender, Vt

from render.errors import SettingsError
from render.shot import Shot
from render.stage import (
    StageOptions,
    StageReader,
    choose_settings,
    default_camera,
    find_not_honoured,
    find_pass,
    read_camera,
    stage_settings,
)
from render.stage.findings import FindingLog
from tests.render.kits.stages import add_mesh, instancer, new_stage


def two_settings(stage: Usd.Stage) -> Usd.Stage:
    """Settings /R/own, which the stage names, and /R/other, with a camera each."""
    for name, policy in (("own", "expandAperture"), ("other", "cropAperture")):
        camera = UsdGeom.Camera.Define(stage, f"/{name}_cam")
        camera.GetHorizontalApertureAttr().Set(36.0)
        camera.GetVerticalApertureAttr().Set(24.0)
        settings = UsdRender.Settings.Define(stage, f"/R/{name}")
        settings.CreateCameraRel().SetTargets([camera.GetPath()])
        settings.CreateAspectRatioConformPolicyAttr(policy)
    stage.SetMetadata("renderSettingsPrimPath", "/R/own")
    return stage


def drawn(stage: Usd.Stage, render_pass: str) -> set[str]:
    """Prims that a pass leaves to be drawn."""
    scene = StageReader(stage, render_pass=find_pass(stage, render_pass)).read(0)
    return {scene.prim_paths[i] for batch in scene.batches for i in set(batch.geometry.prim_ids.tolist())}


def add_pass(stage: Usd.Stage, **members: Sequence[str]) -> Usd.Prim:
    """A pass /P with source /R/own and collections, such as ``prune__includes``."""
    two_settings(stage)
    prim = UsdRender.Pass.Define(stage, "/P").GetPrim()
    UsdRender.Pass(prim).GetRenderSourceRel().SetTargets([Sdf.Path("/R/own")])
    for name, paths in members.items():
        prim.CreateRelationship(f"collection:{name.replace('__', ':')}").SetTargets([Sdf.Path(path) for path in paths])
    return prim


def test_the_chosen_settings_give_camera_and_conform_policy() -> None:
    stage = two_settings(new_stage(0.01))
    assert default_camera(stage).path == "/own_cam"
    assert read_camera(stage, "/own_cam", 0, aspect=2.0).horizontal_aperture_mm == pytest.approx(48)
    choose_settings(stage, "/R/other")
    assert default_camera(stage).path == "/other_cam"
    assert read_camera(stage, "/own_cam", 0, aspect=2.0).horizontal_aperture_mm == pytest.approx(36)
    assert stage.GetRootLayer().pseudoRoot.GetInfo("renderSettingsPrimPath") == "/R/own"


def test_resolution_and_purposes_are_read() -> None:
    stage = two_settings(new_stage())
    prim = UsdRender.Settings(stage.GetPrimAtPath("/R/own"))
    settings = stage_settings(stage)
    assert settings is not None
    assert settings.resolution is None
    assert settings.included_purposes == ("default", "render")
    prim.CreateResolutionAttr(Gf.Vec2i(64, 20))
    prim.CreateIncludedPurposesAttr(["proxy", "rubbish"])
    assert settings.resolution == (64, 20)
    assert settings.included_purposes == ("default", "proxy")


@pytest.mark.parametrize(
    ("space", "written", "message"),
    [
        (None, "", None),
        ("", "", None),
        ("lin_ap1_scene", "", None),
        ("ACEScg", "", None),
        ("lin_rec709_scene", "lin_rec709_scene", "light is added in that space, and colours are converted when an EXR"),
        ("lin_rec2020", "lin_rec2020", "renderingColorSpace lin_rec2020 of /R/own is not the scene_linear space"),
        ("srgb_rec709_scene", "", "renderingColorSpace of /R/own is not used: colour space 'srgb_rec709_scene' is not"),
        ("raw", "", "colour space 'raw' is not linear"),
        ("lin_rec7O9", "", "colour space 'lin_rec7O9' is not known: did you mean 'lin_rec709'"),
    ],
)
def test_a_linear_rendering_space_is_that_of_files(space: str | None, written: str, message: str | None) -> None:
    stage = two_settings(new_stage())
    settings, log = stage_settings(stage), FindingLog()
    assert settings is not None
    if space is not None:
        settings.prim.CreateRenderingColorSpaceAttr(space)
    assert settings.rendering_space(log) == written
    assert len(log.as_list()) == (message is not None)
    assert all(message in finding.message for finding in log.as_list() if message)
    assert find_not_honoured(stage) == []


@pytest.mark.parametrize("path", ["/R/gone", "/own_cam", "no path"])
def test_a_prim_that_is_no_settings_is_refused_with_those_there_are(path: str) -> None:
    with pytest.raises(SettingsError, match="the stage has: /R/own, /R/other"):
        choose_settings(two_settings(new_stage()), path)


def test_prune_leaves_out_all_below() -> None:
    stage = new_stage()
    for path in ("/set/wall", "/set/wall/door", "/set/floor", "/cast"):
        add_mesh(stage, path)
    UsdLux.SphereLight.Define(stage, "/set/wall/lamp")
    add_pass(stage, prune__includes=["/set/wall"])
    assert drawn(stage, "/P") == {"/set/floor", "/cast"}
    assert StageReader(stage, render_pass=find_pass(stage, "/P")).read(0).lights == ()


def test_render_visibility_is_asked_for_each_prim() -> None:
    stage = new_stage()
    for path in ("/set/wall", "/set/wall/door", "/cast"):
        add_mesh(stage, path)
    for path in ("/lamp", "/sun"):
        UsdLux.SphereLight.Define(stage, path)
    add_pass(stage, renderVisibility__excludes=["/set/wall", "/lamp"], renderVisibility__includes=["/set/wall/door"])
    assert drawn(stage, "/P") == {"/set/wall/door", "/cast"}
    scene = StageReader(stage, render_pass=find_pass(stage, "/P")).read(0)
    assert [light.path for light in scene.lights] == ["/sun"]


def test_a_pass_may_choose_by_expression() -> None:
    stage = new_stage()
    for path in ("/set/wall", "/set/floor", "/cast"):
        add_mesh(stage, path)
    prim = add_pass(stage)
    Usd.CollectionAPI(prim, "prune").CreateMembershipExpressionAttr(Sdf.PathExpression("//wall + /cast"))
    assert drawn(stage, "/P") == {"/set/floor"}


def test_an_instancer_is_left_out_whole() -> None:
    stage = new_stage()
    UsdGeom.Sphere.Define(stage, "/trees/leaf")
    instancer(stage, "/trees", ["/trees/leaf"], [0, 0])
    add_mesh(stage, "/ground")
    add_pass(stage, renderVisibility__excludes=["/trees"])
    assert drawn(stage, "/P") == {"/ground"}


def roles(stage: Usd.Stage) -> dict[str, str]:
    """Role of each prim of the stage for the camera, in the pass /P."""
    found = {}
    scene = StageReader(stage, render_pass=find_pass(stage, "/P")).read(0)
    for batch in scene.batches:
        own = batch.geometry.prim_ids if batch.instance_prim_ids is None else batch.instance_prim_ids
        found |= {scene.prim_paths[prim]: batch.camera_role for prim in set(own.tolist())}
    return found


def test_camera_visibility_and_matte_are_asked_for_each_prim() -> None:
    stage = new_stage()
    for path in ("/set/wall", "/set/wall/door", "/set/floor", "/cast"):  # alike, so that they could be drawn as one
        add_mesh(stage, path)
    add_pass(
        stage,
        cameraVisibility__excludes=["/set/wall"],
        cameraVisibility__includes=["/set/wall/door"],
        matte__includes=["/set"],
        matte__excludes=["/set/floor"],
    )
    assert roles(stage) == {"/set/wall": "unseen", "/set/wall/door": "holdout", "/set/floor": "seen", "/cast": "seen"}
    assert find_not_honoured(stage) == []


def test_instances_have_the_camera_role_of_their_own_paths() -> None:
    stage = new_stage()
    add_mesh(stage, "/kinds/tree/leaf")
    for path in ("/a", "/b", "/c"):
        prim = UsdGeom.Xform.Define(stage, path).GetPrim()
        prim.GetReferences().AddInternalReference("/kinds/tree")
        prim.SetInstanceable(True)
    UsdGeom.Sphere.Define(stage, "/many/kind")
    instancer(stage, "/many", ["/many/kind"], [0, 0])
    add_pass(stage, matte__includes=["/b", "/many"], cameraVisibility__excludes=["/c", "/kinds"])
    assert roles(stage) == {
        "/kinds/tree/leaf": "unseen",
        "/a/leaf": "seen",
        "/b/leaf": "holdout",
        "/c/leaf": "unseen",
        "/many": "holdout",
    }


def test_splats_have_the_camera_role_of_their_paths() -> None:
    stage = new_stage()
    for path in ("/seen", "/held", "/unseen"):
        prim = stage.DefinePrim(path, "ParticleField3DGaussianSplat")
        prim.GetAttribute("positions").Set(Vt.Vec3fArray([Gf.Vec3f(0)]))
    add_pass(stage, matte__includes=["/held"], cameraVisibility__excludes=["/unseen"])
    reader = StageReader(stage, render_pass=find_pass(stage, "/P"))
    scene = reader.read(0)
    assert {scene.prim_paths[batch.prim_id]: batch.is_holdout for batch in scene.splats} == {
        "/seen": False,
        "/held": True,
    }
    assert not reader.findings


@pytest.mark.parametrize("members", [{"cameraVisibility__excludes": ["/sky"]}, {"matte__includes": ["/sky"]}])
def test_a_dome_that_the_camera_does_not_see_still_shines(members: dict[str, list[str]]) -> None:
    stage = new_stage()
    UsdLux.DomeLight.Define(stage, "/sky")
    add_pass(stage, **members)
    dome = StageReader(stage, render_pass=find_pass(stage, "/P")).read(0).dome
    assert dome is not None
    assert not dome.visible
    assert dome.radiance == (1, 1, 1)


def test_a_pass_needs_a_source() -> None:
    stage = new_stage()
    add_pass(stage)
    UsdRender.Pass.Define(stage, "/Bare")
    with pytest.raises(SettingsError, match="render pass /Bare has no renderSource"):
        find_pass(stage, "/Bare")
    with pytest.raises(SettingsError, match="the stage has: /P, /Bare"):
        find_pass(stage, "/R/own")


@pytest.mark.parametrize("chooses", ["settings_prim", "render_pass"])
def test_included_purposes_hold_where_the_settings_are_chosen(chooses: str, tmp_path: Path) -> None:
    stage = new_stage()
    add_pass(stage)
    add_mesh(stage, "/proxy").GetPurposeAttr().Set("proxy")
    UsdRender.Settings(stage.GetPrimAtPath("/R/own")).CreateIncludedPurposesAttr(["proxy"])
    stage.GetRootLayer().Export(str(tmp_path / "a.usda"))
    chosen = {chooses: "/R/own" if chooses == "settings_prim" else "/P"}
    for options, count in (
        (StageOptions(), 0),
        (StageOptions(**chosen), 1),
        (StageOptions(**chosen, purposes=("default", "render")), 0),
    ):
        shot = Shot.open(tmp_path / "a.usda", options=options)
        assert len(shot.scene_at(0).batches) == count


def test_what_a_pass_names_and_is_not_there_is_a_finding(tmp_path: Path) -> None:
    stage = new_stage()
    add_mesh(stage, "/there")
    add_pass(stage, matte__includes=["/gone"], prune__excludes=["/there"])
    stage.Export(f"{tmp_path}/shot.usda")
    shot = Shot.open(f"{tmp_path}/shot.usda", options=StageOptions(render_pass="/P"))
    (lost,) = [finding for finding in shot.findings() if finding.code == "missing_target"]
    assert lost.message == "collection:matte:includes of /P names /gone, which the stage does not have"
