"""The glass of a lens file: of the catalogue, whatever numbers stand behind its name, or of the file's own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from render.errors import InputError
from render.model.lens import Glass, Prescription
from render.optics.glass import refractive_index
from render.optics.lens_files import parse_lens_file, read_lens_file
from tests.render.kits.glasses import glass
from tests.render.kits.lens_files import ACHROMAT_SEQ, BK7_AGF, TRIPLET_ZMX, ZOOM_TXT

GLAS = "GLAS N-SK16 0 0 1.5 4.0E+1 0 0 0 0 0 0"
LINES_NM = np.array([450.0, 587.5618, 650.0])


def _triplet(glas: str, *, allow: bool = False, gcat: str = "SCHOTT") -> Prescription:
    assert GLAS in TRIPLET_ZMX
    text = TRIPLET_ZMX.replace(GLAS, glas).replace("GCAT SCHOTT", f"GCAT {gcat}")
    return parse_lens_file(text.encode(), "triplet.zmx", allow_unknown_glass=allow)


def _first(lens: Prescription) -> Glass:
    return lens.surfaces[0].glass


@pytest.mark.parametrize("leftover", ["1.5 4.0E+1", "1.7 30", "0 0", "1 0", "x y", ""])
def test_numbers_behind_a_known_name_are_leftovers(leftover: str) -> None:
    lens = _triplet(f"GLAS N-SK16 0 0 {leftover}")
    assert _first(lens) == glass("N-SK16")
    assert not any("N-SK16" in note for note in lens.notes)


def test_the_catalogue_that_the_file_names_first_wins() -> None:
    assert _first(_triplet("GLAS F2 0 0 1.5 40")).index == pytest.approx(1.62004, abs=1e-5)
    assert _first(_triplet("GLAS F2 0 0 1.5 40", gcat="CDGM SCHOTT")).index == pytest.approx(1.61293, abs=1e-5)


def test_a_glass_under_a_name_of_today_is_noted() -> None:
    lens = _triplet("GLAS LAFN21 0 0 1.5 40")
    assert _first(lens).index == pytest.approx(1.78831, abs=1e-5)
    assert "Glass LAFN21 is LAF21 of Schott in today's catalogue." in lens.notes


def test_an_unknown_glass_is_an_error_with_the_nearest_names() -> None:
    with pytest.raises(
        InputError, match=r"line 17, surface 1: glass N-SK166 is in no catalogue, did you mean N-SK16 "
    ) as caught:
        _triplet("GLAS N-SK166 0 0 1.62 60.3")
    assert (caught.value.code, caught.value.path) == ("unknown_glass", "triplet.zmx")


def test_an_unknown_glass_that_is_allowed_is_the_files_own() -> None:
    lens = _triplet("GLAS XYZZY 0 0 1.62 60.3", allow=True)
    assert _first(lens) == Glass(1.62, 60.3, name="XYZZY")
    assert "Glass XYZZY is in no catalogue: n_d 1.62 and V_d 60.3 are the file's." in lens.notes


@pytest.mark.parametrize("numbers", ["", "1.5 4.0E+1", "0 0", "1.62 0", "1 60", "9 60", "1.62 -60"])
def test_an_unknown_glass_without_usable_numbers_is_refused(numbers: str) -> None:
    with pytest.raises(InputError, match="glass XYZZY is in no catalogue, and has no usable index and Abbe number"):
        _triplet(f"GLAS XYZZY 0 0 {numbers}", allow=True)


def test_a_model_glass_has_the_numbers_of_the_file() -> None:
    assert _first(_triplet("GLAS ___BLANK 1 0 1.62 60.3")) == Glass(1.62, 60.3)
    assert _first(_triplet("GLAS N-SK16 1 0 1.63 60.3")) == Glass(1.63, 60.3, name="N-SK16")
    with pytest.raises(InputError, match="a model glass has no index"):
        _triplet("GLAS ___BLANK 1 0")


def test_a_model_glass_may_be_off_the_normal_line() -> None:
    lines = np.array([435.8343, 486.1327, 587.5618, 656.2725])
    for deviation in (-0.01, 0.012):
        found = _first(_triplet(f"GLAS ___BLANK 1 0 1.62 60.3 {deviation} 0 0 0 0 0"))
        n_g, n_f, n_d, n_c = refractive_index(found, lines)
        assert n_d == pytest.approx(1.62, abs=1e-12)
        assert (n_d - 1) / (n_f - n_c) == pytest.approx(60.3, rel=1e-9)
        assert (n_g - n_f) / (n_f - n_c) == pytest.approx(0.6438 - 0.001682 * 60.3 + deviation, abs=1e-9)
    with pytest.raises(InputError, match=r"the deviation of P_gF must be from -0.1 to 0.1, got 3"):
        _triplet("GLAS ___BLANK 1 0 1.62 60.3 3 0 0 0 0 0")


def test_code_v_has_no_numbers_for_an_unknown_glass() -> None:
    for allow in (False, True):
        with pytest.raises(InputError, match=r"surface 1: glass NBK77_SCHOTT is in no catalogue.*did you mean N-BK7 "):
            parse_lens_file(ACHROMAT_SEQ.replace("NBK7_", "NBK77_").encode(), "a.seq", allow_unknown_glass=allow)


def test_a_private_glass_of_three_indices_bends_as_they_do() -> None:
    known = glass("N-SF11")
    lines = np.array([435.8343, 486.1327, 587.5618, 656.2725])
    indices = " ".join(f"{index:.7f}" for index in refractive_index(known, lines))
    catalogue = f"PRV\nPWL {' '.join(map(str, lines))}\n'mine' {indices}\nEND\n"
    lens = parse_lens_file((catalogue + ACHROMAT_SEQ.replace("NBK7_SCHOTT", "'mine'")).encode(), "a.seq")
    assert refractive_index(_first(lens), LINES_NM) == pytest.approx(refractive_index(known, LINES_NM), abs=2e-4)
    assert _first(lens).abbe == pytest.approx(known.abbe, rel=1e-3)


def test_an_optical_bench_glass_has_a_name_that_agrees_or_counts_not() -> None:
    lens = parse_lens_file(ZOOM_TXT.encode(), "zoom.txt")
    assert _first(lens) == glass("N-LAK8")
    other = parse_lens_file(ZOOM_TXT.replace("53.9\tN-LAK8", "50.9\tN-LAK8").encode(), "zoom.txt")
    assert _first(other) == Glass(1.713, 50.9, name="N-LAK8")


def test_a_catalogue_beside_the_file_wins(tmp_path: Path) -> None:
    (tmp_path / "triplet.zmx").write_text(TRIPLET_ZMX.replace(GLAS, "GLAS MY-OWN 0 0 1.5 40"))
    with pytest.raises(InputError, match="glass MY-OWN is in no catalogue"):
        read_lens_file(tmp_path / "triplet.zmx")
    (tmp_path / "mine.AGF").write_bytes(BK7_AGF.replace("N-BK7", "MY-OWN").encode("utf-16"))
    found = _first(read_lens_file(tmp_path / "triplet.zmx"))
    assert (found.name, found.index) == ("MY-OWN", pytest.approx(1.5168, abs=1e-5))
    assert refractive_index(found, LINES_NM) == pytest.approx(refractive_index(glass("N-BK7"), LINES_NM), abs=1e-8)


def test_a_link_to_a_catalogue_elsewhere_is_not_read(tmp_path: Path) -> None:
    folder = tmp_path / "lens"
    folder.mkdir()
    (tmp_path / "mine.agf").write_text(BK7_AGF.replace("N-BK7", "MY-OWN"))
    (folder / "mine.agf").symlink_to(tmp_path / "mine.agf")
    (folder / "triplet.zmx").write_text(TRIPLET_ZMX.replace(GLAS, "GLAS MY-OWN 0 0 1.5 40"))
    with pytest.raises(InputError, match="glass MY-OWN is in no catalogue"):
        read_lens_file(folder / "triplet.zmx")


def test_a_damaged_catalogue_beside_the_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "triplet.zmx").write_text(TRIPLET_ZMX)
    (tmp_path / "mine.agf").write_text(BK7_AGF.replace("1.03961212", "?"))
    with pytest.raises(InputError, match=r"mine\.agf, line 2: the coefficient"):
        read_lens_file(tmp_path / "triplet.zmx")
