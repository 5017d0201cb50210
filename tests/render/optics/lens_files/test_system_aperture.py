"""The system aperture of Zemax and CODE V sets the beam, and clear diameters can only cut it."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from render.errors import InputError
from render.model.lens import Prescription
from render.optics.lens_files import parse_lens_file
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.f_numbers import f_number, iris_radius_mm
from render.optics.prescription.focusing import focus_lens
from render.optics.prescription.paraxial import first_order, stop_index
from tests.render.kits.lens_files import DOUBLE_GAUSS_SEQ, TRIPLET_ZMX


def zemax(aperture: str, stop_mm: float = 9.0, front_mm: float = 9.0) -> Prescription:
    text = TRIPLET_ZMX.replace("ENPD 14.2857", aperture).replace("DIAM 5.5", f"DIAM {stop_mm}")
    return complete_prescription(parse_lens_file(text.replace("DIAM 9 ", f"DIAM {front_mm} ", 1).encode(), "a.zmx"))


def code_v(aperture: str, stop_mm: float = 40.0, front_mm: float = 0.0) -> Prescription:
    text = DOUBLE_GAUSS_SEQ.replace("EPD   50.0", aperture).replace("  STO\n", f"  STO\n  CIR {stop_mm}\n")
    rim = f"  CIR {front_mm}\n" if front_mm else ""
    return complete_prescription(parse_lens_file(text.replace("  CCY 0\n", f"  CCY 0\n{rim}", 1).encode(), "a.seq"))


def entrance_beam_mm(lens: Prescription) -> float:
    """Diameter of the widest parallel beam that comes through."""
    return 2 * focus_lens(lens, math.inf, 0.5).entrance_pupil_radius_mm


def stop_radius_mm(lens: Prescription) -> float:
    return lens.surfaces[stop_index(lens)].semi_diameter_mm


Make = Callable[..., Prescription]


@pytest.mark.parametrize(
    ("make", "aperture", "f_stop", "beam_mm"),
    [
        (zemax, "ENPD 14.0", 0.0, 14.0),
        (zemax, "FNUM 4.0 0", 4.0, 0.0),
        (code_v, "EPD 45.0", 0.0, 45.0),
        (code_v, "FNO 2.2", 2.2, 0.0),
        (code_v, "NA 0.2", 2.5, 0.0),
    ],
)
def test_the_aperture_sets_the_beam_whatever_the_stop_lets_by(
    make: Make, aperture: str, f_stop: float, beam_mm: float
) -> None:
    lens = make(aperture)
    focal_mm = first_order(lens).focal_length_mm
    assert lens.f_stop == pytest.approx(f_stop or focal_mm / beam_mm, rel=1e-6)
    assert entrance_beam_mm(lens) == pytest.approx(beam_mm or focal_mm / f_stop, rel=1e-6)
    assert stop_radius_mm(lens) == pytest.approx(iris_radius_mm(lens, lens.f_stop), rel=1e-6)


def test_a_stop_that_floats_is_as_wide_as_its_clear_diameter() -> None:
    lens = zemax("FLOA", stop_mm=5.0)
    assert stop_radius_mm(lens) == 5.0
    assert lens.f_stop == pytest.approx(f_number(lens, 5.0), rel=1e-9)
    both = zemax("FLOA\nENPD 3.0", stop_mm=5.0)  # what else stands there does not count
    assert both.f_stop == lens.f_stop


@pytest.mark.parametrize(("make", "aperture"), [(zemax, "ENPD 14"), (code_v, "EPD 45")])
def test_a_narrower_stop_cuts_the_beam(make: Make, aperture: str) -> None:
    radius_mm = 0.8 * stop_radius_mm(make(aperture))
    cut = make(aperture, stop_mm=radius_mm)
    assert stop_radius_mm(cut) == radius_mm
    assert cut.f_stop == pytest.approx(f_number(cut, radius_mm), rel=1e-9)
    assert cut.f_stop > 1.1 * make(aperture).f_stop
    assert any("said to be" in note for note in cut.notes)


@pytest.mark.parametrize(
    ("make", "aperture", "front_mm", "wide_mm"), [(zemax, "ENPD 14", 5.0, 10.0), (code_v, "EPD 45", 20.0, 30.0)]
)
def test_a_narrower_rim_cuts_the_beam_and_a_wider_one_does_not(
    make: Make, aperture: str, front_mm: float, wide_mm: float
) -> None:
    whole, cut, wide = make(aperture), make(aperture, front_mm=front_mm), make(aperture, front_mm=wide_mm)
    # parallel rays meet the front rim at their own height
    assert entrance_beam_mm(cut) == pytest.approx(2 * front_mm, rel=1e-6)
    assert any("Surface 1 cuts the beam on the axis" in note for note in cut.notes)
    assert entrance_beam_mm(wide) == pytest.approx(entrance_beam_mm(whole), rel=1e-6)


@pytest.mark.parametrize("stop_mm", [0.0, 9.0])
def test_the_rim_of_an_asphere_cuts_the_beam_too(stop_mm: float) -> None:
    sphere, asphere = "SURF 1\n  TYPE STANDARD\n", "SURF 1\n  TYPE EVENASPH\n  PARM 2 1E-9\n"
    text = TRIPLET_ZMX.replace(sphere, asphere).replace("DIAM 9 ", "DIAM 5 ", 1).replace("DIAM 5.5", f"DIAM {stop_mm}")
    lens = complete_prescription(parse_lens_file(text.encode(), "a.zmx"))
    assert entrance_beam_mm(lens) == pytest.approx(10.0, rel=1e-5)
    assert stop_radius_mm(lens) == pytest.approx(stop_radius_mm(zemax("ENPD 14.2857")), rel=1e-4)


def test_an_aperture_after_the_surfaces_is_read_too() -> None:
    text = DOUBLE_GAUSS_SEQ.replace("EPD   50.0\n", "").replace("GO\n", "NA 0.2\nGO\n")
    assert parse_lens_file(text.encode(), "a.seq").f_stop == 2.5


@pytest.mark.parametrize(
    ("aperture", "is_told"), [("ENPD 14.0", False), ("FNUM 4.0 0", False), ("FNUM 4.0 1", True), ("FLOA", False)]
)
def test_a_working_f_number_of_a_near_object_is_told(aperture: str, is_told: bool) -> None:
    text = TRIPLET_ZMX.replace("ENPD 14.2857", aperture).replace("DISZ INFINITY", "DISZ 500")
    lens = parse_lens_file(text.encode(), "a.zmx")
    assert any("near object; it is taken for the one at infinity" in note for note in lens.notes) == is_told


@pytest.mark.parametrize(("line", "words"), [("NA -1", "numerical aperture .NA."), ("FNO x", "f-number .FNO.")])
def test_an_aperture_that_is_none_is_refused(line: str, words: str) -> None:
    with pytest.raises(InputError, match=rf"a.seq, line 3: .*{words}"):
        parse_lens_file(DOUBLE_GAUSS_SEQ.replace("EPD   50.0", line).encode(), "a.seq")
