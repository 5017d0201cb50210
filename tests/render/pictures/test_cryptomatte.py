"""Cryptomatte of shots: files decoded by the specification, names of the stage, and an open shutter."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade

from render.frame import FrameRenderer, FrameSettings
from render.output import encode
from render.pictures.picture import Picture, make_picture
from render.shot import Shot
from tests.render.kits.cryptomattes import Cryptomatte, read_cryptomattes
from tests.render.kits.moving_shots import add_card, key_move

pytestmark = pytest.mark.gl

SETTINGS = FrameSettings(
    96,
    54,
    rays=32,
    supersample=1,
    shading="unlit",
    adaptive=False,
    connections=False,
    aovs=("color", "prim_id", "cryptoObject", "cryptoMaterial"),
)


def add_camera(stage: Usd.Stage) -> None:
    camera = UsdGeom.Camera.Define(stage, "/cam")
    camera.CreateFocalLengthAttr(0.3)
    camera.CreateHorizontalApertureAttr(0.36)
    camera.CreateVerticalApertureAttr(0.2025)
    camera.CreateFStopAttr(0.14)
    camera.CreateFocusDistanceAttr(3.0)
    camera.CreateShutterOpenAttr(0.0)
    camera.CreateShutterCloseAttr(0.5)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 100))


def bind(stage: Usd.Stage, prim: Usd.Prim, material: str) -> None:
    made = UsdShade.Material.Define(stage, material)
    shader = UsdShade.Shader.Define(stage, f"{material}/surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0.5, 0.25, 0.125))
    made.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    UsdShade.MaterialBindingAPI.Apply(prim).Bind(made)


def take(renderer: FrameRenderer, stage: Usd.Stage, path: Path, settings: FrameSettings = SETTINGS) -> Picture:
    stage.GetRootLayer().Export(str(path))
    return make_picture(renderer, Shot.open(path), "/cam", 1.0, settings)


def decode(picture: Picture, file: Path) -> dict[str, Cryptomatte]:
    file.write_bytes(encode("exr", picture.frame, picture.graded, picture.metadata))
    return read_cryptomattes(file)


def test_a_file_decodes_to_what_is_in_the_picture(renderer: FrameRenderer, tmp_path: Path) -> None:
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    for i, name in enumerate(("left", "middle", "right")):
        card = add_card(stage, f"/cards/{name}", size=(0.8, 1.5), depth=2.0 + i, colour=(1, 1, 1))
        card.AddTranslateOp().Set(Gf.Vec3d(0.9 * (i - 1), 0, 0))
        if name != "middle":
            bind(stage, card.GetPrim(), f"/looks/{name}")  # they look the same
    add_card(stage, "/out_of_sight", size=(1, 1), depth=-3, colour=(1, 1, 1))
    add_camera(stage)
    picture = take(renderer, stage, tmp_path / "cards.usda")

    mattes = decode(picture, tmp_path / "cards.exr")

    assert set(mattes) == {"cryptoObject", "cryptoMaterial"}
    objects, materials = mattes["cryptoObject"], mattes["cryptoMaterial"]
    assert set(objects.manifest) == {"/cards/left", "/cards/middle", "/cards/right"}
    assert set(materials.manifest) == {"/looks/left", "default", "/looks/right"}
    for matte in mattes.values():
        np.testing.assert_allclose(matte.coverage.sum(axis=-1), picture.frame.color[..., 3], atol=2e-6)
        assert (np.diff(matte.coverage, axis=-1) <= 0).all(), "ranks are sorted"
        assert set(np.unique(matte.ids[matte.coverage > 0])) == set(matte.manifest.values())
        assert (matte.ids[matte.coverage == 0] == 0).all()
    for prim, material in (("left", "/looks/left"), ("middle", "default"), ("right", "/looks/right")):
        np.testing.assert_allclose(objects.of(f"/cards/{prim}"), materials.of(material), atol=1e-6)
        number = picture.frame.prim_paths.index(f"/cards/{prim}") + 1
        whole = objects.of(f"/cards/{prim}") > 0.999
        assert whole.sum() > 100
        assert (picture.frame.aovs["prim_id"][whole] == number).all()


def test_parts_of_a_mesh_and_instances_keep_their_materials(renderer: FrameRenderer, tmp_path: Path) -> None:
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    wall = UsdGeom.Mesh.Define(stage, "/wall")
    wall.CreatePointsAttr([Gf.Vec3f(x, y, -3) for y in (-1, 1) for x in (-1, 0, 1)])
    wall.CreateFaceVertexCountsAttr([4, 4])
    wall.CreateFaceVertexIndicesAttr([0, 1, 4, 3, 1, 2, 5, 4])
    wall.CreateDoubleSidedAttr(True)
    bind(stage, wall.GetPrim(), "/looks/one")
    part = UsdGeom.Subset.CreateGeomSubset(wall, "part", "face", [1], "materialBind")
    bind(stage, part.GetPrim(), "/looks/other")
    many = UsdGeom.PointInstancer.Define(stage, "/many")
    kind = add_card(stage, "/many/kind/card", size=(0.2, 0.2), depth=2.5, colour=(1, 1, 1))
    bind(stage, kind.GetPrim(), "/looks/kind")
    many.CreatePrototypesRel().SetTargets(["/many/kind"])
    many.CreateProtoIndicesAttr([0, 0])
    many.CreatePositionsAttr([Gf.Vec3f(-1.2, 0, 0), Gf.Vec3f(1.2, 0, 0)])
    add_camera(stage)

    mattes = decode(take(renderer, stage, tmp_path / "parts.usda"), tmp_path / "parts.exr")

    objects, materials = mattes["cryptoObject"], mattes["cryptoMaterial"]
    assert set(objects.manifest) == {"/wall", "/many"}
    assert set(materials.manifest) == {"/looks/one", "/looks/other", "/looks/kind"}
    both = materials.of("/looks/one") + materials.of("/looks/other")
    np.testing.assert_allclose(both, objects.of("/wall"), atol=1e-6)
    np.testing.assert_allclose(materials.of("/looks/kind"), objects.of("/many"), atol=1e-6)
    left, right = np.s_[:, :46], np.s_[:, 50:]
    assert materials.of("/looks/other")[left].sum() == materials.of("/looks/one")[right].sum() == 0


@pytest.mark.parametrize("opacity", [1.0, 0.5])
@pytest.mark.parametrize("motion_by", ["moments", "velocities"])
def test_mattes_are_as_smeared_as_the_picture(
    renderer: FrameRenderer, tmp_path: Path, motion_by: str, opacity: float
) -> None:
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    add_card(stage, "/wall", size=(2, 2), depth=5, colour=(0, 0, 0))
    moving = add_card(stage, "/moving", size=(0.4, 0.6), depth=2, colour=(1, 1, 1))
    if opacity < 1:
        moving.CreateDisplayOpacityAttr([opacity])
    key_move(moving.AddTranslateOp(), Gf.Vec3d(-0.4, 0, 0), Gf.Vec3d(0.4, 0, 0))
    add_camera(stage)
    settings = replace(SETTINGS, motion=8, motion_by=motion_by)
    picture = take(renderer, stage, tmp_path / "moving.usda", settings)

    objects = decode(picture, tmp_path / "moving.exr")["cryptoObject"]

    color = picture.frame.color
    np.testing.assert_allclose(objects.of("/moving"), color[..., 1], atol=1e-3)  # white is 1 in half precision, nearly
    np.testing.assert_allclose(objects.of("/wall") + objects.of("/moving"), color[..., 3], atol=1e-5)
    smeared = (objects.of("/moving") > 0.05) & (objects.of("/moving") < 0.95 * opacity)
    assert smeared.sum() > 300
