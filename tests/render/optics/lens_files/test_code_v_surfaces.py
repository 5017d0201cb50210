"""CODE V files with special surfaces, cylinders and biconics."""

from __future__ import annotations

import pytest

from render.errors import InputError
from render.model.lens import Across, Surface
from render.optics.lens_files import parse_lens_file
from render.optics.lens_files.forbes import ForbesTerms, qcon_terms
from tests.render.kits.surface_files import CODE_V


def _front(commands: str, radius: float = 50.0, unit: str = "M") -> Surface:
    return parse_lens_file(CODE_V.format(commands=commands, radius=radius, unit=unit).encode(), "a.seq").surfaces[0]


@pytest.mark.parametrize(
    "commands",
    [
        "SPS ODD 0.0; SCO K -0.5; SCO AR3 1e-5; SCO AR4 2e-6; SCO AR7 -1e-10",
        "SPS ODD; SCO K -0.5 AR3 1e-5 AR4 2e-6 AR7 -1e-10",
        "SPS ODD 1; SCO C1 -0.5; SCO C4 1e-5; SCO C5 2e-6; SCO C8 -1e-10; SCC C4 0",
        "SPS S1 ODD; SCO S1 K -0.5; SCO S1 AR3 1e-5; SCO S1 AR4 2e-6; SCO S1 AR7 -1e-10",
        "SPS ODD 10; SCO K -0.5; SCO AR3 1e-2; SCO AR4 2e-2; SCO AR7 -1e-3",
        "SPS ODD; SCO C33 10; SCO K -0.5; SCO AR3 1e-2; SCO AR4 2e-2; SCO AR7 -1e-3",
    ],
)
def test_odd_powers_in_many_spellings(commands: str) -> None:
    front = _front(commands)
    assert front.odd == pytest.approx((1e-5, 0.0, -1e-10))
    assert front.aspheric == pytest.approx((2e-6,))
    assert front.conic == -0.5


@pytest.mark.parametrize(
    "commands",
    ["SPS QCN 9; SCO K -0.4; SCO QC4 0.02; SCO QC6 -0.003", "SPS QCN; SCO C1 -0.4 C2 9 C3 0.02 C4 -0.003"],
)
def test_qcon_terms_are_read(commands: str) -> None:
    wanted = qcon_terms(ForbesTerms("Qcon", (0.02, -0.003), 9.0))
    front = _front(f"{commands}; CIR 8")
    assert front.aspheric == pytest.approx((wanted[4], wanted[6]))
    assert front.conic == -0.4


def test_qbfs_terms_are_read() -> None:
    front = _front("SPS QBF 9; SCO QB4 0.02; CIR 8")
    assert 1 / front.radius_mm == pytest.approx(0.02 + 2 * 0.02 / 81)
    inches = _front("SPS QBF 0.9; SCO QB4 0.002; CIR 0.8", radius=5, unit="C")
    assert inches.radius_mm == pytest.approx(front.radius_mm)


@pytest.mark.parametrize(
    ("commands", "radius", "across", "conic"),
    [
        ("CYL", 50.0, Across(0.0, 0.0), 0.0),
        ("CYL; K -1", 50.0, Across(0.0, 0.0), -1.0),
        ("CYL; RDX 50", 0.0, Across(50.0, 0.0), 0.0),
        ("CYL; CUX 0.02", 0.0, Across(50.0, 0.0), 0.0),
        ("YTO; RDX 50", 50.0, None, 0.0),
        ("XTO; RDX 50; K -1", 0.0, Across(50.0, -1.0), 0.0),
        ("AAS; RDX 80; KX -0.5; K -2", 50.0, Across(80.0, -0.5), -2.0),
        ("AAS; CUX 0.0125; KX -0.5; KY -2", 50.0, Across(80.0, -0.5), -2.0),
        ("AAS; RDX S1 INFINITY", 50.0, Across(0.0, 0.0), 0.0),
        ("YTO; RDX 70; K -0.5", 50.0, Across(70.0, 0.0, "upright"), -0.5),
        ("XTO; CUX 0.02; K -0.5", 70.0, Across(50.0, -0.5, "across"), 0.0),
    ],
)
def test_cylinders_and_biconics(commands: str, radius: float, across: Across | None, conic: float) -> None:
    front = _front(commands, radius)
    assert front.radius_mm == radius
    assert front.across == across
    assert front.conic == conic


@pytest.mark.parametrize(
    ("commands", "across", "conic"),
    [
        ("YTO; RDX 70; K -1; A 1e-6; C 3e-13", Across(70.0, 0.0, "upright"), -1.0),
        ("XTO; RDX 70; K -1; A 1e-6; C 3e-13", Across(70.0, -1.0, "across"), 0.0),
        ("YTO; RDX 50; A 1e-6; C 3e-13", Across(50.0, 0.0, "upright"), 0.0),
        ("CYL; K -1; A 1e-6; C 3e-13", Across(0.0, 0.0, "upright"), -1.0),
    ],
)
def test_a_torus_has_the_terms_of_its_curve(commands: str, across: Across, conic: float) -> None:
    front = _front(commands)
    assert (front.across, front.conic) == (across, conic)
    assert front.aspheric == pytest.approx((1e-6, 0.0, 3e-13))


def test_a_biconic_has_terms_with_symmetry() -> None:
    assert _front("AAS; RDX 80; AR 1e-6; DR -1e-14").aspheric == (1e-6, 0.0, 0.0, -1e-14)


@pytest.mark.parametrize(
    ("commands", "message"),
    [
        ("SPS XYP", "line 6, surface 1: special surfaces of the kinds ODD, QCN, QBF are supported .* got XYP"),
        ("SPS", "special surfaces .* got nothing"),
        ("SPS ODD x", r"the normalisation radius \(SPS\) must be a number, got 'x'"),
        ("SPS ODD -2; SCO AR3 1", "the normalisation radius .* must be 0 or more, got -2"),
        ("SPS ODD 1e-300; SCO AR3 1", "the normalisation radius of 1e-300 is out of reach"),
        ("SPS ODD; SCO AR3 nan", r"the coefficient AR3 \(SCO\) must be a number, got 'nan'"),
        ("SPS ODD; SCO AR3", r"the coefficient AR3 \(SCO\) must be a number, got ''"),
        ("SPS ODD; SCO AR31 1", "a special surface ODD has no coefficient AR31"),
        ("SPS ODD; SCO AR1 1e-3", r"a term of r\^1 is not supported"),
        ("SPS ODD; SCO QC4 1e-3", "a special surface ODD has no coefficient QC4"),
        ("SPS QCN; SCO QC4 1e-3", r"the normalisation radius \(NRADIUS\) must be above 0, got 0"),
        ("SPS QCN 9; SCO QC5 1e-3", "a special surface QCN has no coefficient QC5"),
        ("SPS QCN 9; SCO QC98 1e-9", "at most 20 Forbes terms are supported, got 48"),
        ("SPS QBF 9; SCO K -1; SCO QB4 1e-3", "Qbfs terms depart from a sphere"),
        ("SCO C1 1", "SCO stands at a surface without SPS"),
        ("CYL; RDX 70", r"a cylinder \(CYL\) is straight one way, got the radii 50 and 70: a torus is YTO or XTO"),
        ("RDY 0; CYL; RDX 70; A 1e-6", r"K and aspheric terms of a cylinder \(CYL\) that is straight in y are not"),
        ("CYL; KX 1", r"KX of a cylinder or torus \(CYL\) must be 0"),
        ("AAS; K -1", r"a biconic \(AAS\) needs its radius in x"),
        ("AAS; RDX 60; AP 0.1", "AP of a biconic must be 0"),
        ("AAS; RDX 60; A 1e-6", "a biconic .* has the terms AR, BR, CR and DR"),
    ],
)
def test_surfaces_that_no_lens_here_has_are_refused(commands: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        _front(commands)
