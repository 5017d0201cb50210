"""`pullfocus films`: the library as a table, and all that is known of one stock, in numbers and drawn."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import OpenImageIO
import pytest

from tests.render.kits.cli_shots import Command
from usd_schemas import library_films


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    """The command."""
    return Command(capsys)


def shown(pullfocus: Command, *arguments: object) -> dict[str, Any]:
    """Return the JSON entry of a stock."""
    ended = pullfocus("films", "show", *arguments, "--json")
    assert ended.status == 0, ended.err
    report: dict[str, Any] = json.loads(ended.out)
    return report


def test_the_library_is_a_table_with_a_line_for_each_stock(pullfocus: Command) -> None:
    ended = pullfocus("films")
    assert ended.status == 0
    for entry in library_films():
        [line] = [line for line in ended.out.splitlines() if line.split()[:1] == [entry.name]]
        assert entry.description in line
    listed = json.loads(pullfocus("films", "--json").out)["films"]
    assert [film["name"] for film in listed] == [film.name for film in library_films()]
    assert listed[0]["speed"] == 500
    assert listed[5]["speed"] is None


def test_the_numbers_of_a_stock_are_reported(pullfocus: Command) -> None:
    output = pullfocus("films", "show", "5219").out
    for words in ("ISO 500", "3200 K", "vision_2383", "Status M", "0.81 / 1.31 / 1.55", "thousandths", "10 / 10 / 10"):
        assert words in output
    assert "none is published" in pullfocus("films", "show", "portra_400").out
    assert "all light" in pullfocus("films", "show", "tri-x_400").out


@pytest.mark.parametrize("film", library_films(), ids=lambda film: film.name)
def test_a_stock_s_wedge_lands_grey_at_its_aim(film: Any, pullfocus: Command) -> None:
    report = shown(pullfocus, film.name)
    records = 1 if film.film.process == "monochrome" else 3
    assert len(report["curves"]) == len(report["channels"]) == records
    wedge = report["wedge"]
    assert (len(wedge["stops"]), wedge["stops"][10]) == (21, 0)
    measured = wedge["cameraDensities"] if film.kind == "camera" else wedge["printDensities"]
    assert measured[10] == pytest.approx(report["middleDensity"], abs=1e-4)
    if film.film.process != "reversal":
        assert wedge["light"][10] == pytest.approx([0.1] * 3, rel=0.001)
    assert (wedge["printDensities"] is None) == (film.film.process == "reversal")


def test_a_push_and_another_print_change_what_is_seen(pullfocus: Command) -> None:
    plain, pushed, other = (shown(pullfocus, "5219", *more) for more in ((), ("--push", 1), ("--with", "3513di")))
    assert pushed["wedge"]["light"][10][1] > 1.5 * plain["wedge"]["light"][10][1]
    assert other["triedWith"] == "eterna_cp_3513di"
    assert other["wedge"]["light"][10] == pytest.approx([0.1] * 3, rel=0.001)
    assert other["wedge"]["light"][7] != plain["wedge"]["light"][7]
    assert shown(pullfocus, "2383", "--with", "eterna_500")["triedWith"] == "eterna_500"


@pytest.mark.parametrize("name", ["vision3_50d_5203", "print_2302"])
def test_a_sheet_is_drawn(name: str, tmp_path: Path, pullfocus: Command) -> None:
    ended = pullfocus("films", "show", name, "--out", tmp_path / "sheets")
    assert ended.status == 0, ended.err
    sheet = tmp_path / "sheets" / f"{name}.png"
    assert f"drawn: {sheet}" in ended.err
    picture = OpenImageIO.ImageBuf(str(sheet)).get_pixels(OpenImageIO.FLOAT)[..., :3]
    assert picture.shape == (1344, 1920, 3)
    wedge = picture[693, 90:1900]  # runs from black to the stock's white, and middle grey is grey
    assert wedge[0].max() < 0.05
    assert wedge[-20].min() > 0.5
    middle = picture[693, 60 + 1805 * 21 // 42]
    assert np.ptp(middle) < 0.01
    assert middle[1] == pytest.approx(0.349, abs=0.01)


def test_a_sheet_is_drawn_in_vectors_too(tmp_path: Path, pullfocus: Command) -> None:
    drawn = [tmp_path / "velvia.svg", tmp_path / "again.svg"]
    for path in drawn:
        assert pullfocus("films", "show", "velvia_50", "--out", path).status == 0
    assert ElementTree.parse(drawn[0]).getroot().tag.endswith("svg")
    assert drawn[0].read_bytes() == drawn[1].read_bytes()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("show", "velvia_5"), "no film stock named 'velvia_5' in the library: did you mean velvia_50"),
        (("show", "velvia_50", "--with", "2383"), "velvia_50 is a reversal stock, which is not printed"),
        (("show", "5219", "--with", "2302"), "needs a print stock of 3 records, got print_2302"),
        (("show", "5219", "--with", "5203"), "vision3_50d_5203 is a camera stock, expected one for prints"),
        (("show", "5219", "--push", "9"), "push is from -5 to 5 stops, got 9"),
        (("show", "5219", "--out", "sheet.pdf"), "--out takes a folder, or a file that ends in .png or .svg"),
    ],
)
def test_bad_words_are_one_clear_sentence(arguments: tuple[str, ...], words: str, pullfocus: Command) -> None:
    ended = pullfocus("films", *arguments)
    assert ended.status == 2
    assert words in ended.err
    assert ended.err.count("\n") == 1
