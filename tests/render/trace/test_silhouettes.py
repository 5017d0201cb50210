"""Where surfaces end and how they lean: a blurred card is as large as it is, and a floor to the horizon has no holes."""

from __future__ import annotations

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.scene import Batch, Material, Scene

Vector = tuple[float, float, float]
SETTINGS = FrameSettings(160, 120, rays=256, shading="unlit", tiled=False)
FOCAL_PX = 36 / 36 * 160


def shown(renderer: FrameRenderer, centre: Vector, right: Vector, up: Vector, f_stop: float = 1.0) -> FloatArray:
    """A white rectangle, spanned by its half sides, before nothing: coverage of each pixel."""
    card = Batch(rectangle(centre, right, up), Material(base_color=(1, 1, 1)), np.eye(4)[None])
    camera = Camera(np.eye(4), 36, 36, 27, f_stop=f_stop, focus_distance_m=3.0)
    return renderer.render(Scene((card,)), camera, SETTINGS).color[..., 3]


@pytest.mark.parametrize("depth_m", [1.5, 3.0, 9.0], ids=["near", "in focus", "far"])
def test_a_card_is_as_large_as_it_is_however_blurred(renderer: FrameRenderer, depth_m: float) -> None:
    """Blur moves light and makes none: the sum over the picture is the card's area, 42 layer pixels square. Half a layer pixel
    more on each side would be 5 % of it."""
    half = 10.5 * depth_m / FOCAL_PX
    coverage = shown(renderer, (0, 0, -depth_m), (half, 0, 0), (0, half, 0))
    assert coverage.sum() == pytest.approx(21**2, rel=0.01)


def test_a_card_that_leans_is_as_large_as_it_is(renderer: FrameRenderer) -> None:
    """Near at one side, far at the other, in focus between: the sum is the area of its picture, a trapezium."""
    coverage = shown(renderer, (0, 0, -3), (0.5, 0, -1.2), (0, 0.3, 0))
    x, half = np.array([-0.5 / 1.8, 0.5 / 4.2]) * FOCAL_PX, 0.3 / np.array([1.8, 4.2]) * FOCAL_PX
    assert coverage.sum() == pytest.approx((x[1] - x[0]) * half.sum(), rel=0.015)


@pytest.mark.parametrize("height_m", [-0.15, -1.0])
def test_a_floor_has_no_holes(renderer: FrameRenderer, height_m: float) -> None:
    """Seen at a grazing angle, where w changes by much of itself from pixel to pixel: no ray slips through, and none is lost."""
    coverage = shown(renderer, (0, height_m, -250), (500, 0, 0), (0, 0, -249.9), f_stop=2.0)
    below = coverage[64:]  # by more than the blur of what is far away
    assert below.min() > 0.995
    assert below.mean() > 0.9999
