"""Cameras that are duplicated: the copy sees the same, over time too, and is a camera of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom

from render.errors import CameraError, SettingsError
from render.shot import Shot
from render.stage import read_camera
from tests.render.kits.focus_shot import CAMERA, FRAMES, NEAR, write_shot
from usd_schemas import FocusPoint, Key, library_body

COPY = "/World/cam_2"


def open_rich_shot(tmp_path: Path) -> Shot:
    """Open a shot whose camera moves in its file, and has a body, a point and keys in its edits."""
    path = write_shot(tmp_path / "shot.usda")
    stage = Usd.Stage.Open(str(path))
    rig = UsdGeom.Xformable(stage.GetPrimAtPath("/World"))
    slide = rig.AddTranslateOp()
    for time in (1, 24):
        slide.Set(Gf.Vec3d(time, 0, 0), time)
        UsdGeom.Camera(stage.GetPrimAtPath(CAMERA)).GetOrderedXformOps()[0].Set(Gf.Vec3d(0, time, 10), time)
    stage.Save()
    shot = Shot.open(path)
    shot.camera.mount_body(CAMERA, library_body("super35_3perf"))
    for time, value in ((1, 2.0), (24, 8.0)):
        shot.camera.set_key(CAMERA, "focus_distance_m", Key(time, value, "auto"))
    shot.focus.add_point(CAMERA, "near", FocusPoint("near", target=(NEAR,), weight=0.5))
    return shot


def test_a_copy_sees_what_its_source_sees(tmp_path):
    shot = open_rich_shot(tmp_path)
    assert shot.camera.duplicate(CAMERA) == COPY
    assert shot.cameras() == [CAMERA, COPY]
    for time in (1, 6.5, 24):
        one, copy = (shot.camera_at(path, time, 64, 36) for path in (CAMERA, COPY))
        assert np.array_equal(one.world_from_camera, copy.world_from_camera)
        for name in (
            "focal_length_mm",
            "f_stop",
            "focus_distance_m",
            "horizontal_aperture_mm",
            "near_m",
            "exposure_scale",
        ):
            assert getattr(one, name) == getattr(copy, name)
    keys, copied = (shot.camera.keys(path, "focus_distance_m") for path in (CAMERA, COPY))
    assert copied == keys
    assert [(placed.point.name, placed.point.weight) for placed in shot.focus.points(COPY, 1)] == [("near", 0.5)]


def test_a_copy_is_a_camera_of_its_own(tmp_path):
    shot = open_rich_shot(tmp_path)
    before = [read_camera(shot.stage, CAMERA, time) for time in FRAMES]
    copy = shot.camera.duplicate(CAMERA)
    shot.camera.set(copy, f_stop=11)
    shot.focus.remove_point(copy, "near")
    assert [read_camera(shot.stage, CAMERA, time).f_stop for time in FRAMES] == [camera.f_stop for camera in before]
    assert [placed.point.name for placed in shot.focus.points(CAMERA, 1)] == ["near"]
    for _ in range(3):
        shot.edits.undo()
    assert shot.cameras() == [CAMERA]


def test_copies_get_free_names(tmp_path):
    shot = Shot.open(write_shot(tmp_path / "shot.usda"))
    assert [shot.camera.duplicate(path) for path in (CAMERA, CAMERA, COPY)] == [
        COPY,
        "/World/cam_3",
        "/World/cam_4",
    ]
    assert shot.camera.duplicate(CAMERA, "hero") == "/World/hero"
    with pytest.raises(SettingsError, match="a prim at /World/near already"):
        shot.camera.duplicate(CAMERA, "near")
    with pytest.raises(SettingsError, match="must be an identifier"):
        shot.camera.duplicate(CAMERA, "a/b")


def test_a_shot_is_still_seen_through_its_only_own_camera(tmp_path):
    shot = Shot.open(write_shot(tmp_path / "shot.usda"))
    assert shot.default_camera().path == CAMERA
    shot.camera.duplicate(None)
    assert shot.default_camera().path == CAMERA
    assert shot.default_camera().reason == "it is the only one that is no edit"


def test_the_copy_of_an_eye_is_none(tmp_path):
    path = write_shot(tmp_path / "shot.usda")
    stage = Usd.Stage.Open(str(path))
    UsdGeom.Camera(stage.GetPrimAtPath(CAMERA)).CreateStereoRoleAttr("left")
    UsdGeom.Camera.Define(stage, "/World/right").CreateStereoRoleAttr("right")
    stage.Save()
    shot = Shot.open(path)
    pairs = shot.stereo_pairs()
    shot.camera.duplicate(CAMERA)
    assert len(pairs) == 1
    assert shot.stereo_pairs() == pairs


def test_a_camera_in_an_instance_is_not_duplicated(tmp_path):
    path = write_shot(tmp_path / "shot.usda")
    stage = Usd.Stage.Open(str(path))
    prim = stage.DefinePrim("/one")
    prim.GetReferences().AddInternalReference("/World")
    prim.SetInstanceable(True)
    stage.Save()
    with pytest.raises(CameraError, match="lies in an instance"):
        Shot.open(path).camera.duplicate("/one/cam")


def test_a_copy_of_an_edits_camera_does_not_take_its_place(tmp_path):
    """A shot without a camera of its own is seen through the first one that edits have made, when that is duplicated too."""
    path = tmp_path / "shot.usda"
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.Cube.Define(stage, "/cube")
    stage.Save()
    shot = Shot.open(path)
    made = shot.camera.create("wide", 1)
    shot.camera.duplicate(made)
    assert shot.default_camera().path == made
