"""Displacement by MaterialX: surfaces move by constants, primvars and images, and stay where it is anything else."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdShade

from render.stage import StageReader
from render.stage.findings import FindingLog
from render.stage.materials.looks import LookReader
from render.stage.materials.textures import TextureCache
from tests.render.kits.materialx_walls import document, wall
from tests.render.kits.stages import bind, codes, set_primvar, write_picture

SURFACE = '<standard_surface name="S" type="surfaceshader"/>'
LINK = '<input name="displacement" type="float" nodename="{}"/>'
IMAGE = (
    '<image name="i" type="float"><input name="file" type="filename" value="h.png"/>'
    '<input name="default" type="float" value="0.5"/></image>'
)


def _stage(folder: Path, displacement: str, nodes: str = "") -> Usd.Stage:
    """The wall, 4 m before the origin and facing it, with a displacement."""
    node = f'<displacement name="D" type="displacementshader">{displacement}</displacement>'
    link = '<input name="displacementshader" type="displacementshader" nodename="D"/></surfacematerial>'
    return wall(folder, document(SURFACE, nodes + node).replace("</surfacematerial>", link))


def _heights(reader: StageReader) -> dict[tuple[float, float], float]:
    """Height of each corner, by the signs of its place."""
    points = reader.read(0).batches[0].geometry.positions
    return {(float(np.sign(x)), float(np.sign(y))): float(z) + 4 for x, y, z in points.tolist()}


def _write_heights(folder: Path) -> None:
    """Image that is white at the upper half, black below."""
    pixels = np.zeros((64, 64, 3), np.uint8)
    pixels[:32] = 255
    write_picture(folder / "h.png", pixels)


def test_a_constant_moves_a_surface(tmp_path: Path) -> None:
    values = '<input name="displacement" type="float" value="0.25"/><input name="scale" type="float" value="2"/>'
    reader = StageReader(_stage(tmp_path, values))
    assert _heights(reader)[1, 1] == pytest.approx(0.5, abs=1e-5)
    assert "materialx_displacement" not in codes(reader)


@pytest.mark.parametrize(
    ("nodes", "low", "high"),
    [
        ("", 0.0, 1.0),
        (
            '<multiply name="h" type="float"><input name="in1" type="float" value="-0.5"/>'
            '<input name="in2" type="float" nodename="i"/></multiply>',
            0.0,
            -0.5,
        ),
        (
            '<remap name="h" type="float"><input name="in" type="float" nodename="i"/>'
            '<input name="outlow" type="float" value="-0.25"/><input name="outhigh" type="float" value="0.75"/></remap>',
            -0.25,
            0.75,
        ),
        (
            '<subtract name="h" type="float"><input name="in1" type="float" value="0.125"/>'
            '<input name="in2" type="float" nodename="i"/></subtract>',
            0.125,
            -0.875,
        ),
    ],
)
def test_an_image_moves_a_surface(tmp_path: Path, nodes: str, low: float, high: float) -> None:
    _write_heights(tmp_path)
    stage = _stage(tmp_path, LINK.format("h" if nodes else "i"), IMAGE + nodes)
    for v, height in ((0.25, low), (0.75, high)):
        st = [(0.5, v)] * 4
        set_primvar(stage.GetPrimAtPath("/wall"), "st", Sdf.ValueTypeNames.TexCoord2fArray, "vertex", st)
        assert _heights(StageReader(stage))[1, 1] == pytest.approx(height, abs=0.01)


COLORS = (
    '<image name="c" type="color3"><input name="file" type="filename" value="c.png" colorspace="raw"/></image>'
    '<{node} name="n" type="color3"><input name="{into}" type="color3" nodename="c"/>{rest}</{node}>'
    '<extract name="h" type="float"><input name="in" type="color3" nodename="n"/>'
    '<input name="index" type="integer" value="{index}"/></extract>'
)
TIMES = '<input name="in2" type="color3" value="0.5, 0, 0.25"/>'
ONTO = '<input name="outlow" type="color3" value="1, 2, 3"/><input name="outhigh" type="color3" value="1, 3, 5"/>'


@pytest.mark.parametrize(
    ("node", "into", "rest", "heights"),
    [
        ("multiply", "in1", TIMES, (0.5, 0.0, 0.05)),
        ("subtract", "in1", TIMES, (0.5, 0.6, -0.05)),
        ("remap", "in", ONTO, (1.0, 2.6, 3.4)),
        ("multiply", "in1", "", (1.0, 0.6, 0.2)),
        ("divide", "in1", "", (1.0, 0.6, 0.2)),
    ],
)
def test_each_channel_has_its_own_constants(
    tmp_path: Path, node: str, into: str, rest: str, heights: tuple[float, float, float]
) -> None:
    for index, height in enumerate(heights):
        folder = tmp_path / str(index)
        folder.mkdir()
        write_picture(folder / "c.png", np.full((8, 8, 3), (255, 153, 51), np.uint8))
        nodes = COLORS.format(node=node, into=into, rest=rest, index=index)
        stage = _stage(folder, LINK.format("h"), nodes)
        assert _heights(StageReader(stage))[1, 1] == pytest.approx(height, abs=0.01)


def test_a_channel_of_a_constant_moves_a_surface(tmp_path: Path) -> None:
    nodes = (
        '<constant name="n" type="vector3"><input name="value" type="vector3" value="1, 2, 3"/></constant>'
        '<extract name="h" type="float"><input name="in" type="vector3" nodename="n"/>'
        '<input name="index" type="integer" value="2"/></extract>'
    )
    assert _heights(StageReader(_stage(tmp_path, LINK.format("h"), nodes)))[1, 1] == pytest.approx(3, abs=1e-5)


def test_an_image_that_is_not_there_gives_its_default(tmp_path: Path) -> None:
    reader = StageReader(_stage(tmp_path, LINK.format("i") + '<input name="scale" type="float" value="2"/>', IMAGE))
    assert _heights(reader)[1, 1] == pytest.approx(1.0, abs=1e-5)
    assert "texture_unreadable" in codes(reader)


def test_a_primvar_moves_a_surface(tmp_path: Path) -> None:
    nodes = '<geompropvalue name="g" type="float"><input name="geomprop" type="string" value="lift"/></geompropvalue>'
    stage = _stage(tmp_path, LINK.format("g"), nodes)
    set_primvar(stage.GetPrimAtPath("/wall"), "lift", Sdf.ValueTypeNames.FloatArray, "vertex", [0.0, 0.25, 0.5, 0.75])
    heights = _heights(StageReader(stage))
    assert [heights[at] for at in ((-1, -1), (1, -1), (1, 1), (-1, 1))] == pytest.approx([0, 0.25, 0.5, 0.75], abs=1e-5)


@pytest.mark.parametrize(
    ("displacement", "nodes", "why"),
    [
        (LINK.format("n"), '<noise2d name="n" type="float"/>', "computed by n, a noise2d"),
        (LINK.format("gone"), "", ""),
        (
            LINK.format("n"),
            '<constant name="n" type="color3"><input name="value" type="color3" value="1,2,3"/></constant>',
            "channels of its height differ",
        ),
        ('<input name="displacement" type="vector3" value="0,0,1"/>', "", "no height"),
        (
            LINK.format("a"),
            IMAGE + '<multiply name="a" type="float"><input name="in1" type="float" nodename="i"/>'
            '<input name="in2" type="float" nodename="i"/></multiply>',
            "joins several",
        ),
        (LINK.format("a"), f'<dot name="a" type="float">{LINK.format("a").replace("displacement", "in")}</dot>', ""),
    ],
)
def test_any_other_displacement_is_named(tmp_path: Path, displacement: str, nodes: str, why: str) -> None:
    reader = StageReader(_stage(tmp_path, displacement, nodes))
    assert _heights(reader)[1, 1] == pytest.approx(0, abs=1e-6)
    found = [each.message for each in reader.findings if each.code.startswith("materialx")]
    assert found
    assert why in " ".join(found)


def test_a_displacement_of_usd_moves_a_surface(tmp_path: Path) -> None:
    """Other readers of looks, such as those of anchors, see the same one."""
    stage = wall(tmp_path, document(SURFACE))
    material = UsdShade.Material.Define(stage, "/mat")
    surface, own = UsdShade.Shader.Define(stage, "/mat/s"), UsdShade.Shader.Define(stage, "/mat/d")
    surface.CreateIdAttr("ND_standard_surface_surfaceshader")
    own.CreateIdAttr("ND_displacement_float")
    own.CreateInput("displacement", Sdf.ValueTypeNames.Float).Set(0.375)
    material.CreateSurfaceOutput("mtlx").ConnectToSource(surface.CreateOutput("out", Sdf.ValueTypeNames.Token))
    material.CreateDisplacementOutput("mtlx").ConnectToSource(own.CreateOutput("out", Sdf.ValueTypeNames.Token))
    bind(stage.GetPrimAtPath("/wall"), "/mat")
    assert _heights(StageReader(stage))[1, 1] == pytest.approx(0.375, abs=1e-5)
    displacement = LookReader(stage, TextureCache(64), FindingLog()).displacement("/mat", Usd.TimeCode(0.0))
    assert displacement is not None
    assert displacement.amount == pytest.approx(0.375)


def test_a_displacement_of_a_document_is_read_alone(tmp_path: Path) -> None:
    stage = _stage(tmp_path, '<input name="displacement" type="float" value="0.25"/>')
    looks = LookReader(stage, TextureCache(64), FindingLog())
    displacement = looks.displacement("/Looks/Materials/M", Usd.TimeCode(0.0))
    assert displacement is not None
    assert displacement.amount == pytest.approx(0.25)
    assert looks.displacement("/Looks/Materials/other", Usd.TimeCode(0.0)) is None
