"""Blurs from MTF charts: the fit finds the blurs that made a chart, and states what it leaves."""

from __future__ import annotations

import numpy as np
import pytest

from render.errors import InputError
from render.model.data_sheet import DataSheet
from render.optics.data_sheet import at_heights, open_pupil, sheet_errors
from render.optics.lens_files.lens_text import decode
from render.optics.measured.geometric_mtf import geometric_mtf
from render.optics.measured.mtf_chart import MtfChart, read_mtf_chart
from render.optics.measured.mtf_fit import fit_blur

HEIGHTS = (0.0, 6.0, 12.0, 18.0, 21.6)
SAGITTAL, TANGENTIAL = (0.006, 0.007, 0.009, 0.012, 0.014), (0.006, 0.008, 0.012, 0.018, 0.022)
PER_MM = np.array([10.0, 20.0, 40.0])
LIGHT = (1.0, 0.92, 0.7, 0.5, 0.4)


def read(text: str) -> MtfChart:
    return read_mtf_chart(decode(text.encode(), "chart.csv"))


def chart_of(sheet: DataSheet, f_stop: float, digits: int = 4, *, diffraction: bool = False) -> str:
    """CSV text of the chart that a sheet's rays give."""
    heights = np.array(sheet.heights_mm)
    errors = sheet_errors(sheet, heights, focal_length_mm=50.0, f_stop=f_stop)
    points, weights = open_pupil(errors.edge, errors.rim_offset, errors.rim_radius)
    contrast = geometric_mtf(errors.landing_mm(points / errors.edge), weights, PER_MM)
    if diffraction:
        s = PER_MM * 550e-6 * f_stop
        contrast = contrast * (2 / np.pi * (np.arccos(s) - s * np.sqrt(1 - s**2)))[:, None]
    rows = [
        f"{height:g},{per_mm:g},{contrast[i, k, 1]:.{digits}f},{contrast[i, k, 0]:.{digits}f}"
        for i, height in enumerate(heights)
        for k, per_mm in enumerate(PER_MM)
    ]
    return "height_mm,lp_mm,sagittal,tangential\n" + "\n".join(rows) + "\n"


def test_the_contrast_of_a_disc_is_the_airy_functions() -> None:
    """An evenly lit disc of radius a has 2·J1(2πνa)/(2πνa): 0 first where 2νa = 1.2197 (Born & Wolf 1999, section 8.5.2)."""
    side = (np.arange(400) + 0.5) / 200 - 1
    grid = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    disc = 0.01 * grid[np.hypot(*grid.T) <= 1]
    [found] = geometric_mtf(disc[None], np.ones((1, len(disc))), np.array([0.0, 1.2196699 / 0.02, 25.0]))
    assert found[0] == pytest.approx(1)
    assert found[1] == pytest.approx(0, abs=2e-3)
    assert found[2] == pytest.approx(0.72170, abs=2e-3)


@pytest.mark.parametrize("diffraction", [False, True])
def test_the_fit_finds_the_blurs_that_made_a_chart(diffraction: bool) -> None:
    made = DataSheet(HEIGHTS, sagittal_blur_mm=SAGITTAL, tangential_blur_mm=TANGENTIAL, f_stop=2.0)
    found = fit_blur(read(chart_of(made, 2.0, diffraction=diffraction)), 50.0, 2.0, diffraction=diffraction)
    assert found.sheet.sagittal_blur_mm == pytest.approx(SAGITTAL, rel=0.01)
    assert found.sheet.tangential_blur_mm == pytest.approx(TANGENTIAL, rel=0.01)
    assert found.rms < 1e-3


def test_other_errors_of_the_lens_are_not_fitted_twice() -> None:
    """Rims, coma and curvature that are known already take their share of the chart's loss."""
    known = DataSheet(
        HEIGHTS,
        light=LIGHT,
        coma_mm=(0, 0.004, 0.008, 0.012, 0.015),
        spherical=(0.3,) * 5,
        f_stop=1.4,
        sagittal_blur_mm=SAGITTAL,
        tangential_blur_mm=TANGENTIAL,
    )
    chart = read(chart_of(known, 1.4))
    found = fit_blur(chart, 50.0, 1.4, known, diffraction=False)
    assert found.sheet.sagittal_blur_mm == pytest.approx(SAGITTAL, rel=0.04)
    assert found.sheet.tangential_blur_mm == pytest.approx(TANGENTIAL, rel=0.04)
    alone = fit_blur(chart, 50.0, 1.4, diffraction=False)
    assert found.rms < 0.005 < alone.rms


def test_what_no_blur_gives_is_left_and_stated() -> None:
    """Contrast that rises with frequency is no lens's: the fit leaves about half of the rise."""
    found = fit_blur(read("0,10,0.2,0.2\n0,40,0.8,0.8\n10,10,0.9,0.9\n"), 50.0, 2.8)
    assert found.worst > 0.25
    assert found.worst_at[0] == 0
    assert 0.1 < found.rms < found.worst


def test_a_chart_without_an_axis_has_its_first_heights_blur_there() -> None:
    made = DataSheet(HEIGHTS, sagittal_blur_mm=SAGITTAL, tangential_blur_mm=TANGENTIAL, f_stop=2.0)
    text = "".join(line + "\n" for line in chart_of(made, 2.0).splitlines() if not line.startswith("0,"))
    found = fit_blur(read(text), 50.0, 2.0, diffraction=False)
    assert found.sheet.heights_mm == HEIGHTS
    assert at_heights(found.sheet, "sagittal_blur_mm", np.zeros(1))[0] == pytest.approx((0.007 + 0.008) / 2, rel=0.01)


def test_charts_in_per_cent_and_other_orders_are_the_same() -> None:
    plain = read("0,10,0.9,0.9\n10,10,0.8,0.7\n")
    percent = read("lp_mm;height_mm;tangential;sagittal  # Leica\n10;0;90;90\n\n10;10;70;80\n")
    for name in ("heights_mm", "per_mm", "contrast", "rows"):
        np.testing.assert_allclose(getattr(plain, name), getattr(percent, name))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "it has no rows"),
        ("height_mm,lp_mm,sagittal\n", "the columns are"),
        ("0,10,0.9\n", "line 1: a row has 4 numbers"),
        ("0,10,0.9,nan\n", "line 1: the tangential must be a number"),
        ("0,10,0.9,1e400\n", "must be a number"),
        ("0,10,-0.1,0.9\n", "0 or more"),
        ("0,0,0.1,0.9\n", "above 0 and up to 2000 lp/mm"),
        ("5000,10,0.1,0.9\n", "a height up to 1000 mm"),
        ("0,10,0.9,101\n", "contrast is at most 1"),
        ("0,10,0.9,0.9\n" * 5001, "at most 5000 rows"),
        ("".join(f"{i},10,0.9,0.9\n" for i in range(201)), "at most 200 image heights"),
        ("0,10,0.9,0.9\n" * 100_000, "too long for a lens file"),
    ],
)
def test_what_is_no_chart_is_one_error(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        read(text)
