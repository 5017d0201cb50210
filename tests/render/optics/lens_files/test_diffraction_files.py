"""Diffractive surfaces of Zemax and CODE V, read and written."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from render.errors import InputError, SettingsError
from render.model.lens import Across, Glass, Prescription, Surface
from render.optics.lens_files import parse_lens_file
from render.optics.lens_files.writing import write_lens
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.paraxial import focal_points, paraxial_system
from render.optics.prescription.tracing import trace_forward
from tests.render.kits.surface_files import CODE_V, ZEMAX


def zemax(*lines: str, unit: str = "MM", curvature: float = 0.02) -> Prescription:
    parameters = "".join(f"  {line}\n" for line in lines)
    text = ZEMAX.format(kind="BINARY_2", curvature=curvature, conic=-0.5, parameters=parameters)
    return parse_lens_file(text.replace("UNIT MM", f"UNIT {unit}").encode(), "a.zmx")


def code_v(commands: str, unit: str = "M", radius: float = 50.0) -> Prescription:
    return parse_lens_file(CODE_V.format(commands=commands, radius=radius, unit=unit).encode(), "a.seq")


BINARY = ("PARM 0 -2", "PARM 2 1e-6", "XDAT 1 2 0 0", "XDAT 2 10.0 0 0", "XDAT 3 50.0 0 0", "XDAT 4 -4.0", "XDAT 5 9")


def test_a_binary_surface_has_shape_and_phase() -> None:
    front = zemax(*BINARY).surfaces[0]
    assert (front.radius_mm, front.conic, front.aspheric) == (50.0, -0.5, (1e-6,))
    assert front.phase == pytest.approx((-1.0, 8e-4))
    assert front.glass.index == pytest.approx(1.5168, abs=1e-4)
    assert zemax(*BINARY, unit="CM").surfaces[0].phase == pytest.approx((-0.01, 8e-8))


def test_a_binary_surface_without_terms_is_an_asphere() -> None:
    assert zemax("PARM 0 1", "PARM 2 1e-6").surfaces[0].phase == ()
    assert zemax("PARM 0 0", *BINARY[1:]).surfaces[0].phase == ()


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (BINARY[1:], r"surface 1: a surface of TYPE BINARY_2 needs its order of diffraction \(PARM 0\)"),
        (("PARM 0 0.5", *BINARY[1:]), r"the order of diffraction \(PARM 0\) must be a whole number .* got 0.5"),
        ((*BINARY, "PARM 9 1"), "PARM 9 of a surface of TYPE BINARY_2 must be 0"),
        ((*BINARY, "XDAT 2 0"), r"the normalisation radius \(XDAT 2\) must be above 0"),
        (
            ("PARM 0 1", "XDAT 1 11", "XDAT 2 1", "XDAT 13 1"),
            r"terms of the phase are supported up to r\^20, got r\^22",
        ),
    ],
)
def test_impossible_binary_surfaces_are_refused(lines: tuple[str, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        zemax(*lines)


def test_a_code_v_phase_is_a_path_at_its_wavelength() -> None:
    """A path of −r²/(2f) has the focal length f at the wavelength that it is of."""
    plate = code_v("DIF DOE; HOR 1; HWL 550; HCT R; HCO C1 -0.005; HCO C2 1e-8", radius=0.0)
    front = plate.surfaces[0]
    assert front.phase == pytest.approx((-0.005 * 2 * math.pi / 550e-6, 1e-8 * 2 * math.pi / 550e-6))
    alone = Prescription((replace(front, glass=Glass()),))
    assert focal_points(paraxial_system(alone, 550.0))[0] == pytest.approx(100.0)
    centimetres = code_v("DIF DOE; HOR 1; HWL 550; HCT R; HCO C1 -0.05", "C", radius=0.0).surfaces[0]
    assert centimetres.phase == pytest.approx(front.phase[:1])


@pytest.mark.parametrize(
    ("commands", "message"),
    [
        ("DIF GRT", "line 6, surface 1: DIF GRT is not supported: expected DOE, a phase"),
        ("DIF DOE; HWL 550; HCO C1 1", "must have rotational symmetry, as HCT R says, got none"),
        ("DIF DOE; HWL 550; HCT XY; HCO C1 1", "must have rotational symmetry, as HCT R says, got XY"),
        ("DIF DOE; HCT R; HCO C1 1", r"the wavelength of the phase \(HWL\) must be from 1 to 1e\+06 nm, got 0 nm"),
        ("DIF DOE; HCT R; HWL 550; HOR 0.5; HCO C1 1", r"the order of diffraction \(HOR\) must be a whole number"),
        ("DIF DOE; HCT R; HWL 550; HCO X 1", "HCO must be followed by C1, C2, ... and a value, got X"),
        ("DIF DOE; HCT R; HWL 550; HCO C1", r"the coefficient C1 \(HCO\) must be a number, got ''"),
        ("DIF DOE; HCT R; HWL 550; HCO C0 1", "begin with C1, got C0"),
    ],
)
def test_impossible_phases_of_code_v_are_refused(commands: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        code_v(commands)


PLAIN = Surface(50.0, 4.0, Glass(1.6, 60.0), 8.0, conic=-0.5, aspheric=(1e-6,), phase=(-12.0, 0.05, 0.0, 1e-8))


def _lens(front: Surface) -> Prescription:
    stop = Surface(0.0, 3.0, semi_diameter_mm=5.0, is_stop=True)
    surfaces = (front, Surface(-90.0, 3.0, semi_diameter_mm=8.0), stop)
    plate = (Surface(0.0, 2.0, Glass(1.5, 60.0), 8.0), Surface(0.0, 0.0, semi_diameter_mm=8.0))
    return complete_prescription(Prescription((*surfaces, *plate), f_stop=8.0, name="Hybrid"), image_height_mm=5.0)


@pytest.mark.parametrize("suffix", [".zmx", ".seq"])
def test_a_diffractive_surface_comes_back(suffix: str) -> None:
    lens = _lens(PLAIN)
    again = parse_lens_file(write_lens(lens, suffix).content, f"again{suffix}")
    assert again.surfaces[0].phase == pytest.approx(PLAIN.phase, rel=1e-12)
    starts = np.array([[1.0, 2.0, -5.0], [-2.0, 0.5, -5.0]])
    headings = np.array([[0.05, -0.02, np.sqrt(1 - 0.0029)]] * 2)
    for wavelength in (480.0, 640.0):
        one, other = (trace_forward(each, starts, headings, wavelength) for each in (lens, again))
        np.testing.assert_allclose(other.at(50.0), one.at(50.0), atol=1e-9)


@pytest.mark.parametrize(
    ("front", "suffix", "message"),
    [
        (
            replace(PLAIN, odd=(1e-6,)),
            ".zmx",
            r"diffraction and aspheric terms of odd powers or beyond r\^16, .*: write .seq",
        ),
        (replace(PLAIN, across=Across(60.0)), ".zmx", r"two curves and diffraction, .*: write .seq"),
        (PLAIN, ".txt", r"surface 1 of Hybrid has diffraction, .*: write .zmx or .seq"),
    ],
)
def test_diffraction_that_a_format_cannot_hold_is_named(front: Surface, suffix: str, message: str) -> None:
    with pytest.raises(SettingsError, match=message):
        write_lens(_lens(front), suffix)
