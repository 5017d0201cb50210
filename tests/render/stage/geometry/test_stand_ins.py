"""Models with a draw mode are drawn by stand-ins: axes, the edges of their box, or cards (UsdGeomModelAPI)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom

from render import colour
from render.model.scene import Scene
from render.stage import AnchorReader, StageReader
from render.stage.options import StageOptions
from tests.render.kits.stages import (
    T,
    add_mesh,
    codes,
    instancer,
    new_stage,
    only_batch,
    read,
    world_points,
    write_picture,
)
from usd_schemas import FocusPoint

HALF = np.array([1.0, 2.0, 3.0])
MIDDLE = np.array([5.0, 0.0, 0.0])
RED = Gf.Vec3f(0.5, 0.1, 0.2)


def add_model(stage: Usd.Stage, path: str = "/set/model", kind: str = "component", **attributes: object) -> Usd.Prim:
    """A model in a group: a box of half sizes `HALF` around (5, 0, 0)."""
    Usd.ModelAPI(UsdGeom.Xform.Define(stage, Sdf.Path(path).GetPrefixes()[0])).SetKind("group")
    model = UsdGeom.Xform.Define(stage, path)
    model.AddTranslateOp().Set(Gf.Vec3d(5, 0, 0))
    points = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * HALF
    add_mesh(stage, f"{path}/box", points, [4, 4], [0, 1, 3, 2, 4, 6, 7, 5])
    Usd.ModelAPI(model).SetKind(kind)
    prim = model.GetPrim()
    UsdGeom.ModelAPI.Apply(prim)
    for name, value in attributes.items():
        prim.GetAttribute(f"model:{name}").Set(value)
    return prim


def picture(tmp_path: Path, name: str = "card.png", channels: int = 3) -> str:
    pixels = np.full((2, 2, channels), 255, np.uint8)
    pixels[0, 0, 0] = 0
    return write_picture(tmp_path / name, pixels)


def box_of(scene: Scene) -> np.ndarray:
    points = np.concatenate([world_points(batch) for batch in scene.batches])
    return np.stack([points.min(axis=0), points.max(axis=0)])


def test_bounds_are_bars_along_the_edges_of_the_box() -> None:
    stage = new_stage()
    add_model(stage, drawMode="bounds", drawModeColor=RED)
    scene = read(stage)
    batch = only_batch(scene)
    out = np.linalg.norm(2 * HALF) / 300 / 2
    np.testing.assert_allclose(box_of(scene), [MIDDLE - HALF - out, MIDDLE + HALF + out], atol=1e-5)
    inside = np.abs(world_points(batch) - MIDDLE) < HALF - 2 * out
    assert (inside.sum(axis=1) == 0).all()  # bars end in corners, and none goes through the box
    assert len(batch.geometry.triangles) == 12 * 12
    assert batch.material.base_color == pytest.approx(colour.rgb_to_working(tuple(RED)))
    assert scene.prim_paths[int(batch.geometry.prim_ids[0])] == "/set/model"


def test_origin_is_three_axes_of_one_unit() -> None:
    stage = new_stage()
    add_model(stage, drawMode="origin")
    points = world_points(only_batch(read(stage))) - MIDDLE
    out = 1 / 60 / 2
    assert points.min() == pytest.approx(-out, abs=1e-6)
    np.testing.assert_allclose(points.max(axis=0), 1 + out, atol=1e-6)
    assert (np.sort(points, axis=1)[:, :2] <= out + 1e-6).all()


@pytest.mark.parametrize(
    ("kind", "applies", "replaced"),
    [("component", None, True), ("component", False, False), ("group", None, False), ("assembly", True, True)],
)
def test_components_and_those_that_apply_it_are_replaced(kind: str, applies: bool | None, replaced: bool) -> None:
    stage = new_stage()
    prim = add_model(stage, kind=kind, drawMode="bounds")
    if applies is not None:
        prim.GetAttribute("model:applyDrawMode").Set(applies)
    assert (len(only_batch(read(stage)).geometry.triangles) == 12 * 12) == replaced


def test_modes_are_inherited_down_to_models_and_prune_below() -> None:
    stage = new_stage()
    add_model(stage, "/set/one")
    add_model(stage, "/set/two", drawMode="default")
    add_model(stage, "/set/three", kind="assembly", applyDrawMode=True)
    add_model(stage, "/set/three/inner", drawMode="cards")
    UsdGeom.ModelAPI.Apply(stage.GetPrimAtPath("/set")).CreateModelDrawModeAttr("bounds")
    scene = read(stage)
    drawn = {scene.prim_paths[i] for batch in scene.batches for i in np.unique(batch.geometry.prim_ids)}
    assert drawn == {"/set/one", "/set/two/box", "/set/three"}
    shown = StageReader(stage, StageOptions(draw_modes=False)).read(0.0)
    assert all(path.endswith("/box") for path in shown.prim_paths)


def test_box_cards_cover_the_faces_and_face_out() -> None:
    stage = new_stage()
    add_model(stage, drawMode="cards", cardGeometry="box")
    batch = only_batch(read(stage))
    points, triangles = world_points(batch) - MIDDLE, batch.geometry.triangles
    assert len(triangles) == 12
    assert not batch.double_sided
    assert batch.culls_backs
    corners = points[triangles]
    np.testing.assert_allclose(np.abs(points), np.tile(HALF, (len(points), 1)), atol=1e-6)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ni,ni->n", normals, corners.mean(axis=1)) > 0).all()
    np.testing.assert_allclose(
        batch.geometry.normals[triangles[:, 0]], normals / np.linalg.norm(normals, axis=1)[:, None]
    )


def test_cross_cards_stand_in_the_middle() -> None:
    stage = new_stage()
    add_model(stage, drawMode="cards")
    points = world_points(only_batch(read(stage))) - MIDDLE
    assert len(points) == 24
    assert (np.sum(np.abs(points) < 1e-6, axis=1) == 1).all()


UPRIGHT = {
    "XPos": ((0, 1, 0), (0, 0, 1)),
    "XNeg": ((0, -1, 0), (0, 0, 1)),
    "YPos": ((-1, 0, 0), (0, 0, 1)),
    "YNeg": ((1, 0, 0), (0, 0, 1)),
    "ZPos": ((1, 0, 0), (0, 1, 0)),
    "ZNeg": ((1, 0, 0), (0, -1, 0)),
}
"""Directions of s and t of each side: not mirrored for who looks at it."""


@pytest.mark.parametrize("side", UPRIGHT)
def test_textures_are_upright_and_the_other_side_mirrored(side: str, tmp_path: Path) -> None:
    stage = new_stage()
    add_model(stage, drawMode="cards", cardGeometry="box", **{f"cardTexture{side}": picture(tmp_path)})
    batch = only_batch(read(stage))
    assert set(batch.material.lookups) == {"base_color"}
    points = (world_points(batch) - MIDDLE) / HALF
    assert len(points) == 8  # the other axes have no texture, and no card
    along = np.array(UPRIGHT[side], float)
    np.testing.assert_allclose(batch.geometry.uvs, (points @ along.T + 1) / 2, atol=1e-6)


def test_each_side_has_its_own_texture_and_cuts_out_its_alpha(tmp_path: Path) -> None:
    stage = new_stage()
    files = {f"cardTexture{side}": picture(tmp_path, f"{side}.png", 4) for side in ("XPos", "XNeg")}
    add_model(stage, drawMode="cards", **files)
    scene = read(stage)
    assert [len(batch.geometry.triangles) for batch in scene.batches] == [2, 2]
    for batch, sign in zip(scene.batches, (1, -1), strict=True):
        assert batch.material.opacity_threshold == pytest.approx(0.1)
        assert batch.material.lookups["opacity"].channel == 3
        np.testing.assert_allclose(batch.geometry.normals, [[sign, 0, 0]] * 4, atol=1e-6)


def test_a_missing_texture_gives_way_to_the_colour() -> None:
    stage = new_stage()
    add_model(stage, drawMode="cards", cardTextureXPos="nothing.png", drawModeColor=RED)
    reader = StageReader(stage)
    batch = only_batch(reader.read(0.0))
    assert batch.material.base_color == pytest.approx(colour.rgb_to_working(tuple(RED)))
    assert "texture_unreadable" in codes(reader)


@pytest.mark.parametrize("up", ["Y", "Z"])
def test_simple_cards_leave_out_the_up_axis(up: str) -> None:
    stage = new_stage(up=up)
    add_model(stage, drawMode="cards")
    UsdGeom.ModelAPI.Apply(stage.GetPrimAtPath("/set"))
    stage.GetPrimAtPath("/set").GetAttribute("model:cardVisibility").Set("simple")
    geometry = only_batch(read(stage)).geometry
    assert set(np.abs(geometry.normals).argmax(axis=1)) == {
        0,
        2,
    }  # in the world, where Y is up, whatever it is on the stage
    assert len(geometry.triangles) == 8


def test_from_texture_places_cards_by_their_matrix(tmp_path: Path) -> None:
    stage = new_stage()
    place = Gf.Matrix4d().SetScale(Gf.Vec3d(2, 3, 1)) * Gf.Matrix4d().SetTranslate(Gf.Vec3d(7, 8, 9))
    file = tmp_path / "placed.exr"
    output, spec = oiio.ImageOutput.create(str(file)), oiio.ImageSpec(2, 2, 3, "half")
    spec.attribute("worldtoscreen", oiio.TypeDesc("matrix"), tuple(np.array(place.GetInverse()).ravel().tolist()))
    assert output.open(str(file), spec)
    assert output.write_image(np.ones((2, 2, 3), np.float32))
    output.close()
    add_model(stage, drawMode="cards", cardGeometry="fromTexture", cardTextureXPos=str(file), cardTextureYPos="no.exr")
    reader = StageReader(stage)
    batch = only_batch(reader.read(0.0))
    points = world_points(batch) - MIDDLE
    np.testing.assert_allclose(points[:, 2], 9, atol=1e-6)
    np.testing.assert_allclose(batch.geometry.uvs, (points[:, :2] - [7, 8]) / [2, 3] * [0.5, -0.5] + 0.5, atol=1e-6)
    assert "draw_mode" in codes(reader)


def test_bounds_follow_what_moves_inside() -> None:
    stage = new_stage()
    prim = add_model(stage, drawMode="bounds")
    shift = UsdGeom.Xformable(stage.GetPrimAtPath("/set/model/box")).AddTranslateOp()
    shift.Set(Gf.Vec3d(0, 0, 0), 0)
    shift.Set(Gf.Vec3d(0, 10, 0), 10)
    reader = StageReader(stage)
    boxes = [box_of(reader.read(time)) for time in (0.0, 5.0)]
    np.testing.assert_allclose(boxes[1] - boxes[0], [[0, 5, 0]] * 2, atol=1e-5)
    UsdGeom.ModelAPI(prim).SetExtentsHint([Gf.Vec3f(-1), Gf.Vec3f(1)])
    assert box_of(StageReader(stage).read(5.0))[1] == pytest.approx([6, 1, 1], abs=0.02)


def test_a_click_on_a_stand_in_stays_on_it() -> None:
    stage = new_stage()
    add_model(stage, drawMode="cards", cardGeometry="box")
    batch = only_batch(read(stage))
    corners = world_points(batch)[batch.geometry.triangles[5]]
    face, fan = int(batch.geometry.face_ids[5]), int(batch.geometry.fan_ids[5])
    point = FocusPoint("p", ("/set/model",), face=face, fan_triangle=fan, barycentric=(0.5, 0.25, 0.25))
    want = np.array([0.5, 0.25, 0.25]) @ corners
    np.testing.assert_allclose(AnchorReader(stage).position(point, 0.0), want, atol=1e-6)


def test_stand_ins_in_native_and_point_instances() -> None:
    stage = new_stage()
    add_model(stage, "/set/model", drawMode="bounds")
    inside = add_model(stage, "/proto/inner", drawMode="bounds").GetPath()
    for number in range(2):
        prim = UsdGeom.Xform.Define(stage, f"/set/i{number}").GetPrim()
        Usd.ModelAPI(prim).SetKind("group")
        prim.GetReferences().AddInternalReference(inside.GetParentPath())
        prim.SetInstanceable(True)
    instancer(stage, "/set/many", ["/set/model"], [0, 0, 0])
    scene = read(stage)
    assert "/set/i1/inner" in scene.prim_paths
    assert scene.triangle_count == 144 * (1 + 1 + 2 + 3)


def test_an_instancer_that_is_a_model_is_replaced_as_a_whole() -> None:
    stage = new_stage()
    Usd.ModelAPI(UsdGeom.Xform.Define(stage, "/set")).SetKind("group")
    add_mesh(stage, "/set/many/quad")
    prim = instancer(stage, "/set/many", ["/set/many/quad"], [0, 0, 0]).GetPrim()
    Usd.ModelAPI(prim).SetKind("component")
    UsdGeom.ModelAPI.Apply(prim).CreateModelDrawModeAttr("bounds")
    scene = read(stage)
    assert scene.triangle_count == 144
    np.testing.assert_allclose(box_of(scene), [[0, 0, 0], [21, 1, 0]], atol=0.05)


@pytest.mark.parametrize(
    ("attribute", "value"),
    [("drawMode", "wires"), ("cardGeometry", "round"), ("drawModeColor", Gf.Vec3f(float("nan")))],
)
def test_odd_values_are_named_and_the_rest_is_drawn(attribute: str, value: object) -> None:
    stage = new_stage()
    prim = add_model(stage, drawMode="cards")
    prim.GetAttribute(f"model:{attribute}").Set(value)
    reader = StageReader(stage)
    assert reader.read(0.0).triangle_count > 0
    assert codes(reader) == {"draw_mode"}


def test_no_model_has_no_draw_mode_and_no_extent_no_box() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/mesh").GetPrim()
    UsdGeom.ModelAPI.Apply(mesh).CreateModelDrawModeAttr("bounds")
    empty = UsdGeom.Xform.Define(stage, "/empty").GetPrim()
    Usd.ModelAPI(empty).SetKind("component")
    UsdGeom.ModelAPI.Apply(empty).CreateModelDrawModeAttr("bounds")
    reader = StageReader(stage)
    assert reader.read(0.0).triangle_count == 2
    assert codes(reader) == {"draw_mode", "bad_geometry"}


def test_a_draw_mode_of_another_type_is_named() -> None:
    stage = new_stage()
    prim = add_model(stage)
    Sdf.AttributeSpec(stage.GetRootLayer().GetPrimAtPath(prim.GetPath()), "model:drawMode", T.Int).default = 3
    reader = StageReader(stage)
    assert reader.read(0.0).triangle_count == 4
    assert codes(reader) <= {"draw_mode"}
