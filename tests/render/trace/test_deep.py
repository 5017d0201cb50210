"""Deep pictures through the lens: they flatten to the flat picture, and their samples lie where the surfaces are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.engines import engine_names
from render.errors import SettingsError
from render.frame import Frame, FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle, sphere
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.moment import Moment, ShutterScenes
from render.model.scene import Batch, Dome, Material, Scene
from tests.render.kits.lenses import PLANAR
from tests.render.kits.tiles import render_in_tiles

pytestmark = pytest.mark.gl

WIDTH, HEIGHT = 96, 64
SETTINGS = FrameSettings(
    WIDTH, HEIGHT, rays=32, supersample=2, shading="unlit", adaptive=False, connections=False, deep=True
)
CAMERA = Camera(np.eye(4), 50.0, 36.0, 24.0, f_stop=1.4, focus_distance_m=4.0, near_m=0.1)
GLASS = replace(CAMERA, f_stop=2.0, lens=replace(CAMERA.lens, model="prescription", prescription=PLANAR.prescription))
HERE = np.eye(4)[None]
SKY = Dome((0.25, 0.5, 1.0), np.eye(4))
NAMES = ("/wall", "/post", "/ball", "/pane")


def scene(sky: Dome | None = SKY) -> Scene:
    """A wall at 8 m on the left, a post at 2 m and a ball at 4 m before it, and a clear pane at 1.5 m in front of all."""
    shapes = {
        (0.5, 0.5, 0.5): rectangle((-2.5, 0, -8), (2.5, 0, 0), (0, 4, 0), prim=0),
        (1.0, 0.0, 0.0): rectangle((0.25, 0, -2), (0.1, 0, 0), (0, 2, 0), prim=1),
        (0.0, 2.0, 0.0): sphere((0.1, 0.1, -4), 0.4, prim=2),
        (0.0, 0.0, 3.0): rectangle((0.2, -0.25, -1.5), (0.2, 0, 0), (0, 0.1, 0), prim=3),
    }
    opacities = (1.0, 1.0, 1.0, 0.5)
    batches = [
        Batch(shape, Material(base_color=colour, opacity=opacity), HERE)
        for (colour, shape), opacity in zip(shapes.items(), opacities, strict=True)
    ]
    return Scene(tuple(batches), (), sky, NAMES)


def flatten(frame: Frame) -> FloatArray:
    """The flat picture: each sample over the next."""
    assert frame.deep is not None
    flat = np.zeros((frame.color.shape[0] * frame.color.shape[1], 4))
    for pixel, light in zip(frame.deep.pixels.tolist(), frame.deep.light.astype(np.float64), strict=True):
        flat[pixel] += (1 - flat[pixel, 3]) * light
    return flat.reshape(frame.color.shape)


LENSES = {
    "thin": (CAMERA, SETTINGS),
    "adaptive": (CAMERA, replace(SETTINGS, adaptive=True)),
    "many passes": (CAMERA, replace(SETTINGS, rays=200)),
    "pinhole": (CAMERA, replace(SETTINGS, engine="pinhole", rays=8)),
    "glass": (GLASS, SETTINGS),
}


@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize("sky", [SKY, None])
def test_samples_flatten_to_the_flat_picture(renderer: FrameRenderer, lens: str, sky: Dome | None) -> None:
    camera, settings = LENSES[lens]
    flat = renderer.render(scene(sky), camera, replace(settings, deep=False)).color
    frame = renderer.render(scene(sky), camera, settings)
    np.testing.assert_array_equal(frame.color, flat)
    np.testing.assert_allclose(flatten(frame), flat, atol=3e-6)
    assert frame.deep is not None
    assert len(frame.deep.pixels) < 3 * WIDTH * HEIGHT


def test_samples_lie_at_the_depths_of_surfaces(renderer: FrameRenderer) -> None:
    """Blurred or not, a pixel has a sample at the depth of each surface that it shows, and none in between."""
    deep = renderer.render(scene(), CAMERA, SETTINGS).deep
    assert deep is not None
    on_planes = np.zeros(len(deep.pixels), bool)
    for depth_m in (1.5, 2.0, 8.0):
        near = np.abs(deep.depths_m - depth_m) < 1e-3 * depth_m
        assert near.sum() > 150, depth_m
        on_planes |= near
    behind = np.isinf(deep.depths_m)
    assert (deep.light[behind, 3] == 0).all()
    ball = deep.depths_m[~on_planes & ~behind]
    assert len(ball) > 50
    assert ball.min() >= 3.6 - 0.01
    assert ball.max() <= 4.0 + 0.01


def test_each_sample_has_the_light_of_its_own_surface(renderer: FrameRenderer) -> None:
    """Unlit, a sample's colour over its alpha is the surface's own; side by side in a blurred pixel they are not mixed."""
    deep = renderer.render(scene(), CAMERA, SETTINGS).deep
    assert deep is not None
    solid = deep.light[:, 3] > 1e-3
    for depth_m, colour in ((1.5, (0, 0, 3)), (2.0, (1, 0, 0)), (8.0, (0.5, 0.5, 0.5))):
        own = solid & (np.abs(deep.depths_m - depth_m) < 1e-3 * depth_m)
        shade = deep.light[own, :3] / deep.light[own, 3:]
        np.testing.assert_allclose(shade, np.broadcast_to(colour, shade.shape), atol=2e-3)
    behind = np.isinf(deep.depths_m)
    np.testing.assert_allclose(deep.light[behind, :3], np.tile([0.25, 0.5, 1.0], (behind.sum(), 1)), rtol=5e-3)


def test_a_prim_at_two_depths_has_two_samples(renderer: FrameRenderer) -> None:
    """Two cards of one prim, far apart, in one blurred pixel: no sample at a depth where nothing is."""
    cards = [
        Batch(rectangle((x, 0, -depth), (1, 0, 0), (0, 3, 0)), Material(base_color=(1.0,) * 3), HERE)
        for x, depth in ((-1.0, 2.0), (1.0, 3.0))
    ]
    deep = renderer.render(Scene(tuple(cards), (), None, ("/cards",)), CAMERA, SETTINGS).deep
    assert deep is not None
    np.testing.assert_allclose(np.unique(np.round(deep.depths_m, 3)), [2, 3])
    both = np.bincount(deep.pixels) == 2
    assert both.sum() > 100


def test_holdouts_leave_no_samples(renderer: FrameRenderer) -> None:
    held = scene()
    held = replace(held, batches=(held.batches[0], replace(held.batches[1], camera_role="holdout"), *held.batches[2:]))
    frame = renderer.render(held, CAMERA, SETTINGS)
    assert frame.deep is not None
    np.testing.assert_allclose(flatten(frame)[..., 3], frame.color[..., 3], atol=3e-6)
    assert not (np.abs(frame.deep.depths_m - 2) < 0.01).any()


def test_tiles_give_the_samples_of_one_piece(renderer: FrameRenderer) -> None:
    tiled, whole = (frame.deep for frame in render_in_tiles(renderer, scene(), CAMERA, SETTINGS))
    assert tiled is not None
    assert whole is not None
    np.testing.assert_array_equal(tiled.pixels, whole.pixels)
    np.testing.assert_allclose(tiled.light, whole.light, atol=1e-4)
    np.testing.assert_allclose(tiled.depths_m, whole.depths_m, rtol=1e-5)


def moved(by_m: float) -> Scene:
    still = scene()
    post = replace(still.batches[1], poses=still.batches[1].poses + by_m * np.eye(4, k=3)[None])
    return replace(still, batches=(still.batches[0], post, *still.batches[2:]))


@pytest.mark.parametrize("by", ["moments", "velocities"])
def test_motion_is_in_the_samples(renderer: FrameRenderer, by: str) -> None:
    settings = replace(SETTINGS, rays=16, motion=8, motion_by=by)
    if by == "velocities":
        moments = [Moment(scene(), CAMERA, 1 / 8)] * 8
        frame = renderer.render_swept(ShutterScenes(scene(), moved(-0.2), moved(0.2)), CAMERA, moments, settings)
    else:
        frame = renderer.render_moving(8, lambda i: Moment(moved(0.05 * (i - 3.5)), CAMERA, 1 / 8), settings)
    np.testing.assert_allclose(flatten(frame), frame.color, atol=3e-6)
    assert frame.deep is not None
    post = np.abs(frame.deep.depths_m - 2) < 0.01
    columns = frame.deep.pixels[post] % WIDTH
    assert np.ptp(columns) > 25, "the post is smeared"


def test_a_nearer_mover_leaves_other_depths_apart(renderer: FrameRenderer) -> None:
    """A pane at 4 m and a wall at 8 m are one prim; the nearest surface of all is elsewhere, and comes from 2 m to 1 m."""

    def at_moment(near_m: float) -> Moment:
        sheets = [
            Batch(
                rectangle((0, 0, -depth), (depth / 8, 0, 0), (0, 3 * depth / 4, 0), prim=0),
                Material(opacity=opacity),
                HERE,
            )
            for depth, opacity in ((4, 0.5), (8, 1.0))
        ]
        post = rectangle((-0.35 * near_m, 0, -near_m), (0.02 * near_m, 0, 0), (0, 0.1 * near_m, 0), prim=1)
        return Moment(Scene((*sheets, Batch(post, Material(), HERE)), (), None, NAMES), CAMERA, 0.5)

    frame = renderer.render_moving(2, lambda i: at_moment(2.0 - i), SETTINGS)
    assert frame.deep is not None
    middle = frame.deep.pixels == HEIGHT // 2 * WIDTH + WIDTH // 2
    np.testing.assert_allclose(frame.deep.depths_m[middle], [4, 8], rtol=1e-3)


def test_more_surfaces_than_slots_keep_light_and_alpha(renderer: FrameRenderer) -> None:
    """Forty strips side by side, in blurred pixels that tell sixteen apart."""
    batches = [
        Batch(
            rectangle((0.002 * (i - 20), 0, -1), (0.001, 0, 0), (0, 3, 0), prim=i),
            Material(base_color=(i / 40, 0.5, 1 - i / 40)),
            HERE,
        )
        for i in range(40)
    ]
    names = tuple(f"/strip{i}" for i in range(40))
    camera = replace(CAMERA, f_stop=0.35, focus_distance_m=30.0)
    frame = renderer.render(Scene(tuple(batches), (), SKY, names), camera, replace(SETTINGS, rays=128))
    assert frame.deep is not None
    assert np.bincount(frame.deep.pixels).max() == 17, "sixteen, and the background"
    np.testing.assert_allclose(flatten(frame), frame.color, atol=3e-6)


@pytest.mark.parametrize("engine", [name for name in engine_names() if name not in ("lens", "pinhole")])
def test_engines_without_deep_pictures_refuse_them(renderer: FrameRenderer, engine: str) -> None:
    with pytest.raises(SettingsError, match=f"the {engine} engine has no deep pictures: take one of lens, pinhole"):
        renderer.render(scene(), CAMERA, replace(SETTINGS, engine=engine))


def test_a_deep_picture_has_no_mattes(renderer: FrameRenderer) -> None:
    with pytest.raises(SettingsError, match="a deep picture has no cryptoObject: make them in a picture of their own"):
        renderer.render(scene(), CAMERA, replace(SETTINGS, aovs=("color", "cryptoObject")))
