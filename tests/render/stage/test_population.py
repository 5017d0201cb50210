"""Population masks and payloads: which files and prims are read at all."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdRender

from render.errors import StageError
from render.shot import Shot
from render.stage import StageOptions
from render.stage.geometry import reading
from tests.render.kits.stages import add_material, add_mesh, bind

CHAIR = StageOptions(mask=("/set/chair",), camera="/cameras/a")


@pytest.fixture
def shot(tmp_path: Path) -> Path:
    """A set of two referenced assets with materials elsewhere, an instancer with a prototype elsewhere, and two cameras."""
    for name in ("chair", "table", "proxy"):
        asset = Usd.Stage.CreateNew(str(tmp_path / f"{name}.usdc"))
        asset.SetDefaultPrim(asset.DefinePrim("/asset", "Xform"))
        add_mesh(asset, "/asset/mesh")
        asset.Save()
    stage = Usd.Stage.CreateNew(str(tmp_path / "shot.usda"))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.Xform.Define(stage, "/set").AddTranslateOp().Set(Gf.Vec3d(1, 2, 3))
    stage.DefinePrim("/set/chair").GetReferences().AddReference("./chair.usdc")
    stage.DefinePrim("/set/table").GetReferences().AddReference("./table.usdc")
    stage.DefinePrim("/set/lamp").GetPayloads().AddPayload("./proxy.usdc")
    add_material(stage, "/looks/red", diffuseColor=(1.0, 0.0, 0.0))
    bind(stage.GetPrimAtPath("/set"), "/looks/red")
    every = Usd.CollectionAPI.Apply(stage.GetPrimAtPath("/set"), "every")
    every.CreateIncludesRel().AddTarget("/set")
    pebbles = UsdGeom.PointInstancer.Define(stage, "/set/pebbles")
    add_mesh(stage, "/library/pebble")
    pebbles.CreatePrototypesRel().AddTarget("/library/pebble")
    pebbles.CreatePositionsAttr([(0, 0, 0), (5, 0, 0)])
    pebbles.CreateProtoIndicesAttr([0, 0])
    for name in "ab":
        UsdGeom.Camera.Define(stage, f"/cameras/{name}").CreateFocusDistanceAttr(5.0)
    stage.Save()
    return tmp_path / "shot.usda"


def files(opened: Shot) -> set[str]:
    return {Path(layer.realPath).name for layer in opened.stage.GetUsedLayers() if layer.realPath}


def test_a_mask_opens_no_file_of_what_it_leaves_out(shot: Path) -> None:
    whole, masked = Shot.open(shot), Shot.open(shot, options=CHAIR)
    assert files(whole) == {"shot.usda", "chair.usdc", "table.usdc", "proxy.usdc"}
    assert files(masked) == {"shot.usda", "chair.usdc"}
    assert not masked.stage.GetPrimAtPath("/set/table")
    assert masked.cameras() == ["/cameras/a"]


def test_a_mask_keeps_materials_transforms_and_prototypes(shot: Path) -> None:
    options = StageOptions(mask=("/set/chair", "/set/pebbles"), camera="/cameras/a")
    whole, masked = (Shot.open(shot, options=each).scene_at(0) for each in (StageOptions(), options))
    assert "/set/table/mesh" not in masked.prim_paths
    of_chair = [batch for batch in masked.batches if batch.material.name == "/looks/red"]
    assert of_chair[0].material.base_color == pytest.approx(whole.batches[0].material.base_color)
    assert of_chair[0].geometry.positions.min(axis=0) + of_chair[0].poses[0][:3, 3] == pytest.approx([1, 2, 3])
    assert sum(len(batch.poses) for batch in masked.batches if batch.instance_numbers is not None) == 2


def test_a_mask_keeps_the_cameras_that_may_be_the_default(shot: Path) -> None:
    stage = Usd.Stage.Open(str(shot))
    UsdGeom.Camera.Define(stage, "/rig/main_cam").CreateFocusDistanceAttr(5.0)
    stage.Save()
    masked = Shot.open(shot, options=StageOptions(mask=("/set/chair",)))
    assert masked.default_camera().path == "/rig/main_cam"
    assert not masked.stage.GetPrimAtPath("/set/table")


def test_a_mask_keeps_all_cameras_for_stereo_pairs(shot: Path) -> None:
    masked = Shot.open(shot, options=replace(CHAIR, all_cameras=True))
    assert masked.cameras() == ["/cameras/a", "/cameras/b"]
    assert not masked.stage.GetPrimAtPath("/set/table")


def test_a_mask_keeps_the_render_settings_and_their_camera(shot: Path) -> None:
    stage = Usd.Stage.Open(str(shot))
    settings = UsdRender.Settings.Define(stage, "/Render/main")
    settings.CreateCameraRel().AddTarget("/cameras/b")
    stage.SetMetadata("renderSettingsPrimPath", "/Render/main")
    stage.Save()
    for options in (
        StageOptions(mask=("/set/chair",)),
        StageOptions(mask=("/set/chair",), settings_prim="/Render/main"),
    ):
        masked = Shot.open(shot, options=options)
        assert masked.default_camera().path == "/cameras/b"
        assert masked.cameras() == ["/cameras/b"]
        assert "table.usdc" not in files(masked)
    settings.GetCameraRel().SetTargets(["/cameras/gone"])
    stage.Save()
    assert Shot.open(shot, options=StageOptions(mask=("/set/chair",))).cameras() == ["/cameras/a", "/cameras/b"]


def test_a_mask_confines_the_stage_as_before(shot: Path, tmp_path: Path) -> None:
    (tmp_path / "inside").mkdir()
    root = tmp_path / "inside" / "root.usda"
    root.write_text('#usda 1.0\ndef "in" {}\ndef "out" (references = @../chair.usdc@) {}\n')
    for options in (StageOptions(mask=("/in",)), StageOptions(unloaded=True)):
        with pytest.raises(StageError) as caught:
            Shot.open(root, confined_to=root.parent, options=options)
        assert caught.value.code == "outside_reference"


def test_payloads_are_left_out_and_counted(shot: Path) -> None:
    whole, unloaded = Shot.open(shot), Shot.open(shot, options=StageOptions(unloaded=True))
    assert "proxy.usdc" not in files(unloaded)
    assert set(whole.scene_at(0).prim_paths) - set(unloaded.scene_at(0).prim_paths) == {"/set/lamp/mesh"}
    found = [finding for finding in unloaded.findings() if finding.code == "unloaded_payloads"]
    assert [finding.message for finding in found] == ["a payload is not loaded, at /set/lamp: not drawn"]
    assert not [finding for finding in whole.findings() if finding.code == "unloaded_payloads"]


def test_a_payload_that_is_missing_is_not_called_left_out(shot: Path) -> None:
    (shot.parent / "proxy.usdc").unlink()
    assert {finding.code for finding in Shot.open(shot).findings()} >= {"missing_reference"}
    assert "unloaded_payloads" not in {finding.code for finding in Shot.open(shot).findings()}


def test_framing_sees_no_payloads_that_are_left_out(shot: Path) -> None:
    stage = Usd.Stage.Open(str(shot))
    stage.RemovePrim("/cameras")
    UsdGeom.Xformable(stage.GetPrimAtPath("/set/lamp")).AddTranslateOp().Set(Gf.Vec3d(1000, 0, 0))
    stage.Save()
    mask = ("/set/chair", "/set/lamp")
    near, far = (
        Shot.open(shot, options=StageOptions(mask=mask, unloaded=unloaded)).camera_at(None, 0, 64, 36)
        for unloaded in (True, False)
    )
    assert far.focus_distance_m > 100 * near.focus_distance_m


def test_surfaces_of_other_purposes_are_not_read(shot: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stage = Usd.Stage.Open(str(shot))
    UsdGeom.Imageable(stage.GetPrimAtPath("/set/table/mesh")).CreatePurposeAttr("proxy")
    stage.Save()
    read: list[Sdf.Path] = []
    actual = reading.read_surface

    def counted(prim: Usd.Prim, *arguments: object) -> object:
        read.append(prim.GetPath())
        return actual(prim, *arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(reading, "read_surface", counted)
    opened = Shot.open(shot)
    opened.scene_at(0)
    assert sorted(map(str, read)) == ["/library/pebble", "/set/chair/mesh", "/set/lamp/mesh"]
    read.clear()
    Shot.open(shot, options=CHAIR).scene_at(0)
    assert list(map(str, read)) == ["/set/chair/mesh"]


def test_a_mask_that_leaves_nothing_to_frame_says_so(shot: Path) -> None:
    masked = Shot.open(shot, options=StageOptions(mask=("/looks",)))
    with pytest.raises(StageError, match="the mask /looks leaves nothing of"):
        masked.default_camera()
