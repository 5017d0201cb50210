"""`pullfocus lenses compare`: two lenses side by side, in numbers and drawn."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import OpenImageIO
import pytest

from tests.render.kits.cli_shots import Command
from tests.render.kits.lens_files import FILES


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)


def compared(pullfocus: Command, *arguments: object) -> list[dict[str, Any]]:
    ended = pullfocus("lenses", "compare", *arguments, "--json")
    assert ended.status == 0, ended.err
    lenses: list[dict[str, Any]] = json.loads(ended.out)["lenses"]
    return lenses


def test_each_side_is_what_show_says_of_it(pullfocus: Command) -> None:
    setting = ("--f-stop", "2.8", "--focus", "2", "--gate", "24x18")
    sides = compared(pullfocus, "planar_50", "zeiss_distagon_15", *setting)
    for name, side in zip(("planar_50", "zeiss_distagon_15"), sides, strict=True):
        shown = json.loads(pullfocus("lenses", "show", name, *setting, "--json").out)
        assert {key: side[key] for key in shown} == shown


def test_a_lens_against_itself_differs_in_nothing(pullfocus: Command) -> None:
    one, other = compared(pullfocus, "double_gauss_50", "double_gauss_50")
    assert one == other


def test_a_zoom_is_compared_at_a_focal_length_with_a_prime(pullfocus: Command) -> None:
    zoom, prime = compared(pullfocus, "tele_zoom_70_200", "thin_50", "--focal-length", "135")
    assert (zoom["focalLengthMm"], prime["focalLengthMm"]) == (pytest.approx(135), pytest.approx(50))
    ended = pullfocus("lenses", "compare", "thin_50", "thin_50", "--focal-length", "135")
    assert (ended.status, "is no zoom" in ended.err) == (2, True)


def test_stopping_down_raises_contrast_and_keeps_breathing(pullfocus: Command) -> None:
    [wide, _] = compared(pullfocus, "planar_50", "thin_50")
    [stopped, thin] = compared(pullfocus, "planar_50", "thin_50", "--f-stop", "5.6")
    assert stopped["mtf"]["overField"][2]["sagittal"][0] > wide["mtf"]["overField"][2]["sagittal"][0] + 0.2
    assert stopped["breathing"]["growth"] == pytest.approx(wide["breathing"]["growth"], rel=0.03)
    assert thin["breathing"]["growth"] == pytest.approx([50 / (1000 * d - 50) for d in (5, 2, 1, 0.5)])


def test_two_lenses_are_drawn_as_png_and_svg(pullfocus: Command, tmp_path: Path) -> None:
    file = tmp_path / "achromat.seq"
    file.write_text(FILES["achromat.seq"])
    png, svg = tmp_path / "two.png", tmp_path / "two.svg"
    assert pullfocus("lenses", "compare", file, "soft_focus_85", "--out", png).status == 0
    assert OpenImageIO.ImageBuf(str(png)).spec().width == 1920
    assert pullfocus("lenses", "compare", "pinhole_35", "swirly_58", "--out", svg).status == 0
    assert ElementTree.parse(svg).getroot().tag.endswith("svg")


def test_the_table_has_both_lenses_in_columns(pullfocus: Command) -> None:
    out = pullfocus("lenses", "compare", "pinhole_35", "planar_50").out
    assert "Pinhole 35 mm" in out
    assert "Planar 50 mm f/1.4" in out
    for word in ("distortion %", "MTF % at 20/mm", "breathing", "red less blue µm", "sagittal focus mm"):
        assert word in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("planar_50", "planar_51"), "planar_50"),
        (("planar_50", "thin_50", "--f-stop", "-1"), "an f-number must be above 0, got -1"),
        (("planar_50", "thin_50", "--gate", "36"), "--gate takes width x height in mm"),
        (("planar_50", "thin_50", "--out", "two.jpg"), "--out takes a folder, or a file that ends in .png or .svg"),
    ],
)
def test_what_cannot_be_compared_is_one_line(pullfocus: Command, arguments: tuple[str, ...], words: str) -> None:
    ended = pullfocus("lenses", "compare", *arguments)
    assert (ended.status, ended.out, ended.err.count("\n")) == (2, "", 1)
    assert words in ended.err
