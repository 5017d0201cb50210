"""From a click to a focused picture: what was clicked is where the focus point stands, and gets sharp."""

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom

from render.errors import CameraError, SettingsError
from render.film import Grade, develop
from render.frame import FrameSettings
from render.pictures.picture import make_picture
from render.shot import Shot
from tests.render.kits.focus_shot import CAMERA, FAR, NEAR, write_shot
from usd_schemas import FilmData, LensCamera

pytestmark = pytest.mark.gl

WIDTH, HEIGHT = 192, 108
SETTINGS = FrameSettings(width=WIDTH, height=HEIGHT, rays=16, supersample=1, shading="unlit")


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return write_zoo(tmp_path_factory.mktemp("zoo") / "zoo.usda")


@pytest.fixture
def shot(path):
    return Shot.open(path)


def write_zoo(path):
    """One of each kind of thing that can be clicked on, side by side, 5 m before the camera; all move to the left."""
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    UsdGeom.SetStageUpAxis(stage, "Z")
    row = UsdGeom.Xform.Define(stage, "/row")
    slide = row.AddTranslateOp()
    slide.Set(Gf.Vec3d(0), 1)
    slide.Set(Gf.Vec3d(-30, 0, 10), 11)
    ball = UsdGeom.Sphere.Define(stage, "/row/ball")
    ball.CreateRadiusAttr(40)
    ball.AddTranslateOp().Set(Gf.Vec3d(-130, 0, 0))
    mesh(stage, "/row/mesh", -43)
    mesh(stage, "/class/kept/mesh", 0)
    stage.GetPrimAtPath("/class").SetSpecifier(Sdf.SpecifierClass)
    copy = UsdGeom.Xform.Define(stage, "/row/copy")
    copy.AddTranslateOp().Set(Gf.Vec3d(43, 0, 0))
    copy.GetPrim().GetReferences().AddInternalReference("/class/kept")
    copy.GetPrim().SetInstanceable(True)
    many = UsdGeom.PointInstancer.Define(stage, "/row/many")
    mesh(stage, "/row/many/prototype/mesh", 0)
    many.CreatePrototypesRel().SetTargets(["/row/many/prototype"])
    many.CreateProtoIndicesAttr([0, 0])
    many.CreatePositionsAttr([Gf.Vec3f(130, 0, 0), Gf.Vec3f(0, 0, 400)])
    camera = UsdGeom.Camera.Define(stage, CAMERA)
    camera.AddTransformOp().Set(
        Gf.Matrix4d().SetLookAt(Gf.Vec3d(0, -500, 0), Gf.Vec3d(0), Gf.Vec3d(0, 0, 1)).GetInverse()
    )
    camera.CreateFocalLengthAttr(50)
    camera.CreateHorizontalApertureAttr(36)
    camera.CreateVerticalApertureAttr(20.25)
    camera.CreateHorizontalApertureOffsetAttr(1.0)
    camera.CreateFStopAttr(2)
    camera.CreateFocusDistanceAttr(200)
    camera.CreateClippingRangeAttr(Gf.Vec2f(1, 10000))
    stage.Save()
    return path


def mesh(stage, path, x):
    """A tilted card of one five-cornered face and one triangle, left-handed to boot."""
    card = UsdGeom.Mesh.Define(stage, path)
    outline = [(-35, -10, -40), (35, 10, -40), (35, 10, 0), (0, 5, 30), (-35, -10, 0), (0, 8, 45)]
    card.CreatePointsAttr([Gf.Vec3f(*corner) for corner in outline])
    card.CreateFaceVertexCountsAttr([5, 3])
    card.CreateFaceVertexIndicesAttr([4, 3, 2, 1, 0, 5, 2, 3])
    card.CreateOrientationAttr("leftHanded")
    card.CreateDoubleSidedAttr(True)
    card.CreateSubdivisionSchemeAttr("none")
    card.AddTranslateOp().Set(Gf.Vec3d(x, 0, 0))


CLICKS = {"/row/ball": 20.5, "/row/mesh": 69.5, "/row/copy/mesh": 115.5, "/row/many": 162.0}


@pytest.mark.parametrize("y", [36.5, 50.5, 61.5])  # on three triangles of the meshes, of two faces
@pytest.mark.parametrize("target", CLICKS)
def test_a_focus_point_stands_where_the_click_was_and_follows_it(renderer, shot, target, y):
    x = CLICKS[target]
    pick = renderer.pick(shot.scene_at(1), shot.camera_at(CAMERA, 1, WIDTH, HEIGHT), WIDTH, HEIGHT, x, y)
    assert pick is not None
    assert pick.prim_path == target
    shot.focus.add_point(CAMERA, "clicked", pick)
    (placed,) = shot.focus.points(CAMERA, 1, aspect=WIDTH / HEIGHT)
    assert placed.position_m == pytest.approx(pick.position_m, abs=2e-4)
    assert placed.screen == pytest.approx((x / WIDTH, y / HEIGHT), abs=2e-4)
    assert placed.depth_m == pytest.approx(pick.depth_m, rel=1e-4)
    assert shot.camera_at(CAMERA, 1, WIDTH, HEIGHT).focus_distance_m == pytest.approx(pick.depth_m, rel=1e-4)
    (later,) = shot.focus.points(CAMERA, 11)
    assert np.subtract(later.position_m, placed.position_m) == pytest.approx((-0.3, 0.1, 0.0), abs=1e-4)


def test_a_click_on_nothing_picks_nothing(renderer, shot):
    assert renderer.pick(shot.scene_at(1), shot.camera_at(CAMERA, 1, WIDTH, HEIGHT), WIDTH, HEIGHT, 2.0, 2.0) is None


def test_what_was_clicked_is_sharp_and_the_rest_is_not(renderer, tmp_path):
    shot = Shot.open(write_shot(tmp_path / "shot.usda"))
    settings = FrameSettings(width=WIDTH, height=HEIGHT, rays=64, aovs=("color", "coc"), shading="unlit")
    places = {NEAR: (96.0, 54.0), FAR: (60.0, 54.0)}
    for name, (x, y) in places.items():
        pick = renderer.pick(shot.scene_at(1), shot.camera_at(CAMERA, 1, WIDTH, HEIGHT), WIDTH, HEIGHT, x, y)
        assert pick.prim_path == name
        shot.focus.add_point(CAMERA, "clicked", pick)
        picture = make_picture(renderer, shot, CAMERA, 1, settings, Grade())
        for other, (u, v) in places.items():
            coc_px = abs(picture.frame.aovs["coc"][int(v), int(u)])
            assert (coc_px < 0.02) if other == name else (coc_px > 0.4)
        shot.focus.remove_point(CAMERA, "clicked")


def test_a_picture_is_the_frame_developed_and_says_how_it_was_made(renderer, shot):
    progress = []
    picture = make_picture(renderer, shot, None, 1, SETTINGS, Grade(), progress.append)
    assert picture.graded.shape == (HEIGHT, WIDTH, 3)
    assert np.array_equal(picture.graded, develop(picture.frame.color, picture.camera.exposure_scale, Grade()))
    assert 0 < picture.graded.max() <= 1
    assert picture.camera.path == CAMERA
    assert (picture.metadata.camera, picture.metadata.time, picture.metadata.stage) == (picture.camera, 1, "zoo.usda")
    assert picture.metadata.settings["rays"] == 16
    assert progress == sorted(progress)
    assert progress[-1] == 1.0
    again = make_picture(renderer, shot, CAMERA, 1, SETTINGS, Grade())
    assert np.array_equal(again.frame.color, picture.frame.color), "same inputs, same pixels"


def test_exposure_times_and_speeds_that_the_shot_sets_are_reported(renderer, shot):
    silent = make_picture(renderer, shot, CAMERA, 1, SETTINGS, Grade()).metadata
    assert (silent.exposure_time_s, silent.iso) == (None, None)
    camera = UsdGeom.Camera(shot.stage.GetPrimAtPath(CAMERA))
    with Usd.EditContext(shot.stage, shot.edits.layer):
        camera.CreateExposureTimeAttr(1 / 48)
        camera.CreateExposureIsoAttr(800)
    metadata = make_picture(renderer, shot, CAMERA, 1, SETTINGS, Grade()).metadata
    assert (metadata.exposure_time_s, metadata.iso) == pytest.approx((1 / 48, 800))


def test_a_shot_is_finished_on_the_film_that_it_says(renderer, shot):
    """The stock of the shot, another one by name, and neither: three pictures of the same light."""
    plain = make_picture(renderer, shot, CAMERA, 1, SETTINGS)
    camera = LensCamera(shot.stage.GetPrimAtPath(CAMERA))
    with Usd.EditContext(shot.stage, shot.edits.layer):
        camera.film.author(FilmData(process="negative", stock="5219", print_stock="2383"))
    negative = make_picture(renderer, shot, CAMERA, 1, SETTINGS)
    slide = make_picture(renderer, shot, CAMERA, 1, SETTINGS, stock="velvia_50")
    np.testing.assert_array_equal(plain.frame.color, negative.frame.color)
    pictures = (plain, negative, slide)
    assert all(picture.graded.min() >= 0 and picture.graded.max() <= 1 for picture in pictures)
    apart = [np.abs(a.graded - b.graded).max() for a in pictures for b in pictures if a is not b]
    assert min(apart) > 0.02
    again = make_picture(renderer, shot, CAMERA, 1, SETTINGS, stock="velvia_50")
    np.testing.assert_array_equal(slide.graded, again.graded)  # its grain too
    with pytest.raises(SettingsError, match="velvia"):
        make_picture(renderer, shot, CAMERA, 1, SETTINGS, stock="velwia_50")
    with Usd.EditContext(shot.stage, shot.edits.layer):
        shot.stage.GetPrimAtPath(CAMERA).GetAttribute("film:stock").Set("unheard of")
    with pytest.raises(CameraError, match="unheard of"):
        make_picture(renderer, shot, CAMERA, 1, SETTINGS)
