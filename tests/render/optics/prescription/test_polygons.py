"""Openings and obscurations that are polygons, and the arms of spiders."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.errors import InputError
from render.model.lens import Outline
from render.optics.prescription.completion import complete_prescription, scale_prescription
from render.optics.prescription.outlines import excess, is_mirrored, polygon, reach_mm, spider, spider_arms, turned
from tests.render.kits.outlined_lenses import DISC, RADIUS, lens, passed_share

TRIANGLE = polygon([(-5.0, -4.0), (7.0, -4.0), (1.0, 6.0)])
ARROW = polygon([(0.0, 6.0), (4.0, -5.0), (0.0, -1.0), (-4.0, -5.0)])


@pytest.mark.parametrize(
    ("opening", "obscuration", "area"),
    [
        (TRIANGLE, None, 60.0),
        (ARROW, None, 28.0),
        (None, ARROW, DISC - 28.0),
        (polygon([(-6.0, -3.0), (-6.0, 3.0), (6.0, 3.0), (6.0, -3.0)]), None, 72.0),
        (None, spider(1.0, 2, 11.0), DISC - 2 * 1.0 * RADIUS),
        (None, spider(1.0, 4, 11.0), DISC - 4 * 1.0 * RADIUS + 1.0),
        (None, spider(0.8, 1, 11.0), DISC - 0.8 * RADIUS),
    ],
)
def test_the_light_that_a_polygon_leaves(opening: Outline | None, obscuration: Outline | None, area: float) -> None:
    assert passed_share(lens(opening, obscuration)) == pytest.approx(area / DISC, abs=4e-3)  # of points 0.025 mm apart


def test_a_rectangle_as_a_polygon_grows_as_one() -> None:
    """Beside an edge the clearance is that of the rectangle, to first order."""
    corners = polygon([(4.0, 3.0), (-4.0, 3.0), (-4.0, -3.0), (4.0, -3.0)])
    points = np.array([[1.0, 3.01], [1.0, 2.99], [0.0, -3.01]])
    np.testing.assert_allclose(excess(corners, points), excess(Outline("rectangle", (4.0, 3.0)), points), atol=1e-4)
    assert (corners.half_mm, corners.centre_mm) == ((4.0, 3.0), (0.0, 0.0))


def test_polygons_that_are_the_same_left_and_right() -> None:
    kinds = {"arrow": ARROW, "triangle": TRIANGLE, "three": spider(1.0, 3, 9.0), "four": spider(1.0, 4, 9.0)}
    mirrored = {name: (is_mirrored(each, 0), is_mirrored(each, 1)) for name, each in kinds.items()}
    assert mirrored == {
        "arrow": (True, False),
        "triangle": (False, False),
        "three": (False, True),
        "four": (True, True),
    }


def test_polygons_are_scaled_and_turned() -> None:
    half = scale_prescription(lens(TRIANGLE), 0.5).surfaces[0].opening
    assert half == polygon([(-2.5, -2.0), (3.5, -2.0), (0.5, 3.0)])
    assert turned(TRIANGLE) == polygon([(4.0, -5.0), (4.0, 7.0), (-6.0, 1.0)])
    assert reach_mm(TRIANGLE) == pytest.approx(np.hypot(7.0, 4.0))


@pytest.mark.parametrize("arms", [1, 2, 3, 4, 7])
def test_the_arms_of_a_spider_are_known_again(arms: int) -> None:
    found = spider_arms(spider(0.75, arms, 9.0, (0.5, -1.0)))
    assert found is not None
    assert (found.width, found.arms, found.centre) == (pytest.approx(0.75), arms, pytest.approx((0.5, -1.0)))
    assert spider_arms(TRIANGLE) is None
    assert spider_arms(ARROW) is None


def test_polygons_with_too_few_or_too_many_corners_are_refused() -> None:
    for corners in (((0.0, 0.0), (1.0, 1.0)), ((0.0, 0.0), (1.0, 1.0), (1.0, 0.0)) * 22):
        with pytest.raises(InputError, match="its opening must have from 3 to 64 corners"):
            complete_prescription(lens(replace(TRIANGLE, corners_mm=corners)))


def test_a_polygon_beside_the_lens_is_refused() -> None:
    with pytest.raises(InputError, match="leave nothing open"):
        complete_prescription(lens(polygon([(40.0, 0.0), (44.0, 0.0), (42.0, 3.0)])))
