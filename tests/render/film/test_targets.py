"""Test targets of film stocks: a wedge, a chart of greys, bulbs a stop apart."""

from __future__ import annotations

import numpy as np
import pytest

from render.film.targets import colour_chart, grey_wedge, small_scene, wedge_stops


def test_the_middle_of_the_wedge_is_middle_grey_and_steps_are_even() -> None:
    wedge = grey_wedge()[0]
    assert wedge[10] == pytest.approx([0.18] * 3)
    assert np.diff(np.log2(wedge[:, 0])) == pytest.approx(np.diff(wedge_stops()), rel=1e-4)


def test_the_greys_of_the_chart_are_grey_and_get_darker() -> None:
    greys = colour_chart()[3]
    assert np.ptp(greys, axis=1).max() < 0.01
    assert (np.diff(greys[:, 1]) < 0).all()
    assert greys[3].mean() == pytest.approx(0.18)
    assert 0.7 < greys[0, 1] < 0.95


def test_the_bulbs_of_the_scene_get_brighter_by_a_stop_each() -> None:
    scene = small_scene(200)
    assert scene.shape == (200, 356, 3)
    bulbs = [scene[round(200 * (0.13 + 0.025 * (i % 2))), round(200 * (0.2 + 0.2 * i))] for i in range(7)]
    assert np.diff(np.log2(np.array(bulbs)), axis=0) == pytest.approx(np.ones((6, 3)), abs=1e-4)
    assert np.median(scene) < 0.18 < scene.max()
