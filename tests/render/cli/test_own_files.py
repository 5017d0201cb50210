"""No command writes over the files of the shot that it reads."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, small, write_shot

TEXTURED = """
    def Material "paint"
    {
        token outputs:surface.connect = </World/paint/surface.outputs:surface>
        def Shader "surface"
        {
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor.connect = </World/paint/file.outputs:rgb>
            token outputs:surface
        }
        def Shader "file"
        {
            uniform token info:id = "UsdUVTexture"
            asset inputs:file = @./paint.png@
            float3 outputs:rgb
        }
    }
"""


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    """The command."""
    return Command(capsys)


@pytest.fixture
def shot(tmp_path: Path) -> Path:
    """A shot of two layers and a texture."""
    (tmp_path / "paint.png").write_bytes(b"the painter's only copy")
    write_shot(tmp_path / "layer.usda", SQUARE, CAMERA, TEXTURED)
    path = tmp_path / "shot.usda"
    path.write_text("#usda 1.0\n(\n    subLayers = [@./layer.usda@]\n)\n")
    return path


@pytest.mark.parametrize("name", ["shot.usda", "layer.usda", "paint.png", "link.usda"])
def test_a_focus_curve_replaces_no_file_of_the_shot(name: str, pullfocus: Command, shot: Path) -> None:
    (shot.parent / "link.usda").symlink_to(shot.parent / "layer.usda")
    out = shot.parent / name
    before = out.read_bytes()
    ended = pullfocus("focus-curve", shot, "--out", out)
    assert ended.status == 2
    assert f"the shot itself is made of {out}" in ended.err
    assert out.read_bytes() == before


def test_a_focus_curve_does_not_replace_the_edits_it_was_solved_with(pullfocus: Command, shot: Path) -> None:
    edits = shot.parent / "edits.usda"
    edits.write_text("#usda 1.0\n")
    ended = pullfocus("focus-curve", shot, "--edits", edits, "--format", "usda", "--out", edits)
    assert (ended.status, edits.read_text()) == (2, "#usda 1.0\n")


def test_a_focus_curve_replaces_its_own_older_self(pullfocus: Command, shot: Path) -> None:
    out = shot.parent / "curve.json"
    out.write_text("older")
    assert pullfocus("focus-curve", shot, "--out", out).status == 0
    assert out.read_text() != "older"


def test_a_picture_replaces_no_texture_of_the_shot(pullfocus: Command, shot: Path) -> None:
    texture = shot.parent / "paint.png"
    ended = pullfocus("record", shot, texture, *small())
    assert ended.status == 2
    assert f"the shot itself is made of {texture}" in ended.err
    assert texture.read_bytes() == b"the painter's only copy"
