"""Networks of MaterialX whose programs the driver refuses: their materials are drawn otherwise, and all else as it is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade

from render import colour
from render.frame import FrameRenderer, FrameSettings
from render.model.arrays import FloatArray
from render.model.refused_programs import REFUSED
from render.pictures import picture
from render.pictures.picture import make_picture
from render.pictures.progressive import PreviewRequest
from render.pictures.progressive.renderer import ProgressiveRenderer
from render.shot import Shot
from render.stage.materials.mtlx import looks
from render.stage.materials.mtlx.generation import ProgramWriter
from render.stage.materials.mtlx.programs import Program
from tests.render.kits.materialx_walls import document, wall
from tests.render.kits.stages import add_material, add_mesh, add_texture, bind, set_primvar, write_picture

pytestmark = pytest.mark.gl

SETTINGS = FrameSettings(16, 16, rays=1, supersample=1, engine="pinhole", shading="unlit")
WRONG = {"no such function": "\nfloat wrong() { return no_such_function(); }\n", "no link": "\nfloat nowhere();\n"}


@pytest.fixture
def renderer() -> Iterator[FrameRenderer]:
    with FrameRenderer() as own:
        yield own


@pytest.fixture(params=list(WRONG))
def spoilt(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Make the generated code wrong of each network that reads the constant 0.375."""
    code = WRONG[request.param]
    use = "evaluate_nodes()\n{\n" + ("    graph_lod_bias = nowhere();\n" if "nowhere" in code else "")

    class Spoilt(ProgramWriter):
        def write(self) -> Program:
            program = super().write()
            if 0.375 not in program.numbers:
                return program
            functions = f"// {tmp_path} {sum(program.numbers)}{code}{program.functions}".replace(
                "evaluate_nodes()\n{\n", use
            )
            return replace(program, functions=functions)

    monkeypatch.setattr(looks, "ProgramWriter", Spoilt)


def _shot(folder: Path) -> Usd.Stage:
    """The wall of a document, and before its left half a card in a network of USD with a UsdPreviewSurface beside it."""
    surface = '<standard_surface name="S"><input name="base" type="float" value="1"/>{}</standard_surface>'
    color = '<input name="base_color" type="color3" value="0.25, 0.5, 0.75"/>'
    stage = wall(folder, document(surface.format(color + '<input name="metalness" type="float" value="0.375"/>')))
    card = add_mesh(stage, "/card", [(-1, -1, -2), (0, -1, -2), (0, 1, -2), (-1, 1, -2)])
    set_primvar(card.GetPrim(), "st", Sdf.ValueTypeNames.TexCoord2fArray, "vertex", [(0, 0), (1, 0), (1, 1), (0, 1)])
    write_picture(folder / "t.png", np.tile(np.array([255, 0, 0], np.uint8), (4, 4, 1)))
    texture = add_texture(stage, "/mat/texture", "./t.png").ConnectableAPI()
    link = add_material(stage, "/mat").CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f)
    link.ConnectToSource(texture, "rgb")
    own = UsdShade.Shader.Define(stage, "/mat/own")
    own.CreateIdAttr("ND_standard_surface_surfaceshader")
    own.CreateInput("base", Sdf.ValueTypeNames.Float).Set(1.0)
    own.CreateInput("base_color", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0, 1, 0))
    own.CreateInput("metalness", Sdf.ValueTypeNames.Float).Set(0.375)
    output = UsdShade.Material(stage.GetPrimAtPath("/mat")).CreateSurfaceOutput("mtlx")
    output.ConnectToSource(own.CreateOutput("out", Sdf.ValueTypeNames.Token))
    bind(card.GetPrim(), "/mat")
    camera = UsdGeom.Camera.Define(stage, "/cam")
    camera.CreateFocalLengthAttr(36)
    camera.CreateHorizontalApertureAttr(36)
    camera.CreateVerticalApertureAttr(36)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 100))
    stage.GetRootLayer().Save()
    return stage


def _seen(light: FloatArray) -> FloatArray:
    return colour.from_working(light, "lin_rec709")[8, [4, 12], :3]


@pytest.mark.usefixtures("spoilt")
def test_what_the_driver_refuses_is_drawn_otherwise(
    renderer: FrameRenderer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the UsdPreviewSurface with its texture, and by the plain base colour, with a finding for each; begun anew once."""
    begun, expose = [], picture._expose_frame

    def count(*given: Any) -> Any:
        begun.append(REFUSED.count)
        return expose(*given)

    monkeypatch.setattr(picture, "_expose_frame", count)
    _shot(tmp_path)
    shot = Shot.open(tmp_path / "shot.usda")
    got = _seen(make_picture(renderer, shot, "/cam", 1.0, SETTINGS).frame.color)
    np.testing.assert_allclose(got, [(1, 0, 0), (0.25, 0.5, 0.75)], atol=0.01)
    first, *later = begun
    assert later == [first + 2]
    refused = {finding.path: finding.message for finding in shot.findings() if finding.code == "materialx_refused"}
    assert set(refused) == {"/mat", "/Looks/Materials/M"}
    assert "refuses the program of its network" in refused["/mat"]


@pytest.mark.usefixtures("spoilt")
def test_a_viewer_sees_what_is_drawn_otherwise(renderer: FrameRenderer, tmp_path: Path) -> None:
    _shot(tmp_path)
    shot = Shot.open(tmp_path / "shot.usda")
    shown = list(ProgressiveRenderer(renderer, shot).pictures(PreviewRequest("/cam", 1.0, SETTINGS)))
    assert shown[-1].picture is not None
    np.testing.assert_allclose(_seen(shown[-1].picture.frame.color), [(1, 0, 0), (0.25, 0.5, 0.75)], atol=0.01)


def test_a_sound_network_is_drawn_as_it_is(renderer: FrameRenderer, tmp_path: Path) -> None:
    _shot(tmp_path)
    shot = Shot.open(tmp_path / "shot.usda")
    got = _seen(make_picture(renderer, shot, "/cam", 1.0, SETTINGS).frame.color)
    np.testing.assert_allclose(got, [(0, 1, 0), (0.25, 0.5, 0.75)], atol=0.01)
    assert "materialx_refused" not in {finding.code for finding in shot.findings()}
