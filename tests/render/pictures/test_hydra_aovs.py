"""AOVs of Hydra's names: what they hold of a stage in centimetres with Z up, against its own transforms and primvars."""

from __future__ import annotations

import json
from pathlib import Path
from typing import cast

import numpy as np
import OpenImageIO
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom

from render.errors import SettingsError
from render.frame import FrameRenderer, FrameSettings
from render.output import encode
from render.pictures.picture import Picture, expose_frame, make_picture
from render.shot import Shot
from tests.render.kits.stages import add_mesh, dense_grid, set_primvar

pytestmark = pytest.mark.gl

T = Sdf.ValueTypeNames
WIDTH, HEIGHT = 96, 64
NAMES = ("color", "depth", "cameraDepth", "normal", "Neye", "Peye", "primId", "prim_id", "instanceId", "elementId")
PRIMVARS = ("primvars:st", "primvars:heat", "primvars:flow", "primvars:displayColor")
CORNERS = [(-60, 0, -40), (0, 0, -40), (0, 0, 40), (-60, 0, 40), (60, 30, -40), (60, 30, 40)]
EYE = (10.0, -200.0, 5.0)
LOOK = Gf.Matrix4d().SetLookAt(Gf.Vec3d(*EYE), Gf.Vec3d(0), Gf.Vec3d(0, 0, 1)).GetInverse()


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wall of two faces, the second turned away, a mirrored card, two instances of a card, and a ball, before nothing."""
    path = tmp_path_factory.mktemp("aovs") / "aovs.usda"
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    UsdGeom.SetStageUpAxis(stage, "Z")
    wall = add_mesh(stage, "/wall", CORNERS, (4, 4), (0, 1, 2, 3, 1, 4, 5, 2))
    set_primvar(wall.GetPrim(), "st", T.TexCoord2fArray, "faceVarying", [(i / 8, i % 3) for i in range(8)])
    set_primvar(wall.GetPrim(), "heat", T.FloatArray, "vertex", [1.0, 2.0, 4.0, 8.0, 16.0, 32.0])
    set_primvar(wall.GetPrim(), "flow", T.Float4Array, "uniform", [(1, 2, 3, 4), (5, 6, 7, 8)])
    card = add_mesh(stage, "/card", [(0, 0, 0), (8, 0, 0), (8, 0, 8), (0, 0, 8)])
    card.AddTranslateOp().Set(Gf.Vec3d(-20, -20, -30))
    card.AddScaleOp().Set(Gf.Vec3f(-1, 1, 1))
    many = UsdGeom.PointInstancer.Define(stage, "/many")
    add_mesh(stage, "/many/kind/mesh", [(0, 0, 0), (8, 0, 0), (8, 0, 8), (0, 0, 8)])
    many.CreatePrototypesRel().SetTargets(["/many/kind"])
    many.CreateProtoIndicesAttr([0, 0])
    many.CreatePositionsAttr([Gf.Vec3f(20, -20, 20), Gf.Vec3f(-40, -20, 20)])
    many.CreateIdsAttr([7, 9])
    set_primvar(stage.GetPrimAtPath("/many/kind/mesh"), "flow", T.Float2, "constant", (0.25, 0.5))
    ball = UsdGeom.Sphere.Define(stage, "/ball")
    ball.CreateRadiusAttr(12)
    ball.AddTranslateOp().Set(Gf.Vec3d(25, -40, -20))
    set_primvar(ball.GetPrim(), "displayColor", T.Color3fArray, "constant", [(0.25, 0.5, 0.75)])
    camera = UsdGeom.Camera.Define(stage, "/cam")
    camera.AddTransformOp().Set(LOOK)
    camera.CreateFocalLengthAttr(50)
    camera.CreateHorizontalApertureAttr(36)
    camera.CreateVerticalApertureAttr(24)
    camera.CreateFStopAttr(2)
    camera.CreateFocusDistanceAttr(200)
    stage.Save()
    return path


@pytest.fixture
def picture(renderer: FrameRenderer, path: Path) -> Picture:
    return take(renderer, path, (*NAMES, *PRIMVARS))


def take(renderer: FrameRenderer, path: Path, aovs: tuple[str, ...]) -> Picture:
    return make_picture(renderer, Shot.open(path), "/cam", 1.0, FrameSettings(WIDTH, HEIGHT, rays=2, aovs=aovs))


def seen(picture: Picture, path: str) -> np.ndarray:
    return picture.frame.aovs["primId"] == picture.frame.prim_paths.index(path)


def stage_points(picture: Picture) -> np.ndarray:
    """``(height, width, 3)`` positions in the stage's world, from camera space by the camera's own matrix."""
    matrix = np.array(LOOK)
    return picture.frame.aovs["Peye"] @ matrix[:3, :3] + matrix[3, :3]


def test_depths_are_in_metres_or_in_scene_units(picture: Picture) -> None:
    aovs = picture.frame.aovs
    something = aovs["primId"] >= 0

    np.testing.assert_allclose(aovs["cameraDepth"][something], 100 * aovs["depth"][something], rtol=1e-6)
    np.testing.assert_array_equal(aovs["Peye"][..., 2], -aovs["cameraDepth"])
    assert (aovs["cameraDepth"][~something] == 0).all()
    assert np.isinf(aovs["depth"][~something]).all()


def test_positions_lie_on_the_surfaces(picture: Picture) -> None:
    points = stage_points(picture)

    on_ball = np.linalg.norm(points[seen(picture, "/ball")] - [25, -40, -20], axis=1)
    np.testing.assert_allclose(on_ball, 11.75, atol=0.26)  # it is made of flat faces
    wall = points[seen(picture, "/wall")]
    np.testing.assert_allclose(wall[:, 1], np.maximum(0.5 * wall[:, 0], 0), atol=2e-3)


def test_normals_face_the_camera_in_the_world_of_the_stage(picture: Picture) -> None:
    normals, points = picture.frame.aovs["normal"], stage_points(picture)

    ball = seen(picture, "/ball")
    np.testing.assert_allclose(normals[ball], (points[ball] - [25, -40, -20]) / 12, atol=0.05)
    for flat in ("/card", "/many"):
        np.testing.assert_allclose(normals[seen(picture, flat)], [[0, -1, 0]] * seen(picture, flat).sum(), atol=1e-6)
    second = picture.frame.aovs["elementId"] == 1
    second &= seen(picture, "/wall")
    np.testing.assert_allclose(normals[second], [np.array([0.5, -1, 0]) / np.sqrt(1.25)] * second.sum(), atol=1e-6)
    something = picture.frame.aovs["primId"] >= 0
    np.testing.assert_allclose(np.linalg.norm(normals[something], axis=1), 1, atol=1e-6)
    assert (np.sum(normals * (np.array(EYE) - points), axis=2)[something] > -1).all()


def test_eye_normals_are_the_normals_in_camera_space(picture: Picture) -> None:
    matrix = np.array(LOOK)

    turned = picture.frame.aovs["Neye"] @ matrix[:3, :3]

    np.testing.assert_allclose(turned, picture.frame.aovs["normal"], atol=1e-6)


def test_ids_are_those_of_hydra(picture: Picture) -> None:
    aovs = picture.frame.aovs

    assert {aovs[name].dtype for name in ("primId", "instanceId", "elementId")} == {np.dtype(np.int32)}
    np.testing.assert_array_equal(aovs["primId"], aovs["prim_id"].astype(np.int64) - 1)
    assert set(np.unique(aovs["instanceId"][seen(picture, "/many")])) == {7, 9}
    assert (aovs["instanceId"][~seen(picture, "/many")] == -1).all()
    assert set(np.unique(aovs["elementId"][seen(picture, "/wall")])) == {0, 1}
    nothing = aovs["primId"] == -1
    assert nothing.any()
    assert (aovs["elementId"][nothing] == -1).all()


def test_primvars_are_interpolated_as_they_say(picture: Picture) -> None:
    aovs, points = picture.frame.aovs, stage_points(picture)
    wall, face = seen(picture, "/wall"), picture.frame.aovs["elementId"]
    left, right = wall & (face == 0), wall & (face == 1)

    np.testing.assert_array_equal(aovs["primvars:flow"][left], [[1, 2, 3, 4]] * left.sum())
    np.testing.assert_array_equal(aovs["primvars:flow"][right], [[5, 6, 7, 8]] * right.sum())
    many = seen(picture, "/many")
    np.testing.assert_array_equal(aovs["primvars:flow"][many], [[0.25, 0.5, 0, 0]] * many.sum())
    assert (aovs["primvars:heat"][~wall] == 0).all(), "only the wall has it"

    # in the left face's triangle of the corners 0, 1 and 2: x from -60 to 0, z from -40 to 40
    x, z = (points[..., 0] + 60) / 60, (points[..., 2] + 40) / 80
    lower = left & (z < x - 0.02)
    np.testing.assert_allclose(aovs["primvars:heat"][lower], (1 + x + 2 * z)[lower], atol=2e-3)
    np.testing.assert_allclose(aovs["primvars:st"][lower][:, 0], (x / 8 + z / 8)[lower], atol=2e-3)
    ball = seen(picture, "/ball")
    np.testing.assert_allclose(aovs["primvars:displayColor"][ball], [[0.25, 0.5, 0.75]] * ball.sum(), atol=1e-6)


def test_native_instances_have_what_they_inherit(renderer: FrameRenderer, tmp_path: Path) -> None:
    """Two instances of one dense mesh, drawn as one, with a primvar each."""
    stage = Usd.Stage.CreateNew(str(tmp_path / "instances.usda"))
    dense_grid(stage, "/_kind/grid")
    stage.GetPrimAtPath("/_kind").SetSpecifier(Sdf.SpecifierClass)
    for i, heat in enumerate((3.0, 5.0)):
        prim = UsdGeom.Xform.Define(stage, f"/i{i}").GetPrim()
        prim.GetReferences().AddInternalReference("/_kind")
        prim.SetInstanceable(True)
        UsdGeom.XformCommonAPI(prim).SetTranslate((2.0 * i - 1.5, -0.5, -4))
        set_primvar(prim, "heat", T.Float, "constant", heat)
    UsdGeom.Camera.Define(stage, "/cam").CreateClippingRangeAttr(Gf.Vec2f(0.1, 100))
    stage.Save()
    aovs = ("color", "primvars:heat")
    settings = FrameSettings(WIDTH, HEIGHT, engine="pinhole", rays=1, aovs=aovs)
    heat_seen = make_picture(renderer, Shot.open(tmp_path / "instances.usda"), "/cam", 1.0, settings).frame.aovs[
        aovs[1]
    ]
    assert set(np.unique(heat_seen[:, : WIDTH // 2])) == {0.0, 3.0}
    assert set(np.unique(heat_seen[:, WIDTH // 2 :])) == {0.0, 5.0}


def test_a_file_has_them_as_parts(picture: Picture, tmp_path: Path) -> None:
    file = tmp_path / "a.exr"
    file.write_bytes(encode("exr", picture.frame, picture.graded, picture.metadata))

    parts = {}
    for i in range(OpenImageIO.ImageBuf(str(file)).nsubimages):
        image = OpenImageIO.ImageBuf(str(file), i, 0)
        spec = image.spec()
        parts[spec["oiio:subimagename"]] = (spec.channelnames, str(spec.format), image.get_pixels(spec.format), spec)

    kinds = {name: part[:2] for name, part in parts.items()}
    assert kinds["Peye"] == (("X", "Y", "Z"), "float")
    assert kinds["primId"] == (("id",), "uint")
    assert kinds["primvars:st"] == (("R", "G"), "float")
    assert kinds["primvars:heat"] == (("R",), "float")
    np.testing.assert_array_equal(parts["Neye"][2], picture.frame.aovs["Neye"])
    for name in ("primId", "prim_id"):
        ids, paths = parts[name][2][..., 0], json.loads(parts[name][3]["pullfocus:primPaths"])
        assert {paths[str(i)] for i in np.unique(ids) if str(i) in paths} == {"/wall", "/card", "/many", "/ball"}
        np.testing.assert_array_equal(ids == int({v: k for k, v in paths.items()}["/ball"]), seen(picture, "/ball"))


def test_a_primvar_that_no_prim_has_is_refused_at_once(path: Path) -> None:
    shot = Shot.open(path)
    settings = FrameSettings(WIDTH, HEIGHT, aovs=("color", "primvars:colour"))
    camera = shot.camera_at("/cam", 1.0, WIDTH, HEIGHT)
    no_renderer = cast(FrameRenderer, None)

    with pytest.raises(SettingsError, match="no prim that is drawn has a primvar colour of one to four numbers"):
        expose_frame(no_renderer, shot, "/cam", camera, 1.0, settings)


def test_a_name_that_is_no_aov_is_refused() -> None:
    with pytest.raises(SettingsError, match=r"aov must be one of color, depth.*primvars:NAME, got 'primvars:'"):
        FrameSettings(aovs=("primvars:",))
