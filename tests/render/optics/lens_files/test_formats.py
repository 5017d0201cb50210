"""Lens files of all four formats give the lens that their programs mean."""

from __future__ import annotations

import pytest

from render.model.lens import AIR, Prescription
from render.optics.glass import C_LINE_NM, F_LINE_NM
from render.optics.lens_files import parse_lens_file, read_lens_file
from render.optics.prescription.paraxial import first_order
from tests.render.kits.lens_files import ACHROMAT_SEQ, DOUBLE_GAUSS_DAT, DOUBLE_GAUSS_SEQ, TRIPLET_ZMX, ZOOM_TXT
from tests.render.kits.lenses import DOUBLE_GAUSS


def _read(name: str, text: str) -> Prescription:
    return parse_lens_file(text.encode(), name)


def test_pbrt_rows_are_the_patents_lens() -> None:
    lens = _read("double gauss.dat", DOUBLE_GAUSS_DAT)
    assert lens.surfaces == DOUBLE_GAUSS.prescription.surfaces
    assert lens.name == "Double Gauss 50 mm"
    assert any("Abbe" in note for note in lens.notes)
    assert any("solved for" in note for note in lens.notes)


def test_a_plane_of_glass_in_a_pbrt_file_is_no_stop() -> None:
    lens = _read("planar.dat", "0 3 1.5 20\n-50 0 1 20\n")
    assert [surface.is_stop for surface in lens.surfaces] == [False, False]


def test_an_achromat_that_is_sold_has_the_focal_length_of_its_label() -> None:
    lens = _read("achromat.seq", ACHROMAT_SEQ)
    optics = first_order(lens)
    assert optics.focal_length_mm == pytest.approx(100, rel=5e-4)
    assert optics.back_focal_mm == pytest.approx(lens.surfaces[-1].thickness_mm, rel=1e-3)
    assert lens.f_stop == pytest.approx(4, rel=1e-3)  # 100 mm over EPD 25
    # What makes it an achromat: red and blue have nearly one focus; a singlet of BK7 would part them by 100/64 mm.
    red, blue = (first_order(lens, nm).back_focal_mm for nm in (C_LINE_NM, F_LINE_NM))
    assert abs(red - blue) < 0.1


def test_code_v_curvatures_give_the_double_gauss_of_the_title() -> None:
    lens = _read("double gauss.seq", DOUBLE_GAUSS_SEQ)
    assert first_order(lens).focal_length_mm == pytest.approx(100, rel=1e-3)
    assert lens.f_stop == pytest.approx(2, rel=1e-3)
    assert [surface.is_stop for surface in lens.surfaces].index(True) == 5
    assert lens.surfaces[-1].thickness_mm == pytest.approx(61.4875 - 0.4003, abs=1e-4)  # with the image's shift


def test_code_v_commands_name_surfaces_or_mean_the_last() -> None:
    aspheres = ACHROMAT_SEQ.replace("  PIM\n", "  ASP; K -1.5\n  A 1E-6; B 2E-9 ; J 3E-20\nCIR S1 11.5 ! smaller\n")
    lens = _read("achromat.seq", aspheres)
    assert lens.surfaces[2].conic == -1.5
    assert lens.surfaces[2].aspheric == (1e-6, 2e-9, 0, 0, 0, 0, 0, 0, 3e-20)
    assert lens.surfaces[0].semi_diameter_mm == 11.5


def test_a_private_glass_of_code_v_goes_through_its_indices() -> None:
    catalogue = "PRV\nPWL 656.27 587.56 486.13\n'mine' 1.51432 1.51680 1.52238\nEND\n"
    lens = _read("achromat.seq", catalogue + ACHROMAT_SEQ.replace("NBK7_SCHOTT", "'mine'"))
    assert lens.surfaces[0].glass.index == pytest.approx(1.51680, abs=1e-5)
    assert lens.surfaces[0].glass.abbe == pytest.approx(64.17, rel=0.01)


def test_zemax_surfaces_with_their_asphere_and_glasses() -> None:
    lens = _read("triplet.zmx", TRIPLET_ZMX)
    assert lens.name == "A triplet"
    assert len(lens.surfaces) == 6
    asphere = lens.surfaces[3]
    assert asphere.is_stop
    assert asphere.radius_mm == pytest.approx(1 / 0.051)
    assert asphere.conic == -0.5
    assert asphere.aspheric == (1.5e-5, 2.5e-8)  # PARM 2 is of r⁴
    assert lens.surfaces[0].glass.index == pytest.approx(1.62041)  # by name, not by the 1.5 and 40 that stand behind it
    assert (lens.surfaces[2].glass.index, lens.surfaces[2].glass.abbe) == (1.62004, 36.37)  # a model glass
    assert (lens.surfaces[4].glass.index, lens.surfaces[4].glass.abbe) == pytest.approx((1.620, 60.3))  # a code
    assert lens.surfaces[0].semi_diameter_mm == 9
    assert lens.f_stop == pytest.approx(first_order(lens).focal_length_mm / 14.2857)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be", "utf-8", "utf-8-sig", "latin-1"])
def test_files_are_read_in_any_encoding(encoding: str, end: str) -> None:
    with_umlaut = TRIPLET_ZMX.replace("A triplet", "Trioplan für Porträts").replace("\n", end)
    lens = parse_lens_file(with_umlaut.encode(encoding), "triplet.zmx")
    assert lens.name == "Trioplan für Porträts"
    assert lens.surfaces == _read("triplet.zmx", TRIPLET_ZMX).surfaces


def test_utf16_of_big_endian_machines_has_a_mark_too() -> None:
    data = b"\xfe\xff" + ZOOM_TXT.encode("utf-16-be")
    assert parse_lens_file(data, "zoom").surfaces == _read("zoom.txt", ZOOM_TXT).surfaces


def test_a_half_character_at_the_end_is_ignored() -> None:
    data = ("é" + TRIPLET_ZMX).encode("utf-16-le")[2:] + b"\n"
    assert parse_lens_file(data, "triplet.zmx").surfaces == _read("triplet.zmx", TRIPLET_ZMX).surfaces


def test_inches_become_millimetres_to_the_last_coefficient() -> None:
    lens = _read("triplet.zmx", TRIPLET_ZMX)
    inches = _read("triplet.zmx", TRIPLET_ZMX.replace("UNIT MM", "UNIT IN"))
    assert first_order(inches).focal_length_mm == pytest.approx(25.4 * first_order(lens).focal_length_mm)
    assert inches.f_stop == pytest.approx(lens.f_stop)
    # The same shape, larger: the sag at 25.4 times the radius is 25.4 times the sag.
    r, (a4, a6) = 3.0, lens.surfaces[3].aspheric
    b4, b6 = inches.surfaces[3].aspheric
    assert b4 * (25.4 * r) ** 4 + b6 * (25.4 * r) ** 6 == pytest.approx(25.4 * (a4 * r**4 + a6 * r**6))


def test_marks_of_the_designer_are_no_surfaces_of_the_lens() -> None:
    mark = '  TYPE STANDARD\n  CURV 0.0 0 0 0 0 ""\n  DISZ 7.5\n  DIAM 20 0 0 0 1 ""\n'
    first = TRIPLET_ZMX.index("SURF 1")
    last = TRIPLET_ZMX.index("SURF 7")
    marked = TRIPLET_ZMX[:first] + "SURF 1\n" + mark + TRIPLET_ZMX[first:last] + "SURF 7\n" + mark + TRIPLET_ZMX[last:]
    lens, plain = _read("triplet.zmx", marked), _read("triplet.zmx", TRIPLET_ZMX)
    assert lens.surfaces[:-1] == plain.surfaces[:-1]
    assert lens.surfaces[-1].thickness_mm == plain.surfaces[-1].thickness_mm + 7.5  # the film is as far away as before


def test_a_near_objects_file_does_not_give_the_film_distance() -> None:
    lens = _read("triplet.zmx", TRIPLET_ZMX.replace("DISZ INFINITY", "DISZ 500"))
    assert lens.surfaces[-1].thickness_mm == 0
    assert any("object is near" in note for note in lens.notes)


def test_a_squared_term_on_a_plane_is_a_paraboloid() -> None:
    flat = TRIPLET_ZMX.replace("CURV 5.1E-002", "CURV 0").replace("PARM 1 0", "PARM 1 0.0255")
    surface = _read("triplet.zmx", flat).surfaces[3]
    assert (surface.radius_mm, surface.conic) == pytest.approx((1 / 0.051, -1))


def test_an_optical_bench_zoom_is_read_at_its_first_position() -> None:
    lens = _read("zoom.txt", ZOOM_TXT)
    assert lens.name == "An example"
    assert lens.f_stop == 2.8
    assert [surface.thickness_mm for surface in lens.surfaces] == [5, 3.5, 1.2, 2, 9.2, 4, 0.6, 4, 38.1]
    assert lens.surfaces[4].is_stop
    assert lens.surfaces[4].semi_diameter_mm == 8
    assert lens.surfaces[0].glass.name == "N-LAK8"
    assert lens.surfaces[1].glass == AIR
    assert (lens.surfaces[5].conic, lens.surfaces[5].aspheric) == (-0.5, (1.5e-6, -2e-9))
    # From 0 to -0.05 at 48 mm, d5 shrinks by as much as d7 grows: what stands between them focuses.
    assert lens.focus_group == (5, 6)
    assert any("4 positions" in note for note in lens.notes)


def test_an_optical_bench_lens_that_moves_whole_has_no_focus_group() -> None:
    unit = ZOOM_TXT.replace("8.15", "9.20").replace("1.65", "0.60")
    assert _read("zoom.txt", unit).focus_group is None


def test_optical_bench_coefficients_begin_where_the_constants_say() -> None:
    from_squared = ZOOM_TXT.replace("[constants]", "[constants]\nAsphericalA2").replace(
        "-0.5\t1.5E-06", "-0.5\t0\t1.5E-06"
    )
    assert _read("zoom.txt", from_squared).surfaces[5].aspheric == (1.5e-6, -2e-9)
    odd = ZOOM_TXT.replace("[constants]", "[constants]\nAsphericalOddCount\t1")
    surface = _read("zoom.txt", odd).surfaces[5]
    assert (surface.odd, surface.aspheric) == ((1.5e-6,), (-2e-9,))


def test_a_format_is_recognised_by_content_without_a_suffix() -> None:
    for text in (DOUBLE_GAUSS_DAT, TRIPLET_ZMX, ACHROMAT_SEQ, ZOOM_TXT):
        assert len(_read("lens", text).surfaces) > 2
        assert len(_read("lens.txt", text).surfaces) > 2


def test_a_file_is_read_from_disk(tmp_path) -> None:
    path = tmp_path / "a lens.DAT"
    path.write_text(DOUBLE_GAUSS_DAT)
    assert len(read_lens_file(path).surfaces) == 11
