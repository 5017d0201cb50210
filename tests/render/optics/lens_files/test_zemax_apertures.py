"""Apertures of Zemax surfaces: circles are read, others are named."""

from __future__ import annotations

import pytest

from render.errors import InputError
from render.model.lens import Prescription
from render.optics.lens_files import parse_lens_file
from tests.render.kits.lens_files import TRIPLET_ZMX


def with_aperture(command: str) -> Prescription:
    """A triplet whose first surface has an aperture, before its DIAM and behind it."""
    first = TRIPLET_ZMX.index("  DIAM", TRIPLET_ZMX.index("SURF 1"))
    text = f"{TRIPLET_ZMX[:first]}  {command}\n{TRIPLET_ZMX[first:]}"
    return parse_lens_file(text.encode(), "a.zmx")


def test_a_circular_aperture_wins_over_the_drawn_diameter() -> None:
    assert with_aperture("CLAP 0 7.5 0").surfaces[0].semi_diameter_mm == 7.5
    assert not any("aperture of surface" in note for note in with_aperture("CLAP 0 7.5 0").notes)


@pytest.mark.parametrize(
    "command", ["CLAP 2 7.5 0", "OBSC 0 2 0", "SQAP 6 4 0", "ELAP 6 4 0", "SQOB 1 1 0", "ELOB 1 2 0", "SPID 0.5 3 0"]
)
def test_an_aperture_that_is_no_circle_is_named(command: str) -> None:
    assert any("aperture of surface 1 is a ring" in note for note in with_aperture(command).notes)


def test_an_aperture_of_zeros_is_none() -> None:
    lens = with_aperture("OBSC 0 0 0")
    assert lens == with_aperture("CLAP 0 0 0")
    assert not any("aperture of surface" in note for note in lens.notes)


def test_a_radius_that_is_no_number_is_refused() -> None:
    with pytest.raises(InputError, match=r"radius \(CLAP\)"):
        with_aperture("CLAP 0 wide 0")
