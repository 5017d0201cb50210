"""Files of several configurations: the first is the prescription, and all are kept."""

from __future__ import annotations

import math

import pytest

from render.errors import InputError
from render.model.lens import Prescription
from render.optics.lens_files import parse_lens_file
from render.optics.lens_files.configurations import (
    DraftConfigurations,
    DraftVariation,
    focal_lengths_mm,
    place_variations,
    prescription_at,
)
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.prescription.paraxial import first_order
from tests.render.kits.lens_files import DOUBLE_GAUSS_SEQ, TRIPLET_ZMX, ZOOM_TXT


def _read(name: str, text: str) -> Prescription:
    return parse_lens_file(text.encode(), name)


def _zemax(*operands: str, active: int = 1, count: int = 2, text: str = TRIPLET_ZMX) -> str:
    return text.replace("MNUM 1 1", "\n".join([f"MNUM {count} {active}", *operands]))


def _thickness(lens: Prescription, index: int) -> float:
    return lens.surfaces[index].thickness_mm


def test_zemax_operands_set_the_first_configuration() -> None:
    operands = ("THIC 2 1 6.5 0 0 0", "THIC 2 2 5.2 0 0 0", "CRVT 6 1 -0.04 0", "SDIA 1 1 8.5 0", "CONN 4 1 -0.75 0")
    lens = _read("a.zmx", _zemax(*operands, active=2))
    assert _thickness(lens, 1) == 6.5
    assert lens.surfaces[5].radius_mm == pytest.approx(-25)
    assert lens.surfaces[0].semi_diameter_mm == 8.5
    assert lens.surfaces[3].conic == -0.75
    plain = _read("a.zmx", TRIPLET_ZMX)
    assert _thickness(plain, 1) == 5.2


def test_a_note_has_each_configurations_focal_length() -> None:
    lens = _read("a.zmx", _zemax("THIC 2 1 5.2 0", "THIC 2 2 6.5 0"))
    lengths = [
        first_order(_read("a.zmx", TRIPLET_ZMX.replace("DISZ 5.2", f"DISZ {gap}"))).focal_length_mm
        for gap in (5.2, 6.5)
    ]
    assert abs(lengths[1] / lengths[0] - 1) > 0.01
    texts = ", ".join(f"{length:.4g}" for length in lengths)
    assert f"The file has 2 configurations; their focal lengths are {texts} mm." in lens.notes


def test_focus_positions_of_one_focal_length_are_said_so() -> None:
    lens = _read("a.zmx", _zemax("THIC 6 1 41 0", "THIC 6 2 44 0"))
    assert any("2 configurations" in note and "all have a focal length of" in note for note in lens.notes)


def test_an_aperture_that_varies_is_the_first_configurations() -> None:
    lens = _read("a.zmx", _zemax("APER 0 1 10 0", "APER 0 2 14.2857 0", active=2))
    assert lens.f_stop == pytest.approx(first_order(lens).focal_length_mm / 10)


def test_the_object_of_the_first_configuration_counts() -> None:
    near = _zemax("THIC 0 1 500 0", "THIC 0 2 1E10 0", active=2)
    far = _zemax("THIC 0 1 1E10 0", "THIC 0 2 500 0", text=TRIPLET_ZMX.replace("DISZ INFINITY", "DISZ 500"), active=2)
    assert _thickness(_read("a.zmx", near), 5) == 0
    assert _thickness(_read("a.zmx", far), 5) == 41


def test_a_solve_keeps_the_sum_of_two_gaps() -> None:
    followed = TRIPLET_ZMX.replace("  DISZ 5.0\n", "  DISZ 5.0\n  TCOM 2 10.2\n")
    lens = _read("a.zmx", _zemax("THIC 2 1 6 0", "THIC 2 2 5.2 0", text=followed, active=2))
    assert (_thickness(lens, 1), _thickness(lens, 3)) == pytest.approx((6, 4.2))
    whole = TRIPLET_ZMX.replace("  DISZ 5.0\n", "  DISZ 5.0\n  TOLE 2 11.4\n")
    lens = _read("a.zmx", _zemax("THIC 2 1 6 0", "THIC 2 2 5.2 0", text=whole, active=2))
    assert (_thickness(lens, 1), _thickness(lens, 3)) == pytest.approx((6, 11.4 - 6 - 1.2))


def test_a_film_that_follows_the_focus_is_solved_for() -> None:
    followed = TRIPLET_ZMX.replace("  DISZ 41.0\n", "  DISZ 41.0\n  MAZH 0 0\n")
    operands = ("THIC 2 1 6 0", "THIC 2 2 5.2 0")
    assert _thickness(_read("a.zmx", _zemax(*operands, text=followed, active=2)), 5) == 0
    assert _thickness(_read("a.zmx", _zemax(*operands, text=followed, active=1)), 5) == 41


def test_operands_that_are_not_read_are_named() -> None:
    lens = _read("a.zmx", _zemax("GLSS 1 1 N-SK16 0", "GLSS 1 2 N-BK7 0", "LTTL 0 1 far 0"))
    assert "Its configurations differ in GLSS too, which is not read." in lens.notes
    lens = _read("a.zmx", _zemax("GLSS 1 1 N-SK16 0", "GLSS 1 2 N-SK16 0", "FVDY 1 1 0.2 0"))
    assert not any("not read" in note for note in lens.notes)


@pytest.mark.parametrize(
    ("operand", "message"),
    [
        ("THIC 12 1 5 0", "THIC is about surface 12, which is not there"),
        ("THIC 2 3 5 0", "configuration of THIC must be from 1 to 2, got 3"),
        ("THIC -2 1 5 0", "surface of THIC must be from 0 to 9999, got -2"),
        ("THIC 2 1 wide 0", "value of THIC must be a number, got 'wide'"),
    ],
)
def test_bad_operands_are_errors(operand: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        _read("a.zmx", _zemax(operand))


def test_too_many_configurations_are_an_error() -> None:
    with pytest.raises(InputError, match=r"number of configurations \(MNUM\) must be from 1 to 64, got 1000"):
        _read("a.zmx", _zemax(count=1000))


def _code_v(*commands: str) -> str:
    return DOUBLE_GAUSS_SEQ.replace("GO\n", "\n".join([*commands, "GO", ""]))


def test_code_v_zoom_positions() -> None:
    lens = _read("a.seq", _code_v("ZOO 2", "ZOO THI S2 0.7 0.5", "ZOO CUY S1 0.018 0.0178", "ZOO CIR S1 30 32"))
    assert _thickness(lens, 1) == 0.7
    assert lens.surfaces[0].radius_mm == pytest.approx(1 / 0.018)
    assert lens.surfaces[0].semi_diameter_mm == 30
    assert any(
        "has 2 zoom positions, whose radii" in note and "first; their focal lengths are" in note for note in lens.notes
    )


def test_code_v_positions_one_by_one() -> None:
    lens = _read("a.seq", _code_v("ZOO 2", 'ZOO TIT; TIT Z1 "wide"', "ZOO THI S2", "THI S2 Z1 0.7", "THI S2 Z2 0.5"))
    assert _thickness(lens, 1) == 0.7
    assert lens.name == "Double Gauss F/2 -  Available Glasses"


def test_code_v_beam_of_the_first_position() -> None:
    lens = _read("a.seq", _code_v("ZOO 2", "ZOO EPD 40 50"))
    assert lens.f_stop == pytest.approx(first_order(lens).focal_length_mm / 40)


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("ZOO THI S2 1 2 3", "ZOO THI has 3 values for 2 positions"),
        ("THI S2 Z3 1", "the file has 2 zoom positions, got Z3"),
        ("ZOO THI S40 1 2", "ZOO THI is about surface 40, which is not there"),
        ("ZOO THI S2 1 x", "value of THI at position 2 must be a number"),
        ("ZOO THI S2 1 2\nZOO 3", "ZOO 3 stands behind values of 2 positions"),
        ("ZOO 900", "ZOO must be from 1 to 64, got 900"),
    ],
)
def test_bad_zoom_positions_are_errors(command: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        _read("a.seq", _code_v("ZOO 2", command))


def test_optical_bench_states_the_focal_lengths() -> None:
    notes = _read("zoom.txt", ZOOM_TXT).notes
    wanted = "The file has 4 positions of zoom and focus; their focal lengths are 48, 70, 48, 70 mm."
    assert wanted in notes


def test_variations_are_placed_in_the_prescription() -> None:
    front, lens, rear, mark = (DraftSurface(str(i), i, thickness=t) for i, t in enumerate((3.0, 1.0, 4.0, 0.5)))
    configurations = DraftConfigurations(
        2,
        variations=[
            DraftVariation(front, "thickness", (3.0, 2.0)),
            DraftVariation(lens, "thickness", (1.0, 1.5)),
            DraftVariation(mark, "thickness", (0.5, 0.25)),
            DraftVariation(None, "f_number", (2.8, None)),
            DraftVariation(None, "object_distance", (math.inf, 20.0)),
        ],
    )
    placed = place_variations(configurations, [front, lens, rear, mark], [lens, rear], unit_mm=10.0)
    assert [(each.surface, each.quantity, each.values) for each in placed] == [
        (0, "thickness", (10.0, 15.0)),
        (None, "f_number", (2.8, None)),
        (None, "object_distance", (math.inf, 200.0)),
        (1, "thickness", (45.0, 42.5)),  # the film is behind the mark
    ]


def test_a_prescription_at_another_configuration() -> None:
    lens = _read("a.zmx", TRIPLET_ZMX)
    draft = [DraftSurface(str(i), i, thickness=s.thickness_mm) for i, s in enumerate(lens.surfaces)]
    varied = DraftConfigurations(2, variations=[DraftVariation(draft[1], "thickness", (5.2, 6.5))])
    placed = place_variations(varied, draft, draft, 1.0)
    other = prescription_at(lens, placed, 1)
    assert _thickness(other, 1) == 6.5
    assert focal_lengths_mm(lens, placed, 2) == pytest.approx(
        [first_order(each).focal_length_mm for each in (lens, other)]
    )
