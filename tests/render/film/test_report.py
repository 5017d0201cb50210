"""Report of a stock: the straight line of its curves, and their slope at grey."""

from __future__ import annotations

import numpy as np
import pytest

from render.film.curve import Curve, parametric_knots
from render.film.report import film_report, straight_line_slope


@pytest.mark.parametrize("gamma", [0.3, 0.62, 1.9, -0.7, -2.5])
@pytest.mark.parametrize("bends", [(0.1, 0.1), (0.4, 0.2), (0.2, 0.5)])
def test_gamma_of_a_drawn_curve_is_that_of_its_line(gamma, bends):
    curve = Curve(parametric_knots(0.1, 3.4, gamma, *bends, 0.9))
    assert straight_line_slope(curve) == pytest.approx(gamma, rel=2e-3)


def test_a_line_alone_has_its_slope_however_short_it_is():
    assert straight_line_slope(Curve(((0.0, 0.2), (0.1, 0.4)))) == pytest.approx(2.0)
    assert straight_line_slope(Curve(((-3.0, 0.2), (3.0, 0.2)))) == 0.0


def test_reversal_stocks_are_steeper_than_at_grey():
    """Grey lies in the bend of a slide film, whose straight line is for its shadows."""
    for name, least in (("velvia_50", 1.5), ("vision3_500t_5219", 0.97)):
        report = film_report(name)
        ratios = np.array(report.gamma) / np.array(report.slope_at_grey)
        assert (ratios >= least).all()
        assert (np.sign(report.gamma) == np.sign(report.slope_at_grey)).all()


def test_no_stretch_of_a_stop_is_steeper():
    curve = film_report("vision3_500t_5219").stock.curves[1]
    starts = np.linspace(-4, 2, 500)
    rises = curve.density(starts + 0.30103) - curve.density(starts)
    assert straight_line_slope(curve) == pytest.approx(rises.max() / 0.30103, rel=1e-3)
