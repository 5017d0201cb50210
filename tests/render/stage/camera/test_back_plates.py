"""Back plates of cameras: pictures that stand before them and go through their lens."""

from __future__ import annotations

import math
import warnings
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdRender

from render.colour import to_working
from render.errors import SettingsError, StageError
from render.frame import FrameRenderer
from render.model.frame_settings import FrameSettings
from render.model.scene import Batch
from render.pictures.picture import make_picture
from render.shot import Shot
from render.shot.focus.visibility import visible_shares
from render.shot.inspection import inspect_shot
from render.stage import StageOptions, StageReader, read_camera
from render.stage.camera.back_plates import PlateReader
from render.stage.findings import FindingLog
from render.stage.render_pass import RenderPass
from tests.render.kits.plates import FOCUS, HEIGHT, WIDTH, add_plate, corners_in_picture, picture, plated, write_image
from tests.render.kits.stages import add_mesh, only_batch, world_points


@pytest.fixture
def red(tmp_path: Path) -> str:
    return write_image(tmp_path / "red.exr", (0.8, 0.2, 0.1))


@pytest.mark.parametrize(("unit", "up"), [(1.0, "Y"), (0.01, "Y"), (0.01, "Z")])
def test_corners_land_in_the_corners_of_the_gate(unit: float, up: str) -> None:
    stage = plated(unit=unit, up=up)
    camera = UsdGeom.Xformable(stage.GetPrimAtPath("/cam"))
    camera.AddTranslateOp().Set(Gf.Vec3d(3, -2, 7))
    camera.AddRotateXYZOp().Set(Gf.Vec3f(20, 30, 40))
    places, depths = corners_in_picture(stage)
    np.testing.assert_allclose(places, [(WIDTH, 0), (0, 0), (0, HEIGHT), (WIDTH, HEIGHT)], atol=1e-3)
    np.testing.assert_allclose(depths, FOCUS * unit, rtol=1e-6)


def test_size_and_distance_are_those_that_usd_computes() -> None:
    stage = plated(scale_tweak=Gf.Vec2f(0.5, 2), translate_tweak=Gf.Vec3f(0.3, -0.2, -4))
    plate, time = UsdGeom.BackPlateAPI(stage.GetPrimAtPath("/cam"), "sky"), Usd.TimeCode(0)
    size = [plate.ComputeEffectiveDimension(is_width, time) for is_width in (True, False)]
    points = world_points(only_batch(StageReader(stage).read(0)))
    np.testing.assert_allclose(np.ptp(points, axis=0), [*size, 0], rtol=1e-6)
    x, y, z = plate.GetCameraSpacePosition(time)
    tweak = plate.GetTranslateTweakAttr().Get()[2]
    assert points.mean(axis=0).tolist() == pytest.approx(
        [x, y, tweak - (z - tweak)]
    )  # USD's z counts the focus distance ahead


def test_tweaks_scale_then_turn_then_move_about_the_centre() -> None:
    turned = plated(
        scale_tweak=Gf.Vec2f(0.5, 0.5), rotateXYZ_tweak=Gf.Vec3f(30, 40, 50), translate_tweak=Gf.Vec3f(1, 2, -3)
    )
    # Hydra turns about z first, then y, then x
    turn = Gf.Rotation((0, 0, 1), 50) * Gf.Rotation((0, 1, 0), 40) * Gf.Rotation((1, 0, 0), 30)
    half = 0.25 * FOCUS * np.array([36, 20.25]) / 50
    flat = [Gf.Vec3d(x * half[0], y * half[1], 0) for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    expected = np.array([turn.TransformDir(corner) + Gf.Vec3d(1, 2, -3 - FOCUS) for corner in flat])
    np.testing.assert_allclose(world_points(only_batch(StageReader(turned).read(0))), expected, atol=1e-6)


@pytest.mark.gl
@pytest.mark.parametrize("engine", ["pinhole", "lens", "accumulation"])
@pytest.mark.parametrize("shading", ["lit", "unlit"])
def test_radiance_is_the_colour_of_the_image(renderer: FrameRenderer, red: str, engine: str, shading: str) -> None:
    stage = plated(red)
    UsdLux.DistantLight.Define(stage, "/sun").CreateIntensityAttr(50)
    UsdLux.DomeLight.Define(stage, "/dome")
    seen = picture(renderer, stage, engine=engine, shading=shading)
    expected = to_working(np.array([[[0.8, 0.2, 0.1, 1.0]]], np.float32))[0, 0]
    np.testing.assert_allclose(seen[2:-2, 2:-2], np.broadcast_to(expected, (HEIGHT - 4, WIDTH - 4, 4)), rtol=4e-3)


@pytest.mark.gl
def test_luma_is_slope_offset_and_power_of_linear_values(renderer: FrameRenderer, red: str) -> None:
    stage = plated(red, luma_slope=Gf.Vec3f(2, 1, 0), luma_offset=Gf.Vec3f(0, 0.3, 0.5), luma_power=Gf.Vec3f(1, 2, 0.5))
    expected = to_working(np.array([[[1.6, 0.25, math.sqrt(0.5), 1.0]]], np.float32))[0, 0]
    np.testing.assert_allclose(picture(renderer, stage)[45, 80], expected, rtol=4e-3)


@pytest.mark.gl
@pytest.mark.parametrize(
    ("channels", "opacity"),
    [((0.25,), 0.25), ((0.9, 0.25), 0.25), ((0.25, 0.3, 0.4), 1.0), ((0.1, 0.1, 0.1, 0.25), 0.25)],
)
def test_opacity_is_the_alpha_of_the_right_channel(
    renderer: FrameRenderer, tmp_path: Path, red: str, channels: tuple[float, ...], opacity: float
) -> None:
    alpha = write_image(tmp_path / "alpha.exr", channels)
    assert picture(renderer, plated(red, alpha_image=alpha))[45, 80, 3] == pytest.approx(opacity, abs=2e-3)


@pytest.mark.gl
def test_the_alpha_of_the_image_itself_is_its_opacity(renderer: FrameRenderer, tmp_path: Path) -> None:
    image = write_image(tmp_path / "half.exr", (0.4, 0.4, 0.4, 0.5))  # colour counts as not multiplied by it
    np.testing.assert_allclose(picture(renderer, plated(image))[45, 80], [0.2, 0.2, 0.2, 0.5], rtol=1e-2)


@pytest.mark.gl
@pytest.mark.parametrize("engine", ["lens", "accumulation"])
def test_an_edge_out_of_focus_is_blurred_by_its_disc(renderer: FrameRenderer, tmp_path: Path, engine: str) -> None:
    """A plate at 10 m of which the left half shows: across its edge light is the part of a disc that is beyond a chord."""
    white = write_image(tmp_path / "white.exr", (1.0, 1.0, 1.0))
    far = 2.0
    shift = Gf.Vec3f(-0.5 * far * FOCUS * 36 / 50, 0, -FOCUS)
    stage = plated(white, scale_tweak=Gf.Vec2f(far, 4 * far), translate_tweak=shift)
    camera = UsdGeom.Camera(stage.GetPrimAtPath("/cam"))
    camera.CreateFStopAttr(0.2)
    seen = picture(renderer, stage, engine=engine, rays=1024, supersample=2)[HEIGHT // 2, :, 0]
    f_px = WIDTH * 50 / 36
    radius_px = f_px * (0.05 / (2 * 0.2)) * (1 / FOCUS - 1 / (far * FOCUS))
    t = np.clip((np.arange(WIDTH) + 0.5 - WIDTH / 2) / radius_px, -1, 1)
    expected = 0.5 - (np.arcsin(t) + t * np.sqrt(1 - t * t)) / np.pi
    middle = slice(WIDTH // 2 - 30, WIDTH // 2 + 30)
    assert radius_px > 2.5
    np.testing.assert_allclose(seen[middle], expected[middle], atol=0.03)  # 1,024 rays, layers of half a pixel


@pytest.mark.gl
def test_a_plate_is_hidden_by_what_is_nearer_and_hides_the_rest(renderer: FrameRenderer, red: str) -> None:
    stage = plated(red)
    for x, depth in ((-0.5, 4.0), (0.5, 6.0)):
        quad = [(x * depth / 5 + a * 0.3, b * 0.3, -depth) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        add_mesh(stage, f"/at{depth:g}", quad).CreateDisplayColorAttr([(0, 0, 1)])
    seen = picture(renderer, stage, shading="unlit", aovs=("color", "depth"))
    red_to_blue = seen[45, :, 0] > seen[45, :, 2]
    assert not red_to_blue[80 - 22]
    assert red_to_blue[80 + 22]


@pytest.mark.gl
def test_plates_are_seen_through_the_cameras_that_visibility_says(renderer: FrameRenderer, red: str) -> None:
    stage = plated(red)
    other = UsdGeom.Camera.Define(stage, "/other")
    other.CreateClippingRangeAttr(Gf.Vec2f(0.01, 1e6))
    seen = {}
    for visibility in ("solo", "all", "mute"):
        UsdGeom.BackPlateAPI(stage.GetPrimAtPath("/cam"), "sky").CreatePlateVisibilityAttr(visibility)
        seen[visibility] = [picture(renderer, stage, path)[45, 80, 3] for path in ("/cam", "/other")]
    assert seen == {"solo": [1, 0], "all": [1, 1], "mute": [0, 0]}


@pytest.mark.gl
def test_a_plate_casts_no_shadow(renderer: FrameRenderer, red: str) -> None:
    stage = plated(red, plateVisibility="all")
    add_mesh(stage, "/wall", [(x * 20, y * 20, -8) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    UsdLux.DistantLight.Define(stage, "/sun").CreateIntensityAttr(3)  # shines along the view, through the plate
    side = UsdGeom.Camera.Define(stage, "/side")
    side.CreateClippingRangeAttr(Gf.Vec2f(0.01, 1e6))
    side.AddTranslateOp().Set(Gf.Vec3d(0, 0, -6))
    with_plate = picture(renderer, stage, "/side")
    assert with_plate[..., 0].min() > 0
    UsdGeom.BackPlateAPI(stage.GetPrimAtPath("/cam"), "sky").CreatePlateVisibilityAttr("mute")
    np.testing.assert_array_equal(with_plate, picture(renderer, stage, "/side"))


@pytest.mark.gl
def test_images_over_time_and_a_moving_camera_are_followed(renderer: FrameRenderer, tmp_path: Path, red: str) -> None:
    blue = write_image(tmp_path / "blue.exr", (0.0, 0.0, 1.0))
    stage = plated(red)
    image = UsdGeom.BackPlateAPI(stage.GetPrimAtPath("/cam"), "sky").GetImageAttr()
    image.Set(red, 1)
    image.Set(blue, 2)
    move = UsdGeom.Xformable(stage.GetPrimAtPath("/cam")).AddTranslateOp()
    move.Set(Gf.Vec3d(0), 1)
    move.Set(Gf.Vec3d(50, 10, 5), 2)
    first, last = (picture(renderer, stage, time=time) for time in (1, 2))
    assert (first[..., 3] == 1).all()
    assert (last[..., 3] == 1).all()
    assert first[45, 80].argmax() == 3
    assert first[45, 80, 0] > first[45, 80, 2]
    assert last[45, 80, 0] < last[45, 80, 2]


def moving_shot(tmp_path: Path) -> Shot:
    """A camera that moves by its plate's width in a frame, its shutter open for half of it; the plate has a black half."""
    pixels = np.zeros((4, 64, 3), np.float32)
    pixels[:, :32] = 1
    stage = plated(write_image(tmp_path / "halves.exr", pixels))
    camera = UsdGeom.Camera(stage.GetPrimAtPath("/cam"))
    move = camera.AddTranslateOp()
    move.Set(Gf.Vec3d(0), 0)
    move.Set(Gf.Vec3d(36, 0, 0), 10)
    camera.CreateShutterOpenAttr(-0.25)
    camera.CreateShutterCloseAttr(0.25)
    add_mesh(stage, "/still", [(x, y, -4.0) for x, y in ((20, -0.1), (20.4, -0.1), (20.4, 0.1), (20, 0.1))])
    stage.Export(f"{tmp_path}/moving.usda")
    return Shot.open(f"{tmp_path}/moving.usda")


@pytest.mark.gl
@pytest.mark.parametrize("motion_by", ["moments", "velocities"])
def test_a_plate_does_not_smear_as_its_camera_moves(renderer: FrameRenderer, tmp_path: Path, motion_by: str) -> None:
    shot = moving_shot(tmp_path)
    still = FrameSettings(WIDTH, HEIGHT, rays=64, supersample=1, adaptive=False)
    moving = FrameSettings(WIDTH, HEIGHT, rays=64, supersample=1, adaptive=False, motion=8, motion_by=motion_by)
    expected, seen = (make_picture(renderer, shot, "/cam", 2.0, one).frame.color[..., 0] for one in (still, moving))
    assert expected[45, 70] > 0.9
    assert abs(seen[:, :70] - expected[:, :70]).max() < 0.02
    assert seen[45, 90:].max() < 0.02


HOSTILE = {
    "focusDistance": [0.0, -1.0, math.nan, math.inf, 1e30],
    "focalLength": [0.0, math.nan],
    "horizontalAperture": [-1.0, math.inf],
    "backPlate:sky:scale:tweak": [Gf.Vec2f(math.nan, 1), Gf.Vec2f(0, 0), Gf.Vec2f(0, 1)],
    "backPlate:sky:translate:tweak": [Gf.Vec3f(0, 0, math.inf), Gf.Vec3f(0, 0, -1e30)],
    "backPlate:sky:rotateXYZ:tweak": [Gf.Vec3f(math.nan, 0, 0)],
}


@pytest.mark.parametrize(("name", "value"), [(name, value) for name, values in HOSTILE.items() for value in values])
def test_a_plate_that_cannot_be_placed_is_named(name: str, value: object) -> None:
    stage = plated()
    add_mesh(stage, "/quad")
    stage.GetPrimAtPath("/cam").GetAttribute(name).Set(value)
    reader = StageReader(stage)
    assert len(reader.read(0).batches) == 1
    (finding,) = [one for one in reader.findings if one.path == "/cam.backPlate:sky"]
    assert "not drawn" in finding.message


def test_values_out_of_range_are_named_and_the_plate_is_drawn(red: str) -> None:
    stage = plated(red, luma_power=Gf.Vec3f(0, 1, 1), luma_slope=Gf.Vec3f(math.nan, 1, 1), plateVisibility="everybody")
    reader = StageReader(stage)
    only_batch(reader.read(0))
    found = {
        finding.path.removeprefix("/cam.backPlate:sky:")
        for finding in reader.findings
        if finding.code == "bad_back_plate"
    }
    assert found == {"luma:power", "luma:slope", "plateVisibility"}


@pytest.mark.parametrize("name", ["image", "alpha:image", "depth:image"])
def test_an_image_of_another_type_is_named(red: str, name: str) -> None:
    stage = plated(red)
    prim = stage.GetRootLayer().GetPrimAtPath("/cam")
    stage.GetPrimAtPath("/cam").RemoveProperty(f"backPlate:sky:{name}")
    Sdf.AttributeSpec(prim, f"backPlate:sky:{name}", Sdf.ValueTypeNames.String).default = "x.exr"
    reader = StageReader(stage)
    only_batch(reader.read(0))
    (finding,) = reader.findings
    assert (finding.code, finding.path) == ("bad_back_plate", f"/cam.backPlate:sky:{name}")
    assert f"backPlate:sky:{name} must be an asset, got 'x.exr' (str)" in finding.message


def test_a_grade_beyond_all_numbers_warns_of_nothing(tmp_path: Path) -> None:
    bright = write_image(tmp_path / "bright.exr", (20.0, 1.0, 0.5))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        batch = only_batch(StageReader(plated(bright, luma_power=Gf.Vec3f(50, 50, 50))).read(0))
    assert np.isfinite(batch.material.lookups["emissive"].image.pixels).all()


@pytest.mark.gl
def test_a_plate_whose_image_is_missing_is_black_and_named(renderer: FrameRenderer) -> None:
    stage = plated("nowhere.exr")
    np.testing.assert_array_equal(picture(renderer, stage)[45, 80], [0, 0, 0, 1])
    reader = StageReader(stage)
    reader.read(0)
    (finding,) = reader.findings
    assert finding.message == "nowhere.exr of back plate sky of /cam is missing: it is black"
    assert finding.path == "/cam.backPlate:sky:image"


def test_an_image_outside_the_shot_is_refused_where_it_is_confined(tmp_path: Path, red: str) -> None:
    (tmp_path / "shot").mkdir()
    (tmp_path / "shot" / "link.exr").symlink_to(red)
    for image in (red, "../red.exr", "link.exr"):
        plated(image).Export(f"{tmp_path}/shot/shot.usda")
        with pytest.raises(StageError, match="lies outside what was given"):
            Shot.open(tmp_path / "shot" / "shot.usda", confined_to=tmp_path / "shot")
    stage = plated(red)
    reader = PlateReader({stage.GetPrimAtPath("/cam"): "seen"}, tmp_path / "shot", False, log := FindingLog())
    (batch,) = reader.batches(UsdGeom.XformCache(), np.eye(4), 1.0, lambda path: 0)
    assert batch.material.lookups == {}
    assert "lies outside what was given: it is black" in log.as_list()[0].message


def test_a_change_of_the_focus_moves_the_plate_and_reads_nothing_else(tmp_path: Path, red: str) -> None:
    stage = plated(red)
    add_mesh(stage, "/quad")
    stage.Export(f"{tmp_path}/shot.usda")
    shot = Shot.open(f"{tmp_path}/shot.usda")
    before, quad = _plate(shot), shot.scene_at(0).batches[0]
    shot.camera.set("/cam", focus_distance_m=8.0)
    after = _plate(shot)
    assert (before.poses[0, 2, 3], after.poses[0, 2, 3]) == (-5, -8)
    assert after.material is before.material
    assert shot.scene_at(0).batches[0] is quad
    assert shot.scene_at(1).batches[1] is after


def _plate(shot: Shot) -> Batch:
    return next(batch for batch in shot.scene_at(0).batches if batch.seen_by == "/cam")


def test_files_are_closed_with_the_shot(tmp_path: Path, red: str) -> None:
    plated(red).Export(f"{tmp_path}/shot.usda")
    shot = Shot.open(f"{tmp_path}/shot.usda")
    shot.scene_at(0)
    del shot  # without a cycle of references, which would keep it until it is collected
    assert Sdf.Layer.Find(f"{tmp_path}/shot.usda") is None


def test_plates_come_and_go_with_their_schema(red: str) -> None:
    stage = plated(red)
    reader = StageReader(stage)
    assert len(reader.read(0).batches) == 1
    UsdGeom.Camera.Define(stage, "/other").CreateFocusDistanceAttr(3.0)
    add_plate(stage, red, "/other")
    assert len(reader.read(0).batches) == 2
    stage.GetPrimAtPath("/cam").RemoveAPI(UsdGeom.BackPlateAPI, "sky")
    assert [batch.seen_by for batch in reader.read(0).batches] == ["/other"]


def test_plates_go_and_come_with_their_active_camera(red: str) -> None:
    stage = plated(red)
    reader = StageReader(stage)
    counts = [len(reader.read(0).batches)]
    for active in (False, True):
        stage.GetPrimAtPath("/cam").SetActive(active)
        counts.append(len(reader.read(0).batches))
    assert counts == [1, 0, 1]


def test_visibility_and_purpose_of_a_camera_do_not_count(red: str) -> None:
    stage = plated(red)
    camera = UsdGeom.Imageable(stage.GetPrimAtPath("/cam"))
    camera.CreateVisibilityAttr("invisible")
    camera.CreatePurposeAttr("guide")
    assert only_batch(StageReader(stage).read(0)).seen_by == "/cam"


def test_a_mask_leaves_out_the_plates_of_other_cameras(red: str) -> None:
    stage = plated(red)
    assert StageReader(stage, StageOptions(mask=("/elsewhere",))).read(0).batches == ()
    assert len(StageReader(stage, StageOptions(mask=("/cam",))).read(0).batches) == 1


def test_a_render_pass_holds_plates_out_or_hides_them(red: str) -> None:
    stage = plated(red)
    settings = UsdRender.Settings.Define(stage, "/Render/settings")
    one = UsdRender.Pass.Define(stage, "/Render/pass")
    one.GetRenderSourceRel().SetTargets([settings.GetPath()])
    roles = []
    for name, relation in (("matte", "includes"), ("cameraVisibility", "excludes"), ("renderVisibility", "excludes")):
        target = one.GetPrim().CreateRelationship(f"collection:{name}:{relation}")
        target.SetTargets(["/cam"])
        batches = StageReader(stage, render_pass=RenderPass(one.GetPrim())).read(0).batches
        roles.append([batch.camera_role for batch in batches])
        target.ClearTargets(True)
    assert roles == [["holdout"], ["unseen"], []]


@pytest.mark.gl
def test_a_click_gives_the_depth_of_a_plate_and_no_focus_point(
    renderer: FrameRenderer, tmp_path: Path, red: str
) -> None:
    plated(red, translate_tweak=Gf.Vec3f(0, 0, -1)).Export(f"{tmp_path}/shot.usda")
    shot = Shot.open(f"{tmp_path}/shot.usda")
    pick = renderer.pick(shot.scene_at(0), shot.camera_at("/cam", 0, WIDTH, HEIGHT), WIDTH, HEIGHT, 80, 45)
    assert pick is not None
    assert (pick.prim_path, pick.depth_m) == ("/cam", pytest.approx(6))
    with pytest.raises(SettingsError, match="is on a back plate of /cam"):
        shot.focus.add_point("/cam", "sky", pick)
    assert shot.focus.points("/cam", 0) == []


def test_a_plate_hides_focus_points_from_its_own_camera_alone(red: str) -> None:
    stage = plated(red)
    UsdGeom.Camera.Define(stage, "/other").CreateClippingRangeAttr(Gf.Vec2f(0.01, 1e6))
    scene, points = StageReader(stage).read(0), np.array([(0.0, 0, -4), (0, 0, -6)])
    assert visible_shares(scene, read_camera(stage, "/cam", 0), points).tolist() == [1, 0]
    assert visible_shares(scene, read_camera(stage, "/other", 0), points).tolist() == [1, 1]


@pytest.mark.gl
def test_an_orthographic_camera_has_its_plate(renderer: FrameRenderer, red: str) -> None:
    stage = plated(red)
    UsdGeom.Camera(stage.GetPrimAtPath("/cam")).CreateProjectionAttr("orthographic")
    assert (picture(renderer, stage)[1:-1, 1:-1, 3] == 1).all()
    for depth, hidden in ((4.0, True), (6.0, False)):
        quad = [(x * 0.005, y * 0.005, -depth) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        add_mesh(stage, "/quad", quad).CreateDisplayColorAttr([(0, 0, 1)])
        pixel = picture(renderer, stage, shading="unlit")[45, 80]
        assert (pixel[2] > pixel[0]) == hidden


def test_inspection_lists_plates_apart_from_surfaces(tmp_path: Path, red: str) -> None:
    stage = plated(red, unit=0.01, translate_tweak=Gf.Vec3f(0, 0, -95))
    add_plate(stage, "", name="ground", plateVisibility="mute", scale_tweak=Gf.Vec2f(math.nan))
    stage.Export(f"{tmp_path}/shot.usda")
    inspection = inspect_shot(Shot.open(f"{tmp_path}/shot.usda"))
    listed = {plate.name: (plate.image, plate.visibility, plate.depth_m) for plate in inspection.back_plates}
    assert listed == {"sky": (red, "solo", pytest.approx(1.0)), "ground": ("", "mute", None)}
    assert (inspection.prim_count, inspection.triangle_count) == (0, 0)
