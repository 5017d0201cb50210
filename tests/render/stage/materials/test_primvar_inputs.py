"""Inputs of materials that are primvars, and textures with coordinates of their own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdShade

from render import colour
from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.unlit import looked_up
from render.model.camera import Camera
from render.model.scene import VALUES_WIDTH, Batch, Light, Material
from render.stage import StageReader
from tests.render.kits.lit_walls import WALL, centre_radiance, lit
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
    write_picture,
)

ST = [(0, 0), (1, 0), (1, 1), (0, 1)]


def connect(
    stage: Usd.Stage, shader: UsdShade.Shader, name: str, kind: str, varname: str, fallback: object = None
) -> None:
    """Feed an input from a primvar."""
    types = {"float": T.Float, "int": T.Int, "float3": T.Float3, "vector": T.Vector3f, "string": T.String}
    reader = UsdShade.Shader.Define(stage, f"{shader.GetPath().GetParentPath()}/read_{name}")
    reader.CreateIdAttr(f"UsdPrimvarReader_{kind}")
    reader.CreateInput("varname", T.String).Set(varname)
    if fallback is not None:
        reader.CreateInput("fallback", types[kind]).Set(fallback)
    shader.CreateInput(name, types[kind]).ConnectToSource(reader.CreateOutput("result", types[kind]))


def square(stage: Usd.Stage) -> tuple[Sdf.Path, UsdShade.Shader]:
    shader = add_material(stage, "/looks/a")
    mesh = add_mesh(stage, "/m").GetPrim()
    bind(mesh, "/looks/a")
    return mesh.GetPath(), shader


def test_numbers_and_colours_of_vertices_replace_constants() -> None:
    stage = new_stage()
    path, shader = square(stage)
    prim = stage.GetPrimAtPath(path)
    connect(stage, shader, "roughness", "float", "rough")
    connect(stage, shader, "emissiveColor", "float3", "glow")
    connect(stage, shader, "metallic", "int", "metal")
    set_primvar(prim, "rough", T.FloatArray, "vertex", [0.1, 0.2, 0.3, 0.4])
    set_primvar(prim, "glow", T.Color3fArray, "uniform", [(1, 2, 3)])
    set_primvar(prim, "metal", T.IntArray, "constant", [1])
    prim.GetAttribute("primvars:glow").SetColorSpace("lin_ap1_scene")
    batch = only_batch(read(stage))
    values, at = batch.geometry.values, batch.material.values
    assert values is not None
    assert values.shape[1] == VALUES_WIDTH
    np.testing.assert_allclose(np.sort(values[:, at["roughness"]]), [0.1, 0.2, 0.3, 0.4])
    assert (values[:, at["metallic"]] == 1).all()
    glow = values[:, at["emissive"] : at["emissive"] + 3]
    wanted = colour.to_working(np.array([[1, 2, 3]], np.float32), "lin_ap1_scene")
    np.testing.assert_allclose(glow, wanted.repeat(4, axis=0), rtol=1e-3)


def test_a_missing_primvar_gives_the_readers_fallback() -> None:
    stage = new_stage()
    _, shader = square(stage)
    connect(stage, shader, "roughness", "float", "none", 0.25)
    connect(stage, shader, "clearcoat", "float", "none")
    connect(stage, shader, "emissiveColor", "float3", "none", Gf.Vec3f(0.5, 0.25, 0))
    batch = only_batch(read(stage))
    values, at = batch.geometry.values, batch.material.values
    assert values is not None
    assert (values[:, at["roughness"]] == 0.25).all()
    assert (values[:, at["clearcoat"]] == 0).all()
    wanted = colour.rgb_to_working((0.5, 0.25, 0.0))
    np.testing.assert_allclose(values[0, at["emissive"] : at["emissive"] + 3], wanted, atol=1e-6)


def test_more_numbers_than_vertices_have_are_named() -> None:
    stage = new_stage()
    _, shader = square(stage)
    for name in ("roughness", "metallic", "clearcoat", "ior"):
        connect(stage, shader, name, "float", name)
    connect(stage, shader, "emissiveColor", "float3", "glow")
    reader = StageReader(stage)
    assert len(only_batch(reader.read(0)).material.values) == 4
    assert any("at most 6 numbers" in finding.message for finding in reader.findings)


@pytest.mark.parametrize(
    ("name", "kind"), [("roughness", "string"), ("roughness", "float3"), ("emissiveColor", "float")]
)
def test_readers_of_another_type_are_named(name: str, kind: str) -> None:
    stage = new_stage()
    _, shader = square(stage)
    connect(stage, shader, name, kind, "odd")
    reader = StageReader(stage)
    assert only_batch(reader.read(0)).material.values == {}
    assert codes(reader) == {f"material_{name}"}


def test_values_of_the_wrong_type_are_the_fallback() -> None:
    stage = new_stage()
    path, shader = square(stage)
    connect(stage, shader, "roughness", "float", "rough", 0.25)
    set_primvar(stage.GetPrimAtPath(path), "rough", T.StringArray, "constant", ["rough"])
    reader = StageReader(stage)
    values = only_batch(reader.read(0)).geometry.values
    assert values is not None
    assert (values[:, 0] == 0.25).all()
    assert codes(reader) == {"bad_primvar_rough"}


@pytest.mark.parametrize(
    "inputs",
    [
        {"emissive": 3, "metallic": 1, "roughness": 1},
        {"specular": 3, "clearcoat": 1, "ior": 1},
        {"clearcoat": 1, "clearcoat_roughness": 1, "occlusion": 1},
    ],
)
def test_values_of_one_number_are_as_the_constant(renderer: FrameRenderer, inputs: dict[str, int]) -> None:
    numbers = {"emissive": (0.1, 0.2, 0.3), "specular": (0.4, 0.5, 0.6), "roughness": (0.4,), "metallic": (0.5,)}
    numbers |= {"clearcoat": (0.8,), "ior": (1.8,), "clearcoat_roughness": (0.3,), "occlusion": (0.5,)}
    base = Material(specular=(0.0, 0.0, 0.0) if "specular" in inputs else None)
    first = dict(zip(inputs, np.cumsum([0, *inputs.values()]).tolist(), strict=False))
    row = np.zeros(VALUES_WIDTH, np.float32)
    for name, at in first.items():
        row[at : at + inputs[name]] = numbers[name]
    constants = {name: numbers[name] if inputs[name] == 3 else numbers[name][0] for name in inputs}
    board = replace(WALL.geometry, values=np.tile(row, (4, 1)))
    # a surface of the scene has a clear coat, so that both are drawn with one
    plain = replace(base, clearcoat=0.3, **constants) if "clearcoat" not in inputs else replace(base, **constants)
    read_from = replace(base, clearcoat=0.0 if "clearcoat" in inputs else 0.3, values=first)
    sun = Light("distant", (2.0, 1.0, 0.5), np.eye(4))
    seen = [
        centre_radiance(renderer, lit(sun, batches=(Batch(board, material, np.eye(4)[None]),)))
        for material in (read_from, plain)
    ]
    np.testing.assert_allclose(*seen, rtol=3e-3)


def two_sets(folder: Path) -> Usd.Stage:
    """A colour by st, and an opacity, white in its left half, by a second set that is turned about."""
    stage = new_stage()
    mesh = add_mesh(stage, "/m", [(-1, -1, -2.8), (1, -1, -2.8), (1, 1, -2.8), (-1, 1, -2.8)]).GetPrim()
    set_primvar(mesh, "st", T.TexCoord2fArray, "vertex", ST)
    set_primvar(mesh, "other", T.TexCoord2fArray, "vertex", [(1 - s, 1 - t) for s, t in ST])
    shader = add_material(stage, "/looks/a")
    half = np.zeros((2, 2, 3), np.uint8)
    half[:, 0] = 255
    for name, output, varname, pixels in (
        ("diffuseColor", "rgb", "st", np.full((2, 2, 3), 255, np.uint8)),
        ("opacity", "r", "other", half),
    ):
        texture = add_texture(stage, f"/looks/a/{name}", write_picture(folder / f"{name}.png", pixels), varname)
        for wrap in ("wrapS", "wrapT"):
            texture.CreateInput(wrap, T.Token).Set("clamp")
        texture.CreateInput("sourceColorSpace", T.Token).Set("raw")
        shader.CreateInput(name, T.Float).ConnectToSource(texture.CreateOutput(output, T.Float))
    bind(mesh, "/looks/a")
    return stage


def test_a_second_set_of_coordinates_is_drawn(tmp_path: Path, renderer: FrameRenderer) -> None:
    """White in the right half of the picture, since its coordinates are turned about."""
    scene = read(two_sets(tmp_path))
    settings = FrameSettings(40, 40, rays=1, engine="pinhole", shading="unlit")
    picture = renderer.render(scene, Camera(np.eye(4), 50, 36, 36), settings).color[20, :, 1]
    assert picture[2:8] == pytest.approx(0, abs=1e-3)
    assert picture[32:38] == pytest.approx(1, abs=1e-3)


def test_the_reference_looks_up_by_the_second_set(tmp_path: Path) -> None:
    batch = only_batch(read(two_sets(tmp_path)))
    lookup = batch.material.lookups["opacity"]
    coordinates = batch.geometry.coordinates(lookup)
    assert coordinates is not None
    assert batch.geometry.uvs is not None
    np.testing.assert_allclose(coordinates, 1 - batch.geometry.uvs)
    left = batch.geometry.positions[:, 0] < 0
    np.testing.assert_allclose(looked_up(lookup, coordinates.astype(np.float64))[:, 0], np.where(left, 0, 1), atol=1e-3)


def test_coordinates_may_be_constant(tmp_path: Path) -> None:
    """Authored on the texture itself: the mesh needs no coordinates."""
    stage = new_stage()
    _, shader = square(stage)
    texture = add_texture(stage, "/looks/a/t", write_picture(tmp_path / "t.png", np.zeros((1, 1, 3), np.uint8)))
    texture.GetInput("st").ClearSources()
    texture.GetInput("st").Set(Gf.Vec2f(0.25, 0.75))
    shader.CreateInput("diffuseColor", T.Color3f).ConnectToSource(texture.CreateOutput("rgb", T.Float3))
    reader = StageReader(stage)
    lookup = only_batch(reader.read(0)).material.lookups["base_color"]
    np.testing.assert_allclose(lookup.uv_transform, [[0, 0, 0.25], [0, 0, 0.75]])
    assert codes(reader) == set()


def test_coordinates_fall_back_to_what_their_reader_says(tmp_path: Path) -> None:
    stage = new_stage()
    _, shader = square(stage)
    texture = add_texture(stage, "/looks/a/t", write_picture(tmp_path / "t.png", np.zeros((1, 1, 3), np.uint8)))
    reader = UsdShade.Shader(stage.GetPrimAtPath("/looks/a/t_reader"))
    reader.CreateInput("fallback", T.Float2).Set(Gf.Vec2f(0.5, 0.25))
    shader.CreateInput("diffuseColor", T.Color3f).ConnectToSource(texture.CreateOutput("rgb", T.Float3))
    uvs = only_batch(read(stage)).geometry.uvs
    assert uvs is not None
    np.testing.assert_allclose(uvs, [[0.5, 0.25]] * len(uvs))
