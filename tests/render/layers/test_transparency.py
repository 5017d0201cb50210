"""Surfaces that let light through, one behind the other: what is seen of each, and of what is solid behind them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db
from render.lab.reference.scenes import rectangle
from render.layers.peel import MAX_PINHOLE_LAYERS
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.moment import Moment, ShutterScenes
from render.model.scene import Batch, Dome, Material, Scene
from render.optics.view import PinholeView
from render.trace.rays import make_ray_pattern

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


def test_the_reference_merges_what_it_has_no_layers_for(renderer: FrameRenderer) -> None:
    count, opacity = MAX_PINHOLE_LAYERS + 6, 0.03125
    through = (1 - opacity) ** count
    seen = middle(renderer, panes(count, opacity, pane(3.0, 1.0, radiance=2.0)), "accumulation", rays=1)
    np.testing.assert_allclose(seen, [2 * through] * 3 + [1], rtol=1e-3)


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


@pytest.mark.parametrize(
    ("engine", "layers"), [("lens", 4), ("lens", 8), *(("pinhole", layers) for layers in (1, 2, 4))]
)
@pytest.mark.parametrize(("count", "opacity"), [(9, 0.25), (20, 0.0625)])
def test_panes_beyond_the_layers_are_merged(
    renderer: FrameRenderer, engine: str, layers: int, count: int, opacity: float
) -> None:
    """Before a wall, and before the sky."""
    through = (1 - opacity) ** count
    seen = middle(renderer, panes(count, opacity, pane(3.0, 1.0, radiance=2.0)), engine, layers=layers)
    np.testing.assert_allclose(seen, [2 * through] * 3 + [1], rtol=1e-2)
    seen = middle(renderer, panes(count, opacity), engine, layers=layers)
    np.testing.assert_allclose(seen, [4 * through] * 3 + [1 - through], rtol=1e-2)


def staggered_panes(count: int) -> Scene:
    """Panes of several colours, each a little to the right of the one before and behind it, before bars of light."""
    batches = []
    for i in range(count):
        depth_m, shade = 1 + 0.1 * i, 0.3 + 0.7 * (5 * i % 12) / 12
        glass = rectangle(((0.054 * i - 0.27) * depth_m, 0, -depth_m), (0.5 * depth_m, 0, 0), (0, 0.3 * depth_m, 0))
        batches.append(Batch(glass, Material(base_color=(shade, 1 - shade, 0.5), opacity=0.2), np.eye(4)[None]))
    for i in range(-8, 9):
        bar = rectangle((0.2 * i, 0, -4.0), (0.06, 0, 0), (0, 2.0, 0))
        batches.append(Batch(bar, Material(base_color=(2.0, 1.5, 1.0)), np.eye(4)[None]))
    return Scene(tuple(batches), (), LIT_FROM_BEHIND, ("/pane",))


def test_twelve_panes_are_those_of_the_accumulation_buffer(renderer: FrameRenderer) -> None:
    """Blurred panes with edges: seven of them and what is behind have layers of their own."""
    scene, settings = staggered_panes(12), FrameSettings(32, 24, shading="unlit", rays=64)
    right = renderer.render(scene, CAMERA, replace(settings, engine="accumulation", rays=16)).color
    seen = renderer.render(scene, CAMERA, settings).color
    assert psnr_db(seen[..., :3], right[..., :3]) > 36
    np.testing.assert_allclose(seen.mean(axis=(0, 1)), right.mean(axis=(0, 1)), rtol=2e-2)


def test_panes_behind_an_opaque_edge_are_merged(renderer: FrameRenderer) -> None:
    """Six panes, then a card across half of the picture, then six panes and a wall: rays come behind the card's edge."""
    card = rectangle((-0.9, 0, -1.3), (0.9, 0, 0), (0, 9.0, 0))
    behind = [pane(1.6 + 0.1 * i, 0.25, radiance=0.5) for i in range(6)]
    scene = panes(6, 0.05, Batch(card, Material(), np.eye(4)[None]), *behind, pane(3.0, 1.0, radiance=2.0))
    settings = FrameSettings(32, 24, shading="unlit", rays=64)
    right = renderer.render(scene, CAMERA, replace(settings, engine="accumulation", rays=16)).color
    seen = renderer.render(scene, CAMERA, settings).color
    assert psnr_db(seen[..., :3], right[..., :3]) > 36


def test_moving_panes_beyond_the_layers_are_merged(renderer: FrameRenderer) -> None:
    """Motion by velocities: twelve panes and the wall behind them go to the right."""
    scene = panes(12, 0.25, pane(3.0, 1.0, radiance=2.0))

    def moved(by_m: float) -> Scene:
        shift = by_m * np.eye(4, k=3)[None]
        return replace(scene, batches=tuple(replace(batch, poses=batch.poses + shift) for batch in scene.batches))

    scenes = ShutterScenes(scene, moved(-0.1), moved(0.1))
    settings = FrameSettings(16, 12, shading="unlit", rays=4, supersample=1, motion_by="velocities")
    seen = renderer.render_swept(scenes, CAMERA, [Moment(scene, CAMERA, 1 / 2)] * 2, settings).color[6, 8]
    np.testing.assert_allclose(seen, [2 * 0.75**12] * 3 + [1], rtol=1e-2)


def test_previews_merge_the_panes_beyond_their_layers(renderer: FrameRenderer) -> None:
    view, previewer = PinholeView.from_camera(CAMERA, *SIZE), renderer.device.previewer
    with renderer.on_device():
        renderer.load(panes(5, 0.25, pane(3.0, 1.0, radiance=2.0)), CAMERA, FrameSettings(*SIZE, shading="unlit"))
        peeler = renderer.device.peeler
        peeled, view = previewer.peel(peeler, CAMERA, view, unlit=True, sketch="never")
        pattern = make_ray_pattern(4, CAMERA.iris)
        seen = previewer.trace(peeler, peeled, CAMERA, view, pattern, 1)[view.height // 2, view.width // 2]
    np.testing.assert_allclose(seen, [2 * 0.75**5] * 3 + [1], rtol=1e-2)


def test_the_last_layer_holds_a_wall_here_and_a_pane_there(renderer: FrameRenderer) -> None:
    """Two layers for three panes: the last one holds the wall where it stands, and the other panes elsewhere."""
    half = pane(3.0, 1.0, radiance=2.0)
    right = replace(half, poses=np.eye(4)[None] + 27 * np.eye(4, k=3)[None])
    scene = panes(3, 0.5, right)
    color = renderer.render(
        scene, CAMERA, FrameSettings(*SIZE, engine="pinhole", shading="unlit", rays=1, layers=2)
    ).color
    np.testing.assert_allclose(color[18, 6], [0.5, 0.5, 0.5, 0.875], rtol=2e-3)
    np.testing.assert_allclose(color[18, 42], [0.25, 0.25, 0.25, 1], rtol=2e-3)


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
