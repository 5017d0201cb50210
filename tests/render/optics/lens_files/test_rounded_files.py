"""Files whose numbers are rounded, or written in other ways than ours: what is assumed is noted."""

from __future__ import annotations

import pytest

from render.errors import InputError
from render.model.lens import Prescription
from render.optics.lens_files import parse_lens_file
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.paraxial import first_order
from tests.render.kits.lens_files import ACHROMAT_SEQ, TRIPLET_ZMX, ZOOM_TXT


def _read(name: str, text: str) -> Prescription:
    return parse_lens_file(text.encode(), name)


def _close(**numbers: float) -> Prescription:
    text = "40 5 1.6 20\n-50 0.1 1 {front}\n{radius} 3 1.5 {behind}\n-60 1 1 20\n0 3 0 8\n200 2 1.5 18\n-200 50 1 18\n"
    return _read("close.dat", text.format(**numbers))


def test_rims_that_meet_by_rounding_are_trimmed() -> None:
    # Sags of -50 and -40 part by r²·(1/80 − 1/100) = 0.1 mm at about 6.3 mm: 12.6 mm across.
    lens = _close(front=13, behind=14, radius=-40)
    trimmed = lens.surfaces[1].semi_diameter_mm
    assert 6.2 < trimmed < 6.5
    assert lens.surfaces[2].semi_diameter_mm == 7
    note = f"The clear diameter of surface 2 was trimmed from 13 to {2 * trimmed:.5g} mm: it meets surface 3 there."
    assert note in lens.notes
    complete_prescription(lens)  # overlaps are refused here


def test_the_narrower_of_two_neighbours_is_trimmed() -> None:
    lens = _close(front=14, behind=13, radius=-40)
    assert lens.surfaces[1].semi_diameter_mm == 7
    assert lens.surfaces[2].semi_diameter_mm < 6.5


def test_rims_that_overlap_by_far_are_refused() -> None:
    lens = _close(front=15, behind=16, radius=-40)
    assert lens.surfaces[1].semi_diameter_mm == 7.5
    with pytest.raises(
        InputError, match=r"surface 2 of close: it overlaps surface 3 by .* within their clear diameters"
    ):
        complete_prescription(lens)


def test_a_rim_a_little_beyond_its_sphere_is_trimmed() -> None:
    ball = "9.95 20 1.5 {} \n-30 0.1 1 20\n0 1 0 3\n"
    lens = _read("ball.dat", ball.format(20))
    assert lens.surfaces[0].semi_diameter_mm == pytest.approx(9.95)
    assert "trimmed from 20 to 19.9 mm: its sphere ends there" in "".join(lens.notes)
    with pytest.raises(InputError, match=r"its clear semi-diameter of 15 mm exceeds the 9\.95 mm"):
        complete_prescription(_read("ball.dat", ball.format(30)))


def test_a_field_stop_before_its_neighbour_is_left_out() -> None:
    plain = _read("zoom.txt", ZOOM_TXT)
    stopped = ZOOM_TXT.replace("7\t-45\td7\t\t19\n", "7\t-45\t-0.4\t\t19\n71\tFS\t1.0\t\t17\n")
    lens = _read("zoom.txt", stopped)
    assert len(lens.surfaces) == len(plain.surfaces)
    assert lens.surfaces[6].thickness_mm == pytest.approx(0.6)
    assert first_order(lens).focal_length_mm == pytest.approx(first_order(plain).focal_length_mm)
    assert any(note.startswith("Surface 71, a plane of air, stands 0.4 mm before its neighbour") for note in lens.notes)


def test_a_plane_that_glass_bulges_through_is_left_out() -> None:
    plane = "SURF 2.5\n  TYPE STANDARD\n  CURV 0\n  DISZ {}\n  DIAM 9 1\n"
    text = TRIPLET_ZMX.replace("SURF 3\n", plane.format(5.2) + "SURF 3\n")
    plain = _read("a.zmx", TRIPLET_ZMX)
    # The vertex of surface 2 is 0.04 mm before its rim, 9 mm from the axis.
    cut = _read("a.zmx", text.replace("CURV -1.0E-003", "CURV 1.0E-003").replace("  DISZ 5.2\n", "  DISZ 0.02\n", 1))
    assert len(cut.surfaces) == len(plain.surfaces)
    assert cut.surfaces[1].thickness_mm == pytest.approx(5.22)
    assert "Surface 2.5, a plane of air, is cut by the glass beside it; it is left out." in cut.notes
    kept = _read("a.zmx", text.replace("  DISZ 5.2\n", "  DISZ 0.02\n", 1))
    assert len(kept.surfaces) == len(plain.surfaces) + 1
    assert kept.notes == plain.notes


def test_a_field_stop_left_out_keeps_the_zoom() -> None:
    stopped = ZOOM_TXT.replace("7\t-45\td7\t\t19\n", "7\t-45\t-0.4\t\t19\n71\tFS\td7\t\t17\n")
    shorter = ZOOM_TXT.replace("d7\t0.60\t2.6\t1.65\t3.7", "d7\t0.20\t2.2\t1.25\t3.3")
    lens, plain = _read("zoom.txt", stopped), _read("zoom.txt", shorter)
    gaps = [surface.thickness_mm for surface in plain.surfaces]
    assert [surface.thickness_mm for surface in lens.surfaces] == pytest.approx(gaps)
    assert lens.focus_group == plain.focus_group
    assert [note for note in lens.notes if "positions" in note] == [note for note in plain.notes if "positions" in note]


def test_a_stop_that_glass_bulges_through_is_moved() -> None:
    bulging = ZOOM_TXT.replace("4\t40\t2.0", "4\t-400\t-0.05").replace("5\tAS\td5", "5\tAS\t9.25")
    lens = _read("zoom.txt", bulging)
    assert (lens.surfaces[3].thickness_mm, lens.surfaces[4].thickness_mm) == pytest.approx((0, 9.2))
    assert any("Glass bulges 0.05 mm through the stop, surface 5" in note for note in lens.notes)


def test_other_negative_gaps_are_refused() -> None:
    lens = _read("triplet.zmx", TRIPLET_ZMX.replace("DISZ 5.2", "DISZ -5.2"))
    with pytest.raises(InputError, match=r"surface 2 of A triplet: its thickness must be 0 or more, got -5\.2 mm"):
        complete_prescription(lens)


@pytest.mark.parametrize("infinity", ["INFINITY", "-Infinity", "inf", "+INF"])
def test_an_infinite_radius_is_a_plane(infinity: str) -> None:
    dat = _read("a.dat", f"50 3 1.5 20\n{infinity} 0 1 20\n")
    assert dat.surfaces[1].radius_mm == 0
    seq = _read("a.seq", ACHROMAT_SEQ.replace("-129.9400000000001", infinity))
    assert seq.surfaces[2].radius_mm == 0
    bench = _read("a.txt", ZOOM_TXT.replace("9\t-60", f"9\t{infinity}"))
    assert bench.surfaces[8].radius_mm == 0


@pytest.mark.parametrize("far", ["INFINITY", "Infinity", "1.0E+10", "inf"])
def test_an_object_far_away_is_written_in_many_ways(far: str) -> None:
    zmx = _read("a.zmx", TRIPLET_ZMX.replace("DISZ INFINITY", f"DISZ {far}"))
    assert zmx.surfaces[-1].thickness_mm == 41
    seq = _read("a.seq", ACHROMAT_SEQ.replace("0.1e14", far))
    assert seq.surfaces[-1].thickness_mm == pytest.approx(95.952, abs=1e-3)


def test_an_object_behind_a_designers_plane_is_as_far() -> None:
    plane = '  TYPE STANDARD\n  CURV 0.0 0 0 0 0 ""\n  DISZ INFINITY\n'
    text = TRIPLET_ZMX.replace("DISZ INFINITY", "DISZ 0").replace("SURF 1\n", f"SURF 0.5\n{plane}SURF 1\n")
    lens = _read("a.zmx", text)
    assert lens.surfaces[-1].thickness_mm == 41
    assert not any("near" in note for note in lens.notes)


def test_parameters_beyond_the_eighth_may_be_zero() -> None:
    more = TRIPLET_ZMX.replace("  PARM 3 2.5E-8\n", "  PARM 3 2.5E-8\n  PARM 9 0.0\n  PARM 10 0\n  PARM 0 0\n")
    assert _read("a.zmx", more).surfaces == _read("a.zmx", TRIPLET_ZMX).surfaces


def test_exponents_of_fortran_are_numbers() -> None:
    text = TRIPLET_ZMX.replace("1.5E-5", "1.5D-05")
    assert _read("a.zmx", text).surfaces == _read("a.zmx", TRIPLET_ZMX).surfaces
