"""Cylinders, biconics and tori that are written as lens files and read again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.errors import SettingsError
from render.model.lens import Across, Glass, Prescription, Surface
from render.optics.lens_files import parse_lens_file
from render.optics.lens_files.writing import write_lens
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.tracing import trace_forward

GLASS = Glass(1.6, 60.0)
TERMS = (2e-6, -3e-9, 0.0, 1e-15)
FRONTS = {
    "cylinder": Surface(50.0, 4.0, GLASS, 8.0, conic=-0.5, across=Across()),
    "lying": Surface(0.0, 4.0, GLASS, 8.0, across=Across(50.0, -0.5)),
    "biconic": Surface(50.0, 4.0, GLASS, 8.0, conic=0.25, across=Across(-150.0, -2.0)),
    "barrel": Surface(50.0, 4.0, GLASS, 8.0, across=Across(90.0, torus="upright")),
    "torus": Surface(50.0, 4.0, GLASS, 8.0, conic=-0.5, aspheric=TERMS, across=Across(90.0, torus="upright")),
    "acylinder": Surface(50.0, 4.0, GLASS, 8.0, conic=-0.5, aspheric=TERMS, across=Across(torus="upright")),
    "flat curve": Surface(0.0, 4.0, GLASS, 8.0, aspheric=TERMS, across=Across(90.0, torus="upright")),
    "biconic asphere": Surface(50.0, 4.0, GLASS, 8.0, aspheric=TERMS, across=Across(90.0, -0.5)),
    "lying torus": Surface(50.0, 4.0, GLASS, 8.0, aspheric=TERMS, across=Across(90.0, -0.5, "across")),
    "high": Surface(50.0, 4.0, GLASS, 8.0, aspheric=(0.0,) * 7 + (1e-20,), across=Across(torus="upright")),
}
IN_ZEMAX = ("cylinder", "lying", "biconic", "barrel", "torus", "acylinder", "flat curve")


def _lens(front: Surface) -> Prescription:
    surfaces = (
        front,
        Surface(-60.0, 5.0, semi_diameter_mm=8.0),
        Surface(0.0, 3.0, semi_diameter_mm=4.0, is_stop=True),
        Surface(70.0, 4.0, GLASS, 9.0),
        Surface(-50.0, 0.0, semi_diameter_mm=9.0),
    )
    return complete_prescription(Prescription(surfaces, f_stop=8.0, name="Two curves"), image_height_mm=8.0)


@pytest.mark.parametrize(
    ("name", "suffix"), [*((name, ".zmx") for name in IN_ZEMAX), *((name, ".seq") for name in FRONTS)]
)
def test_a_surface_with_two_curves_comes_back(name: str, suffix: str) -> None:
    """The same shape, and the same rays within 1e-9 mm."""
    lens = _lens(FRONTS[name])
    again = parse_lens_file(write_lens(lens, suffix).content, f"again{suffix}")
    here, there = lens.surfaces[0], again.surfaces[0]
    assert there.across == here.across
    assert (there.radius_mm, there.conic) == (pytest.approx(here.radius_mm, rel=1e-12), here.conic)
    assert there.aspheric == pytest.approx(here.aspheric, rel=1e-12)
    rng = np.random.default_rng(2)
    starts = np.concatenate([rng.uniform(-3, 3, (60, 2)), np.full((60, 1), -10.0)], axis=1)
    headings = np.concatenate([rng.uniform(-0.1, 0.1, (60, 2)), np.ones((60, 1))], axis=1)
    headings /= np.linalg.norm(headings, axis=1)[:, None]
    one, other = (trace_forward(each, starts, headings, clip=False) for each in (lens, again))
    assert one.passes.all()
    np.testing.assert_allclose(other.at(60.0), one.at(60.0), atol=1e-9)


@pytest.mark.parametrize(
    ("name", "suffix", "message"),
    [
        ("biconic asphere", ".zmx", r"surface 1 of Two curves has two curves and aspheric terms of r, .*: write .seq"),
        ("lying torus", ".zmx", r"a curve from side to side that is turned to make a torus, .*: write .seq"),
        ("high", ".zmx", r"aspheric terms beyond y\^14 on a torus, .*: write .seq"),
        ("cylinder", ".txt", r"another curve from side to side, .*: write .zmx or .seq"),
    ],
)
def test_a_shape_that_a_format_cannot_hold_is_named(name: str, suffix: str, message: str) -> None:
    with pytest.raises(SettingsError, match=message):
        write_lens(_lens(FRONTS[name]), suffix)


@pytest.mark.parametrize("suffix", [".zmx", ".seq"])
def test_odd_terms_beside_two_curves_are_refused(suffix: str) -> None:
    lens = _lens(replace(FRONTS["torus"], odd=(1e-6,)))
    with pytest.raises(SettingsError, match=r"aspheric terms of odd powers.* no lens file that is written can"):
        write_lens(lens, suffix)


def test_cylinders_that_focus_are_noted() -> None:
    surfaces = (replace(FRONTS["lying"], across=Across(300.0)), Surface(0.0, 5.0, across=Across(-300.0)))
    rest = _lens(FRONTS["lying"]).surfaces[2:]
    lens = Prescription((*surfaces, *rest), f_stop=8.0, name="Moving", focus_group_across=(0, 1))
    notes = write_lens(complete_prescription(lens, image_height_mm=8.0), ".seq").notes
    assert "The cylinders that move to focus from side to side are not written." in notes
