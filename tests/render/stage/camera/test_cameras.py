"""Cameras have the view and the lens that USD says, in metres and millimetres."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdRender

from render.errors import CameraError, SettingsError, StageError
from render.stage import (
    conform_camera,
    default_camera,
    frame_range,
    list_cameras,
    open_stage,
    read_camera,
    world_from_stage,
)
from tests.render.kits.stages import add_mesh, new_stage
from usd_schemas import ApertureData, LensCamera, LensData, TiltShiftData


def add_camera(stage: Usd.Stage, path: str = "/cam", **values: object) -> UsdGeom.Camera:
    camera = UsdGeom.Camera.Define(stage, path)
    for name, value in values.items():
        camera.GetPrim().GetAttribute(name.replace("__", ":")).Set(value)
    return camera


@pytest.mark.parametrize("metres_per_unit", [1.0, 0.01, 0.0254])
def test_lens_and_focus_are_the_same_in_any_unit(metres_per_unit: float) -> None:
    stage = new_stage(metres_per_unit)
    tenths = 1 / (metres_per_unit * 100)
    add_camera(
        stage,
        focalLength=85 * tenths,
        horizontalAperture=36 * tenths,
        verticalAperture=24 * tenths,
        horizontalApertureOffset=2 * tenths,
        verticalApertureOffset=-3 * tenths,
        focusDistance=4.5 / metres_per_unit,
        fStop=1.4,
        clippingRange=Gf.Vec2f(0.1 / metres_per_unit, 50 / metres_per_unit),
    )
    camera = read_camera(stage, "/cam", 0)
    lengths = (camera.focal_length_mm, camera.horizontal_aperture_mm, camera.vertical_aperture_mm)
    assert lengths == pytest.approx((85, 36, 24), rel=1e-6)
    assert (camera.horizontal_offset_mm, camera.vertical_offset_mm) == pytest.approx((2, -3), rel=1e-6)
    assert (camera.focus_distance_m, camera.near_m, camera.far_m) == pytest.approx((4.5, 0.1, 50), rel=1e-6)
    assert camera.f_stop == pytest.approx(1.4)


def test_rise_and_shift_move_the_gate_in_mm_in_any_scene_unit() -> None:
    """They show more of what is above and on the right, as aperture offsets do, and add to them."""
    stage = new_stage(0.01)
    add_camera(stage, horizontalApertureOffset=1.0, verticalApertureOffset=-2.0)
    camera = LensCamera(stage.GetPrimAtPath("/cam"))
    camera.tilt_shift.author(TiltShiftData(rise_mm=3.0, shift_mm=-4.0))
    read = read_camera(stage, "/cam", 0)
    assert (read.horizontal_offset_mm, read.vertical_offset_mm) == pytest.approx((1 - 4, -2 + 3))


@pytest.mark.parametrize("up", ["Y", "Z"])
def test_a_scaled_and_mirrored_camera_is_still_rigid(up: str) -> None:
    stage = new_stage(0.01, up)
    camera = add_camera(stage)
    camera.AddTranslateOp().Set(Gf.Vec3d(100, 200, 300))
    camera.AddRotateXYZOp().Set(Gf.Vec3f(20, 30, 40))
    camera.AddScaleOp().Set(Gf.Vec3f(2, -3, 4))
    pose = read_camera(stage, "/cam", 0).world_from_camera
    np.testing.assert_allclose(pose[:3, :3].T @ pose[:3, :3], np.eye(3), atol=1e-12)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1)
    expected = [1, 2, 3] if up == "Y" else [1, 3, -2]
    np.testing.assert_allclose(pose[:3, 3], expected, atol=1e-12)


def test_iris_shutter_exposure_and_breathing() -> None:
    stage = new_stage()
    usd = add_camera(stage, shutter__open=-0.25, shutter__close=0.25, exposure=2.0)
    lens = LensCamera(usd.GetPrim())
    lens.aperture.author(ApertureData(blades=7, roundness=0.3, rotation=90.0))
    lens.lens.author(LensData(breathing=True))
    camera = read_camera(stage, "/cam", 0)
    assert (camera.iris.blades, camera.iris.roundness) == (7, pytest.approx(0.3))
    assert camera.iris.rotation_rad == pytest.approx(math.pi / 2)
    assert (camera.shutter_open, camera.shutter_close) == (-0.25, 0.25)
    assert camera.exposure_scale == pytest.approx(4.0)
    assert camera.breathing


def test_a_pinhole_lens_has_no_aperture() -> None:
    stage = new_stage()
    LensCamera(add_camera(stage, fStop=2.0).GetPrim()).lens.author(LensData(model="pinhole"))
    assert read_camera(stage, "/cam", 0).f_stop == 0


def test_values_are_those_of_the_time() -> None:
    stage = new_stage()
    usd = add_camera(stage)
    usd.GetFocusDistanceAttr().Set(1.0, 0)
    usd.GetFocusDistanceAttr().Set(3.0, 10)
    assert read_camera(stage, "/cam", 5).focus_distance_m == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("policy", "aspect", "gate"),
    [
        ("expandAperture", 2.0, (48, 24)),
        ("expandAperture", 1.0, (36, 36)),
        ("cropAperture", 2.0, (36, 18)),
        ("cropAperture", 1.0, (24, 24)),
        ("adjustApertureWidth", 2.0, (48, 24)),
        ("adjustApertureWidth", 1.0, (24, 24)),
        ("adjustApertureHeight", 2.0, (36, 18)),
        ("adjustApertureHeight", 1.0, (36, 36)),
        ("adjustPixelAspectRatio", 2.0, (36, 24)),
    ],
)
def test_the_gate_takes_the_pictures_shape_by_the_policy(policy: str, aspect: float, gate: tuple[float, float]) -> None:
    stage = new_stage(0.01)
    add_camera(stage, horizontalAperture=36.0, verticalAperture=24.0, horizontalApertureOffset=1.0)
    camera = read_camera(stage, "/cam", 0, aspect=aspect, conform=policy)
    assert (camera.horizontal_aperture_mm, camera.vertical_aperture_mm) == pytest.approx(gate)
    assert camera.horizontal_offset_mm == pytest.approx(1)


def test_the_stages_render_settings_choose_the_policy() -> None:
    stage = new_stage(0.01)
    add_camera(stage, horizontalAperture=36.0, verticalAperture=24.0)
    settings = UsdRender.Settings.Define(stage, "/Render/main")
    settings.CreateAspectRatioConformPolicyAttr("cropAperture")
    stage.SetMetadata("renderSettingsPrimPath", "/Render/main")
    camera = read_camera(stage, "/cam", 0, aspect=2.0)
    assert (camera.horizontal_aperture_mm, camera.vertical_aperture_mm) == pytest.approx((36, 18))


def test_an_unknown_policy_and_an_impossible_shape() -> None:
    stage = new_stage()
    add_camera(stage)
    with pytest.raises(SettingsError, match="conform policy"):
        read_camera(stage, "/cam", 0, aspect=1.0, conform="stretch")
    with pytest.raises(SettingsError, match="aspect ratio"):
        read_camera(stage, "/cam", 0, aspect=0.0)


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("focalLength", -50.0, "focalLength"),
        ("focalLength", 0.0, "focalLength"),
        ("focalLength", float("nan"), "focalLength"),
        ("horizontalAperture", 0.0, "horizontalAperture"),
        ("verticalAperture", -1.0, "verticalAperture"),
        ("fStop", -2.0, "fStop"),
        ("focusDistance", float("-inf"), "focusDistance"),
        ("horizontalApertureOffset", float("nan"), "horizontalApertureOffset"),
        ("clippingRange", Gf.Vec2f(10, 1), "clippingRange"),
        ("projection", "isometric", "perspective or orthographic, got 'isometric'"),
        ("exposure", 999.0, "exposure of camera /cam must be from -100 to 100 stops, got 999"),
        ("exposure", float("nan"), "exposure of camera /cam must be"),
        ("exposure__time", float("inf"), "exposure:time of camera /cam must be a positive number, got inf"),
        ("exposure__iso", 0.0, "exposure:iso of camera /cam must be a positive number, got 0"),
        ("exposure__fStop", -2.0, "exposure:fStop of camera /cam must be a positive number, got -2"),
        ("exposure__responsivity", -1.0, "exposure:responsivity of camera /cam must be a positive number, got -1"),
        ("shutter__open", float("nan"), "shutter:open of camera /cam must be a finite number of frames, got nan"),
        ("shutter__close", float("inf"), "shutter:close of camera /cam must be a finite number of frames, got inf"),
    ],
)
def test_impossible_numbers_are_named(name: str, value: object, says: str) -> None:
    stage = new_stage()
    add_camera(stage, **{name: value})
    with pytest.raises(CameraError, match=says) as caught:
        read_camera(stage, "/cam", 0)
    assert "/cam" in caught.value.detail


def test_a_camera_transform_that_is_not_finite() -> None:
    stage = new_stage()
    add_camera(stage).AddTranslateOp().Set(Gf.Vec3d(float("nan"), 0, 0))
    with pytest.raises(StageError, match="/cam"):
        read_camera(stage, "/cam", 0)


@pytest.mark.parametrize("path", ["/nowhere", "/m", "not a path", "", "/"])
def test_what_is_no_camera_is_named_with_what_there_is(path: str) -> None:
    stage = new_stage()
    add_camera(stage, "/shot/cam_a")
    add_mesh(stage, "/m")
    with pytest.raises(CameraError, match="/shot/cam_a"):
        read_camera(stage, path, 0)


# Which camera


def test_the_render_settings_name_the_camera() -> None:
    stage = new_stage()
    for name in ("main_cam", "other"):
        add_camera(stage, f"/{name}")
    settings = UsdRender.Settings.Define(stage, "/Render/main")
    settings.CreateCameraRel().SetTargets([Sdf.Path("/other")])
    stage.SetMetadata("renderSettingsPrimPath", "/Render/main")
    choice = default_camera(stage)
    assert (choice.path, choice.framing) == ("/other", None)
    assert "render settings" in choice.reason


def test_then_main_cam_then_the_only_one() -> None:
    stage = new_stage()
    add_camera(stage, "/a")
    assert default_camera(stage).path == "/a"
    add_camera(stage, "/shot/main_cam")
    assert default_camera(stage).path == "/shot/main_cam"
    assert list_cameras(stage) == ["/a", "/shot/main_cam"]


@pytest.mark.parametrize("up", ["Y", "Z"])
@pytest.mark.parametrize("aspect", [16 / 9, 1.0, 0.6])
def test_else_a_camera_that_has_everything_in_view(up: str, aspect: float) -> None:
    stage = new_stage(0.01, up)
    points = np.random.default_rng(3).uniform(-1, 1, (30, 3)) * [300, 100, 50] + [1000, 0, 0]
    mesh = add_mesh(stage, "/m", points, [3] * 10, range(30))
    mesh.CreateExtentAttr(UsdGeom.PointBased.ComputeExtent(mesh.GetPointsAttr().Get()))
    for name in ("a", "b"):
        add_camera(stage, f"/{name}")
    choice = default_camera(stage, aspect=aspect)
    assert choice.path is None
    camera = choice.framing
    assert camera is not None
    world = points * 0.01
    if up == "Z":
        world = np.stack([world[:, 0], world[:, 2], -world[:, 1]], axis=1)
    seen = (world - camera.world_from_camera[:3, 3]) @ camera.world_from_camera[:3, :3]
    x = np.abs(seen[:, 0] / -seen[:, 2]) * camera.focal_length_mm / (camera.horizontal_aperture_mm / 2)
    y = np.abs(seen[:, 1] / -seen[:, 2]) * camera.focal_length_mm / (camera.vertical_aperture_mm / 2)
    assert (seen[:, 2] < 0).all()
    assert 0.3 < max(x.max(), y.max()) <= 1
    assert camera.horizontal_aperture_mm / camera.vertical_aperture_mm == pytest.approx(aspect)


def recorder_camera(stage: Usd.Stage, time: float, purposes: Sequence[str]) -> Gf.Camera:
    """The camera of ``_ComputeCameraToFrameStage`` in OpenUSD's ``usdAppUtils/frameRecorder.cpp``."""
    camera = Gf.Camera()
    box = UsdGeom.BBoxCache(time, purposes, True).ComputeWorldBound(stage.GetPseudoRoot())
    size, is_y_up = box.ComputeAlignedRange().GetSize(), UsdGeom.GetStageUpAxis(stage) == "Y"
    corner = Gf.Vec2d(size[0], size[1] if is_y_up else size[2]) / 2
    half_view = math.radians(camera.GetFieldOfView(Gf.Camera.FOVHorizontal) / 2)
    distance = corner.GetLength() / math.tan(half_view) + (size[2] if is_y_up else size[1]) / 2
    distance += camera.clippingRange.min if distance < camera.clippingRange.min else 0
    transform = Gf.Matrix4d(1).SetRotate(Gf.Rotation((1, 0, 0), 0 if is_y_up else 90))
    offset = Gf.Vec3d(0, 0, distance) if is_y_up else Gf.Vec3d(0, -distance, 0)
    camera.transform = transform.SetTranslateOnly(box.ComputeCentroid() + offset)
    return camera


@pytest.mark.parametrize("up", ["Y", "Z", "X", "rubbish"])
@pytest.mark.parametrize("size", [(30, 10, 5), (0.1, 0.2, 0.05), (0.01, 0.01, 3), (0, 0, 0)])
def test_the_framing_camera_is_usdrecords(up: str, size: tuple[float, float, float]) -> None:
    stage = new_stage(0.01)
    stage.GetPseudoRoot().SetMetadata("upAxis", up)
    mesh = add_mesh(stage, "/m", np.array([(-0.5, -0.5, -0.5), (0.5, 0.5, 0.5), (0.5, -0.5, 0)]) * size, [3], range(3))
    mesh.CreateExtentAttr(UsdGeom.PointBased.ComputeExtent(mesh.GetPointsAttr().Get()))
    mesh.AddTranslateOp().Set((7, 8, 9), 1)
    mesh.AddTranslateOp(opSuffix="by").Set((0, 0, 0), 0)
    mesh.AddRotateXYZOp().Set((10, 20, 30))
    camera = default_camera(stage, time=1).framing
    assert camera is not None
    theirs = recorder_camera(stage, 1, ["default", "render"])
    pose = (world_from_stage(stage) @ np.array(theirs.transform).T) * [100, 100, 100, 1]
    assert camera.world_from_camera == pytest.approx(pose, abs=1e-5)
    lengths = (camera.focal_length_mm, camera.horizontal_aperture_mm, camera.vertical_aperture_mm)
    assert lengths == pytest.approx((theirs.focalLength, theirs.horizontalAperture, theirs.verticalAperture))
    assert (camera.near_m, camera.far_m) == pytest.approx((0.01, 1e4))
    assert camera.f_stop == theirs.fStop == 0


def test_a_unit_cube_is_framed_from_its_half_diagonal() -> None:
    """The front's half diagonal √2/2 is seen under half of the field of view, whose tangent is 20.955/2/50."""
    stage = new_stage(1.0, "Z")
    UsdGeom.Cube.Define(stage, "/c").GetSizeAttr().Set(1.0)
    camera = default_camera(stage).framing
    assert camera is not None
    assert camera.world_from_camera[:3, 3] == pytest.approx([0, 0, math.sqrt(0.5) * 100 / 20.955 + 0.5])
    assert camera.world_from_camera[:3, :3] == pytest.approx(np.eye(3))


def test_purposes_and_mask_choose_what_is_framed() -> None:
    stage = new_stage()
    for number, purpose in enumerate(("default", "render", "proxy", "guide")):
        cube = UsdGeom.Cube.Define(stage, f"/{purpose}")
        cube.GetPurposeAttr().Set(purpose)
        cube.AddTranslateOp().Set((10.0 * number, 0, 0))
    middles = {
        ("default",): 0.0,
        ("default", "render"): 5.0,
        ("default", "proxy"): 10.0,
        ("default", "render", "proxy", "guide"): 15.0,
    }
    for purposes, middle in middles.items():
        camera = default_camera(stage, purposes=purposes).framing
        assert camera is not None
        assert camera.world_from_camera[0, 3] == pytest.approx(middle)
    masked = default_camera(stage, purposes=("default", "render"), mask=["/render", "/guide"]).framing
    assert masked is not None
    assert masked.world_from_camera[0, 3] == pytest.approx(10)


def test_an_empty_stage_has_nothing_to_frame() -> None:
    with pytest.raises(StageError) as caught:
        default_camera(new_stage())
    assert caught.value.code == "empty_stage"


def test_an_empty_stage_says_which_file_is_missing(tmp_path: Path) -> None:
    file = tmp_path / "a.usda"
    file.write_text("#usda 1.0\n(subLayers = [@./set.usda@])\n")
    with pytest.raises(
        StageError, match=r"nothing that a camera could frame; set\.usda is missing: layer a\.usda"
    ) as caught:
        default_camera(open_stage(file))
    assert caught.value.code == "empty_stage"


def test_the_gate_of_a_conformed_camera_is_kept_without_an_aspect() -> None:
    stage = new_stage()
    add_camera(stage)
    camera = read_camera(stage, "/cam", 0)
    assert conform_camera(camera, None) is camera


def test_frames_are_time_codes() -> None:
    stage = new_stage()
    stage.SetStartTimeCode(1001)
    stage.SetEndTimeCode(1096)
    stage.SetTimeCodesPerSecond(48)
    found = frame_range(stage)
    assert (found.start, found.end, found.frames_per_second) == (1001, 1096, 48)
