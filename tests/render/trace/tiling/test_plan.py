"""Plans of tiles on devices of little and of much memory."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.layers.targets import MAX_LAYER_PIXELS
from render.model.camera import Camera
from render.optics.view import PinholeView
from render.trace.tiling.plan import LayerBudget, TilePlan, layers_bytes, plan_tiles

LAYERS, REACH_PX, MOST_SIDE_PX = 8, 120.0, 32768
CAMERA = Camera(np.eye(4), 50.0, 36.0, 20.25, f_stop=2.0, focus_distance_m=4.0)


def planned(width: int, supersample: int, budget: LayerBudget) -> TilePlan | None:
    picture = PinholeView.from_camera(CAMERA, width, width * 9 // 16)
    scaled = ("width", "height", "fx", "fy", "cx", "cy")
    whole = replace(picture, **{name: supersample * getattr(picture, name) for name in scaled})
    return plan_tiles(picture, whole, REACH_PX, LAYERS, budget, MOST_SIDE_PX, lit=True)


@pytest.mark.parametrize(("gib", "budget_gib"), [(0, 1), (4, 1), (24, 3), (80, 10)])
def test_layers_have_an_eighth_of_the_device_s_memory(gib: int, budget_gib: int) -> None:
    budget = LayerBudget.of_device(gib << 30)
    assert budget.bytes == budget_gib << 30
    assert 8 * budget.strip_bytes == budget.bytes


def test_a_large_device_draws_a_picture_in_one_piece() -> None:
    assert planned(1920, 2, LayerBudget.of_device(0)) is not None
    assert planned(1920, 2, LayerBudget.of_device(24 << 30)) is None


@pytest.mark.parametrize("width", [3840, 7680])
def test_a_window_holds_no_more_pixels_than_layers_may_have(width: int) -> None:
    tiles = planned(width, 4, LayerBudget.of_device(1 << 40))
    assert tiles is not None
    across = tiles.whole.size[1 - tiles.axis]
    assert tiles.strip <= tiles.window
    assert tiles.window * across <= MAX_LAYER_PIXELS
    assert [tiles.tiles[0].first, tiles.tiles[-1].stop] == [0, width]


def test_windows_keep_to_the_budget() -> None:
    budget = LayerBudget.of_device(0)
    tiles = planned(3840, 2, budget)
    assert tiles is not None
    across = tiles.whole.size[1 - tiles.axis]
    assert layers_bytes(tiles.window, across, LAYERS) + layers_bytes(tiles.strip, across, LAYERS) <= 1.01 * budget.bytes
