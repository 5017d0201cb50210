"""Mixes of MaterialX's surfaces, against the pictures of what is mixed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, UsdShade

from render.frame import FrameRenderer
from render.model.arrays import FloatArray
from render.stage import StageReader
from tests.render.kits.materialx_walls import add_lamp, add_light, document, material_of, picture, wall
from tests.render.kits.stages import bind, codes

pytestmark = pytest.mark.gl

SURFACES = {
    "metal": '<standard_surface name="{}" type="surfaceshader"><input name="base_color" type="color3" value="0.9,0.6,0.2"/>'
    '<input name="base" type="float" value="1"/><input name="metalness" type="float" value="1"/>'
    '<input name="specular_roughness" type="float" value="0.4"/></standard_surface>',
    "paint": '<gltf_pbr name="{}" type="surfaceshader"><input name="base_color" type="color3" value="0.1,0.3,0.7"/>'
    '<input name="metallic" type="float" value="0"/><input name="roughness" type="float" value="0.4"/>'
    '<input name="emissive" type="color3" value="0.2,0,0"/></gltf_pbr>',
    "coat": '<open_pbr_surface name="{}" type="surfaceshader"><input name="base_color" type="color3" value="0.5,0.1,0.1"/>'
    '<input name="coat_weight" type="float" value="1"/><input name="specular_roughness" type="float" value="0.4"/>'
    '<input name="coat_roughness" type="float" value="0.2"/></open_pbr_surface>',
    "glass": '<standard_surface name="{}" type="surfaceshader"><input name="transmission" type="float" value="1"/>'
    '<input name="specular_roughness" type="float" value="0.4"/></standard_surface>',
    "leaf": '<standard_surface name="{}" type="surfaceshader"><input name="base_color" type="color3" value="0.9,0,0"/>'
    '<input name="base" type="float" value="1"/><input name="specular_roughness" type="float" value="0.4"/>'
    '<input name="opacity" type="color3" value="0.25,0.25,0.25"/></standard_surface>',
    "pane": '<UsdPreviewSurface name="{}" type="surfaceshader"><input name="diffuseColor" type="color3" value="0,0.5,0.8"/>'
    '<input name="roughness" type="float" value="0.4"/><input name="opacity" type="float" value="0.5"/></UsdPreviewSurface>',
    "gone": '<gltf_pbr name="{}" type="surfaceshader"><input name="base_color" type="color3" value="1,0,0"/>'
    '<input name="metallic" type="float" value="0"/><input name="roughness" type="float" value="0.4"/>'
    '<input name="alpha_mode" type="integer" value="2"/><input name="alpha" type="float" value="0"/></gltf_pbr>',
    "glow": '<surface_unlit name="{}" type="surfaceshader">'
    '<input name="emission_color" type="color3" value="0.3,0.5,0.1"/></surface_unlit>',
    "lobes": '<surface name="{}" type="surfaceshader"><input name="bsdf" type="BSDF" nodename="d"/></surface>',
}
LOBE = (
    '<oren_nayar_diffuse_bsdf name="d" type="BSDF"><input name="color" type="color3" value="0.2,0.6,0.4"/>'
    "</oren_nayar_diffuse_bsdf>"
)
QUARTER = '<constant name="q" type="float"><input name="value" type="float" value="0.25"/></constant>'
RIGHT = (
    '<texcoord name="st" type="vector2"/><extract name="u" type="float"><input name="in" type="vector2" nodename="st"/>'
    '</extract><ifgreater name="r" type="float"><input name="value1" type="float" nodename="u"/>'
    '<input name="value2" type="float" value="0.5"/><input name="in1" type="float" value="1"/>'
    '<input name="in2" type="float" value="0"/></ifgreater>'
)
BY_VALUE, BY_NODE, BY_SIDE = 'value="0.25"', 'nodename="q"', 'nodename="r"'


def _mix(name: str, bg: str, fg: str, share: str) -> str:
    sides = "".join(
        f'<input name="{side}" type="surfaceshader" nodename="{n}"/>' for side, n in (("bg", bg), ("fg", fg))
    )
    return f'<mix name="{name}" type="surfaceshader">{sides}<input name="mix" type="float" {share}/></mix>'


def _mixed(bg: str, fg: str, share: str) -> str:
    """Document that mixes two of `SURFACES`."""
    nodes = LOBE + QUARTER + RIGHT + SURFACES[bg].format("a") + SURFACES[fg].format("b")
    return document(_mix("S", "a", "b", share), nodes)


def _reader(folder: Path, text: str) -> StageReader:
    reader = StageReader(wall(folder, text))
    reader.read(0)
    return reader


def _messages(reader: StageReader) -> str:
    return " | ".join(finding.message for finding in reader.findings)


def _picture(renderer: FrameRenderer, folder: Path, text: str) -> FloatArray:
    folder.mkdir()
    stage = wall(folder, text)
    add_light(stage)
    add_lamp(stage)
    return picture(renderer, stage)


@pytest.mark.parametrize("share", [BY_VALUE, BY_NODE])
@pytest.mark.parametrize(
    ("bg", "fg"),
    [
        ("metal", "paint"),
        ("paint", "coat"),
        ("metal", "glass"),
        ("glow", "paint"),
        ("lobes", "metal"),
        ("leaf", "paint"),
        ("paint", "pane"),
        ("leaf", "pane"),
        ("gone", "paint"),
        ("gone", "metal"),
    ],
)
def test_a_mix_has_the_light_of_both(renderer: FrameRenderer, tmp_path: Path, bg: str, fg: str, share: str) -> None:
    """Surfaces are of equal roughness, or one of them reflects nothing."""
    mixed = _picture(renderer, tmp_path / "mixed", _mixed(bg, fg, share))
    a, b = (_picture(renderer, tmp_path / each, document(SURFACES[each].format("S"), LOBE)) for each in (bg, fg))
    assert np.abs(a - b).max() > 0.1
    np.testing.assert_allclose(mixed, 0.75 * a + 0.25 * b, atol=0.01)


@pytest.mark.parametrize(("bg", "fg"), [("metal", "paint"), ("glass", "coat"), ("lobes", "glow")])
def test_a_mask_shows_one_or_the_other(renderer: FrameRenderer, tmp_path: Path, bg: str, fg: str) -> None:
    mixed = _picture(renderer, tmp_path / "mixed", _mixed(bg, fg, BY_SIDE))
    a, b = (_picture(renderer, tmp_path / each, document(SURFACES[each].format("S"), LOBE)) for each in (bg, fg))
    np.testing.assert_allclose(mixed[:, :7], a[:, :7], atol=0.004)
    np.testing.assert_allclose(mixed[:, 9:], b[:, 9:], atol=0.004)


def test_mixes_are_mixed(renderer: FrameRenderer, tmp_path: Path) -> None:
    names = ("metal", "paint", "glass")
    nodes = LOBE + QUARTER + "".join(SURFACES[each].format(each) for each in names) + _mix("m", *names[:2], BY_NODE)
    mixed = _picture(renderer, tmp_path / "mixed", document(_mix("S", "m", "glass", BY_NODE), nodes))
    metal, paint, glass = (
        _picture(renderer, tmp_path / each, document(SURFACES[each].format("S"), LOBE)) for each in names
    )
    np.testing.assert_allclose(mixed, 0.75 * (0.75 * metal + 0.25 * paint) + 0.25 * glass, atol=0.01)


@pytest.mark.parametrize(("share", "seen"), [("0", "metal"), ("1", "paint"), ("-3", "metal"), ("7", "paint")])
def test_a_whole_share_costs_nothing(tmp_path: Path, share: str, seen: str) -> None:
    alone, mixed = tmp_path / "alone", tmp_path / "mixed"
    graphs = []
    for folder, text in (
        (alone, document(SURFACES[seen].format("S"))),
        (mixed, _mixed("metal", "paint", f'value="{share}"')),
    ):
        folder.mkdir()
        graphs.append(material_of(_reader(folder, text)).graph)
    assert graphs[0].numbers == graphs[1].numbers
    assert graphs[1].mixed == 1


def test_a_mix_of_usds_own_shaders(renderer: FrameRenderer, tmp_path: Path) -> None:
    stage = wall(tmp_path, document(SURFACES["glow"].format("S")))
    shaders = {}
    for name, color in (("a", (0.8, 0.0, 0.0)), ("b", (0.0, 0.4, 0.0))):
        shaders[name] = UsdShade.Shader.Define(stage, f"/mat/{name}")
        shaders[name].CreateIdAttr("ND_surface_unlit")
        shaders[name].CreateInput("emission_color", Sdf.ValueTypeNames.Color3f).Set(color)
    mixed = UsdShade.Shader.Define(stage, "/mat/mixed")
    mixed.CreateIdAttr("ND_mix_surfaceshader")
    mixed.CreateInput("mix", Sdf.ValueTypeNames.Float).Set(0.25)
    for side, name in (("bg", "a"), ("fg", "b")):
        out = shaders[name].CreateOutput("out", Sdf.ValueTypeNames.Token)
        mixed.CreateInput(side, Sdf.ValueTypeNames.Token).ConnectToSource(out)
    material = UsdShade.Material.Define(stage, "/mat")
    material.CreateSurfaceOutput("mtlx").ConnectToSource(mixed.CreateOutput("out", Sdf.ValueTypeNames.Token))
    bind(stage.GetPrimAtPath("/wall"), "/mat")
    assert not {code for code in codes(StageReader(stage)) if "materialx" in code}
    np.testing.assert_allclose(picture(renderer, stage)[8, 8, :3], (0.6, 0.1, 0.0), atol=0.002)


@pytest.mark.parametrize(
    ("kind", "value", "color"),
    [
        ("color3", "0.2,0.4,0.1", (0.2, 0.4, 0.1, 1.0)),
        ("float", "0.3", (0.3, 0.3, 0.3, 1.0)),
        ("color4", "0.8,0.4,0.2,0.5", (0.4, 0.2, 0.1, 0.5)),
        ("color3", "abc", (0.0, 0.0, 0.0, 1.0)),
    ],
)
def test_a_color_becomes_a_surface(
    renderer: FrameRenderer, tmp_path: Path, kind: str, value: str, color: tuple[float, ...]
) -> None:
    glow = f'<convert name="c" type="surfaceshader"><input name="in" type="{kind}" value="{value}"/></convert>'
    dot = '<dot name="S" type="surfaceshader"><input name="in" type="surfaceshader" nodename="c"/></dot>'
    found = picture(renderer, wall(tmp_path, document(dot, glow)))
    np.testing.assert_allclose(found[8, 8], color, atol=0.002)


def test_what_cannot_be_mixed_is_named(tmp_path: Path) -> None:
    nodes = "".join(SURFACES["paint"].format(f"s{i}") for i in range(10)) + QUARTER
    many = nodes + "".join(_mix(f"m{i}", f"m{i - 1}" if i else "s0", f"s{i + 1}", BY_NODE) for i in range(9))
    cases = {
        "too many": (many, _mix("S", "m8", "s0", BY_NODE), "mixes more than 8 surfaces"),
        "strange": ('<volume name="v" type="surfaceshader"/>' + nodes, _mix("S", "v", "s0", BY_NODE), "is a volume"),
        "ours": (
            nodes,
            _mix("S", "s0", "s1", BY_NODE).replace("mix ", "mixed_surface ").replace("</mix", "</mixed_surface"),
            "is a",
        ),
        "nothing": ("", _mix("S", "s0", "s1", BY_VALUE), "mixes no surfaces"),
        "itself": (nodes, _mix("S", "S", "s1", BY_VALUE), "circle"),
    }
    for name, (given, surface, told) in cases.items():
        folder = tmp_path / name
        folder.mkdir()
        reader = _reader(folder, document(surface, given))
        assert told in _messages(reader), name
        assert (material_of(reader).graph is None) == (name != "prefixed"), name


def test_eight_surfaces_behind_dots_are_mixed(tmp_path: Path) -> None:
    dot = '<dot name="d{0}" type="surfaceshader"><input name="in" type="surfaceshader" nodename="s{0}"/></dot>'
    nodes = QUARTER + "".join(SURFACES["paint"].format(f"s{i}") + dot.format(i) for i in range(8))
    nodes += "".join(_mix(f"m{i}", f"m{i - 1}" if i else "d0", f"d{i + 1}", BY_NODE) for i in range(6))
    assert material_of(_reader(tmp_path, document(_mix("S", "m5", "d7", BY_NODE), nodes))).graph.mixed == 15


def test_a_surface_is_no_number(tmp_path: Path) -> None:
    nodes = "".join(SURFACES["paint"].format(name) for name in "ab")
    reader = _reader(tmp_path, document(_mix("S", "a", "b", 'nodename="a"'), nodes))
    assert "is fed by a surface" in _messages(reader)


@pytest.mark.parametrize("share", ['value="abc"', 'value="0.2, 0.3, 0.4"'])
def test_a_share_that_is_no_number_is_named(tmp_path: Path, share: str) -> None:
    nodes = "".join(SURFACES["paint"].format(name) for name in "ab")
    reader = _reader(tmp_path, document(_mix("S", "a", "b", share), nodes))
    assert "which is no number, is not drawn" in _messages(reader)
    assert material_of(reader).graph.mixed == 1


def test_a_side_that_nothing_feeds_is_named(tmp_path: Path) -> None:
    reader = _reader(tmp_path, document(_mix("S", "a", "none", BY_VALUE), SURFACES["paint"].format("a")))
    assert "the fg of S, which nothing feeds, is not drawn" in _messages(reader)
    assert material_of(reader).graph.mixed == 1
