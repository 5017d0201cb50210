"""Inputs of UsdPreviewSurface beyond its colours: opacity mode, clear coat, occlusion, constant normals, wrapping by files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from pxr import Gf, Usd

from render.model.scene import Material
from render.stage import StageReader
from tests.render.kits.stages import (
    T,
    add_material,
    add_mesh,
    add_texture,
    add_textured_material,
    bind,
    codes,
    new_stage,
    only_batch,
    read,
    set_primvar,
    write_picture,
)


def material_of(stage: Usd.Stage) -> Material:
    return only_batch(read(stage)).material


def test_opacity_mode_says_what_opacity_fades() -> None:
    stage = new_stage()
    fades = {}
    for name, mode in (("a", None), ("b", "transparent"), ("c", "presence"), ("d", "wrong")):
        shader = add_material(stage, f"/looks/{name}", opacity=0.5)
        if mode is not None:
            shader.CreateInput("opacityMode", T.Token).Set(mode)
        bind(add_mesh(stage, f"/{name}").GetPrim(), f"/looks/{name}")
    reader = StageReader(stage)
    scene = reader.read(0)
    for batch in scene.batches:
        fades[batch.material.name] = batch.material.fades_highlights
    assert set(fades.values()) == {False, True}
    assert [finding.code for finding in reader.findings] == ["material_opacityMode"]
    assert "got 'wrong'" in reader.findings[0].message


def test_scalars_of_the_clear_coat_and_index_have_textures(tmp_path: Path) -> None:
    stage = new_stage()
    shader = add_material(stage, "/looks/a")
    texture = add_texture(stage, "/looks/a/t", write_picture(tmp_path / "t.png", np.full((1, 1, 3), 128, np.uint8)))
    for name, output in (("clearcoat", "r"), ("clearcoatRoughness", "g"), ("ior", "b"), ("opacityThreshold", "r")):
        shader.CreateInput(name, T.Float).ConnectToSource(texture.CreateOutput(output, T.Float))
    bind(add_mesh(stage, "/m").GetPrim(), "/looks/a")
    reader = StageReader(stage)
    lookups = only_batch(reader.read(0)).material.lookups
    assert {name: look.channel for name, look in lookups.items()} == {
        "clearcoat": 0,
        "clearcoat_roughness": 1,
        "ior": 2,
    }
    assert "material_opacityThreshold" in codes(reader), "it takes a constant alone"


def test_a_ninth_texture_of_a_material_is_named(tmp_path: Path) -> None:
    stage = new_stage()
    shader = add_material(stage, "/looks/a")
    names = ("roughness", "metallic", "opacity", "occlusion", "clearcoat", "clearcoatRoughness", "ior")
    for number, name in enumerate((*names, "diffuseColor", "emissiveColor")):
        file = write_picture(tmp_path / f"{name}.png", np.full((1, 1, 3), number, np.uint8))
        output = add_texture(stage, f"/looks/a/{name}", file).CreateOutput("r", T.Float)
        shader.CreateInput(name, T.Float).ConnectToSource(output)
    bind(add_mesh(stage, "/m").GetPrim(), "/looks/a")
    reader = StageReader(stage)
    assert len(only_batch(reader.read(0)).material.lookups) == 8
    (message,) = (finding.message for finding in reader.findings if finding.code.startswith("material_textures"))
    assert "9 textures are more than 8" in message


def test_constant_occlusion_is_read() -> None:
    stage = new_stage()
    add_material(stage, "/looks/a", occlusion=0.25)
    bind(add_mesh(stage, "/m").GetPrim(), "/looks/a")
    assert material_of(stage).occlusion == 0.25


def test_a_constant_normal_leans_in_tangent_space() -> None:
    stage = new_stage()
    shader = add_material(stage, "/looks/a")
    shader.CreateInput("normal", T.Normal3f).Set(Gf.Vec3f(0.6, 0, 0.8))
    mesh = add_mesh(stage, "/m").GetPrim()
    set_primvar(mesh, "st", T.TexCoord2fArray, "vertex", [(0, 0), (1, 0), (1, 1), (0, 1)])
    bind(mesh, "/looks/a")
    lookup = material_of(stage).lookups["normal"]
    np.testing.assert_allclose(lookup.image.pixels[0, 0, :3], [0.6, 0, 0.8], atol=1e-3)


@pytest.mark.parametrize(
    ("token", "named", "expected"),
    [
        (None, {}, ("black", "black")),
        (None, {"wrapmodes": "periodic,clamp"}, ("repeat", "clamp")),
        (None, {"wrapmodes": "mirror"}, ("mirror", "mirror")),
        (None, {"wrapmodes": "periodic,clamp", "wrapS": "mirror"}, ("mirror", "clamp")),
        ("useMetadata", {"wrapS": "odd", "wrapT": "repeat"}, ("black", "repeat")),
        ("clamp", {"wrapmodes": "periodic"}, ("clamp", "repeat")),
    ],
)
def test_textures_wrap_as_their_file_says(
    tmp_path: Path, token: str | None, named: dict[str, str], expected: tuple[str, str]
) -> None:
    """The token is of ``wrapS``; ``wrapT`` is not authored."""
    output = oiio.ImageOutput.create(str(tmp_path / "t.exr"))
    assert output is not None
    spec = oiio.ImageSpec(1, 1, 3, "half")
    for name, value in named.items():
        spec.attribute(name, value)
    assert output.open(str(tmp_path / "t.exr"), spec)
    assert output.write_image(np.zeros((1, 1, 3), np.float32))
    output.close()
    stage = new_stage()
    texture = add_textured_material(stage, add_mesh(stage, "/m").GetPrim(), str(tmp_path / "t.exr"))
    if token is not None:
        texture.CreateInput("wrapS", T.Token).Set(token)
    lookup = material_of(stage).lookups["base_color"]
    assert (lookup.wrap_s, lookup.wrap_t) == expected


def test_a_wrap_that_is_none_is_named(tmp_path: Path) -> None:
    stage = new_stage()
    file = write_picture(tmp_path / "t.png", np.zeros((1, 1, 3), np.uint8))
    texture = add_textured_material(stage, add_mesh(stage, "/m").GetPrim(), file)
    texture.CreateInput("wrapS", T.Token).Set("round")
    reader = StageReader(stage)
    assert only_batch(reader.read(0)).material.lookups["base_color"].wrap_s == "black"
    assert "texture_wrapS" in codes(reader)
