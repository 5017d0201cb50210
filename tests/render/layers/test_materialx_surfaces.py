"""Networks of MaterialX as they are drawn: nodes by closed forms, surfaces against UsdPreviewSurface."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, UsdGeom, UsdLux, UsdShade

from render.frame import FrameRenderer
from tests.render.kits.materialx_walls import add_lamp, add_light, document, glowing, picture, wall
from tests.render.kits.stages import add_material, bind, set_primvar, write_picture

pytestmark = pytest.mark.gl

MIDDLES = (np.arange(16) + 0.5) / 16


def test_a_ramp_runs_along_the_texture_coordinates(renderer: FrameRenderer, tmp_path: Path) -> None:
    ramp = (
        '<ramplr name="r" type="color3"><input name="valuel" type="color3" value="1,0,0"/>'
        '<input name="valuer" type="color3" value="0,0.5,4"/></ramplr>'
    )
    got = picture(renderer, wall(tmp_path, glowing(ramp, 'nodename="r"')))[8, :, :3]
    np.testing.assert_allclose(got, np.stack([1 - MIDDLES, 0.5 * MIDDLES, 4 * MIDDLES], axis=1), atol=0.01)


def test_nodes_compute_as_they_say(renderer: FrameRenderer, tmp_path: Path) -> None:
    """0.5 + 0.4 sin(6 s) over the picture, and s t."""
    nodes = (
        '<nodegraph name="G"><texcoord name="uv" type="vector2"/>'
        '<separate2 name="part" type="multioutput"><input name="in" type="vector2" nodename="uv"/></separate2>'
        '<multiply name="six" type="float"><input name="in1" type="float" nodename="part" output="outx"/>'
        '<input name="in2" type="float" value="6"/></multiply>'
        '<sin name="wave" type="float"><input name="in" type="float" nodename="six"/></sin>'
        '<range name="up" type="float"><input name="in" type="float" nodename="wave"/>'
        '<input name="inlow" type="float" value="-1"/>'
        '<input name="inhigh" type="float" value="1"/><input name="outlow" type="float" value="0.1"/>'
        '<input name="outhigh" type="float" value="0.9"/></range>'
        '<multiply name="st" type="float"><input name="in1" type="float" nodename="part" output="outx"/>'
        '<input name="in2" type="float" nodename="part" output="outy"/></multiply>'
        '<combine3 name="c" type="color3"><input name="in1" type="float" nodename="up"/>'
        '<input name="in2" type="float" nodename="st"/>'
        '<input name="in3" type="float" value="0.25"/></combine3><output name="o" type="color3" nodename="c"/></nodegraph>'
    )
    got = picture(renderer, wall(tmp_path, glowing(nodes, 'nodegraph="G" output="o"')))[..., :3]
    s, t = np.meshgrid(MIDDLES, MIDDLES[::-1])
    want = np.stack([0.5 + 0.4 * np.sin(6 * s), s * t, np.full_like(s, 0.25)], axis=2)
    np.testing.assert_allclose(got, want, atol=0.01)


@pytest.mark.parametrize("up", ["Y", "Z"])
def test_a_place_is_in_the_prims_own_space(renderer: FrameRenderer, tmp_path: Path, up: str) -> None:
    """Centimetres from the prim's origin, wherever the prim stands."""
    nodes = (
        '<position name="p" type="vector3"/>'
        '<convert name="c" type="color3"><input name="in" type="vector3" nodename="p"/></convert>'
        '<multiply name="m" type="color3"><input name="in1" type="color3" nodename="c"/>'
        '<input name="in2" type="float" value="0.01"/></multiply>'
        '<add name="a" type="color3"><input name="in1" type="color3" nodename="m"/>'
        '<input name="in2" type="float" value="5"/></add>'
    )
    stage = wall(tmp_path, glowing(nodes, 'nodename="a"'), metres_per_unit=0.01, up=up)
    shift = Gf.Vec3d(50, 0, 0)  # the picture shows what lies half a metre farther left of it
    UsdGeom.Xformable(stage.GetPrimAtPath("/wall")).AddTranslateOp().Set(shift)
    got = picture(renderer, stage)[8, 8:, :3] - 5
    np.testing.assert_allclose(got[:, 0], 4 * (MIDDLES[8:] - 0.5) - 0.5, atol=0.02)
    np.testing.assert_allclose(got[:, 1 if up == "Z" else 2], 4 if up == "Z" else -4, atol=0.02)


def test_a_place_in_the_world_is_the_stages(renderer: FrameRenderer, tmp_path: Path) -> None:
    nodes = (
        '<position name="p" type="vector3"><input name="space" type="string" value="world"/></position>'
        '<convert name="c" type="color3"><input name="in" type="vector3" nodename="p"/></convert>'
        '<multiply name="m" type="color3"><input name="in1" type="color3" nodename="c"/>'
        '<input name="in2" type="float" value="0.01"/></multiply>'
        '<add name="a" type="color3"><input name="in1" type="color3" nodename="m"/>'
        '<input name="in2" type="float" value="5"/></add>'
    )
    stage = wall(tmp_path, glowing(nodes, 'nodename="a"'), metres_per_unit=0.01, up="Z")
    got = picture(renderer, stage)[..., :3] - 5
    np.testing.assert_allclose(got[8, :, 0], 4 * (MIDDLES - 0.5), atol=0.02)
    np.testing.assert_allclose(got[:, 8, 1], 4, atol=0.02)
    np.testing.assert_allclose(got[:, 8, 2], -4 * (MIDDLES - 0.5), atol=0.02)


def test_an_image_is_read_in_its_colour_space(renderer: FrameRenderer, tmp_path: Path) -> None:
    """Rows from the top; sRGB is made linear."""
    pixels = np.zeros((2, 2, 3), np.uint8)
    pixels[0, 1], pixels[1, 0] = (188, 0, 0), (0, 255, 0)
    write_picture(tmp_path / "t.png", pixels.repeat(32, axis=0).repeat(32, axis=1))
    file = '<input name="file" type="filename" value="t.png" colorspace="srgb_texture"/>'
    image = f'<image name="i" type="color3">{file}</image>'
    got = picture(renderer, wall(tmp_path, glowing(image, 'nodename="i"')), 4)[..., :3]
    np.testing.assert_allclose(got[0, 3], (0.503, 0, 0), atol=0.01)
    np.testing.assert_allclose(got[3, 0], (0, 1, 0), atol=0.01)


def test_an_image_is_tiled(renderer: FrameRenderer, tmp_path: Path) -> None:
    pixels = np.zeros((1, 64, 3), np.uint8)
    pixels[:, 32:] = 255
    write_picture(tmp_path / "t.png", pixels)
    image = (
        '<tiledimage name="i" type="color3"><input name="file" type="filename" value="t.png"/>'
        '<input name="uvtiling" type="vector2" value="4, 1"/></tiledimage>'
    )
    got = picture(renderer, wall(tmp_path, glowing(image, 'nodename="i"')), 64)[32, :, 0]
    assert [round(float(got[16 * tile + at])) for tile in range(4) for at in (4, 12)] == [0, 1] * 4


def test_colours_of_the_geometry_are_read(renderer: FrameRenderer, tmp_path: Path) -> None:
    nodes = '<geompropvalue name="g" type="color3"><input name="geomprop" type="string" value="paint"/></geompropvalue>'
    stage = wall(tmp_path, glowing(nodes, 'nodename="g"'))
    prim = stage.GetPrimAtPath("/wall")
    set_primvar(prim, "paint", Sdf.ValueTypeNames.Color3fArray, "constant", [(0.2, 0.7, 0.1)])
    np.testing.assert_allclose(picture(renderer, stage, 4)[1, 1, :3], (0.2, 0.7, 0.1), atol=0.003)


def test_numbers_of_the_geometry_are_read(renderer: FrameRenderer, tmp_path: Path) -> None:
    nodes = (
        '<geompropvalue name="g" type="float"><input name="geomprop" type="string" value="wear"/></geompropvalue>'
        '<mix name="m" type="color3"><input name="fg" type="color3" value="1,0,0"/><input name="bg" type="color3" value="0,0,1"/>'
        '<input name="mix" type="float" nodename="g"/></mix>'
    )
    stage = wall(tmp_path, glowing(nodes, 'nodename="m"'))
    set_primvar(stage.GetPrimAtPath("/wall"), "wear", Sdf.ValueTypeNames.FloatArray, "vertex", [0.0, 1.0, 1.0, 0.0])
    got = picture(renderer, stage)[8, :, :3]
    np.testing.assert_allclose(got, np.stack([MIDDLES, 0 * MIDDLES, 1 - MIDDLES], axis=1), atol=0.01)


def test_time_runs_with_the_frames(renderer: FrameRenderer, tmp_path: Path) -> None:
    join = '<combine3 name="c" type="color3"><input name="in1" type="float" nodename="t"/></combine3>'
    nodes = f'<time name="t" type="float"/>{join}'
    stage = wall(tmp_path, glowing(nodes, 'nodename="c"'))
    stage.SetTimeCodesPerSecond(24)
    assert picture(renderer, stage, 4, time=12)[1, 1, 0] == pytest.approx(0.5, abs=0.002)
    assert picture(renderer, stage, 4, time=36)[1, 1, 0] == pytest.approx(1.5, abs=0.004)


PREVIEW = {"diffuseColor": Gf.Vec3f(0.6, 0.3, 0.1), "metallic": 0.3, "roughness": 0.35, "ior": 1.6}
SURFACES = {
    "standard_surface": {
        "base": "1",
        "base_color": "0.6,0.3,0.1",
        "metalness": "0.3",
        "specular_roughness": "0.35",
        "specular_IOR": "1.6",
    },
    "open_pbr_surface": {
        "base_color": "0.6,0.3,0.1",
        "base_metalness": "0.3",
        "specular_roughness": "0.35",
        "specular_ior": "1.6",
    },
    "gltf_pbr": {"base_color": "0.6,0.3,0.1", "metallic": "0.3", "roughness": "0.35", "ior": "1.6"},
    "UsdPreviewSurface": {"diffuseColor": "0.6,0.3,0.1", "metallic": "0.3", "roughness": "0.35", "ior": "1.6"},
    "disney_principled": {
        "baseColor": "0.6,0.3,0.1",
        "metallic": "0.3",
        "roughness": "0.35",
        "specular": str((0.6 / 2.6) ** 2 / 0.08),
    },
}


@pytest.mark.parametrize("category", list(SURFACES))
def test_a_surface_equals_the_preview_surface(renderer: FrameRenderer, tmp_path: Path, category: str) -> None:
    inputs = "".join(
        f'<input name="{name}" type="{"color3" if "," in value else "float"}" value="{value}"/>'
        for name, value in SURFACES[category].items()
    )
    stage = wall(tmp_path, document(f'<{category} name="S" type="surfaceshader">{inputs}</{category}>'))
    add_light(stage)
    got = picture(renderer, stage)
    add_material(stage, "/preview", **PREVIEW)
    bind(stage.GetPrimAtPath("/wall"), "/preview")
    want = picture(renderer, stage)
    assert want[..., :3].max() > 0.2
    np.testing.assert_allclose(got, want, atol=0.004)


def test_a_network_in_usd_equals_a_document(renderer: FrameRenderer, tmp_path: Path) -> None:
    nodes = (
        '<checkerboard name="c" type="color3"><input name="color1" type="color3" value="0.9,0.1,0.2"/>'
        '<input name="color2" type="color3" value="0.05,0.1,0.7"/>'
        '<input name="uvtiling" type="vector2" value="4,4"/></checkerboard>'
    )
    surface = (
        '<standard_surface name="S" type="surfaceshader"><input name="base_color" type="color3" nodename="c"/>'
        '<input name="coat" type="float" value="0.7"/></standard_surface>'
    )
    stage = wall(tmp_path, document(surface, nodes))
    add_light(stage)
    want = picture(renderer, stage)
    material = UsdShade.Material.Define(stage, "/mat")
    shader = UsdShade.Shader.Define(stage, "/mat/s")
    shader.CreateIdAttr("ND_standard_surface_surfaceshader")
    shader.CreateInput("coat", Sdf.ValueTypeNames.Float).Set(0.7)
    board = UsdShade.Shader.Define(stage, "/mat/c")
    board.CreateIdAttr("ND_checkerboard_color3")
    for name, value in (("color1", (0.9, 0.1, 0.2)), ("color2", (0.05, 0.1, 0.7))):
        board.CreateInput(name, Sdf.ValueTypeNames.Color3f).Set(value)
    board.CreateInput("uvtiling", Sdf.ValueTypeNames.Float2).Set((4, 4))
    link = shader.CreateInput("base_color", Sdf.ValueTypeNames.Color3f)
    link.ConnectToSource(board.CreateOutput("out", Sdf.ValueTypeNames.Color3f))
    material.CreateSurfaceOutput("mtlx").ConnectToSource(shader.CreateOutput("out", Sdf.ValueTypeNames.Token))
    bind(stage.GetPrimAtPath("/wall"), "/mat")
    got = picture(renderer, stage)
    assert np.ptp(want[..., 0]) > 0.1
    np.testing.assert_allclose(got, want, atol=1e-4)


def test_a_normal_map_turns_the_surface(renderer: FrameRenderer, tmp_path: Path) -> None:
    """A map that leans everything towards +s by 30° is lit by the cosine of what is left."""
    lean = np.round(127.5 + 127.5 * np.array([0.5, 0, np.sqrt(0.75)])).astype(np.uint8)
    write_picture(tmp_path / "n.png", np.tile(lean, (2, 2, 1)))
    nodes = (
        '<image name="i" type="vector3"><input name="file" type="filename" value="n.png"/></image>'
        '<normalmap name="n" type="vector3"><input name="in" type="vector3" nodename="i"/></normalmap>'
    )
    surface = (
        '<standard_surface name="S" type="surfaceshader"><input name="specular" type="float" value="0"/>'
        '<input name="base" type="float" value="1"/><input name="base_color" type="color3" value="0.5,0.5,0.5"/>'
        '<input name="normal" type="vector3" nodename="n"/></standard_surface>'
    )
    stage = wall(tmp_path, document(surface, nodes))
    sun = UsdLux.DistantLight.Define(stage, "/sun")
    sun.CreateAngleAttr(0.0)
    sun.CreateIntensityAttr(2.0)
    turn = UsdGeom.Xformable(sun).AddRotateYOp()
    for degrees in (0.0, 30.0, -40.0):
        turn.Set(degrees)  # towards +X for what shines from there
        leaning = np.cos(np.radians(30 - degrees))
        got = picture(renderer, stage, 4)[1, 1, 0]
        # without reflection at normal incidence there is a faint sheen at grazing angles
        assert got == pytest.approx(0.5 / np.pi * 2 * leaning, rel=0.02)


def test_glass_reflects_and_shows_what_is_behind(renderer: FrameRenderer, tmp_path: Path) -> None:
    """Seen head-on, glass of index 1.5 keeps back 4 % of what is behind it, and reflects 4 % of the sky."""
    surface = (
        '<standard_surface name="S" type="surfaceshader"><input name="transmission" type="float" value="1"/>'
        '<input name="specular_roughness" type="float" value="0.2"/></standard_surface>'
    )
    stage = wall(tmp_path, document(surface))
    add_lamp(stage)
    sky = UsdLux.DomeLight.Define(stage, "/sky")
    sky.CreateIntensityAttr(0.0)
    assert picture(renderer, stage, 5)[2, 2, 0] == pytest.approx(2 * 0.96, rel=0.01)
    sky.CreateIntensityAttr(1.0)
    assert picture(renderer, stage, 5)[2, 2, 0] == pytest.approx(2 * 0.96 + 0.04, rel=0.02)


def test_a_cut_out_leaves_holes(renderer: FrameRenderer, tmp_path: Path) -> None:
    nodes = (
        '<checkerboard name="c" type="color3"><input name="color1" type="color3" value="1,1,1"/>'
        '<input name="color2" type="color3" value="0,0,0"/><input name="uvtiling" type="vector2" value="2,1"/></checkerboard>'
    )
    opacity = '<input name="opacity" type="color3" nodename="c"/>'
    surface = f'<standard_surface name="S" type="surfaceshader">{opacity}</standard_surface>'
    got = picture(renderer, wall(tmp_path, document(surface, nodes)), 8)[4, :, 3]
    assert sorted({round(float(value)) for value in (got[1], got[6])}) == [0, 1]


def test_a_set_of_udim_tiles_is_drawn(renderer: FrameRenderer, tmp_path: Path) -> None:
    """Tiles 1001 and 1012, of unlike sizes; where there is none, the default."""
    write_picture(tmp_path / "t.1001.png", np.tile(np.array([255, 0, 0], np.uint8), (8, 8, 1)))
    write_picture(tmp_path / "t.1012.png", np.tile(np.array([0, 255, 0], np.uint8), (32, 32, 1)))
    image = (
        '<image name="i" type="color3"><input name="file" type="filename" value="t.&lt;UDIM&gt;.png"/>'
        '<input name="default" type="color3" value="0,0,0.5"/></image>'
    )
    stage = wall(tmp_path, glowing(image, 'nodename="i"'))
    prim = stage.GetPrimAtPath("/wall")
    set_primvar(prim, "st", Sdf.ValueTypeNames.TexCoord2fArray, "vertex", [(0, 0), (2, 0), (2, 2), (0, 2)])
    got = picture(renderer, stage)[..., :3]
    np.testing.assert_allclose(got[12, 3], (1, 0, 0), atol=0.01)
    np.testing.assert_allclose(got[3, 12], (0, 1, 0), atol=0.01)
    np.testing.assert_allclose(got[3, 3], (0, 0, 0.5), atol=0.01)


def test_normals_are_those_of_the_prims_own_space(renderer: FrameRenderer, tmp_path: Path) -> None:
    convert = '<convert name="c" type="color3"><input name="in" type="vector3" nodename="n"/></convert>'
    nodes = f'<normal name="n" type="vector3"/>{convert}'
    stage = wall(tmp_path, glowing(nodes, 'nodename="c"'))
    np.testing.assert_allclose(picture(renderer, stage, 4)[1, 1, :3], (0, 0, 1), atol=0.01)


def test_unlit_surfaces_glow_and_let_through(renderer: FrameRenderer, tmp_path: Path) -> None:
    surface = (
        '<surface_unlit name="S" type="surfaceshader"><input name="transmission" type="float" value="1"/>'
        '<input name="emission_color" type="color3" value="0.3,0.3,0.3"/></surface_unlit>'
    )
    stage = wall(tmp_path, document(surface))
    add_lamp(stage)
    assert picture(renderer, stage, 5)[2, 2, 0] == pytest.approx(2.3, rel=0.01)


def test_a_network_of_usd_reads_a_set_of_tiles(renderer: FrameRenderer, tmp_path: Path) -> None:
    for number, color in ((1001, (255, 0, 0)), (1002, (0, 255, 0))):
        write_picture(tmp_path / f"t.{number}.png", np.tile(np.array(color, np.uint8), (8, 8, 1)))
    stage = wall(tmp_path, document('<surface_unlit name="S" type="surfaceshader"/>'))
    prim = stage.GetPrimAtPath("/wall")
    set_primvar(prim, "st", Sdf.ValueTypeNames.TexCoord2fArray, "vertex", [(0, 0), (2, 0), (2, 1), (0, 1)])
    material = UsdShade.Material.Define(stage, "/mat")
    shader, image = UsdShade.Shader.Define(stage, "/mat/s"), UsdShade.Shader.Define(stage, "/mat/i")
    shader.CreateIdAttr("ND_surface_unlit")
    image.CreateIdAttr("ND_image_color3")
    image.CreateInput("file", Sdf.ValueTypeNames.Asset).Set("./t.<UDIM>.png")
    link = shader.CreateInput("emission_color", Sdf.ValueTypeNames.Color3f)
    link.ConnectToSource(image.CreateOutput("out", Sdf.ValueTypeNames.Color3f))
    material.CreateSurfaceOutput().ConnectToSource(shader.CreateOutput("out", Sdf.ValueTypeNames.Token))
    bind(prim, "/mat")
    got = picture(renderer, stage, 8)[4, :, :3]
    np.testing.assert_allclose(got[[1, 6]], [(1, 0, 0), (0, 1, 0)], atol=0.01)


@pytest.mark.parametrize("word", ["GRAPH", "focus", "detail", "Surface", "OPAQUE", "graph"])
def test_names_of_a_document_meet_none_of_ours(renderer: FrameRenderer, tmp_path: Path, word: str) -> None:
    inner = f'<input name="in1" type="float" interfacename="{word}"/><input name="in2" type="float" value="0.5"/>'
    nodes = (
        f'<nodedef name="ND_half" node="half"><input name="{word}" type="float" value="1"/>'
        f'<output name="out" type="float"/></nodedef><nodegraph name="{word}" nodedef="ND_half">'
        f'<multiply name="{word}" type="float">{inner}</multiply><output name="out" type="float" nodename="{word}"/></nodegraph>'
        f'<half name="h" type="float"><input name="{word}" type="float" value="0.5"/></half>'
        '<convert name="c" type="color3"><input name="in" type="float" nodename="h"/></convert>'
    )
    got = picture(renderer, wall(tmp_path, glowing(nodes, 'nodename="c"')), 4)
    assert got[1, 1, 0] == pytest.approx(0.25, abs=0.002)
