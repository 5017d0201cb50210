"""A shot without a camera gets one that sees what its framing camera showed, as an edit like any other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom

from render.errors import CameraError, SettingsError, StageError
from render.shot import Shot
from render.shot.camera import creation
from render.stage import read_camera
from tests.render.kits.focus_shot import Units, write_shot
from tests.render.kits.stages import add_mesh
from usd_schemas import FocusPoint, library_body
from usd_schemas.registration import SINGLE_APPLY


def write_cards(path: Path, metres: float = 1.0, up: str = "Y") -> Path:
    """Write a shot of one card, without a camera, that is two metres wide at its first frame and eight at its last."""
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, metres)
    UsdGeom.SetStageUpAxis(stage, up)
    stage.SetStartTimeCode(1)
    stage.SetEndTimeCode(5)
    for time, half_m in ((1, 1.0), (5, 4.0)):
        x, y = half_m / metres, half_m / metres / 2
        corners = [(-x, -y), (x, -y), (x, y), (-x, y)]
        points = [(u + 3 / metres, v, 0) if up == "Y" else (u + 3 / metres, 0, v) for u, v in corners]
        mesh = add_mesh(stage, "/card", points) if time == 1 else UsdGeom.Mesh(stage.GetPrimAtPath("/card"))
        mesh.GetPointsAttr().Set(points, time)
        mesh.CreateExtentAttr().Set(UsdGeom.PointBased.ComputeExtent(points), time)
    stage.Save()
    return path


@pytest.mark.parametrize("up", ["Y", "Z"])
@pytest.mark.parametrize("metres", [1.0, 0.01, 0.3048])
def test_the_camera_sees_what_the_framing_camera_saw(tmp_path: Path, metres: float, up: str) -> None:
    shot = Shot.open(write_cards(tmp_path / "cards.usda", metres, up))
    for time in (1.0, 5.0):
        view = shot.camera_at(None, time, 1600, 900)
        path = shot.camera.create(time=time)
        camera = shot.camera_at(path, time, 1600, 900)
        assert shot.default_camera().path == path == "/main_cam"
        assert camera.world_from_camera == pytest.approx(view.world_from_camera, abs=1e-6)
        assert camera.focus_distance_m == pytest.approx(view.focus_distance_m)
        assert (camera.near_m, camera.far_m) == pytest.approx((view.near_m, view.far_m))
        for seen, seen_before in (
            (camera.horizontal_aperture_mm, view.horizontal_aperture_mm),
            (camera.vertical_aperture_mm, view.vertical_aperture_mm),
        ):
            share = (seen / camera.focal_length_mm) / (seen_before / view.focal_length_mm)
            assert 1 - 1e-6 < share < 1.01, "all that was seen, and hardly more: the gate of the body is nearly 16:9"
        shot.edits.undo()
        assert shot.cameras() == []
        assert shot.camera_at(None, time, 16, 9).path == ""


def test_it_is_a_plain_camera_of_the_edit_layer_with_body_and_lens(tmp_path: Path) -> None:
    shot = Shot.open(write_cards(tmp_path / "cards.usda", 0.01))
    before = (tmp_path / "cards.usda").read_bytes()
    path = shot.camera.create()
    assert shot.edits.history.undo_label == "create camera main_cam"
    spec = shot.edits.layer.GetPrimAtPath(path)
    assert (spec.specifier, spec.typeName) == (Sdf.SpecifierDef, "Camera")
    prim = shot.stage.GetPrimAtPath(path)
    assert set(SINGLE_APPLY) <= set(prim.GetAppliedSchemas())
    body, camera = library_body(creation.BODY), read_camera(shot.stage, path, 1)
    assert (camera.horizontal_aperture_mm, camera.vertical_aperture_mm) == pytest.approx(body.gate_mm, rel=1e-6)
    assert prim.GetAttribute("film:body").Get() == body.title
    assert (camera.lens.model, camera.f_stop) == ("thin", pytest.approx(creation.F_STOP))
    shot.edits.save(tmp_path / "edits.usda")
    over = Usd.Stage.CreateNew(str(tmp_path / "over.usda"))
    over.GetRootLayer().subLayerPaths = ["edits.usda", "cards.usda"]
    assert over.GetPrimAtPath(path).GetTypeName() == "Camera"
    assert (tmp_path / "cards.usda").read_bytes() == before


def test_focus_points_and_keys_are_for_the_new_camera(tmp_path: Path) -> None:
    shot = Shot.open(write_shot(tmp_path / "shot.usda", camera=False))
    path = shot.camera.create()
    target = next(str(prim.GetPath()) for prim in shot.stage.Traverse() if prim.IsA(UsdGeom.Mesh))
    shot.focus.set(None, mode="points")
    shot.focus.add_point(None, "card", FocusPoint(name="card", target=(target,)))
    (point,) = shot.focus.points(path, 1)
    assert shot.focus.read(None, 1).focus_distance_m == pytest.approx(point.depth_m, rel=1e-3)
    assert shot.focus.curve(None, [1, 2]).time_codes == pytest.approx([1, 2])
    shot.camera.set(None, f_stop=4.0, time=1)
    assert [key.time for key in shot.camera.keys(path, "f_stop")] == [1]


def test_a_shot_that_has_a_camera_to_be_shown_through_keeps_it(tmp_path: Path) -> None:
    shot = Shot.open(write_shot(tmp_path / "shot.usda", Units()))
    (camera,) = shot.cameras()
    with pytest.raises(CameraError, match="is shown through its own camera") as caught:
        shot.camera.create()
    assert (caught.value.code, caught.value.path) == ("has_camera", camera)
    assert shot.edits.state() == ""


def test_one_of_several_cameras_without_a_main_one_is_created(tmp_path: Path) -> None:
    path = write_cards(tmp_path / "cards.usda")
    stage = Usd.Stage.Open(str(path))
    for name in ("left", "right"):
        UsdGeom.Camera.Define(stage, f"/{name}")
    stage.Save()
    shot = Shot.open(path)
    assert shot.default_camera().path is None
    assert shot.camera.create() == shot.default_camera().path == "/main_cam"


def test_where_no_camera_makes_a_picture_one_is_created(tmp_path: Path) -> None:
    path = write_cards(tmp_path / "cards.usda")
    stage = Usd.Stage.Open(str(path))
    UsdGeom.Camera.Define(stage, "/flat").CreateFocalLengthAttr(-1.0)
    stage.Save()
    shot = Shot.open(path)
    assert shot.default_camera().path == "/flat"
    assert shot.camera.create() == shot.default_camera().path


def test_names_that_are_taken_or_none_are_refused(tmp_path: Path) -> None:
    path = write_cards(tmp_path / "cards.usda")
    stage = Usd.Stage.Open(str(path))
    UsdGeom.Xform.Define(stage, "/main_cam")
    stage.Save()
    shot = Shot.open(path)
    with pytest.raises(SettingsError, match="already") as caught:
        shot.camera.create("card")
    assert caught.value.code == "name_taken"
    for name in ("", "2nd", "a/b", "/card", "..", "a b", "card.x"):
        with pytest.raises(SettingsError, match="must be an identifier"):
            shot.camera.create(name)
    with pytest.raises(SettingsError, match="finite"):
        shot.camera.create(time=np.inf)
    assert shot.edits.state() == ""
    assert shot.camera.create() == "/main_cam_2"


def test_an_empty_shot_has_no_view_to_create_one_from(tmp_path: Path) -> None:
    Usd.Stage.CreateNew(str(tmp_path / "empty.usda")).Save()
    shot = Shot.open(tmp_path / "empty.usda")
    with pytest.raises(StageError) as caught:
        shot.camera.create()
    assert caught.value.code == "empty_stage"
