"""`pullfocus record --stereo` writes the pictures of both eyes of a rig."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest
from numpy.typing import NDArray
from pxr import Gf, Usd, UsdGeom, UsdRender

from render.cli.options.stereo import view_pattern
from render.shot import Shot
from render.shot.inspection import inspect_shot
from render.stage import list_pairs, pair_of
from tests.render.kits.cli_shots import Command
from tests.render.kits.stages import add_mesh, new_stage
from usd_schemas import LensCamera

WIDTH, HEIGHT = 160, 90
INTERAXIAL = 0.2
DEPTHS = (2.0, 8.0)


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    """A rig of two parallel cameras 0.2 m apart, and two small squares of unlike colours 2 m and 8 m in front of its middle."""
    stage = new_stage()
    for depth, height, color in zip(DEPTHS, (-0.1, 0.1), ((1, 0, 0), (0, 0, 1)), strict=True):
        half, y = 0.02 * depth, height * depth
        quad = [(x * half, y + v * half, -depth) for x, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        add_mesh(stage, f"/at{depth:g}", quad).CreateDisplayColorAttr([color])
    UsdGeom.Xform.Define(stage, "/rig")
    for role, x in (("left", -INTERAXIAL / 2), ("right", INTERAXIAL / 2)):
        camera = UsdGeom.Camera.Define(stage, f"/rig/{role}")
        camera.AddTranslateOp().Set(Gf.Vec3d(x, 0, 0))
        camera.CreateStereoRoleAttr(role)
        camera.CreateHorizontalApertureAttr(0.4)
        camera.CreateVerticalApertureAttr(0.225)
        camera.CreateFocalLengthAttr(0.5)
        camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 100))
    UsdGeom.Camera.Define(stage, "/rig/middle")
    UsdGeom.Camera.Define(stage, "/elsewhere")
    stage.Export(f"{tmp_path}/rig.usda")
    return tmp_path / "rig.usda"


def parts(path: Path) -> dict[str, tuple[OpenImageIO.ImageSpec, NDArray[np.float32]]]:
    """Parts of an EXR by name."""
    found, file = {}, OpenImageIO.ImageInput.open(str(path))
    while file.seek_subimage(len(found), 0):
        spec = file.spec()
        found[spec["oiio:subimagename"]] = spec, file.read_image(len(found), 0, 0, spec.nchannels, "float")
    return found


def centre(coverage: NDArray[np.float32]) -> float:
    """Mean column of the light of a picture ``(height, width)``."""
    return float((coverage.sum(axis=0) * (np.arange(coverage.shape[1]) + 0.5)).sum() / coverage.sum())


def record(command: Command, rig: Path, out: Path, *more: object) -> list[dict[str, object]]:
    small = ("--imageWidth", WIDTH, "--rays", 16, "--supersample", 2, "--shading", "unlit", "--no-adaptive", "--json")
    ended = command("record", rig, out, "--stereo", *small, *more)
    assert ended.status == 0, ended.err
    return list(json.loads(ended.out)["frames"])


@pytest.mark.gl
def test_an_exr_holds_both_views_apart_by_their_disparity(command: Command, rig: Path, tmp_path: Path) -> None:
    (entry,) = record(command, rig, tmp_path / "both.exr", "--aov", "color,depth,cryptoObject")
    assert entry["views"] == ["left", "right"]
    found = parts(tmp_path / "both.exr")
    kinds = ("rgba", "depth", "cryptoObject")
    assert list(found) == [f"{kind}.{view}" for view in ("left", "right") for kind in kinds]
    for name, (spec, _) in found.items():
        assert spec.getattribute("view") == name.rpartition(".")[2]
        assert spec.getattribute("cameraLabel") == f"/rig/{name.rpartition('.')[2]}"
    assert found["rgba.left"][0].channelnames == ("R", "G", "B", "A")
    assert "cryptomatte" in "".join(attribute.name for attribute in found["rgba.left"][0].extra_attribs)
    f_px = WIDTH * 0.5 / 0.4  # edges lie between pixels of the layers
    for row, depth in ((slice(HEIGHT // 2, None), DEPTHS[0]), (slice(None, HEIGHT // 2), DEPTHS[1])):
        left, right = (centre(found[f"rgba.{view}"][1][row, :, 3]) for view in ("left", "right"))
        assert left - right == pytest.approx(f_px * INTERAXIAL / depth, abs=0.02)
        assert left + right == pytest.approx(WIDTH, abs=0.02)


@pytest.mark.gl
def test_pictures_and_named_views_have_files_of_their_own(command: Command, rig: Path, tmp_path: Path) -> None:
    entries = record(command, rig, tmp_path / "shot.####.png", "--frames", "7:8")
    names = [f"shot.{view}.000{frame}.png" for frame in (7, 8) for view in ("left", "right")]
    assert [Path(str(entry["file"])).name for entry in entries] == names
    pictures = [OpenImageIO.ImageBuf(str(tmp_path / name)).get_pixels() for name in names]
    assert abs(pictures[0] - pictures[1]).max() > 0.5
    np.testing.assert_array_equal(pictures[0], pictures[2])
    record(command, rig, tmp_path / "eyes" / "%V" / "one.exr", "--camera", "middle")
    assert sorted(path.parent.name for path in (tmp_path / "eyes").rglob("*.exr")) == ["left", "right"]
    entries = record(command, rig, tmp_path / "one_%V.exr", "--camera", "middle")
    assert [entry["views"] for entry in entries] == [["left"], ["right"]]
    for view in ("left", "right"):
        ((name, (spec, _)),) = parts(tmp_path / f"one_{view}.exr").items()
        assert (name, spec.getattribute("view")) == ("rgba", view)


@pytest.mark.gl
def test_a_metered_pair_has_one_exposure(command: Command, rig: Path, tmp_path: Path) -> None:
    stage = Usd.Stage.Open(str(rig))
    add_mesh(stage, "/wall", [(x, y, -20.0) for x, y in ((0, -9), (9, -9), (9, 9), (0, 9))])
    left = LensCamera(stage.GetPrimAtPath("/rig/left"))
    left.prim.AddAppliedSchema("FilmAPI")
    left.prim.GetAttribute("film:metering:mode").Set("average")
    stage.Save()
    record(command, rig, tmp_path / "both.exr")
    found = parts(tmp_path / "both.exr")
    scales = [found[f"rgba.{view}"][0].getattribute("pullfocus:exposureScale") for view in ("left", "right")]
    assert scales[0] == scales[1] != 1


@pytest.mark.parametrize(
    ("out", "left"),
    [
        ("shot.exr", "shot.exr"),
        ("shot.png", "shot.left.png"),
        ("shot.####.jpg", "shot.left.####.jpg"),
        ("shot####.png", "shot.left.####.png"),
        ("a.b/shot_####.png", "a.b/shot.left_####.png"),
        ("####.png", "left.####.png"),
        ("%V/shot.####.png", "left/shot.####.png"),
        ("shot_%v.exr", "shot_l.exr"),
    ],
)
def test_the_eye_stands_before_the_frame_number(out: str, left: str) -> None:
    assert view_pattern(out, "left") == left


def two_rigs() -> Usd.Stage:
    stage = new_stage()
    roles = {"a/l": "left", "a/r": "right", "b/eyes/l": "left", "b/far/r": "right", "b/c": "mono", "d/l": "left"}
    for path, role in roles.items():
        UsdGeom.Camera.Define(stage, f"/{path}").CreateStereoRoleAttr(role)
    return stage


def test_cameras_of_one_rig_are_a_pair() -> None:
    stage = two_rigs()
    cameras = [str(prim.GetPath()) for prim in stage.Traverse() if prim.IsA(UsdGeom.Camera)]
    pairs = list_pairs(stage, cameras)
    assert [(pair.left, pair.right) for pair in pairs] == [("/a/l", "/a/r"), ("/b/eyes/l", "/b/far/r")]
    assert pair_of(pairs, "/a/r") is pairs[0]
    assert pair_of(pairs, "/b/c") is pairs[1]
    assert pair_of(pairs, "/d/l") is None
    assert pair_of(pairs, "/top") is None
    UsdGeom.Camera.Define(stage, "/a/other").CreateStereoRoleAttr("right")
    assert len(list_pairs(stage, [*cameras, "/a/other"])) == 1


def test_each_eye_has_what_the_other_alone_says(rig: Path) -> None:
    stage = Usd.Stage.Open(str(rig))
    left, right = (UsdGeom.Camera(stage.GetPrimAtPath(f"/rig/{role}")) for role in ("left", "right"))
    left.CreateFocusDistanceAttr().Set(2.0, 1)
    left.GetFocusDistanceAttr().Set(8.0, 11)
    left.CreateFStopAttr(2.8)
    left.CreateHorizontalApertureOffsetAttr(0.01)
    left.GetPrim().AddAppliedSchema("LensAPI")
    left.GetPrim().GetAttribute("lens:name").Set("fifty")
    right.CreateFStopAttr(4.0)
    right.CreateExposureAttr(1.5)
    stage.Save()
    shot = Shot.open(rig)
    assert shot.camera.share_settings("/rig/left", "/rig/right") == ()
    cameras = [shot.camera_at(f"/rig/{role}", 6, WIDTH, HEIGHT) for role in ("left", "right")]
    assert [camera.focus_distance_m for camera in cameras] == [5, 5]
    assert [camera.f_stop for camera in cameras] == pytest.approx([2.8, 4])
    assert [camera.lens.name for camera in cameras] == ["fifty", "fifty"]
    assert [camera.horizontal_offset_mm for camera in cameras] == pytest.approx([1, 0])
    assert cameras[0].exposure_scale == cameras[1].exposure_scale == pytest.approx(2**1.5)
    positions = [camera.world_from_camera[0, 3] for camera in cameras]
    assert positions == [-INTERAXIAL / 2, INTERAXIAL / 2]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("--camera", "/elsewhere"),
            "/elsewhere belongs to no pair of cameras, the pairs are: /rig/left and /rig/right",
        ),
        (("--progressive",), "leave out --progressive"),
        (("--contact-sheet", "fStop=2,4"), "leave out --contact-sheet"),
    ],
)
def test_what_is_no_pair_is_refused(command: Command, rig: Path, arguments: tuple[str, ...], message: str) -> None:
    ended = command("record", rig, rig.with_name("out.png"), "--stereo", *arguments)
    assert ended.status != 0
    assert message in ended.err


def test_a_stage_without_a_pair_says_so(command: Command, rig: Path) -> None:
    stage = Usd.Stage.Open(str(rig))
    stage.RemovePrim("/rig/left")
    stage.Save()
    ended = command("record", rig, rig.with_name("out.exr"), "--stereo")
    assert ended.status != 0
    assert "needs two cameras with stereoRole left and right, and rig.usda has no pair" in ended.err


def test_inspection_shows_roles_and_pairs(command: Command, rig: Path) -> None:
    inspection = inspect_shot(Shot.open(rig))
    assert inspection.stereo_roles == {"/rig/left": "left", "/rig/right": "right"}
    assert [(pair.left, pair.right) for pair in inspection.stereo_pairs] == [("/rig/left", "/rig/right")]
    assert "left eye, with /rig/right" in command("inspect", rig).out
    told = json.loads(command("inspect", rig, "--json").out)
    assert told["stereoPairs"] == [{"left": "/rig/left", "right": "/rig/right"}]
    stage = Usd.Stage.Open(str(rig))
    UsdGeom.Camera(stage.GetPrimAtPath("/rig/right")).GetStereoRoleAttr().Set("centre")
    stage.Save()
    assert "left eye, of no pair" in command("inspect", rig).out
    assert "bad_stereo_role" in {finding.code for finding in Shot.open(rig).findings()}


@pytest.mark.gl
@pytest.mark.parametrize("stereo", [False, True])
def test_a_product_has_both_eyes_where_that_is_asked_for(
    command: Command, rig: Path, tmp_path: Path, stereo: bool
) -> None:
    stage = Usd.Stage.Open(str(rig))
    settings = UsdRender.Settings.Define(stage, "/Render/settings")
    settings.CreateResolutionAttr(Gf.Vec2i(32, 18))
    stage.SetMetadata("renderSettingsPrimPath", "/Render/settings")
    for name, camera in (("one.exr", "/rig/right"), ("two.png", "/rig/right"), ("three.png", "/elsewhere")):
        product = UsdRender.Product.Define(stage, f"/Render/{name[:-4]}")
        product.CreateProductNameAttr(name)
        product.CreateCameraRel().SetTargets([camera])
        settings.CreateProductsRel().AddTarget(product.GetPath())
    stage.Save()
    ended = command("record", rig, tmp_path / "out", "--products", "--json", "--rays", 4, *["--stereo"] * stereo)
    assert ended.status == 0, ended.err
    entries = json.loads(ended.out)["frames"]
    files = {Path(entry["file"]).name: entry.get("views") for entry in entries}
    assert {path.name for path in (tmp_path / "out").iterdir()} == set(files)
    if stereo:
        both = {"one.exr": ["left", "right"], "two.left.png": ["left"], "two.right.png": ["right"], "three.png": None}
        assert files == both
        assert list(parts(tmp_path / "out" / "one.exr")) == ["rgba.left", "rgba.right"]
        assert entries[0]["cameras"] == {"left": "/rig/left", "right": "/rig/right"}
    else:
        assert files == dict.fromkeys(("one.exr", "two.png", "three.png"))
        assert entries[0]["camera"] == "/rig/right"
