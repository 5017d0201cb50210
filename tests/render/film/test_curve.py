"""Characteristic curves: knots, toe, line and shoulder."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.interpolate import PchipInterpolator

from render.errors import SettingsError
from render.film.curve import Curve, Knots, parametric_knots
from usd_schemas import library_films

NEGATIVE: Knots = ((-3.0, 0.2), (-2.0, 0.4), (-1.0, 1.0), (0.0, 1.6), (1.0, 1.8))


def test_a_curve_goes_through_its_knots_and_is_level_beyond_them() -> None:
    curve = Curve(NEGATIVE)
    for exposure, density in NEGATIVE:
        assert curve.density(exposure) == pytest.approx(density)
    assert curve.density([-9.0, -np.inf, 9.0, np.inf]) == pytest.approx([0.2, 0.2, 1.8, 1.8])


@pytest.mark.parametrize("film", library_films(), ids=lambda film: film.name)
def test_the_cubic_is_scipys_pchip_and_the_table_is_as_accurate(film: object) -> None:
    for curves in (film.film.curve, film.film.print_curve):  # type: ignore[attr-defined]
        for knots in (curves.red, curves.green, curves.blue):
            if knots:
                x = np.linspace(knots[0][0] - 0.5, knots[-1][0] + 0.5, 3001)
                found = Curve(knots).density(x)
                wanted = PchipInterpolator(*np.array(knots).T)(np.clip(x, knots[0][0], knots[-1][0]))
                assert np.abs(found - wanted).max() < 1e-12
                assert np.abs(Curve(knots).densities(x.astype(np.float32)) - found).max() < 5e-6


@given(st.lists(st.tuples(st.floats(0.01, 2), st.floats(0, 1)), min_size=2, max_size=12), st.booleans())
@example([(1.0, 0.0), (1.0, 5e-324), (1.0, 0.5)], False)  # a slope of 5e-324: its quotient overflowed
def test_a_curve_never_overshoots_its_knots(steps: list[tuple[float, float]], falling: bool) -> None:
    x, d = np.cumsum(np.array(steps), axis=0).T
    d = d[-1] - d if falling else d
    curve = Curve(tuple(zip(x.tolist(), d.tolist(), strict=True)))
    fine = curve.density(np.linspace(x[0], x[-1], 500))
    rise = np.diff(fine)
    assert (rise <= 1e-12).all() if falling else (rise >= -1e-12).all()


@pytest.mark.parametrize("mirror", [False, True])
def test_exposure_is_found_from_density(mirror: bool) -> None:
    curve = Curve(tuple((-x, d) for x, d in reversed(NEGATIVE)) if mirror else NEGATIVE)
    for density in (0.2001, 0.5, 1.0, 1.79):
        assert curve.density(curve.exposure_at(density)) == pytest.approx(density, abs=1e-6)
    with pytest.raises(SettingsError, match=r"has densities from 0.2 to 1.8, not 2"):
        curve.exposure_at(2.0)


def test_of_a_level_stretch_the_middle_is_taken() -> None:
    curve = Curve(((-1.0, 0.1), (0.0, 0.5), (1.0, 0.5), (2.0, 0.9)))
    assert curve.exposure_at(0.5) == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize(
    ("knots", "words"),
    [
        (((0.0, 0.1),), "the red curve needs at least 2 knots .*, got 1"),
        (((0.0, 0.1), (0.0, 0.2)), "log exposure of the red curve must increase by at least 1e-10, got 0 after 0"),
        (((0.0, 0.1), (5e-324, 0.2)), "must increase by at least 1e-10, got 4.94066e-324 after 0"),
        (((1.0, 0.1), (0.5, 0.2)), "log exposure of the red curve must increase by at least 1e-10, got 0.5 after 1"),
        (((0.0, 0.1), (1.0, 0.9), (2.0, 0.7)), "the red curve runs backwards: .* got 0.9 at 1 and 0.7 at 2"),
        (((0.0, 0.9), (1.0, 0.95), (2.0, 0.1)), "the red curve runs backwards: .* got 0.9 at 0 and 0.95 at 1"),
        (((0.0, float("nan")), (1.0, 0.5)), "densities from 0 to 20, got .0, nan."),
        (((-1e300, 0.0), (1e300, 1.0)), "log10 exposures from -30 to 30"),
        (((0.0, -0.1), (1.0, 0.5)), "densities from 0 to 20"),
    ],
)
def test_curves_that_go_backwards_are_refused(knots: Knots, words: str) -> None:
    with pytest.raises(SettingsError, match=words) as refused:
        Curve(knots, "the red curve")
    assert refused.value.code == "bad_curve"


@pytest.mark.parametrize("sign", [1, -1])
def test_a_parametric_curve_has_the_given_slope_ends_and_aim(sign: int) -> None:
    curve = Curve(parametric_knots(0.1, 2.5, sign * 0.6, 0.5, 0.8, aim=0.75))
    assert (curve.base, curve.greatest) == pytest.approx((0.1, 2.5))
    assert curve.density(0.0) == pytest.approx(0.85, abs=1e-5)
    assert curve.density(0.5) - curve.density(-0.25) == pytest.approx(sign * 0.6 * 0.75, abs=1e-5)
    foot = -sign * 0.75 / 0.6  # where the line alone would meet the least density
    for reach, level in ((-0.26, True), (-0.2, False), (0.2, False), (0.26, True)):
        on_the_line = max(0.1 + 0.6 * reach, 0.1)
        assert (curve.density(foot + sign * reach) == pytest.approx(on_the_line, abs=2e-4)) == level
    assert curve.density(foot) == pytest.approx(0.1 + 0.6 * 0.5 / 8, abs=1e-5)  # a parabola's middle


def test_without_bends_there_is_only_the_line() -> None:
    knots = np.array(parametric_knots(0.0, 2.0, 1.0, 0.0, 0.0, aim=0.5))
    assert knots[[0, -1]] == pytest.approx(np.array([(-0.5, 0.0), (1.5, 2.0)]))
    assert knots[:, 1] == pytest.approx(knots[:, 0] + 0.5)


def test_an_aim_out_of_reach_is_half_the_range() -> None:
    assert Curve(parametric_knots(0.1, 0.5, 0.6, 0.1, 0.1, aim=0.75)).density(0.0) == pytest.approx(0.3, abs=1e-5)


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ((0.1, 2.5, 0.0, 0.5, 0.5), "a gamma other than 0"),
        ((2.5, 0.1, 0.6, 0.5, 0.5), "0 <= least density < greatest density"),
        ((0.1, 2.5, 0.6, -0.5, 0.5), "toe and shoulder from 0 up"),
        ((0.1, 1.3, 1.2, 1.0, 1.5), "no room for a toe of 1 and a shoulder of 1.5: its line is 1 long"),
        ((0.1, float("inf"), 1.2, 1.0, 1.5), "got 0.1, inf"),
    ],
)
def test_impossible_parameters_are_refused(numbers: tuple[float, float, float, float, float], words: str) -> None:
    with pytest.raises(SettingsError, match=words):
        parametric_knots(*numbers, aim=0.75)
