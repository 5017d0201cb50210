"""CODE V files as they are in the world: glued continuations, private glass, and what is refused by its name."""

from __future__ import annotations

import pytest

from render.errors import InputError
from render.model.lens import Prescription
from render.optics.glass import refractive_index
from render.optics.lens_files import parse_lens_file
from render.optics.prescription.paraxial import first_order
from tests.render.kits.lens_files import ACHROMAT_SEQ

FIRST = "S     61.46999999999995 6.0 NBK7_SCHOTT\n"


def _read(text: str) -> Prescription:
    return parse_lens_file(text.encode(), "a.seq")


PLAIN = _read(ACHROMAT_SEQ)


@pytest.mark.parametrize(
    "lines",
    [
        "S 61.46999999999995&\n 6.0&\n NBK7_SCHOTT\n",
        "S 61.46999999999995 6.0 &  ! and the glass\n  NBK7_SCHOTT\n",
        "S 61.46999999999995 6.0&   \n NBK7_SCHOTT; CCY 0;THC 0\n",
        "s 61.46999999999995 6.0 nbk7_schott ! crown\n",
        "S1 61.46999999999995 6.0 NBK7_SCHOTT\n",
        "S 0 0; RDY S1 61.46999999999995; THI S1 6.0; GLA S1 NBK7_SCHOTT\n",
    ],
)
def test_one_surface_in_many_spellings(lines: str) -> None:
    lens = _read(ACHROMAT_SEQ.replace(FIRST, lines))
    assert [(s.radius_mm, s.thickness_mm) for s in lens.surfaces] == [
        (s.radius_mm, s.thickness_mm) for s in PLAIN.surfaces
    ]
    assert [s.glass.index for s in lens.surfaces] == [s.glass.index for s in PLAIN.surfaces]


def test_a_private_catalogue_over_glued_lines() -> None:
    wavelengths = "PWL 706.5 656.27 587.56&\n   546.07 486.13 435.8"
    catalogue = f"PRV  \n  {wavelengths}\n  'E48' 1.5263 1.52830 1.53116&\n   1.5334 1.53780 1.5427\nEND\n"
    lens = _read(catalogue + ACHROMAT_SEQ.replace("NBK7_SCHOTT", "'E48'"))
    glass = lens.surfaces[0].glass
    assert glass.name == "E48"
    for wavelength, index in ((656.27, 1.5283), (587.56, 1.53116), (486.13, 1.5378)):
        assert refractive_index(glass, wavelength) == pytest.approx(index, abs=2e-4)


def test_a_private_glass_by_laurents_series() -> None:
    # Schott's formula for BK7 in catalogues of the 1980s: n_d is 1.51680, V_d 64.17.
    laurent = "2.2718929 -1.0108077E-2 1.0592509E-2 2.0816965E-4 -7.6472538E-6 4.9240991E-7"
    lens = _read(f"PRV\n'old' LAU {laurent}\nEND\n" + ACHROMAT_SEQ.replace("NBK7_SCHOTT", "'old'"))
    glass = lens.surfaces[0].glass
    assert glass.index == pytest.approx(1.51680, abs=1e-5)
    assert glass.abbe == pytest.approx(64.17, abs=0.02)


@pytest.mark.parametrize(
    ("catalogue", "message"),
    [
        ("'x' LAU 2.27", "line 2: glass X: LAU takes 2 to 8 coefficients, got 1"),
        ("'x' LAU 2.27 much", "the coefficient of glass X must be a number, got 'much'"),
        ("'x' LAU 99 1", "the refractive index must be from 1 to 5"),
        ("'x' GMS 1 2 3 4 5 6", "glass X: the formula GMS is not supported, only indices and LAU"),
        ("PWL 500 600\n'x' 1.5 1.6 1.7", "glass X: expected one index for each of the 2 wavelengths"),
    ],
)
def test_a_wrong_private_catalogue(catalogue: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        _read(f"PRV\n{catalogue}\nEND\n{ACHROMAT_SEQ}")


@pytest.mark.parametrize(("unit", "scale"), [("M", 1), ("C", 10), ("I", 25.4), ("IN", 25.4), ("CM", 10), ("MM", 1)])
def test_units_of_length(unit: str, scale: float) -> None:
    lens = _read(ACHROMAT_SEQ.replace("DIM   M", f"LEN NEW\nDIM {unit}"))
    assert first_order(lens).focal_length_mm == pytest.approx(scale * first_order(PLAIN).focal_length_mm)


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("YDE 1.5", r"surface 2: tilts and decentres \(YDE 1\.5\) are not supported"),
        ("DAR; ADE S1 -3", r"surface 1: tilts and decentres \(ADE -3\) are not supported"),
        ("BDE 2 ; CDE 0", r"surface 2: tilts and decentres \(BDE 2\) are not supported"),
        ("ADE x", r"surface 2: the tilt \(ADE\) must be a number"),
        ("RMD S1 REFL", r"surface 1: mirrors \(RMD\) are not supported"),
        ("GRN C10 0.02", r"surface 2: gradient-index glasses \(GRN\) are not supported"),
        ("NSS", r"surface 2: non-sequential surfaces \(NSS\) are not supported"),
        ("GRT", "surface 2: GRT is not supported"),
        ("ADE S9 3", "there is no surface 9"),
    ],
)
def test_what_is_refused_is_named_with_its_surface(command: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        _read(ACHROMAT_SEQ.replace("NSF5_SCHOTT\n", f"NSF5_SCHOTT\n  {command}\n"))


def test_a_mirror_is_refused() -> None:
    with pytest.raises(InputError, match=r"line 10, surface 1: mirrors \(REFL\) are not supported"):
        _read(ACHROMAT_SEQ.replace("6.0 NBK7_SCHOTT", "-6.0 REFL"))


def test_tilts_of_nothing_and_surfaces_that_refract_are_read() -> None:
    harmless = "NSF5_SCHOTT\n  DAR; XDE 0; YDE 0.0; ADE 0; BEN\n  RMD S1 REFR\n"
    assert _read(ACHROMAT_SEQ.replace("NSF5_SCHOTT\n", harmless)).surfaces == PLAIN.surfaces
