"""`pullfocus lenses`: the library as a table, and all that is known of one lens, in numbers and drawn."""

from __future__ import annotations

import errno
import json
import math
import os
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import OpenImageIO
import pytest

from render.cli.tables.lens import _PICTURE_ERROR_MM
from render.trace.prescription_table import FILM_ERROR_MM
from tests.render.kits.cli_shots import Command
from tests.render.kits.lens_files import FILES
from usd_schemas import library_lenses


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    """The command."""
    return Command(capsys)


def shown(pullfocus: Command, *arguments: object) -> dict[str, Any]:
    """Return the JSON entry of a lens."""
    ended = pullfocus("lenses", "show", *arguments, "--json")
    assert ended.status == 0, ended.err
    report: dict[str, Any] = json.loads(ended.out)
    return report


def test_the_library_is_a_table_with_a_line_for_each_lens(pullfocus: Command) -> None:
    ended = pullfocus("lenses")
    assert ended.status == 0
    for entry in library_lenses():
        [line] = [line for line in ended.out.splitlines() if line.split()[:1] == [entry.name]]
        assert entry.description in line
    listed = json.loads(pullfocus("lenses", "--json").out)["lenses"]
    assert [lens["name"] for lens in listed] == [entry.name for entry in library_lenses()]
    assert {
        "name",
        "title",
        "model",
        "focalLengthMm",
        "focalLengthRangeMm",
        "fStop",
        "families",
        "year",
        "source",
        "description",
    } == set(listed[0])


def test_a_lens_says_whence_its_numbers_are(pullfocus: Command) -> None:
    said = "US 2,601,805 (Lowenthal), in Smith, Modern Lens Design (1992), p. 305; 1952; stated there 100 mm f/1.35 over 25.9°"
    assert said in " ".join(pullfocus("lenses", "show", "gauss_lowenthal_100").out.split())
    assert shown(pullfocus, "thin_50")["source"] == "ours"


def found(pullfocus: Command, *search: str) -> list[str]:
    """Return the names of the lenses that a search finds."""
    ended = pullfocus("lenses", *search, "--json")
    assert ended.status == 0, ended.err
    return [lens["name"] for lens in json.loads(ended.out)["lenses"]]


def test_lenses_are_found_by_what_a_cinematographer_asks_for(pullfocus: Command) -> None:
    normal = found(pullfocus, "--focal-length", "40-60", "--faster-than", "1.4")
    assert {"planar_50", "thin_50"} <= set(normal)
    assert not {"double_gauss_50", "distagon_35"} & set(normal)
    assert "distagon_35" in found(
        pullfocus, "--family", "Retrofocus", "--year", "1970-1979", "--search", "zeiss aspheric"
    )
    assert "telephoto_250" in found(pullfocus, "--focal-length", "200-")
    assert {"double_gauss_50", "thin_50"} <= set(found(pullfocus, "--focal-length", "50"))  # as engraved: it is 50.36
    assert "pinhole_35" not in found(pullfocus, "--faster-than", "64")
    ended = pullfocus("lenses", "--search", "no such words")
    assert (ended.status, ended.out, ended.err) == (0, "", "the library has no such lens\n")


@pytest.mark.parametrize(
    ("search", "said"),
    [
        (("--family", "petzvall"), "no family 'petzvall' of lenses: did you mean petzval"),
        (("--year", "1969-1950"), "a range of years ends before it begins: 1969 to 1950"),
        (("--focal-length", "wide"), "a number, or a range such as 40-60, got 'wide'"),
        (("--focal-length", "-"), "a number, or a range such as 40-60, got '-'"),
    ],
)
def test_a_search_for_what_cannot_be_is_one_error(search: tuple[str, ...], said: str, pullfocus: Command) -> None:
    ended = pullfocus("lenses", *search)
    assert (ended.status, ended.out, ended.err.count("\n")) == (2, "", 1)
    assert said in ended.err


@pytest.mark.parametrize(
    ("search", "action"),
    [
        (("--focal-length", "50"), ("show", "thin_50")),
        (("--family", "petzval"), ("compare", "thin_50", "thin_50")),
        (("--year", "1950-"), ("glass", "N-BK7")),
    ],
)
def test_a_search_before_an_action_is_refused(
    search: tuple[str, ...], action: tuple[str, ...], pullfocus: Command
) -> None:
    ended = pullfocus("lenses", *search, *action)
    assert (ended.status, ended.out, ended.err.count("\n")) == (2, "", 1)
    assert f"{search[0]} before {action[0]} searches the library" in ended.err


def test_the_numbers_of_a_lens_are_reported_with_their_units(pullfocus: Command) -> None:
    output = pullfocus("lenses", "show", "planar_50").out
    for words in (
        "50.00 mm",
        "f/1.4, wide open",
        "f/1.41 as focused; by the paraxial pupil f/1.43",
        "T1.43: 96 % of the light pass, by its coatings",
        "infinity",
        "40.1° across",
        "35.50 mm; film",
        "24.12 mm behind the front vertex",
        "65.08 mm before the film",
        "H 35.73 mm behind the front vertex; H′ 14.50 mm before the rear vertex",
        "moving the whole lens",
        "The back focal distance of 35.5 mm was solved for.",
    ):
        assert words in output


@pytest.mark.parametrize(("lens", "widest"), [("singlet_50", 2.8), ("thin_50", 1.2)])
def test_the_f_number_as_set_and_as_reached(lens: str, widest: float, pullfocus: Command) -> None:
    stopped = shown(pullfocus, lens, "--f-stop", "8")
    assert (stopped["fStopSet"], stopped["fStop"]) == pytest.approx((8, 8))
    report = shown(pullfocus, lens, "--f-stop", "0.5")
    assert (report["fStopSet"], report["fStop"]) == pytest.approx((0.5, widest), rel=1e-3)
    output = pullfocus("lenses", "show", lens, "--f-stop", "0.5").out
    assert f"f/{widest}: set to f/0.5, and it opens no wider" in output


def test_f_numbers_of_beam_cone_and_pupil_are_in_the_json(pullfocus: Command) -> None:
    far, near = (shown(pullfocus, "distagon_35", "--f-stop", "2", *more) for more in ((), ("--focus", "0.5")))
    for report in (far, near):
        assert (report["fStop"], report["fStopWideOpen"]) == pytest.approx((2, 1.4), rel=1e-3)
        assert report["fStopParaxial"] < 0.98 * report["fStop"]
        assert report["tStop"] == pytest.approx(report["fStop"] / math.sqrt(report["transmittance"]))
        assert 0.9 < report["transmittance"] < 1
    assert far["fStopWorking"] == pytest.approx(2, rel=0.01)
    assert near["fStopWorking"] > 1.02 * far["fStopWorking"]
    thin = shown(pullfocus, "thin_50")
    assert (report["transmittanceSource"], thin["transmittanceSource"]) == ("coatings", "stated")
    assert (thin["fStopWorking"], thin["fStopParaxial"], thin["transmittance"]) == (None, None, 1)


def test_a_zoom_is_shown_at_any_focal_length_of_its_range(pullfocus: Command) -> None:
    report = shown(pullfocus, "tele_zoom_70_200", "--focal-length", "135", "--focus", "3")
    assert (report["focalLengthMm"], report["fStopWideOpen"]) == (135, pytest.approx(2.8, rel=0.01))
    zoom = report["zoom"]
    assert (zoom["shortestMm"], zoom["longestMm"]) == pytest.approx((72.1, 194.01), rel=2e-4)
    assert zoom["keepsFocus"]
    assert [each["fStop"] for each in zoom["positions"]] == [2.8] * 3
    at_ends = [shown(pullfocus, "tele_zoom_70_200", "--focal-length", mm)["fieldOfViewDeg"] for mm in (72.1, 194)]
    assert [ends["diagonal"] for ends in at_ends] == pytest.approx([34, 12.7], abs=1)  # 2·atan(21.6/f), less distortion
    output = pullfocus("lenses", "show", "tele_zoom_70_200").out
    assert "72.09 to 194 mm; keeps its focus" in output
    assert shown(pullfocus, "planar_50")["zoom"] is None


@pytest.mark.parametrize(
    ("lens", "said"),
    [
        ("tele_zoom_70_200", "zooms from 72.09 to 194 mm, got 50 mm"),
        ("planar_50", "is no zoom: its focal length is 50 mm"),
    ],
)
def test_a_focal_length_that_a_lens_has_not_is_refused(lens: str, said: str, pullfocus: Command) -> None:
    ended = pullfocus("lenses", "show", lens, "--focal-length", "50")
    assert (ended.status, ended.out, ended.err.count("\n")) == (2, "", 1)
    assert said in ended.err


def test_the_groups_that_float_are_told(pullfocus: Command) -> None:
    report = shown(pullfocus, "master_prime_100", "--focus", "1")
    groups = [(each["first"], each["last"]) for each in report["barrelMm"]["floatingGroups"]]
    assert groups == [(8, 11), (12, 20)]
    assert report["closeFocusM"] == pytest.approx(1.0047)
    assert "surfaces 9 to 12 by -13.86 mm" in pullfocus("lenses", "show", "master_prime_100").out


def test_transfer_colour_and_focus_scale_are_in_the_json(pullfocus: Command) -> None:
    report, thin = shown(pullfocus, "double_gauss_50", "--f-stop", "2.8"), shown(pullfocus, "thin_50")
    mtf = report["mtf"]
    assert [each["linePairsPerMm"] for each in mtf["overField"]] == [10, 20, 40]
    assert sum(each["weight"] for each in mtf["wavelengths"]) == pytest.approx(1)
    for each in mtf["overField"]:
        assert len(each["sagittal"]) == len(each["tangentialGeometric"]) == len(mtf["heightsMm"])
        assert each["sagittal"][0] == pytest.approx(each["tangential"][0], abs=0.01)
    assert len(mtf["throughFocus"][0]["tangential"]) == len(mtf["filmShiftsMm"])
    assert (mtf["diffraction"], thin["mtf"]["diffraction"]) == ("wavefront", "rays times the perfect lens")
    assert len(report["colour"]["longitudinalMm"]) == 3
    assert (report["focusScale"][0]["label"], thin["focusScale"]) == ("∞", [])
    assert 0 < report["pictureErrorUm"] <= 4
    assert thin["pictureErrorUm"] is None


def test_an_error_of_the_pictures_rays_is_noted_above_4_um(pullfocus: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    assert FILM_ERROR_MM == _PICTURE_ERROR_MM
    monkeypatch.setattr("render.trace.table_error.table_error_mm", lambda _: 0.0071)
    report = shown(pullfocus, "double_gauss_50")
    assert report["pictureErrorUm"] == pytest.approx(7.1)
    assert any("up to 7.1 µm off on the film" in note for note in report["notes"])


def test_the_gate_decides_the_field(pullfocus: Command) -> None:
    whole, cropped = (shown(pullfocus, "double_gauss_50", *more) for more in ((), ("--gate", "24.89x18.66")))
    assert cropped["gateMm"] == [24.89, 18.66]
    assert cropped["fieldOfViewDeg"]["horizontal"] < whole["fieldOfViewDeg"]["horizontal"]
    assert cropped["cornerIllumination"] > whole["cornerIllumination"]


def test_dark_corners_are_said_in_a_note(pullfocus: Command) -> None:
    said = "leaves the corners of the gate, 43.3 mm across, dark."
    assert [note for note in shown(pullfocus, "petzval_50")["notes"] if said in note]
    assert not [note for note in shown(pullfocus, "petzval_50", "--gate", "10.26x7.49")["notes"] if "dark" in note]


def test_json_may_be_requested_before_or_after_the_action(pullfocus: Command) -> None:
    assert json.loads(pullfocus("lenses", "--json", "show", "thin_50").out) == shown(pullfocus, "thin_50")


@pytest.mark.filterwarnings("error")
def test_huge_focus_distances_are_infinity_and_near_ones_refused(pullfocus: Command) -> None:
    assert shown(pullfocus, "thin_50", "--focus", "1e300") == shown(pullfocus, "thin_50")
    ended = pullfocus("lenses", "show", "planar_50", "--focus", "1e-320")
    assert (ended.status, ended.err.count("\n")) == (2, 1)
    assert "a focus distance must be above 0 m" in ended.err


def test_a_lens_file_is_shown_as_one_of_the_library_is(pullfocus: Command, tmp_path: Path) -> None:
    file = tmp_path / "achromat.seq"
    file.write_text(FILES["achromat.seq"])
    report = shown(pullfocus, file)
    assert (report["name"], report["title"], report["model"]) == ("achromat", "32327 Achromatic Lens", "prescription")
    assert report["focalLengthMm"] == pytest.approx(100.03, rel=1e-3)
    assert report["barrelMm"]["surfaces"] == 3


def test_a_glass_is_shown_by_any_of_its_names(pullfocus: Command) -> None:
    for name in ("N-BK7", "nbk7_schott", "BK7"):
        ended = pullfocus("lenses", "glass", name)
        assert ended.status == 0
        for words in (
            "N-BK7 of Schott",
            "1.51680, 64.17",
            "0.5349",
            "1.52668 at 435.83 nm",
            "sellmeier: 1 0 1.03961212",
        ):
            assert words in ended.out
    report = json.loads(pullfocus("lenses", "glass", "517642", "--json").out)
    assert (report["maker"], report["index"], report["abbe"]) == (None, pytest.approx(1.517), 64.2)
    assert report["indices"]["F"] > report["indices"]["d"] > report["indices"]["C"]


def test_a_glass_that_no_catalogue_has_is_refused_with_the_nearest(pullfocus: Command) -> None:
    ended = pullfocus("lenses", "glass", "N-BK77")
    assert (ended.status, ended.out) == (2, "")
    assert "glass 'N-BK77' is in no catalogue, did you mean N-BK7 or " in ended.err


def test_unknown_glass_is_refused_unless_it_is_allowed(pullfocus: Command, tmp_path: Path) -> None:
    file = tmp_path / "triplet.zmx"
    file.write_text(FILES["triplet.zmx"].replace("GLAS N-SK16 0 0 1.5 4.0E+1", "GLAS N-SK166 0 0 1.62 60.3"))
    refused = pullfocus("lenses", "show", file)
    assert refused.status == 1
    assert "glass N-SK166 is in no catalogue, did you mean N-SK16 " in refused.err
    assert "? --allow-unknown-glass takes it by index and Abbe number, where the file has them" in refused.err
    report = shown(pullfocus, file, "--allow-unknown-glass")
    assert "Glass N-SK166 is in no catalogue: n_d 1.62 and V_d 60.3 are the file's." in report["notes"]


@pytest.mark.parametrize(
    ("name", "suffix"), [("double_gauss_50", "png"), ("soft_focus_85", "svg"), ("pinhole_35", "svg")]
)
def test_a_sheet_is_drawn_in_the_format_that_its_name_asks_for(
    name: str, suffix: str, pullfocus: Command, tmp_path: Path
) -> None:
    file = tmp_path / f"lens.{suffix}"
    ended = pullfocus("lenses", "show", name, "--out", file)
    assert ended.status == 0, ended.err
    assert f"drawn: {file}" in ended.err
    assert [path.name for path in tmp_path.iterdir()] == [file.name]
    if suffix == "svg":
        assert ElementTree.parse(file).getroot().tag.endswith("svg")
    else:
        pixels = OpenImageIO.ImageBuf(str(file)).get_pixels(OpenImageIO.UINT8)
        assert pixels.shape[:2] == (2136, 1920)
        assert (pixels[..., :3].max(axis=-1) < 250).mean() > 0.03  # there is something on it


def test_a_folder_takes_sheets_by_their_lenses_names(pullfocus: Command, tmp_path: Path) -> None:
    assert pullfocus("lenses", "show", "pinhole_35", "--out", tmp_path / "sheets").status == 0
    assert [path.name for path in (tmp_path / "sheets").iterdir()] == ["pinhole_35.png"]


def test_the_same_lens_gives_the_same_sheet_to_the_byte(pullfocus: Command, tmp_path: Path) -> None:
    files = [tmp_path / "a.svg", tmp_path / "b.svg"]
    for file in files:
        pullfocus("lenses", "show", "thin_50", "--focus", "2", "--out", file)
    assert files[0].read_bytes() == files[1].read_bytes()


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (("planr_50",), 2, "there is no lens named 'planr_50' in the library: did you mean planar_50"),
        (("nowhere/lens.zmx",), 1, "lens file nowhere/lens.zmx cannot be read: No such file or directory"),
        (("planar_50", "--focus", "0.03"), 2, "cannot focus at 0.03 m: the nearest that it reaches is 0.0384 m"),
        (("planar_50", "--focus", "0.03"), 2, "before surface 1"),
        (("planar_50", "--focus", "-1"), 2, "a focus distance must be above 0 m, got -1"),
        (("planar_50", "--focus", "nan"), 2, "a focus distance must be above 0 m, got nan"),
        (("planar_50", "--f-stop", "0"), 2, "an f-number must be above 0, got 0"),
        (("pinhole_35", "--f-stop", "2"), 2, "Pinhole 35 mm is a pinhole: it has no f-number to set, got 2"),
        (("planar_50", "--gate", "36"), 2, "--gate takes width x height in mm, such as 24.89x18.66, got 36"),
        (("planar_50", "--gate", "36x0"), 2, "a film gate's sides must be from 0.1 to 1000 mm, got 36 x 0"),
        (
            ("thin_50", "--out", "lens.jpg"),
            2,
            "--out takes a folder, or a file that ends in .png or .svg, got lens.jpg",
        ),
        (
            ("thin_50", "--out", "nowhere/lens.png"),
            1,
            "cannot write nowhere/lens.png: the folder nowhere does not exist",
        ),
    ],
)
def test_what_cannot_be_shown_is_refused_by_one_sentence(
    arguments: tuple[str, ...], status: int, words: str, pullfocus: Command
) -> None:
    ended = pullfocus("lenses", "show", *arguments)
    assert ended.status == status
    [line] = ended.err.splitlines()
    assert words in line


def test_a_broken_lens_file_names_the_surface(pullfocus: Command, tmp_path: Path) -> None:
    file = tmp_path / "broken.dat"
    file.write_text(FILES["double gauss.dat"].replace("1.67", "-1.67", 1))
    ended = pullfocus("lenses", "show", file)
    assert ended.status == 1
    [line] = ended.err.splitlines()
    assert "surface 1" in line


def test_a_lens_that_does_not_reach_infinity_is_no_wrong_argument(pullfocus: Command, tmp_path: Path) -> None:
    file = tmp_path / "near.txt"
    file.write_text(FILES["zoom.txt"])
    ended = pullfocus("lenses", "show", file)
    assert (ended.status, ended.err.count("\n")) == (1, 1)
    assert "An example cannot focus at infinity: the farthest that it reaches is 0.2484 m; --focus sets" in ended.err
    assert pullfocus("lenses", "show", file, "--focus", "1").status == 2
    assert 0 < shown(pullfocus, file, "--focus", "0.2")["nearestFocusM"] < 0.2


@pytest.mark.parametrize("out", ["kept/lens.svg", "missing/lens.png", "kept"])
def test_an_unwritable_sheet_is_refused_before_computing(
    out: str, pullfocus: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "kept").touch()
    monkeypatch.setattr("render.cli.lenses.lens_report", lambda *_: pytest.fail("it was computed"))
    ended = pullfocus("lenses", "show", "thin_50", "--out", tmp_path / out)
    assert (ended.status, ended.out, ended.err.count("\n")) == (1, "", 1)
    assert "cannot " in ended.err
    assert [path.name for path in tmp_path.iterdir()] == ["kept"]


def test_tables_that_cannot_be_written_are_refused_likewise(
    pullfocus: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("render.cli.lenses.lens_report", lambda *_: pytest.fail("it was computed"))
    ended = pullfocus("lenses", "show", "thin_50", "--tables", tmp_path / "missing" / "t.lens")
    assert (ended.status, ended.out) == (1, "")
    assert "missing does not exist" in ended.err


def test_a_full_disk_leaves_the_numbers_and_what_was_there(
    pullfocus: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    (tmp_path / "lens.svg").write_text("old")
    monkeypatch.setattr(os, "fsync", full)
    ended = pullfocus("lenses", "show", "thin_50", "--out", tmp_path / "lens.svg")
    assert ended.status == 1
    assert "the disk is full" in ended.err
    assert "50.00 mm" in ended.out
    assert [path.read_text() for path in tmp_path.iterdir()] == ["old"]
