"""Apertures of Zemax surfaces: circles are clear diameters, other shapes openings and obscurations; what is left is named."""

from __future__ import annotations

import numpy as np
import pytest

from render.errors import InputError
from render.model.lens import Outline, Prescription
from render.optics.lens_files import parse_lens_file
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.outlines import spider
from tests.render.kits.lens_files import TRIPLET_ZMX


def with_aperture(command: str, text: str = TRIPLET_ZMX) -> Prescription:
    """A triplet whose first surface has an aperture, before its DIAM and behind it."""
    first = text.index("  DIAM", text.index("SURF 1"))
    return parse_lens_file(f"{text[:first]}  {command}\n{text[first:]}".encode(), "a.zmx")


def named(lens: Prescription) -> list[str]:
    return [note for note in lens.notes if "aperture of surface" in note]


def test_a_circular_aperture_wins_over_the_drawn_diameter() -> None:
    lens = with_aperture("CLAP 0 7.5 0")
    assert lens.surfaces[0].semi_diameter_mm == 7.5
    assert not lens.outlines
    assert not named(lens)


def circle(radius: float, x: float = 0.0, y: float = 0.0) -> Outline:
    return Outline("ellipse", (radius, radius), (x, y))


@pytest.mark.parametrize(
    ("command", "opening", "obscuration", "semi_diameter"),
    [
        ("CLAP 2 7.5 0", None, circle(2.0), 7.5),
        ("CLAP 2 7.5 0\n  OBDC 0.5 -1", circle(7.5, 0.5, -1.0), circle(2.0, 0.5, -1.0), 7.5 + np.hypot(0.5, 1)),
        ("OBDC 0.5 -1\n  OBSC 0 2 0", None, circle(2.0, 0.5, -1.0), None),
        ("OBSC 0 2 0", None, circle(2.0), None),
        ("OBSC 3 99 0", None, None, 3.0),
        ("SQAP 6 4 0", Outline("rectangle", (6.0, 4.0)), None, np.hypot(6, 4)),
        ("ELAP 6 4 0", Outline("ellipse", (6.0, 4.0)), None, 6.0),
        ("SQOB 1 2 0", None, Outline("rectangle", (1.0, 2.0)), None),
        ("ELOB 1 2 0\n  OBDC 3 0", None, Outline("ellipse", (1.0, 2.0), (3.0, 0.0)), None),
        ("SPID 0.5 3 0", None, spider(0.5, 3, 1.05 * 9), None),
        ("SPID 0.5 4 0\n  OBDC 0 1", None, spider(0.5, 4, 1.05 * 10, (0.0, 1.0)), None),
    ],
)
def test_apertures_are_read(
    command: str, opening: Outline | None, obscuration: Outline | None, semi_diameter: float | None
) -> None:
    lens, plain = with_aperture(command), with_aperture("")
    assert (lens.surfaces[0].opening, lens.surfaces[0].obscuration) == (opening, obscuration)
    wide = plain.surfaces[0].semi_diameter_mm if semi_diameter is None else semi_diameter
    assert lens.surfaces[0].semi_diameter_mm == pytest.approx(wide)
    assert not named(lens)
    complete_prescription(lens)


def test_apertures_have_the_unit_of_the_file() -> None:
    in_cm = TRIPLET_ZMX.replace("UNIT MM", "UNIT CM")
    assert with_aperture("SQAP 6 4 0\n  OBDC 1 0", in_cm).surfaces[0].opening == Outline(
        "rectangle", (60.0, 40.0), (10.0, 0.0)
    )


@pytest.mark.parametrize("command", ["USAP", "OBSC 1 2 0"])
def test_what_is_not_read_is_named(command: str) -> None:
    lens = with_aperture(command)
    assert named(lens) == [f"The aperture of surface 1 ({command[:4]}) is not read; light passes it."]
    assert not lens.outlines


def test_a_spider_without_a_clear_diameter_is_named() -> None:
    text = TRIPLET_ZMX.replace("  DIAM 9 1 0 0 1", "  DIAM 0 1 0 0 1", 1)
    assert named(with_aperture("SPID 0.5 3 0", text)) == [
        "The aperture of surface 1 (SPID) is not read; light passes it."
    ]


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("SPID 0.5 2.5 0", r"of its aperture \(SPID\) the number of arms must be a whole one up to 16, got 2.5"),
        ("SPID 0.5 17 0", "the number of arms must be a whole one up to 16, got 17"),
        ("SPID 19 3 0", "3 arms of the width 19 leave nothing open"),
    ],
)
def test_impossible_spiders_are_refused(command: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        with_aperture(command)


def test_an_aperture_of_zeros_is_none() -> None:
    lens = with_aperture("OBSC 0 0 0")
    assert lens == with_aperture("CLAP 0 0 0") == with_aperture("SPID 0 3 0") == with_aperture("OBDC 1 1")
    assert not named(lens)


def test_a_mask_of_air_before_the_glass_stays() -> None:
    """A plane without an aperture there is where a designer counts from."""
    first = TRIPLET_ZMX.index("SURF 1")
    for aperture, count in (("OBSC 0 2 0", 1), ("", 0)):
        mask = f"SURF 1\n  TYPE STANDARD\n  CURV 0.0\n  {aperture}\n  DISZ 3\n  DIAM 9 1 0 0 1\n"
        lens = parse_lens_file((TRIPLET_ZMX[:first] + mask + TRIPLET_ZMX[first:]).encode(), "a.zmx")
        assert len(lens.surfaces) == len(with_aperture("").surfaces) + count
        assert len(lens.outlines) == count


def test_a_rectangle_is_no_wider_than_its_sphere() -> None:
    wide = with_aperture("SQAP 20 20 0").surfaces[0]
    assert wide.semi_diameter_mm < abs(wide.radius_mm) < np.hypot(20, 20)


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("CLAP 0 wide 0", r"line \d+, surface 1: the radius \(CLAP\) must be a number, got 'wide'"),
        ("CLAP 8 7 0", r"of its aperture \(CLAP\) the radii must grow, got 8 and 7"),
        ("OBSC 2 0 0", r"of its aperture \(OBSC\) the radii must grow, got 2 and 0"),
        ("CLAP -1 7 0", r"the radius \(CLAP\) must be 0 or more, got -1"),
        ("SQAP 6 -4 0", r"the half width \(SQAP\) must be 0 or more, got -4"),
        ("ELAP 6 0 0", r"of its aperture \(ELAP\) both half widths must be above 0, got 6 and 0"),
        ("OBDC nan 0", r"the centre of the aperture \(OBDC\) must be a number, got 'nan'"),
    ],
)
def test_an_impossible_aperture_is_refused(command: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        with_aperture(command)


@pytest.mark.parametrize("command", ["OBSC 0 99 0", "SQAP 1 1 0\n  OBDC 50 0", "ELOB 1E300 1E300 0"])
def test_an_aperture_that_nothing_passes_is_refused(command: str) -> None:
    with pytest.raises(InputError, match=r"surface 1 of A triplet: its .*(nothing open|must be from)"):
        complete_prescription(with_aperture(command))
