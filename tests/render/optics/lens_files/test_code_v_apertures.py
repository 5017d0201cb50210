"""Apertures of CODE V's surfaces: circles, rectangles and ellipses, their obscurations and centres; what is left is named."""

from __future__ import annotations

import numpy as np
import pytest

from render.errors import InputError
from render.model.lens import Outline, Prescription
from render.optics.lens_files import parse_lens_file
from render.optics.prescription.completion import complete_prescription
from tests.render.kits.lens_files import ACHROMAT_SEQ


def with_apertures(*commands: str) -> Prescription:
    """An achromat whose third surface has apertures."""
    text = ACHROMAT_SEQ.replace("  PIM\n", "".join(f"  {command}\n" for command in commands))
    return parse_lens_file(text.encode(), "a.seq")


def named(lens: Prescription) -> list[str]:
    return [note for note in lens.notes if "aperture of surface" in note]


@pytest.mark.parametrize(
    ("commands", "opening", "obscuration", "semi_diameter"),
    [
        (["CIR 11"], None, None, 11.0),
        (["CIR OBS 3"], None, Outline("ellipse", (3.0, 3.0)), 12.0),
        (["CIR OBS 3; ADX OBS 1; ADY OBS -2"], None, Outline("ellipse", (3.0, 3.0), (1.0, -2.0)), 12.0),
        (["REX 9; REY 5"], Outline("rectangle", (9.0, 5.0)), None, 12.0),
        (["ELX S3 9", "ELY S3 5"], Outline("ellipse", (9.0, 5.0)), None, 12.0),
        (["REX OBS 2; REY OBS 1", "CIR L'rim' 11"], None, Outline("rectangle", (2.0, 1.0)), 11.0),
        (["ADX L'mask' 1", "REX L'mask' 9; REY L'mask' 5"], Outline("rectangle", (9.0, 5.0), (1.0, 0.0)), None, 12.0),
        (["CIR EDG 14; REX EDG 14"], None, None, 12.0),
        (["CIR L'b' 10; ADY L'b' 1"], Outline("ellipse", (10.0, 10.0), (0.0, 1.0)), None, 12.0),
    ],
)
def test_apertures_are_read(
    commands: list[str], opening: Outline | None, obscuration: Outline | None, semi_diameter: float
) -> None:
    lens = with_apertures(*commands)
    assert (lens.surfaces[2].opening, lens.surfaces[2].obscuration) == (opening, obscuration)
    assert lens.surfaces[2].semi_diameter_mm == semi_diameter
    assert not named(lens)
    complete_prescription(lens)


def test_a_rectangle_alone_sets_how_wide_the_surface_is() -> None:
    text = ACHROMAT_SEQ.replace("  CIR 12.0\n  PIM\n", "  REX 9; REY 5\n")
    assert parse_lens_file(text.encode(), "a.seq").surfaces[2].semi_diameter_mm == pytest.approx(np.hypot(9, 5))


@pytest.mark.parametrize(
    ("commands", "what"),
    [
        (["CIR HOL 2"], "CIR HOL"),
        (["REX 9; REY 5; ARO 30"], "REX and REY, turned by ARO"),
        (["REX 9; REY 5", "ELX L'b' 8; ELY L'b' 7"], "ELX and ELY"),
        (["CIR OBS 1", "CIR OBS L'b' 2; ADX OBS L'b' 4"], "CIR OBS"),
    ],
)
def test_what_is_not_read_is_named(commands: list[str], what: str) -> None:
    assert named(with_apertures(*commands)) == [f"The aperture of surface 3 ({what}) is not read; light passes it."]


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("REX 9", "surface 3: of its aperture REX and REY must both be above 0, got 9 and 0"),
        ("CIR OBS -2", r"surface 3: the half width \(CIR\) must be 0 or more, got -2"),
        ("ELX wide", r"surface 3: the half width \(ELX\) must be a number, got 'wide'"),
        ("ADX inf", r"surface 3: the place of the aperture \(ADX\) must be a number, got 'inf'"),
        ("CIR OBS", r"surface 3: the half width \(CIR\) must be a number, got ''"),
    ],
)
def test_an_impossible_aperture_is_refused(command: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        with_apertures(command)


def test_zoom_positions_that_change_an_aperture_are_named() -> None:
    text = ACHROMAT_SEQ.replace("  PIM\n", "  REX 9; REY 5\n").replace(
        "SI    0.0 0.0\n", "SI 0 0\nZOO 2\nZOO REX S3 9 8\n"
    )
    lens = parse_lens_file(text.encode(), "a.seq")
    assert any("differ in REX too, which is not read" in note for note in lens.notes)
