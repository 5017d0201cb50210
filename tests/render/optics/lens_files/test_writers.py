"""Lenses that are written as lens files and read again."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from render.errors import SettingsError
from render.model.lens import Dispersion, Glass, Prescription, Surface
from render.optics.dispersion.lines import C_LINE_NM, D_LINE_NM, F_LINE_NM, G_LINE_NM
from render.optics.dispersion.names import find_glass
from render.optics.glass import refractive_index
from render.optics.lens_files import parse_lens_file
from render.optics.lens_files.writing import WRITTEN_SUFFIXES, write_lens
from render.optics.lens_files.written_parts import glass_form, plain_name
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.paraxial import first_order
from render.optics.prescription.surface_shape import sag_mm
from render.shot.lens.lens_alone import library_lens_alone
from tests.render.kits.lens_files import TRIPLET_ZMX, ZOOM_TXT
from usd_schemas import library_lenses

LINES_NM = (C_LINE_NM, D_LINE_NM, F_LINE_NM, G_LINE_NM)


def _library() -> list[tuple[str, Prescription]]:
    lenses = [(entry.name, library_lens_alone(entry.name).camera.lens.prescription) for entry in library_lenses()]
    return [(name, complete_prescription(lens)) for name, lens in lenses if lens is not None]


LIBRARY = _library()


def _again(lens: Prescription, suffix: str) -> Prescription:
    return parse_lens_file(write_lens(lens, suffix).content, f"again{suffix}")


def _catalogue(name: str) -> Glass:
    glass = find_glass(name)
    assert glass is not None
    return glass


def _check_same(lens: Prescription, again: Prescription, glass_within: float = 1e-7) -> None:
    """Compare two lenses, number by number."""
    for name in ("radius_mm", "thickness_mm", "semi_diameter_mm", "conic", "is_stop"):
        values = [getattr(surface, name) for surface in again.surfaces]
        assert values == pytest.approx([getattr(surface, name) for surface in lens.surfaces], rel=1e-12), name
    for here, there in zip(lens.surfaces, again.surfaces, strict=True):
        assert there.aspheric == pytest.approx(here.aspheric, rel=1e-12)
        for line in LINES_NM:
            index = refractive_index(here.glass, line)
            assert refractive_index(there.glass, line) == pytest.approx(index, abs=glass_within)
    assert again.f_stop == pytest.approx(lens.f_stop, rel=2e-6)
    assert again.name == lens.name


@pytest.mark.parametrize("suffix", WRITTEN_SUFFIXES)
@pytest.mark.parametrize(("name", "lens"), LIBRARY, ids=[name for name, _ in LIBRARY])
def test_a_lens_of_the_library_comes_back(name: str, lens: Prescription, suffix: str) -> None:
    if lens.is_anamorphic and suffix == ".txt":
        with pytest.raises(SettingsError, match=r"another curve from side to side, .* write .zmx or .seq"):
            write_lens(lens, suffix)
        return
    written = write_lens(lens, suffix)
    again = parse_lens_file(written.content, f"again{suffix}")
    plane_for_stop = any("written as a plane before it" in note for note in written.notes)
    assert len(again.surfaces) == len(lens.surfaces) + plane_for_stop
    assert first_order(again).focal_length_mm == pytest.approx(first_order(lens).focal_length_mm, rel=1e-6)
    if not plane_for_stop:
        own = any(glass_form(surface.glass).kind == "own" for surface in lens.surfaces)
        _check_same(replace(lens, name=plain_name(lens.name)), again, 1e-3 if own else 1e-7)


@pytest.mark.parametrize(
    ("name", "focal_length_mm", "f_number"),
    [
        ("planar_50", 50.000446168509704, 1.4),
        ("distagon_35", 35.00001223114783, 1.4),
        ("double_gauss_50", 50.35816695831366, 2.01790180),
    ],
)
def test_other_programs_read_the_same_lens(name: str, focal_length_mm: float, f_number: float) -> None:
    """The numbers are those of rayoptics 0.9.8 for the written .zmx and .seq, and of optiland 0.6.3 for the .zmx."""
    lens = dict(LIBRARY)[name]
    for suffix in (".zmx", ".seq"):
        again = _again(lens, suffix)
        assert first_order(again).focal_length_mm == pytest.approx(focal_length_mm, rel=1e-12)
        assert again.f_stop == pytest.approx(f_number, rel=1e-7)


def _made(*glasses: Glass, **changes: object) -> Prescription:
    first, second = glasses
    surfaces = (
        Surface(31.7, 4.25, first, 10.5, conic=-0.75, aspheric=(1.25e-6, -3.5e-9, 0.0, 7e-14)),
        Surface(-95.0, 3.1, semi_diameter_mm=10.0),
        Surface(0.0, 3.3, semi_diameter_mm=8.0, is_stop=True),
        Surface(-41.0, 1.2, second, 9.0),
        Surface(70.0, 2.4, semi_diameter_mm=9.2, conic=0.5),
        Surface(60.0, 3.0, first, 10.0),
        Surface(-55.0, 0.0, semi_diameter_mm=10.0),
    )
    whole = complete_prescription(Prescription(surfaces, f_stop=4.0, name="A lens"))
    return replace(whole, **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize("suffix", WRITTEN_SUFFIXES)
@pytest.mark.parametrize(
    "glasses",
    [("N-SK16", "F2"), ("F2_HOYA", "SF10"), ("PMMA", "POLYCARB"), ("F_SILICA", "CAF2"), ("S-LAH58", "H-ZF52")],
)
def test_glass_by_its_name_comes_back(glasses: tuple[str, str], suffix: str) -> None:
    lens = _made(*(_catalogue(name) for name in glasses))
    _check_same(lens, _again(lens, suffix))


@pytest.mark.parametrize("suffix", WRITTEN_SUFFIXES)
@pytest.mark.parametrize(
    "glasses",
    [
        (Glass(1.62041, 60.32), Glass(1.80518, 25.46)),
        (Glass(1.6213579, 60.3234), Glass(2.05, 17.7)),
        (Glass(1.5), Glass(1.6)),
    ],
)
def test_model_glass_comes_back(glasses: tuple[Glass, Glass], suffix: str) -> None:
    lens = _made(*glasses)
    _check_same(lens, _again(lens, suffix), 1e-6 if suffix == ".seq" else 1e-7)


OWN = Glass(1.6204, 60.3, name="MYOWN", dispersion=Dispersion("cauchy", (1.6015, 0.0, 0.0062, -2.0, 1.2e-4, -4.0)))


def test_glass_of_no_catalogue_is_private_in_code_v() -> None:
    lens = _made(OWN, Glass(1.5))
    again = _again(lens, ".seq")
    _check_same(lens, again, 1e-6)
    assert not [note for note in write_lens(lens, ".seq").notes if "Glass" in note]


@pytest.mark.parametrize("suffix", [".zmx", ".txt"])
def test_glass_of_no_catalogue_is_noted_elsewhere(suffix: str) -> None:
    lens = _made(OWN, Glass(1.6, 40.0))
    written = write_lens(lens, suffix)
    assert any(note.startswith("Glass MYOWN of surface 1 is written by n_d") for note in written.notes)
    again = parse_lens_file(written.content, f"again{suffix}")
    assert refractive_index(again.surfaces[0].glass, D_LINE_NM) == pytest.approx(OWN.index, abs=1e-6)


@pytest.mark.parametrize("suffix", WRITTEN_SUFFIXES)
def test_what_a_format_cannot_say_is_noted(suffix: str) -> None:
    lens = _made(_catalogue("N-BK7"), _catalogue("F2"), focus_group=(3, 4))
    coated = replace(lens, surfaces=(replace(lens.surfaces[0], coating_nm=520.0), *lens.surfaces[1:]))
    notes = write_lens(coated, suffix).notes
    assert "Coatings are not written." in notes
    assert ("The group that moves to focus is not written." in notes) == (suffix != ".txt")


@pytest.mark.parametrize("suffix", WRITTEN_SUFFIXES)
@pytest.mark.parametrize(
    ("aspheric", "odd"),
    [
        ((1e-6,), (-2e-5, 3e-8)),
        ((), (1e-5,)),
        ((1e-6,), (-2e-5, 3e-8, 0.0, 1e-12)),
        ((1e-6, 0.0, 0.0, 0.0, 0.0, 0.0, 1e-17), (-2e-5, 0.0, 0.0, 0.0, 0.0, 1e-14)),
        ((1e-6, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2e-19, -1e-21), ()),
    ],
)
def test_odd_and_high_powers_come_back(suffix: str, aspheric: tuple[float, ...], odd: tuple[float, ...]) -> None:
    lens = _made(_catalogue("N-BK7"), _catalogue("F2"))
    front = replace(lens.surfaces[0], aspheric=aspheric, odd=odd)
    again = _again(replace(lens, surfaces=(front, *lens.surfaces[1:])), suffix).surfaces[0]
    assert again.aspheric == pytest.approx(aspheric, rel=1e-12)
    assert again.odd == pytest.approx(odd, rel=1e-12)
    assert again.conic == front.conic


@pytest.mark.parametrize("suffix", WRITTEN_SUFFIXES)
def test_powers_beyond_20_come_back_as_a_fit(suffix: str) -> None:
    lens = _made(_catalogue("N-BK7"), _catalogue("F2"))
    front = replace(lens.surfaces[0], aspheric=(1e-6,) + (0.0,) * 8 + (1e-25,))
    again = _again(replace(lens, surfaces=(front, *lens.surfaces[1:])), suffix).surfaces[0]
    squares = np.linspace(0, front.semi_diameter_mm, 20) ** 2
    np.testing.assert_allclose(sag_mm(again, squares), sag_mm(front, squares), atol=1e-8)
    assert sag_mm(front, squares[-1]) - sag_mm(replace(front, aspheric=(1e-6,)), squares[-1]) > 1e-3


def test_the_focus_group_comes_back_in_an_optical_bench_file() -> None:
    lens = _made(_catalogue("N-BK7"), _catalogue("F2"), focus_group=(3, 4))
    assert _again(lens, ".txt").focus_group == (3, 4)
    rear = replace(lens, focus_group=(5, 6))
    assert _again(rear, ".txt").focus_group == (5, 6)
    front = write_lens(replace(lens, focus_group=(0, 1)), ".txt")
    assert "The group that moves to focus is not written." in front.notes


@pytest.mark.parametrize(("name", "text"), [("a.zmx", TRIPLET_ZMX), ("a.txt", ZOOM_TXT)])
@pytest.mark.parametrize("suffix", WRITTEN_SUFFIXES)
def test_a_lens_of_a_file_goes_into_another(name: str, text: str, suffix: str) -> None:
    lens = complete_prescription(parse_lens_file(text.encode(), name))
    again = _again(lens, suffix)
    assert first_order(again).focal_length_mm == pytest.approx(first_order(lens).focal_length_mm, rel=1e-7)
    assert again.f_stop == pytest.approx(lens.f_stop, rel=1e-9)


@pytest.mark.parametrize("suffix", WRITTEN_SUFFIXES)
def test_names_are_written_without_what_parts_words(suffix: str) -> None:
    lens = _made(_catalogue("N-BK7"), _catalogue("F2"), name="Kino \"Plasmat\"; für\t'16 mm' & more!\n")
    assert _again(lens, suffix).name == "Kino Plasmat für 16 mm more"


def test_a_zemax_file_is_ascii_where_its_name_is() -> None:
    lens = _made(_catalogue("N-BK7"), _catalogue("F2"))
    assert write_lens(lens, ".zmx").content.startswith(b"VERS 140124 258 36214\r\nMODE SEQ\r\n")
    assert write_lens(replace(lens, name="für"), ".zmx").content.startswith(b"\xff\xfe")


def test_other_suffixes_are_refused() -> None:
    with pytest.raises(SettingsError, match=r"lens files are written as \.zmx, \.seq, \.txt, got \.dat"):
        write_lens(_made(_catalogue("N-BK7"), _catalogue("F2")), ".dat")


def test_what_no_writer_knows_is_refused() -> None:
    @dataclass(frozen=True)
    class Odd(Surface):
        wedge: float = 0.0

    lens = _made(_catalogue("N-BK7"), _catalogue("F2"))
    odd = Odd(**(vars(lens.surfaces[0]) | {"wedge": 1.0}))
    with pytest.raises(SettingsError, match="A lens cannot be written as a lens file: surface 1 has values of wedge"):
        write_lens(replace(lens, surfaces=(odd, *lens.surfaces[1:])), ".zmx")
