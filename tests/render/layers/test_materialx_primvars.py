"""Primvars of networks of MaterialX: several of a kind, and beside the place in the prim's own space."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd

from render.frame import FrameRenderer
from render.stage import Finding, StageReader
from tests.render.kits.materialx_walls import glowing, picture, wall
from tests.render.kits.stages import set_primvar

pytestmark = pytest.mark.gl

MIDDLES = (np.arange(16) + 0.5) / 16


def _primvar(node: str, kind: str, name: str, default: str = "") -> str:
    fallback = f'<input name="default" type="{kind}" value="{default}"/>' if default else ""
    geomprop = f'<input name="geomprop" type="string" value="{name}"/>'
    return f'<geompropvalue name="{node}" type="{kind}">{geomprop}{fallback}</geompropvalue>'


def _sum(node: str, a: str, b: str) -> str:
    links = "".join(f'<input name="in{n}" type="color3" nodename="{each}"/>' for n, each in ((1, a), (2, b)))
    return f'<add name="{node}" type="color3">{links}</add>'


def test_several_colours_are_read(renderer: FrameRenderer, tmp_path: Path) -> None:
    """Two colours of the geometry, and a vector."""
    nodes = (
        _primvar("a", "color3", "paint")
        + _primvar("b", "color3", "dirt")
        + _primvar("v", "vector3", "lean")
        + '<convert name="c" type="color3"><input name="in" type="vector3" nodename="v"/></convert>'
        + _sum("ab", "a", "b")
        + _sum("abc", "ab", "c")
    )
    stage = wall(tmp_path, glowing(nodes, 'nodename="abc"'))
    prim = stage.GetPrimAtPath("/wall")
    set_primvar(prim, "paint", Sdf.ValueTypeNames.Color3fArray, "constant", [(0.2, 0.1, 0)])
    dirt = [(0, 0, 0), (0, 0.4, 0), (0, 0.4, 0), (0, 0, 0)]
    set_primvar(prim, "dirt", Sdf.ValueTypeNames.Color3fArray, "vertex", dirt)
    set_primvar(prim, "lean", Sdf.ValueTypeNames.Vector3fArray, "constant", [(0, 0, 0.5)])
    got = picture(renderer, stage)[8, :, :3]
    want = np.stack([np.full(16, 0.2), 0.1 + 0.4 * MIDDLES, np.full(16, 0.5)], axis=1)
    np.testing.assert_allclose(got, want, atol=0.005)
    assert "materialx_primvar" not in {each.code for each in _findings(stage)}


def test_several_coordinates_and_numbers_are_read(renderer: FrameRenderer, tmp_path: Path) -> None:
    nodes = (
        '<texcoord name="st" type="vector2"/>'
        + _primvar("m", "vector2", "map2")
        + _primvar("x", "float", "wear")
        + _primvar("y", "float", "rust")
        + '<add name="uv" type="vector2"><input name="in1" type="vector2" nodename="st"/>'
        '<input name="in2" type="vector2" nodename="m"/></add>'
        '<separate2 name="p" type="multioutput"><input name="in" type="vector2" nodename="uv"/></separate2>'
        '<subtract name="z" type="float"><input name="in1" type="float" nodename="y"/>'
        '<input name="in2" type="float" nodename="x"/></subtract>'
        '<combine3 name="c" type="color3"><input name="in1" type="float" nodename="p" output="outx"/>'
        '<input name="in2" type="float" nodename="p" output="outy"/><input name="in3" type="float" nodename="z"/></combine3>'
    )
    stage = wall(tmp_path, glowing(nodes, 'nodename="c"'))
    prim = stage.GetPrimAtPath("/wall")
    set_primvar(prim, "map2", Sdf.ValueTypeNames.TexCoord2fArray, "vertex", [(1, 0), (0, 0), (0, 1), (1, 1)])
    set_primvar(prim, "wear", Sdf.ValueTypeNames.FloatArray, "constant", [0.25])
    set_primvar(prim, "rust", Sdf.ValueTypeNames.FloatArray, "vertex", [0.25, 1.25, 1.25, 0.25])
    got = picture(renderer, stage)[..., :3]
    np.testing.assert_allclose(got[8, :, 0], 1, atol=0.005)
    np.testing.assert_allclose(got[:, 8, 1], 2 * MIDDLES[::-1], atol=0.01)
    np.testing.assert_allclose(got[8, :, 2], MIDDLES, atol=0.01)


def test_a_colour_is_read_beside_the_place(renderer: FrameRenderer, tmp_path: Path) -> None:
    nodes = (
        _primvar("a", "color3", "paint")
        + '<position name="p" type="vector3"/><multiply name="q" type="vector3"><input name="in1" type="vector3" nodename="p"/>'
        '<input name="in2" type="vector3" value="0,0,-0.1"/></multiply>'
        '<convert name="c" type="color3"><input name="in" type="vector3" nodename="q"/></convert>' + _sum("s", "a", "c")
    )
    stage = wall(tmp_path, glowing(nodes, 'nodename="s"'))
    prim = stage.GetPrimAtPath("/wall")
    set_primvar(prim, "paint", Sdf.ValueTypeNames.Color3fArray, "constant", [(0.3, 0.6, 0.2)])
    np.testing.assert_allclose(picture(renderer, stage, 4)[1, 1, :3], (0.3, 0.6, 0.6), atol=0.005)


def test_a_primvar_too_many_is_named_and_has_its_default(renderer: FrameRenderer, tmp_path: Path) -> None:
    nodes = "".join(_primvar(f"n{n}", "color3", f"c{n}", "0.125,0.25,0") for n in range(4)) + _sum("s0", "n0", "n1")
    nodes += _sum("s1", "s0", "n2") + _sum("s2", "s1", "n3")
    stage = wall(tmp_path, glowing(nodes, 'nodename="s2"'))
    np.testing.assert_allclose(picture(renderer, stage, 4)[1, 1, :3], (0.5, 1, 0), atol=0.005)
    found = [each.message for each in _findings(stage) if each.code == "materialx_primvar"]
    assert len(found) == 1
    assert "c3 is not read" in found[0]


def _findings(stage: Usd.Stage) -> list[Finding]:
    reader = StageReader(stage)
    reader.read(0)
    return reader.findings
