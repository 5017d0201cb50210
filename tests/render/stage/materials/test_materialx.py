"""Reading of MaterialX: documents with what they include and define, and findings for what cannot be drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdShade

from render import colour
from render.model.refused_programs import REFUSED
from render.stage import StageReader
from render.stage.findings import FindingLog
from render.stage.materials.mtlx.documents import STUDIO_VARIABLE, studio_documents
from render.stage.materials.mtlx.looks import MaterialXLooks
from render.stage.materials.textures import TextureCache
from tests.render.kits.materialx_walls import document, glowing, material_of, wall
from tests.render.kits.stages import add_material, bind, codes, write_picture

SURFACE = '<standard_surface name="S" type="surfaceshader">{}</standard_surface>'


def _read(folder: Path, text: str) -> StageReader:
    reader = StageReader(wall(folder, text))
    reader.read(0)
    return reader


def _messages(reader: StageReader) -> str:
    return " | ".join(finding.message for finding in reader.findings)


def test_materials_of_one_kind_share_their_functions(tmp_path: Path) -> None:
    """So that they share a program of the device: only numbers differ."""
    graphs = []
    for number, color in enumerate(("1,0,0", "0,0.3,0.9")):
        folder = tmp_path / str(number)
        folder.mkdir()
        nodes = f'<constant name="any_{number}" type="color3"><input name="value" type="color3" value="{color}"/></constant>'
        surface = SURFACE.format(f'<input name="base_color" type="color3" nodename="any_{number}"/>')
        graphs.append(material_of(_read(folder, document(surface, nodes))).graph)
    assert graphs[0].functions == graphs[1].functions
    assert graphs[0].numbers != graphs[1].numbers


def test_definitions_of_an_included_document_are_used(tmp_path: Path) -> None:
    (tmp_path / "defs.mtlx").write_text(
        '<materialx version="1.38" namespace="shop"><nodedef name="ND_half" node="half"><input name="in" type="float" value="3"/>'
        '<output name="out" type="color3"/></nodedef><nodegraph name="NG_half" nodedef="ND_half">'
        '<multiply name="m" type="float"><input name="in1" type="float" interfacename="in"/>'
        '<input name="in2" type="float" value="0.5"/></multiply>'
        '<convert name="c" type="color3"><input name="in" type="float" nodename="m"/></convert>'
        '<output name="out" type="color3" nodename="c"/></nodegraph></materialx>'
    )
    nodes = '<xi:include href="defs.mtlx"/><half name="h" type="color3" namespace="shop"/>'
    reader = _read(tmp_path, glowing(nodes, 'nodename="h"'))
    assert "half" in material_of(reader).graph.functions
    assert not {code for code in codes(reader) if "materialx" in code}


def test_definitions_of_the_studio_are_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "studio"
    folder.mkdir()
    (folder / "defs.mtlx").write_text(
        '<materialx version="1.38"><nodedef name="ND_seven" node="seven"><output name="out" type="float"/></nodedef>'
        '<nodegraph name="NG_seven" nodedef="ND_seven"><constant name="c" type="float">'
        '<input name="value" type="float" value="0.7"/></constant><output name="out" type="float" nodename="c"/></nodegraph>'
        "</materialx>"
    )
    monkeypatch.setenv(STUDIO_VARIABLE, str(folder))
    studio_documents.cache_clear()
    try:
        surface = SURFACE.format('<input name="metalness" type="float" nodename="s"/>')
        reader = _read(tmp_path, document(surface, '<seven name="s" type="float"/>'))
        assert "seven" in material_of(reader).graph.functions
    finally:
        studio_documents.cache_clear()


def test_a_surface_that_a_document_defines_is_taken_apart(tmp_path: Path) -> None:
    nodes = (
        '<nodedef name="ND_paint" node="paint"><input name="tone" type="color3" value="1,0,0"/>'
        '<output name="out" type="surfaceshader"/></nodedef><nodegraph name="NG_paint" nodedef="ND_paint">'
        '<standard_surface name="s" type="surfaceshader"><input name="base_color" type="color3" interfacename="tone"/>'
        '</standard_surface><output name="out" type="surfaceshader" nodename="s"/></nodegraph>'
    )
    surface = '<paint name="S" type="surfaceshader"><input name="tone" type="color3" value="0.125,0.25,0.375"/></paint>'
    assert {0.125, 0.25, 0.375} <= set(material_of(_read(tmp_path, document(surface, nodes))).graph.numbers)


def test_nodes_of_older_versions_are_read(tmp_path: Path) -> None:
    """MaterialX 1.39 has no swizzle."""
    nodes = (
        '<texcoord name="uv" type="vector2"/><swizzle name="x" type="float"><input name="in" type="vector2" nodename="uv"/>'
        '<input name="channels" type="string" value="x"/></swizzle>'
    )
    surface = SURFACE.format('<input name="metalness" type="float" nodename="x"/>')
    reader = _read(tmp_path, document(surface, nodes, version="1.38"))
    assert "graph_uv" in material_of(reader).graph.functions
    assert "materialx_node" not in codes(reader)


@pytest.mark.parametrize("version", ["1.38", "1.39"])
@pytest.mark.parametrize("name", ["w", "twice"])
def test_an_unknown_node_is_named_and_the_rest_is_drawn(tmp_path: Path, version: str, name: str) -> None:
    """Whether it feeds the surface, or a node that does."""
    nodes = (
        '<warp_drive name="w" type="float"/><multiply name="twice" type="float"><input name="in1" type="float" nodename="w"/>'
        '<input name="in2" type="float" value="2"/></multiply>'
    )
    surface = SURFACE.format(
        f'<input name="metalness" type="float" nodename="{name}"/><input name="base" type="float" value="0.625"/>'
    )
    reader = _read(tmp_path, document(surface, nodes, version))
    assert 0.625 in material_of(reader).graph.numbers
    assert "node w is a warp_drive" in _messages(reader)


@pytest.mark.parametrize("link", ['nodename="gone"', 'nodegraph="gone" output="o"'])
def test_a_link_to_nothing_is_named_and_its_value_is_used(tmp_path: Path, link: str) -> None:
    surface = SURFACE.format(f'<input name="metalness" type="float" {link} value="0.625"/>')
    reader = _read(tmp_path, document(surface))
    assert 0.625 in material_of(reader).graph.numbers
    assert "metalness of S is fed by gone" in _messages(reader)


def test_lobes_that_are_not_drawn_are_named(tmp_path: Path) -> None:
    surface = SURFACE.format(
        '<input name="specular_anisotropy" type="float" value="0.5"/><input name="coat_anisotropy" type="float" value="0"/>'
    )
    finding = next(each for each in _read(tmp_path, document(surface)).findings if each.code == "materialx_lobes")
    assert "specular_anisotropy" in finding.message
    assert "coat_anisotropy" not in finding.message


def test_a_circle_of_nodes_is_a_finding(tmp_path: Path) -> None:
    turn = '<sin name="{0}" type="float"><input name="in" type="float" nodename="{1}"/></sin>'
    surface = SURFACE.format('<input name="base" type="float" nodename="a"/>')
    reader = _read(tmp_path, document(surface, turn.format("a", "b") + turn.format("b", "a")))
    assert "circle" in _messages(reader)
    assert material_of(reader).graph is None


LOBES = '<surface name="S" type="surfaceshader"><input name="bsdf" type="BSDF" nodename="d"/></surface>'


def test_lobes_that_cannot_be_drawn_are_named(tmp_path: Path) -> None:
    """One of two, and both."""
    nodes = (
        '<chiang_hair_bsdf name="h" type="BSDF"/><{0} name="b" type="BSDF"/><layer name="d" type="BSDF">'
        '<input name="top" type="BSDF" nodename="h"/><input name="base" type="BSDF" nodename="b"/></layer>'
    )
    reader = _read(tmp_path, document(LOBES, nodes.format("oren_nayar_diffuse_bsdf")))
    assert 0.18 in material_of(reader).graph.numbers
    assert "h, a chiang_hair_bsdf" in _messages(reader)
    other = tmp_path / "other"
    other.mkdir()
    reader = _read(other, document(LOBES, nodes.format("chiang_hair_bsdf")))
    assert material_of(reader).graph is None
    assert "no lobes that can be drawn" in _messages(reader)


METAL_F0 = tuple(
    ((ior - 1) ** 2 + extinction**2) / ((ior + 1) ** 2 + extinction**2)
    for ior, extinction in ((0.5, 3.424), (0.25, 2.346), (0.125, 1.77))
)
"""Reflectance of indices with MaterialX's default extinction, that of gold."""


@pytest.mark.parametrize(
    ("lobe", "inputs", "color"),
    [
        ("oren_nayar_diffuse_bsdf", 'name="color" type="color3" value="0.125,0.25,0.375"', (0.125, 0.25, 0.375)),
        ("oren_nayar_diffuse_bsdf", 'name="color" type="color3" nodename="n"', (0.8, 0.8, 0.8)),
        ("conductor_bsdf", 'name="ior" type="color3" value="0.5,0.25,0.125"', METAL_F0),
        ("dielectric_bsdf", 'name="ior" type="float" value="1.5"', (0.8, 0.8, 0.8)),
    ],
)
def test_lobes_that_a_driver_refuses_have_a_plain_color(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lobe: str, inputs: str, color: tuple[float, ...]
) -> None:
    monkeypatch.setattr(REFUSED, "reason", lambda functions: "too large")
    nodes = f'<noise2d name="n" type="color3"/><{lobe} name="d" type="BSDF"><input {inputs}/></{lobe}>'
    material = material_of(_read(tmp_path, document(LOBES, nodes)))
    assert material.graph is None
    assert colour.from_working(np.array(material.base_color), "lin_rec709") == pytest.approx(color, abs=1e-5)


def test_a_refused_program_changes_only_what_it_draws(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(REFUSED, "_reasons", {})
    reader = _read(tmp_path, document(SURFACE.format("")))
    scene, changes = reader.read(0), reader.changes
    REFUSED.add("float another();", "it is another shot's")
    assert reader.read(0) is scene
    assert reader.changes == changes
    REFUSED.add(material_of(reader).graph.functions, "it is too large")
    assert material_of(reader).graph is None
    assert reader.changes > changes


def test_lobes_that_a_document_defines_are_taken_apart(tmp_path: Path) -> None:
    nodes = (
        '<nodedef name="ND_paint" node="paint"><input name="tone" type="color3" value="1,0,0"/><output name="out" type="BSDF"/>'
        '</nodedef><nodegraph name="NG_paint" nodedef="ND_paint"><oren_nayar_diffuse_bsdf name="o" type="BSDF">'
        '<input name="color" type="color3" interfacename="tone"/></oren_nayar_diffuse_bsdf>'
        '<output name="out" type="BSDF" nodename="o"/></nodegraph>'
        '<paint name="d" type="BSDF"><input name="tone" type="color3" value="0.125,0.25,0.375"/></paint>'
    )
    assert {0.125, 0.25, 0.375} <= set(material_of(_read(tmp_path, document(LOBES, nodes))).graph.numbers)


def test_lobes_that_are_shared_many_times_are_read(tmp_path: Path) -> None:
    """Each of a hundred sums adds the one before to itself."""
    link = '<input name="in{0}" type="BSDF" nodename="n{1}"/>'
    nodes = '<oren_nayar_diffuse_bsdf name="n0" type="BSDF"/>' + "".join(
        f'<add name="n{n}" type="BSDF">{link.format(1, n - 1)}{link.format(2, n - 1)}</add>' for n in range(1, 100)
    )
    reader = _read(tmp_path, document(LOBES.replace('nodename="d"', 'nodename="n99"'), nodes))
    assert material_of(reader).graph is not None


def test_includes_outside_the_shot_are_not_read(tmp_path: Path) -> None:
    (tmp_path / "secret.mtlx").write_text('<materialx><surfacematerial name="M"/></materialx>')
    shot = tmp_path / "shot"
    shot.mkdir()
    surface = SURFACE.format("")
    stage = wall(shot, document(surface, '<xi:include href="../secret.mtlx"/>'))
    log = FindingLog()
    looks = MaterialXLooks(stage, TextureCache(64, confined_to=shot), log)
    assert looks.of_document("/Looks/Materials/M", Usd.TimeCode(0.0)) is None
    assert "lies outside" in log.as_list()[0].message


def test_code_that_a_document_names_is_not_read(tmp_path: Path) -> None:
    secret = tmp_path / "secret.glsl"
    secret.write_text("void half(out float result) { result = 1234567.0; }")
    nodes = (
        '<nodedef name="ND_half" node="half"><output name="out" type="float"/></nodedef>'
        f'<implementation name="IM_half" nodedef="ND_half" file="{secret}" function="half" target="genglsl"/>'
        '<half name="h" type="float"/>'
    )
    surface = SURFACE.format('<input name="base" type="float" nodename="h"/>')
    reader = _read(tmp_path, document(surface, nodes))
    assert "1234567" not in material_of(reader).graph.functions
    assert "half" in _messages(reader)


@pytest.mark.parametrize("name", ["a; } void evil() {", "x\ny", "x#undef", "ä", ""])
def test_names_of_primvars_do_not_enter_the_code(tmp_path: Path, name: str) -> None:
    nodes = (
        f'<geompropvalue name="g" type="color3"><input name="geomprop" type="string" value="{name}"/></geompropvalue>'
    )
    reader = _read(tmp_path, glowing(nodes, 'nodename="g"'))
    graph = material_of(reader).graph
    assert graph is None or not name or name not in graph.functions


def test_octaves_of_noise_have_an_end(tmp_path: Path) -> None:
    nodes = '<fractal3d name="f" type="float"><input name="octaves" type="integer" value="2000000000"/></fractal3d>'
    surface = SURFACE.format('<input name="base" type="float" nodename="f"/>')
    functions = material_of(_read(tmp_path, document(surface, nodes))).graph.functions
    assert "< octaves;" not in functions
    assert "min(octaves, 16)" in functions


@pytest.mark.parametrize(
    "nodes",
    [
        '<input name="a" type="float" interfacename="a"/>',
        '<nodegraph name="G"><input name="a" type="float" nodegraph="G" output="o"/>'
        '<output name="o" type="float" interfacename="a"/></nodegraph>',
    ],
)
def test_inputs_that_lead_to_themselves_are_a_finding(tmp_path: Path, nodes: str) -> None:
    link = 'interfacename="a"' if "nodegraph" not in nodes else 'nodegraph="G" output="o"'
    surface = SURFACE.format(f'<input name="base" type="float" {link}/>')
    reader = _read(tmp_path, document(surface, nodes))
    assert "circle" in _messages(reader)


def test_displacement_is_named_as_not_drawn(tmp_path: Path) -> None:
    text = document(SURFACE.format("")).replace(
        "</surfacematerial>", '<input name="displacementshader" nodename="D"/></surfacematerial>'
    )
    assert "materialx_displacement" in codes(_read(tmp_path, text))


def test_a_surface_for_materialx_comes_first(tmp_path: Path) -> None:
    stage = wall(tmp_path, document(SURFACE.format("")))
    surface = add_material(stage, "/mat", displacement=1.0)
    material = UsdShade.Material(stage.GetPrimAtPath("/mat"))
    material.CreateDisplacementOutput().ConnectToSource(surface.CreateOutput("displacement", Sdf.ValueTypeNames.Token))
    own = UsdShade.Shader.Define(stage, "/mat/mtlx")
    own.CreateIdAttr("ND_standard_surface_surfaceshader")
    material.CreateSurfaceOutput("mtlx").ConnectToSource(own.CreateOutput("out", Sdf.ValueTypeNames.Token))
    bind(stage.GetPrimAtPath("/wall"), "/mat")
    batch = StageReader(stage).read(0).batches[0]
    assert batch.material.graph is not None
    np.testing.assert_allclose(batch.geometry.positions[:, 2], -3, atol=1e-5)


def test_folders_with_brackets_hold_textures(tmp_path: Path) -> None:
    folder = tmp_path / "a [v2]"
    folder.mkdir()
    write_picture(folder / "t.png", np.zeros((2, 2, 3), np.uint8))
    image = '<image name="i" type="color3"><input name="file" type="filename" value="t.png"/></image>'
    assert "texture_unreadable" not in codes(_read(folder, glowing(image, 'nodename="i"')))


def _with_preview(folder: Path, identifier: str) -> Usd.Stage:
    """Wall in a material with a red UsdPreviewSurface, and a node of MaterialX beside it."""
    stage = wall(folder, document(SURFACE.format("")))
    add_material(stage, "/mat", diffuseColor=Gf.Vec3f(1, 0, 0))
    own = UsdShade.Shader.Define(stage, "/mat/mtlx")
    own.CreateIdAttr(identifier)
    output = UsdShade.Material(stage.GetPrimAtPath("/mat")).CreateSurfaceOutput("mtlx")
    output.ConnectToSource(own.CreateOutput("out", Sdf.ValueTypeNames.Token))
    bind(stage.GetPrimAtPath("/wall"), "/mat")
    return stage


def test_a_plain_network_of_usd_has_no_findings(tmp_path: Path) -> None:
    reader = StageReader(_with_preview(tmp_path, "ND_standard_surface_surfaceshader"))
    assert material_of(reader).graph is not None
    assert not {code for code in codes(reader) if "materialx" in code}


@pytest.mark.parametrize("identifier", ["ND_surface", "ND_studio_skin"])
def test_a_preview_stands_in_for_what_cannot_be_read(tmp_path: Path, identifier: str) -> None:
    reader = StageReader(_with_preview(tmp_path, identifier))
    material = material_of(reader)
    assert material.graph is None
    assert material.base_color[0] > 3 * material.base_color[2]


def test_definitions_of_the_librarys_own_nodes_change_nothing(tmp_path: Path) -> None:
    """As where a document includes a file of the library."""
    nodes = (
        '<nodedef name="ND_x" node="standard_surface"><input name="base" type="float" value="1"/>'
        '<output name="out" type="surfaceshader"/></nodedef><nodegraph name="NG_x" nodedef="ND_x">'
        '<surface name="s" type="surfaceshader"/><output name="out" type="surfaceshader" nodename="s"/></nodegraph>'
        '<nodedef name="ND_y" node="contrast"><input name="in" type="matrix33"/><output name="out" type="matrix33"/></nodedef>'
        '<nodegraph name="NG_y" nodedef="ND_y"><constant name="c" type="matrix33"/>'
        '<output name="out" type="matrix33" nodename="c"/></nodegraph>'
        '<contrast name="k" type="float"><input name="in" type="float" value="0.375"/></contrast>'
    )
    surface = SURFACE.format(
        '<input name="base" type="float" nodename="k"/><input name="metalness" type="float" value="0.625"/>'
    )
    reader = _read(tmp_path, document(surface, nodes))
    assert {0.375, 0.625} <= set(material_of(reader).graph.numbers)
    assert "materialx_node" not in codes(reader)


def test_chains_of_two_hundred_nodes_are_read(tmp_path: Path) -> None:
    link = '<sin name="n{0}" type="float"><input name="in" type="float" nodename="n{1}"/></sin>'
    nodes = '<constant name="n0" type="float"/>' + "".join(link.format(n, n - 1) for n in range(1, 190))
    reader = _read(tmp_path, document(SURFACE.format('<input name="base" type="float" nodename="n189"/>'), nodes))
    assert material_of(reader).graph is not None


@pytest.mark.parametrize(
    ("surface", "opacity"),
    [
        ('<gltf_pbr name="S"><input name="alpha" type="float" value="0.3"/></gltf_pbr>', 1.0),
        (
            '<gltf_pbr name="S"><input name="alpha" type="float" value="0.3"/>'
            '<input name="alpha_mode" type="integer" value="2"/></gltf_pbr>',
            0.3,
        ),
        (
            '<UsdPreviewSurface name="S"><input name="opacity" type="float" value="0.5"/>'
            '<input name="opacityThreshold" type="float" value="0.4"/></UsdPreviewSurface>',
            1.0,
        ),
        ('<standard_surface name="S"><input name="transmission" type="float" value="1"/></standard_surface>', 0.04),
        (
            '<standard_surface name="S"><input name="transmission" type="float" value="1"/>'
            '<input name="metalness" type="float" value="1"/></standard_surface>',
            1.0,
        ),
    ],
)
def test_opacity_is_known_where_it_is_constant(tmp_path: Path, surface: str, opacity: float) -> None:
    assert material_of(_read(tmp_path, document(surface))).graph.opacity == pytest.approx(opacity)
