"""UsdPreviewSurface networks, textures and bindings come out as the specification says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdRender, UsdShade

from render import colour
from render.model.scene import Batch, Material
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


def test_constants_come_through_in_the_working_space() -> None:
    stage = new_stage()
    add_material(
        stage,
        "/looks/a",
        diffuseColor=Gf.Vec3f(0.8, 0.2, 0.1),
        emissiveColor=Gf.Vec3f(3, 2, 1),
        metallic=0.3,
        roughness=0.7,
        clearcoat=0.4,
        clearcoatRoughness=0.2,
        ior=1.33,
        opacity=0.9,
        opacityThreshold=0.1,
    )
    bind(add_mesh(stage, "/m").GetPrim(), "/looks/a")
    material = material_of(stage)
    np.testing.assert_allclose(material.base_color, colour.rgb_to_working((0.8, 0.2, 0.1)), rtol=1e-5)
    np.testing.assert_allclose(material.emissive, colour.rgb_to_working((3, 2, 1)), rtol=1e-5)
    assert material.specular is None
    got = (material.metallic, material.roughness, material.clearcoat, material.clearcoat_roughness)
    assert got == pytest.approx((0.3, 0.7, 0.4, 0.2))
    assert (material.ior, material.opacity, material.opacity_threshold) == pytest.approx((1.33, 0.9, 0.1))


def test_unauthored_inputs_have_the_specifications_fallbacks() -> None:
    stage = new_stage()
    add_material(stage, "/looks/a")
    bind(add_mesh(stage, "/m").GetPrim(), "/looks/a")
    material = material_of(stage)
    assert material.base_color == pytest.approx((0.18, 0.18, 0.18), abs=1e-4)
    assert (material.roughness, material.metallic, material.ior, material.opacity) == (0.5, 0.0, 1.5, 1.0)


def test_the_specular_workflow_is_read() -> None:
    stage = new_stage()
    add_material(stage, "/looks/a", useSpecularWorkflow=1, specularColor=Gf.Vec3f(0.5, 0.5, 0.5))
    bind(add_mesh(stage, "/m").GetPrim(), "/looks/a")
    assert material_of(stage).specular == pytest.approx((0.5, 0.5, 0.5), abs=1e-4)


def test_inputs_come_through_node_graphs_and_interfaces() -> None:
    stage = new_stage()
    shader = add_material(stage, "/looks/a")
    material = UsdShade.Material(stage.GetPrimAtPath("/looks/a"))
    interface = material.CreateInput("gloss", T.Float)
    interface.Set(0.25)
    shader.CreateInput("roughness", T.Float).ConnectToSource(interface)
    bind(add_mesh(stage, "/m").GetPrim(), "/looks/a")
    assert material_of(stage).roughness == pytest.approx(0.25)


def test_a_texture_has_its_coordinates_wrap_scale_and_transform(tmp_path: Path) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m").GetPrim()
    set_primvar(mesh, "map", T.TexCoord2fArray, "vertex", [(0, 0), (1, 0), (1, 1), (0, 1)])
    file = write_picture(tmp_path / "t.png", np.full((2, 4, 3), 255, np.uint8))
    shader = add_material(stage, "/looks/a")
    texture = add_texture(stage, "/looks/a/tex", file, "map")
    texture.CreateInput("wrapS", T.Token).Set("mirror")
    texture.CreateInput("wrapT", T.Token).Set("clamp")
    texture.CreateInput("scale", T.Float4).Set(Gf.Vec4f(0.5, 0.5, 0.5, 1))
    turn = UsdShade.Shader.Define(stage, "/looks/a/turn")
    turn.CreateIdAttr("UsdTransform2d")
    turn.CreateInput("scale", T.Float2).Set(Gf.Vec2f(2, 3))
    turn.CreateInput("rotation", T.Float).Set(90.0)
    turn.CreateInput("translation", T.Float2).Set(Gf.Vec2f(0.1, 0.2))
    reader = UsdShade.Shader(stage.GetPrimAtPath("/looks/a/tex_reader"))
    turn.CreateInput("in", T.Float2).ConnectToSource(reader.GetOutput("result"))
    texture.GetInput("st").ConnectToSource(turn.CreateOutput("result", T.Float2))
    shader.CreateInput("diffuseColor", T.Color3f).ConnectToSource(texture.CreateOutput("rgb", T.Float3))
    bind(mesh, "/looks/a")
    batch = only_batch(read(stage))
    lookup = batch.material.lookups["base_color"]
    assert (lookup.wrap_s, lookup.wrap_t, lookup.channel) == ("mirror", "clamp", -1)
    np.testing.assert_allclose(lookup.scale, [0.5, 0.5, 0.5, 1])
    # (1, 0) is scaled to (2, 0), turned to (0, 2), moved to (0.1, 2.2).
    np.testing.assert_allclose(lookup.uv_transform @ [1, 0, 1], [0.1, 2.2], atol=1e-6)
    assert lookup.image.pixels.shape == (2, 4, 4)
    assert batch.geometry.uvs is not None
    np.testing.assert_allclose(batch.geometry.uvs[2], [1, 1])


@pytest.mark.parametrize(
    ("space", "pixels", "expected"),
    [
        ("auto", np.full((1, 1, 3), 188, np.uint8), 0.5029),  # 8-bit colour is sRGB
        ("sRGB", np.full((1, 1, 3), 188, np.uint8), 0.5029),
        ("texture_paint", np.full((1, 1, 3), 188, np.uint8), 0.5029),  # the configuration's role for such input
        ("ACEScct", np.full((1, 1, 3), 188, np.uint8), 2 ** (188 / 255 * 17.52 - 9.72)),  # and a name of it
        ("raw", np.full((1, 1, 3), 188, np.uint8), 188 / 255),
        ("auto", np.full((1, 1, 1), 188, np.uint8), 188 / 255),  # one channel is data
        ("auto", np.full((1, 1, 3), 2.5, np.float32), 2.5),  # floating point is linear
        ("raw", np.full((1, 1, 3), 48000, np.uint16), 48000 / 65535),
    ],
)
def test_texels_are_converted_by_their_colour_space(
    tmp_path: Path, space: str, pixels: np.ndarray, expected: float
) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m").GetPrim()
    file = write_picture(tmp_path / ("t.exr" if pixels.dtype == np.float32 else "t.png"), pixels)
    add_textured_material(stage, mesh, file).CreateInput("sourceColorSpace", T.Token).Set(space)
    texel = material_of(stage).lookups["base_color"].image.pixels[0, 0]
    # Grey has the same value in every linear RGB space; half floats have 11 bits.
    np.testing.assert_allclose(texel, [expected] * 3 + [1], rtol=2e-3)


def test_a_coloured_texel_gets_the_working_primaries(tmp_path: Path) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m").GetPrim()
    file = write_picture(tmp_path / "t.exr", np.array([[[1.0, 0.5, 0.25]]], np.float32))
    texture = add_textured_material(stage, mesh, file)
    texture.CreateInput("scale", T.Float4).Set(Gf.Vec4f(2, 1, 0.5, 1))
    texture.CreateInput("bias", T.Float4).Set(Gf.Vec4f(0, 0.1, 0, 0))
    lookup = material_of(stage).lookups["base_color"]
    texel = lookup.image.pixels[0, 0].astype(np.float32) * lookup.scale + lookup.bias
    np.testing.assert_allclose(texel[:3], colour.rgb_to_working((2.0, 0.6, 0.125)), rtol=2e-3)


def test_a_data_channel_keeps_its_numbers(tmp_path: Path) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m").GetPrim()
    file = write_picture(tmp_path / "t.png", np.array([[[10, 128, 250, 60]]], np.uint8))
    shader = add_material(stage, "/looks/a")
    texture = add_texture(stage, "/looks/a/tex", file)
    texture.CreateInput("sourceColorSpace", T.Token).Set("raw")
    for name, output in (("roughness", "g"), ("metallic", "b"), ("opacity", "a")):
        shader.CreateInput(name, T.Float).ConnectToSource(texture.CreateOutput(output, T.Float))
    bind(mesh, "/looks/a")
    lookups = material_of(stage).lookups
    channels = {name: lookup.channel for name, lookup in lookups.items()}
    assert channels == {"roughness": 1, "metallic": 2, "opacity": 3}
    np.testing.assert_allclose(lookups["opacity"].image.pixels[0, 0] * 255, [10, 128, 250, 60], atol=0.1)
    assert lookups["roughness"].image is lookups["metallic"].image


def test_a_mesh_without_uvs_is_reported_and_reads_one_texel(tmp_path: Path) -> None:
    stage = new_stage()
    file = write_picture(tmp_path / "one.png", np.full((1, 1, 3), 128, np.uint8))
    add_textured_material(stage, add_mesh(stage, "/m").GetPrim(), file)
    reader = StageReader(stage)
    geometry = only_batch(reader.read(0)).geometry
    assert geometry.uvs is not None
    assert (geometry.uvs == 0).all()
    assert codes(reader) == {"no_texture_coordinates"}


def test_large_textures_are_averaged_down(tmp_path: Path) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m").GetPrim()
    pixels = np.zeros((100, 300, 3), np.float32)
    pixels[:, ::2] = 1.0
    add_textured_material(stage, mesh, write_picture(tmp_path / "t.exr", pixels))
    image = StageReader(stage, max_texture=64).read(0).batches[0].material.lookups["base_color"].image
    assert max(image.pixels.shape[:2]) <= 64
    assert image.pixels[..., :3].mean(dtype=np.float64) == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize("content", [None, b"not a picture"])
def test_a_texture_that_cannot_be_read_is_named_and_its_fallback_used(tmp_path: Path, content: bytes | None) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m").GetPrim()
    file = tmp_path / "gone.png"
    if content is not None:
        file.write_bytes(content)
    texture = add_textured_material(stage, mesh, str(file))
    texture.CreateInput("fallback", T.Float4).Set(Gf.Vec4f(0.5, 0.5, 0.5, 1))
    reader = StageReader(stage)
    material = reader.read(0).batches[0].material
    assert material.lookups == {}
    assert material.base_color == pytest.approx((0.5, 0.5, 0.5), abs=1e-3)
    finding = next(f for f in reader.findings if f.code == "texture_unreadable")
    assert "gone.png" in finding.message


def test_each_missing_texture_of_a_materialx_file_is_named(tmp_path: Path) -> None:
    inputs = {"base_color": "wood.png", "specular_roughness": "dust.png"}
    images = "".join(
        f'<image name="{name}"><input name="file" type="filename" value="{file}"/></image>'
        for name, file in inputs.items()
    )
    links = "".join(f'<input name="{name}" nodename="{name}"/>' for name in inputs)
    (tmp_path / "m.mtlx").write_text(
        f'<materialx>{images}<standard_surface name="s">{links}</standard_surface>'
        '<surfacematerial name="oak"><input name="surfaceshader" nodename="s"/></surfacematerial></materialx>'
    )
    stage = new_stage()
    add_mesh(stage, "/m")
    stage.GetRootLayer().Export(str(tmp_path / "a.usda"))
    stage = Usd.Stage.Open(str(tmp_path / "a.usda"))
    stage.DefinePrim("/Looks").GetReferences().AddReference("./m.mtlx", "/MaterialX")
    binding = UsdShade.MaterialBindingAPI.Apply(stage.GetPrimAtPath("/m"))
    binding.GetPrim().CreateRelationship("material:binding").SetTargets(["/Looks/oak"])
    reader = StageReader(stage)
    reader.read(0)
    messages = [finding.message for finding in reader.findings if finding.code == "texture_unreadable"]
    assert len(messages) == 2
    assert all(any(file in message and "/Looks/oak" in message for message in messages) for file in inputs.values())


def test_a_primvar_reader_makes_display_colour_the_base_colour() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m").GetPrim()
    set_primvar(mesh, "tint", T.Color3fArray, "constant", [(0, 0, 1)])
    shader = add_material(stage, "/looks/a")
    reader = UsdShade.Shader.Define(stage, "/looks/a/reader")
    reader.CreateIdAttr("UsdPrimvarReader_float3")
    reader.CreateInput("varname", T.String).Set("tint")
    shader.CreateInput("diffuseColor", T.Color3f).ConnectToSource(reader.CreateOutput("result", T.Float3))
    bind(mesh, "/looks/a")
    batch = only_batch(read(stage))
    assert batch.material.uses_display_color
    assert batch.material.base_color == (1, 1, 1)
    assert batch.geometry.colors is not None
    np.testing.assert_allclose(batch.geometry.colors[0, :3], colour.rgb_to_working((0, 0, 1)), atol=1e-6)


def test_the_fallback_of_a_texture_may_have_three_numbers() -> None:
    stage = new_stage()
    texture = add_textured_material(stage, add_mesh(stage, "/m").GetPrim(), "")
    texture.CreateInput("fallback", T.Float3).Set(Gf.Vec3f(0.1, 0.2, 0.3))
    np.testing.assert_allclose(material_of(stage).base_color, colour.rgb_to_working((0.1, 0.2, 0.3)), rtol=1e-5)


def test_scale_and_bias_of_a_texture_may_have_three_numbers(tmp_path: Path) -> None:
    stage = new_stage()
    file = write_picture(tmp_path / "t.png", np.full((2, 2, 3), 255, np.uint8))
    texture = add_textured_material(stage, add_mesh(stage, "/m").GetPrim(), file)
    texture.CreateInput("scale", T.Float3).Set(Gf.Vec3f(0.5, 0.5, 0.5))
    lookup = material_of(stage).lookups["base_color"]
    np.testing.assert_allclose(lookup.scale, [0.5, 0.5, 0.5, 1.0])


@pytest.mark.parametrize("fallback", [None, (0.1, 0.2, 0.3)])
def test_a_reader_of_a_missing_primvar_gives_its_fallback(fallback: tuple[float, float, float] | None) -> None:
    """A UsdPrimvarReader's own fallback is 0, not the surface's 0.18 or 1."""
    stage = new_stage()
    shader = add_material(stage, "/looks/a")
    bind(add_mesh(stage, "/m").GetPrim(), "/looks/a")
    for name, kind, number_type in (("diffuseColor", "float3", T.Color3f), ("opacity", "float", T.Float)):
        reader = UsdShade.Shader.Define(stage, f"/looks/a/{name}_reader")
        reader.CreateIdAttr(f"UsdPrimvarReader_{kind}")
        reader.CreateInput("varname", T.String).Set("nothing_has_this")
        if fallback is not None:
            value = Gf.Vec3f(*fallback) if name == "diffuseColor" else fallback[0]
            reader.CreateInput("fallback", T.Float3 if name == "diffuseColor" else T.Float).Set(value)
        shader.CreateInput(name, number_type).ConnectToSource(reader.CreateOutput("result", T.Float3))
    usd = StageReader(stage)
    colors = only_batch(usd.read(0)).geometry.colors
    assert codes(usd) == ({"no_opacity"} if fallback is None else set()), "what becomes invisible is named"
    assert colors is not None
    rgb = fallback or (0.0, 0.0, 0.0)
    np.testing.assert_allclose(colors, [[*colour.rgb_to_working(rgb), rgb[0]]] * len(colors), atol=1e-6)


def test_what_a_material_uses_that_is_not_honoured_is_reported() -> None:
    stage = new_stage()
    shader = add_material(stage, "/looks/a", displacement=0.5)
    odd = UsdShade.Shader.Define(stage, "/looks/a/odd")
    odd.CreateIdAttr("StudioNoise")
    shader.CreateInput("diffuseColor", T.Color3f).ConnectToSource(odd.CreateOutput("result", T.Color3f))
    bind(add_mesh(stage, "/m").GetPrim(), "/looks/a")
    UsdShade.Material.Define(stage, "/looks/empty")
    bind(add_mesh(stage, "/n").GetPrim(), "/looks/empty")
    reader = StageReader(stage)
    reader.read(0)
    assert codes(reader) == {"material_diffuseColor", "material_displacement", "material_unread"}


def test_equal_materials_are_one_draw() -> None:
    stage = new_stage()
    for name in "ab":
        add_material(stage, f"/looks/{name}", roughness=0.3)
        bind(add_mesh(stage, f"/m_{name}").GetPrim(), f"/looks/{name}")
    assert len(read(stage).batches) == 1


# Bindings


def names_of(batches: tuple[Batch, ...]) -> dict[str, list[int]]:
    """Faces by material name."""
    return {batch.material.name: sorted(set(batch.geometry.face_ids.tolist())) for batch in batches}


def three_looks(stage: Usd.Stage) -> None:
    for number, name in enumerate("abc"):
        add_material(stage, f"/looks/{name}", roughness=0.1 + 0.2 * number)


def test_bindings_are_inherited_and_the_nearest_wins() -> None:
    stage = new_stage()
    three_looks(stage)
    bind(UsdGeom.Xform.Define(stage, "/group").GetPrim(), "/looks/a")
    add_mesh(stage, "/group/far")
    bind(add_mesh(stage, "/group/near").GetPrim(), "/looks/b")
    assert set(names_of(read(stage).batches)) == {"/looks/a", "/looks/b"}


def test_a_stronger_binding_above_wins() -> None:
    stage = new_stage()
    three_looks(stage)
    bind(UsdGeom.Xform.Define(stage, "/group").GetPrim(), "/looks/a", bindingStrength="strongerThanDescendants")
    bind(add_mesh(stage, "/group/m").GetPrim(), "/looks/b")
    assert set(names_of(read(stage).batches)) == {"/looks/a"}


def test_bindings_for_previews_win_as_in_usdrecord() -> None:
    stage = new_stage()
    three_looks(stage)
    mesh = add_mesh(stage, "/m").GetPrim()
    bind(mesh, "/looks/a", materialPurpose="full")
    assert set(names_of(read(stage).batches)) == {"/looks/a"}, "where there is no other, rather than no material"
    bind(mesh, "/looks/b")
    assert set(names_of(read(stage).batches)) == {"/looks/b"}
    bind(mesh, "/looks/c", materialPurpose="preview")
    assert set(names_of(read(stage).batches)) == {"/looks/c"}


@pytest.mark.parametrize(
    ("purposes", "worn"),
    [
        (["full", ""], "/looks/a"),
        (["", "full"], "/looks/b"),
        (["preview"], "/looks/c"),
        (["of ours", "full"], "/looks/b"),
        ([], "/looks/c"),
    ],
)
def test_render_settings_choose_the_purpose_of_bindings(purposes: list[str], worn: str) -> None:
    """An unknown purpose has no binding of its own, so that USD takes the one without purpose."""
    stage = new_stage()
    three_looks(stage)
    mesh = add_mesh(stage, "/m").GetPrim()
    bind(mesh, "/looks/a", materialPurpose="full")
    bind(mesh, "/looks/b")
    bind(mesh, "/looks/c", materialPurpose="preview")
    reader = StageReader(stage)
    assert set(names_of(reader.read(0).batches)) == {"/looks/c"}
    settings = UsdRender.Settings.Define(stage, "/Render/settings")
    stage.SetMetadata("renderSettingsPrimPath", "/Render/settings")
    assert set(names_of(reader.read(0).batches)) == {"/looks/c"}, "nothing is authored"
    settings.CreateMaterialBindingPurposesAttr(purposes)
    assert set(names_of(reader.read(0).batches)) == {worn}
    settings.GetMaterialBindingPurposesAttr().Clear()
    assert set(names_of(reader.read(0).batches)) == {"/looks/c"}


def test_subsets_are_bound_by_purpose_too() -> None:
    stage = new_stage()
    three_looks(stage)
    points = [(x, y, 0) for y in (0, 1) for x in range(3)]
    mesh = add_mesh(stage, "/m", points, [4] * 2, [0, 1, 4, 3, 1, 2, 5, 4])
    subset = UsdShade.MaterialBindingAPI(mesh.GetPrim()).CreateMaterialBindSubset("s", [1]).GetPrim()
    bind(mesh.GetPrim(), "/looks/a")
    bind(subset, "/looks/b", materialPurpose="full")
    bind(subset, "/looks/c", materialPurpose="preview")
    assert names_of(read(stage).batches) == {"/looks/a": [0], "/looks/c": [1]}


def test_a_collection_binds_its_members() -> None:
    stage = new_stage()
    three_looks(stage)
    group = UsdGeom.Xform.Define(stage, "/group").GetPrim()
    bind(group, "/looks/a")
    add_mesh(stage, "/group/in")
    add_mesh(stage, "/group/out")
    collection = Usd.CollectionAPI.Apply(group, "shiny")
    collection.CreateIncludesRel().AddTarget("/group/in")
    material = UsdShade.Material(stage.GetPrimAtPath("/looks/b"))
    UsdShade.MaterialBindingAPI(group).Bind(collection, material, "shiny")
    scene = read(stage)
    worn = {scene.prim_paths[b.geometry.prim_ids[0]]: b.material.name for b in scene.batches}
    assert worn == {"/group/in": "/looks/b", "/group/out": "/looks/a"}


def test_geom_subsets_split_a_mesh_and_keep_its_face_numbers() -> None:
    stage = new_stage()
    three_looks(stage)
    points = [(x, y, 0) for y in (0, 1) for x in range(5)]
    corners = [c for i in range(4) for c in (i, i + 1, i + 6, i + 5)]
    mesh = add_mesh(stage, "/m", points, [4] * 4, corners)
    bind(mesh.GetPrim(), "/looks/a")
    binding = UsdShade.MaterialBindingAPI(mesh.GetPrim())
    bind(binding.CreateMaterialBindSubset("s1", [1, 3]).GetPrim(), "/looks/b")
    bind(binding.CreateMaterialBindSubset("s2", [2]).GetPrim(), "/looks/c")
    batches = read(stage).batches
    assert names_of(batches) == {"/looks/a": [0], "/looks/b": [1, 3], "/looks/c": [2]}
    for batch in batches:
        centres = batch.geometry.positions[batch.geometry.triangles].mean(axis=1)
        np.testing.assert_array_equal(np.floor(centres[:, 0]), batch.geometry.face_ids)
