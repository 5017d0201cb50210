"""Surfaces that let light through, one behind the other: what is seen of each, and of what is solid behind them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle
from render.layers.peel import MAX_PINHOLE_LAYERS
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.scene import Batch, Dome, Material, Scene

SIZE = (48, 36)
CAMERA = Camera(np.eye(4), 50, 36, 27, f_stop=2.0, focus_distance_m=1.5, near_m=0.1)
LIT_FROM_BEHIND = Dome((4.0, 4.0, 4.0), np.eye(4))
"""Seen past everything, so that what is let through can be read off the picture. Pictures are unlit: panes are black."""


def pane(depth_m: float, opacity: float, radiance: float = 0.0) -> Batch:
    """A pane across the whole view."""
    wall = rectangle((0, 0, -depth_m), (9 * depth_m, 0, 0), (0, 9 * depth_m, 0))
    return Batch(wall, Material(base_color=(radiance,) * 3, opacity=opacity), np.eye(4)[None])


def panes(count: int, opacity: float, *behind: Batch) -> Scene:
    """Panes from 1 m on, a centimetre apart, before what is behind."""
    glass = [pane(1 + 0.01 * i, opacity) for i in range(count)]
    return Scene((*behind, *glass), (), LIT_FROM_BEHIND, ("/pane",))


def middle(renderer: FrameRenderer, scene: Scene, engine: str, **settings: int) -> FloatArray:
    """Colour in the middle of the picture."""
    frame = renderer.render(
        scene, CAMERA, FrameSettings(*SIZE, engine=engine, shading="unlit", **{"rays": 8, **settings})
    )
    return frame.color[SIZE[1] // 2, SIZE[0] // 2]


@pytest.mark.parametrize("count", [1, 3, 4, 5, 8, 12, 20])
@pytest.mark.parametrize("opacity", [0.25, 0.75])
def test_the_reference_sees_through_any_number_of_panes(renderer: FrameRenderer, count: int, opacity: float) -> None:
    """n panes of opacity a let (1 - a)^n through."""
    through = (1 - opacity) ** count
    seen = middle(renderer, panes(count, opacity), "accumulation", rays=2)
    np.testing.assert_allclose(seen, [4 * through] * 3 + [1 - through], rtol=1e-5, atol=1e-7)
    seen = middle(renderer, panes(count, opacity, pane(3.0, 1.0, radiance=2.0)), "accumulation", rays=2)
    np.testing.assert_allclose(seen, [2 * through] * 3 + [1], rtol=1e-5, atol=1e-7)


def test_beyond_its_limit_the_reference_still_sees_what_is_solid(renderer: FrameRenderer) -> None:
    count, opacity = MAX_PINHOLE_LAYERS + 6, 0.03125
    through = (1 - opacity) ** (MAX_PINHOLE_LAYERS - 1)
    seen = middle(renderer, panes(count, opacity, pane(3.0, 1.0, radiance=2.0)), "accumulation", rays=1)
    np.testing.assert_allclose(seen, [2 * through] * 3 + [1], rtol=1e-4)


@pytest.mark.parametrize("engine", ["lens", "pinhole"])
def test_eight_layers_hold_five_panes_and_what_is_behind(renderer: FrameRenderer, engine: str) -> None:
    through = 0.5**5
    seen = middle(renderer, panes(5, 0.5), engine, layers=8)
    np.testing.assert_allclose(seen, [4 * through] * 3 + [1 - through], rtol=2e-3)
    seen = middle(renderer, panes(5, 0.5, pane(3.0, 1.0, radiance=2.0)), engine, layers=8)
    np.testing.assert_allclose(seen, [2 * through] * 3 + [1], rtol=2e-3)


@pytest.mark.parametrize(("count", "layers"), [(5, 1), (7, 1), (7, 4)])
def test_panes_do_not_count_against_the_lens_layers(renderer: FrameRenderer, count: int, layers: int) -> None:
    """As many as there are layers for in all, through a blurred lens; behind them the sky or a wall, and a wall behind that."""
    solid = [pane(3.0, 1.0, radiance=2.0), pane(9.0, 1.0, radiance=7.0)]
    for behind in ([], solid[:1], solid):
        scene = panes(count, 0.5, *behind)
        seen, right = (middle(renderer, scene, engine, layers=layers) for engine in ("lens", "accumulation"))
        np.testing.assert_allclose(seen, right, rtol=2e-3)


@pytest.mark.parametrize(("engine", "layers"), [("lens", 8), *(("pinhole", layers) for layers in (1, 2, 4, 8))])
def test_where_layers_run_out_panes_are_lost_and_never_what_is_solid(
    renderer: FrameRenderer, engine: str, layers: int
) -> None:
    """Ten panes: the last layer goes to the wall behind them, or to one more pane where there is none."""
    seen = middle(renderer, panes(10, 0.5, pane(3.0, 1.0, radiance=2.0)), engine, layers=layers)
    np.testing.assert_allclose(seen, [2 * 0.5 ** (layers - 1)] * 3 + [1], rtol=2e-3)
    through = 0.5**layers
    seen = middle(renderer, panes(10, 0.5), engine, layers=layers)
    np.testing.assert_allclose(seen, [4 * through] * 3 + [1 - through], rtol=2e-3)


def test_the_last_layer_holds_a_wall_here_and_a_pane_there(renderer: FrameRenderer) -> None:
    """Two layers for three panes: the last one holds the wall where it stands, and a second pane elsewhere."""
    half = pane(3.0, 1.0, radiance=2.0)
    right = replace(half, poses=np.eye(4)[None] + 27 * np.eye(4, k=3)[None])
    scene = panes(3, 0.5, right)
    color = renderer.render(
        scene, CAMERA, FrameSettings(*SIZE, engine="pinhole", shading="unlit", rays=1, layers=2)
    ).color
    np.testing.assert_allclose(color[18, 6], [1, 1, 1, 0.75], rtol=2e-3)
    np.testing.assert_allclose(color[18, 42], [1, 1, 1, 1], rtol=2e-3)


def test_a_pane_on_a_wall_does_not_take_its_place(renderer: FrameRenderer) -> None:
    """Both at the same depth to the bit, in the last layer: the wall is kept, whichever is drawn first."""
    wall, film = pane(2.0, 1.0, radiance=2.0), pane(2.0, 0.5, radiance=8.0)
    for batches in ((wall, film), (film, wall)):
        scene = Scene(batches, (), LIT_FROM_BEHIND, ("/pane",))
        np.testing.assert_allclose(middle(renderer, scene, "pinhole", layers=1), [2, 2, 2, 1], rtol=2e-3)


def test_glass_before_what_is_blurred_leaves_its_blur_alone(renderer: FrameRenderer) -> None:
    """Through five clear panes of opacity 1/8 the lens's picture is (7/8)^5 of that without, but for rays at the very edges:
    with panes in the way a ray is followed in other steps, and one that just meets a bar may come to just miss it."""
    bars = []
    for i in range(-6, 7):
        bar = rectangle((0.12 * i, 0, -3.0), (0.03, 0, 0), (0, 2.0, 0))
        bars.append(Batch(bar, Material(base_color=(2.0, 2.0, 2.0)), np.eye(4)[None]))
    settings = FrameSettings(*SIZE, shading="unlit", rays=64, layers=8)
    bare = renderer.render(Scene(tuple(bars), (), LIT_FROM_BEHIND, ("/bar",)), CAMERA, settings).color[..., 0]
    glazed = renderer.render(panes(5, 0.125, *bars), CAMERA, settings).color[..., 0] / 0.875**5
    assert bare.min() < 2.5
    assert bare.max() > 3.5
    np.testing.assert_allclose(glazed.mean(), bare.mean(), rtol=2e-3)
    np.testing.assert_allclose(glazed, bare, atol=10 / 64 * (4 - 2))
