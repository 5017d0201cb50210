"""Surfaces are displaced along their normals by UsdPreviewSurface: constants, primvars and textures (in stage units)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdShade

from render.model.scene import Geometry, Image, TextureLookup
from render.stage import AnchorReader, StageReader
from render.stage.geometry.displacement import look_up
from render.stage.options import StageOptions
from tests.render.kits.stages import (
    T,
    add_material,
    add_mesh,
    add_texture,
    bind,
    codes,
    new_stage,
    only_batch,
    read,
    set_primvar,
    world_points,
    write_picture,
)
from usd_schemas import FocusPoint

UNIT_UVS = [(0, 0), (1, 0), (1, 1), (0, 1)]
CUBE_POINTS = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
CUBE_CORNERS = [0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4, 2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6]


def add_displaced(stage: Usd.Stage, prim: Usd.Prim, displacement: float = 0.0) -> UsdShade.Shader:
    """Bind a material that displaces; returns its surface."""
    shader = add_material(stage, "/look", displacement=displacement)
    output = shader.CreateOutput("displacement", T.Token)
    UsdShade.Material(stage.GetPrimAtPath("/look")).CreateDisplacementOutput().ConnectToSource(output)
    bind(prim, "/look")
    return shader


def add_displaced_texture(
    stage: Usd.Stage, shader: UsdShade.Shader, pixels: np.ndarray, tmp_path: Path
) -> UsdShade.Shader:
    texture = add_texture(stage, "/look/height", write_picture(tmp_path / "height.exr", pixels.astype(np.float32)))
    texture.CreateInput("wrapS", T.Token).Set("clamp")
    texture.CreateInput("wrapT", T.Token).Set("clamp")
    shader.CreateInput("displacement", T.Float).ConnectToSource(texture.CreateOutput("r", T.Float))
    return texture


def geometry_of(stage: Usd.Stage, complexity: str = "auto") -> Geometry:
    return only_batch(StageReader(stage, StageOptions(complexity=complexity)).read(0.0)).geometry


def test_a_constant_moves_a_square_along_its_normal() -> None:
    stage = new_stage()
    add_displaced(stage, add_mesh(stage, "/m").GetPrim(), 0.25)
    geometry = geometry_of(stage)
    np.testing.assert_allclose(geometry.positions[:, 2], 0.25)
    np.testing.assert_allclose(geometry.normals, [[0, 0, 1]] * 4)


def test_a_ball_grows_by_its_displacement() -> None:
    stage = new_stage()
    ball = UsdGeom.Sphere.Define(stage, "/ball")
    ball.CreateRadiusAttr(2.0)
    add_displaced(stage, ball.GetPrim(), -0.5)
    geometry = geometry_of(stage)
    np.testing.assert_allclose(np.linalg.norm(geometry.positions, axis=1), 1.5, atol=5e-3)
    unit = geometry.positions / np.linalg.norm(geometry.positions, axis=1, keepdims=True)
    np.testing.assert_allclose(geometry.normals, unit, atol=0.01)


@pytest.mark.parametrize("left_handed", [False, True])
def test_limit_surfaces_move_along_their_own_normals(left_handed: bool) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/cube", CUBE_POINTS, [4] * 6, CUBE_CORNERS, "catmullClark")
    if left_handed:
        mesh.CreateOrientationAttr("leftHanded")
    plain = geometry_of(stage, "veryhigh")
    add_displaced(stage, mesh.GetPrim(), 0.3)
    moved = geometry_of(stage, "veryhigh")
    np.testing.assert_allclose(moved.positions, plain.positions + 0.3 * plain.normals, atol=1e-5)
    np.testing.assert_allclose(moved.normals, plain.normals, atol=0.02)  # a parallel surface has the same normals


def test_displacement_is_in_stage_units_whatever_the_scale() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m", [(0, 0, 0), (1, 0, 1), (1, 1, 1), (0, 1, 0)])
    mesh.AddRotateZOp().Set(30.0)
    mesh.AddScaleOp().Set(Gf.Vec3f(4, 1, 2))
    plain = only_batch(read(stage))
    edges = [world_points(plain)[i] - world_points(plain)[0] for i in (1, 3)]
    normal = np.cross(*edges) / np.linalg.norm(np.cross(*edges))
    before = world_points(plain)
    add_displaced(stage, mesh.GetPrim(), 0.5)
    np.testing.assert_allclose(world_points(only_batch(read(stage))), before + 0.5 * normal, atol=1e-5)


def test_a_texture_displaces_by_its_values(tmp_path: Path) -> None:
    """A ramp makes a slope: heights by coordinates, and normals by their gradient."""
    stage = new_stage()
    mesh = add_mesh(stage, "/m", scheme="bilinear")
    set_primvar(mesh.GetPrim(), "st", T.TexCoord2fArray, "faceVarying", UNIT_UVS)
    ramp = np.repeat(np.tile((np.arange(64)[None] + 0.5) / 64, (64, 1))[..., None], 3, axis=2)
    shader = add_displaced(stage, mesh.GetPrim())
    texture = add_displaced_texture(stage, shader, ramp, tmp_path)
    texture.CreateInput("scale", T.Float4).Set(Gf.Vec4f(2))
    texture.CreateInput("bias", T.Float4).Set(Gf.Vec4f(-1))
    geometry = geometry_of(stage, "veryhigh")
    inner = np.abs(geometry.positions[:, 0] - 0.5) < 0.49
    np.testing.assert_allclose(geometry.positions[inner, 2], 2 * geometry.positions[inner, 0] - 1, atol=2e-3)
    slope = np.array([-2, 0, 1]) / np.sqrt(5)
    middle = np.abs(geometry.positions[:, 0] - 0.5) < 0.2
    np.testing.assert_allclose(geometry.normals[middle], np.tile(slope, (middle.sum(), 1)), atol=0.01)
    assert len(geometry_of(stage).triangles) > 64 * 64 * 2  # automatic levels are fine enough for the picture


def test_textures_are_read_between_texels_and_wrapped() -> None:
    pixels = np.zeros((1, 2, 4), np.float16)
    pixels[0, :, 0] = (1, 3)
    image = Image(pixels)
    at = np.array([[0.25, 0.5], [0.5, 0.5], [0.75, 0.5], [1.0, 0.5], [1.25, 0.5]], np.float32)
    found = {
        wrap: look_up(TextureLookup(image, wrap_s=wrap, wrap_t="clamp", channel=0), at).tolist()
        for wrap in ("repeat", "clamp", "mirror", "black")
    }
    assert found["repeat"] == pytest.approx([1, 2, 3, 2, 1])
    assert found["clamp"] == pytest.approx([1, 2, 3, 3, 3])
    assert found["mirror"] == pytest.approx([1, 2, 3, 3, 3])
    assert found["black"] == pytest.approx([1, 2, 3, 1.5, 0])


def test_detail_between_points_is_its_mean(tmp_path: Path) -> None:
    """Stripes of 0 and 1, finer than the points are apart, are a half everywhere."""
    stage = new_stage()
    mesh = add_mesh(stage, "/m", scheme="bilinear")
    set_primvar(mesh.GetPrim(), "st", T.TexCoord2fArray, "vertex", UNIT_UVS)
    stripes = np.zeros((96, 96, 3))
    stripes[:, ::2] = 1
    add_displaced_texture(stage, add_displaced(stage, mesh.GetPrim()), stripes, tmp_path)
    np.testing.assert_allclose(geometry_of(stage, "veryhigh").positions[:, 2], 0.5, atol=1e-3)


def test_a_primvar_displaces_each_point() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m")
    set_primvar(mesh.GetPrim(), "height", T.FloatArray, "vertex", [0.0, 1.0, 2.0, 3.0])
    reader = UsdShade.Shader.Define(stage, "/look/reader")
    reader.CreateIdAttr("UsdPrimvarReader_float")
    reader.CreateInput("varname", T.String).Set("height")
    shader = add_displaced(stage, mesh.GetPrim())
    shader.CreateInput("displacement", T.Float).ConnectToSource(reader.CreateOutput("result", T.Float))
    geometry = geometry_of(stage)
    np.testing.assert_allclose(geometry.positions[:, 2], [0, 1, 2, 3])


def test_seams_of_texture_coordinates_stay_closed(tmp_path: Path) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/cube", CUBE_POINTS, [4] * 6, CUBE_CORNERS, "catmullClark")
    set_primvar(mesh.GetPrim(), "st", T.TexCoord2fArray, "faceVarying", UNIT_UVS * 6)
    shader = add_displaced(stage, mesh.GetPrim())
    noise = np.random.default_rng(5).uniform(0, 0.5, (16, 16, 1)).repeat(3, axis=2)
    add_displaced_texture(stage, shader, noise, tmp_path)
    geometry = geometry_of(stage, "medium")
    corners = np.round(geometry.positions[geometry.triangles], 5)
    edges = [tuple(sorted((tuple(t[i]), tuple(t[(i + 1) % 3])))) for t in corners.tolist() for i in range(3)]
    assert {edges.count(edge) for edge in edges} == {2}


@pytest.mark.parametrize("scheme", ["none", "catmullClark"])
def test_a_click_on_a_displaced_surface_stays_on_it(scheme: str, tmp_path: Path) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/cube", CUBE_POINTS, [4] * 6, CUBE_CORNERS, scheme)
    set_primvar(mesh.GetPrim(), "st", T.TexCoord2fArray, "faceVarying", UNIT_UVS * 6)
    noise = np.random.default_rng(5).uniform(0, 0.5, (16, 16, 1)).repeat(3, axis=2)
    add_displaced_texture(stage, add_displaced(stage, mesh.GetPrim()), noise, tmp_path)
    options = StageOptions(complexity="high")
    geometry = only_batch(StageReader(stage, options).read(0.0)).geometry
    random = np.random.default_rng(7)
    triangles, weights = random.integers(0, len(geometry.triangles), 12), random.dirichlet([1, 1, 1], 12)
    fans, shares = geometry.fan_points(triangles, weights)
    anchors = AnchorReader(stage, options)
    for triangle, own, fan, share in zip(triangles, weights, fans, shares, strict=True):
        face = int(geometry.face_ids[triangle])
        point = FocusPoint("p", ("/cube",), face=face, fan_triangle=int(fan), barycentric=tuple(share.tolist()))
        drawn = own @ geometry.positions[geometry.triangles[triangle]]
        np.testing.assert_allclose(anchors.position(point, 0.0), drawn, atol=2e-5)


def test_animated_displacement_moves() -> None:
    stage = new_stage()
    shader = add_displaced(stage, add_mesh(stage, "/m").GetPrim())
    shader.GetInput("displacement").GetAttr().Set(0.0, 0)
    shader.GetInput("displacement").GetAttr().Set(1.0, 10)
    reader = StageReader(stage)
    heights = [only_batch(reader.read(time)).geometry.positions[0, 2] for time in (0.0, 5.0, 10.0)]
    assert heights == pytest.approx([0, 0.5, 1])


def test_different_displacements_are_different_surfaces() -> None:
    stage = new_stage()
    for name, amount in (("a", 0.1), ("b", 0.2)):
        mesh = add_mesh(stage, f"/{name}")
        shader = add_material(stage, f"/look_{name}", displacement=amount)
        output = shader.CreateOutput("displacement", T.Token)
        UsdShade.Material(stage.GetPrimAtPath(f"/look_{name}")).CreateDisplacementOutput().ConnectToSource(output)
        bind(mesh.GetPrim(), f"/look_{name}")
    found = sorted({round(float(z), 5) for batch in read(stage).batches for z in world_points(batch)[:, 2]})
    assert found == [0.1, 0.2]


@pytest.mark.parametrize(
    ("amount", "code"),
    [(float("nan"), "material_displacement"), (float("inf"), "material_displacement"), (1e12, "bad_geometry")],
)
def test_absurd_displacements_are_named(amount: float, code: str) -> None:
    stage = new_stage()
    add_displaced(stage, add_mesh(stage, "/m").GetPrim(), amount)
    reader = StageReader(stage)
    reader.read(0.0)
    assert codes(reader) == {code}


def test_a_displacement_without_its_output_is_named() -> None:
    stage = new_stage()
    add_material(stage, "/look", displacement=0.5)
    bind(add_mesh(stage, "/m").GetPrim(), "/look")
    reader = StageReader(stage)
    assert (only_batch(reader.read(0.0)).geometry.positions[:, 2] == 0).all()
    assert codes(reader) == {"material_displacement"}


def test_a_set_of_tiles_displaces(tmp_path: Path) -> None:
    """Tiles side by side displace each its half; where there is none, the fallback."""
    for number, value in ((1001, 0.25), (1002, 0.5)):
        write_picture(tmp_path / f"height.{number}.exr", np.full((4, 4, 1), value, np.float32))
    stage = new_stage()
    points = [(x, y, 0) for y in range(2) for x in range(7)]
    corners = [corner for x in range(6) for corner in (x, x + 1, x + 8, x + 7)]
    mesh = add_mesh(stage, "/m", points, [4] * 6, corners)
    uvs = [(0.5 * x + 0.01, 0.5 * y + 0.01) for x, y, _ in points]
    set_primvar(mesh.GetPrim(), "st", T.TexCoord2fArray, "vertex", uvs)
    shader = add_displaced(stage, mesh.GetPrim())
    texture = add_texture(stage, "/look/height", str(tmp_path / "height.<UDIM>.exr"))
    texture.CreateInput("fallback", T.Float4).Set((0.125, 0, 0, 1))
    shader.CreateInput("displacement", T.Float).ConnectToSource(texture.CreateOutput("r", T.Float))
    moved = world_points(only_batch(read(stage)))
    for low, high, want in ((0, 1.5, 0.25), (2, 3.5, 0.5), (4, 6.5, 0.125)):
        own = (moved[:, 0] >= low) & (moved[:, 0] < high)
        np.testing.assert_allclose(moved[own, 2], want, atol=1e-3)


def test_a_textured_mesh_without_faces_is_named(tmp_path: Path) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m", counts=(), corners=())
    shader = add_displaced(stage, mesh.GetPrim())
    add_displaced_texture(stage, shader, np.ones((2, 2, 1)), tmp_path)
    reader = StageReader(stage)
    assert not reader.read(0.0).batches
    assert "no_faces" in codes(reader)
