"""FLAG: the linear-time blur sheds what a point by point one does, and its pictures are near the lens tracer's."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import moderngl
import numpy as np
import pytest
from pxr import Gf

from render.film import Grade
from render.frame import FrameRenderer, FrameSettings
from render.gl.shaders import ProgramCache
from render.lab.reference.metrics import psnr_db
from render.lab.reference.scenes import posts_before_wall, rectangle, spheres_over_checkerboard
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.lens import IrisShape
from render.model.scene import Batch, Dome, Material, Scene
from render.pictures.picture import make_picture
from render.postblur.blur_shape import BlurShape, make_blur_shape
from render.postblur.flag import BAND_BYTES, CONTRIBUTION_BYTES, Flag, Ring
from render.postblur.focus_split import SPLIT_PX
from render.postblur.point_spread import ALL_RADII, Field, RadiusWindow
from render.shot import Shot
from tests.render.kits.blur_fields import IRISES, blur_by_point
from tests.render.kits.moving_shots import add_card, key_move, write_posts_shot


@pytest.fixture
def ctx(renderer: FrameRenderer) -> moderngl.Context:
    return renderer.graphics.ctx


def blurred(
    ctx: moderngl.Context, light: FloatArray, radii: FloatArray, shape: BlurShape, most_px: float, split_px: float = 0.0
) -> FloatArray:
    """``(h, w, 4)`` of light ``(h, w, 4)`` with radii ``(h, w)``; with a split also what is spread at half the resolution."""
    height, width = radii.shape
    flag = Flag(ctx, ProgramCache(ctx))
    sources = ctx.texture((width, height), 4, light.tobytes(), dtype="f4")
    both = ctx.texture((width, height), 2, np.stack([radii, 0 * radii], axis=-1).astype("f4").tobytes(), dtype="f4")
    target = ctx.texture((width, height), 4, dtype="f4")
    between = 0.5 * split_px, split_px
    fine = RadiusWindow(fall=between) if split_px else ALL_RADII
    flag.blur(Field(sources, both, 0), shape, split_px or most_px, target, fine)
    total = np.frombuffer(target.read(), np.float32).reshape(height, width, 4).copy()
    if split_px:
        wide = flag.reduce(Field(sources, both, 0), 2, RadiusWindow(rise=between))
        coarse = ctx.texture(wide.light.size, 4, dtype="f4")
        flag.blur(wide, shape, most_px / 2, coarse)
        half = np.frombuffer(coarse.read(), np.float32).reshape(*wide.light.size[::-1], 4)
        total += half.repeat(2, axis=0).repeat(2, axis=1)[:height, :width]
        for texture in (wide.light, wide.radii, coarse):
            texture.release()
    for texture in (sources, both, target):
        texture.release()
    return total


@pytest.mark.parametrize("behind", [True, False])
@pytest.mark.parametrize("iris", IRISES)
def test_rows_and_columns_shed_what_points_do(ctx: moderngl.Context, iris: str, behind: bool) -> None:
    random = np.random.default_rng(7)
    light = random.random((19, 27, 4)).astype(np.float32)
    light[random.random((19, 27)) < 0.2] = 0
    radii = (7.3 * random.random((19, 27))).astype(np.float32)
    shape = make_blur_shape(IRISES[iris], behind=behind)
    assert shape.is_symmetric == (iris != "five, turned")
    seen = blurred(ctx, light, radii, shape, 7.3)
    np.testing.assert_allclose(seen, blur_by_point(light, radii, shape), atol=5e-5)


@pytest.mark.parametrize("radius", [0.1, 0.6, 1.0, 1.3, 2.7, 5.0, 11.4, 20.0])
def test_a_point_keeps_its_light(ctx: moderngl.Context, radius: float) -> None:
    light = np.zeros((61, 61, 4), np.float32)
    light[30, 30] = 1
    seen = blurred(ctx, light, np.full((61, 61), radius, np.float32), make_blur_shape(IrisShape(), behind=True), radius)
    assert seen[..., 0].sum() == pytest.approx(1.0, rel=4e-3)
    if radius > 2:
        y, x = np.nonzero(seen[..., 3] > 0.5 * seen[..., 3].max())
        assert np.hypot(x - 30, y - 30).max() == pytest.approx(radius, abs=0.8)


def test_wide_blurs_at_half_the_resolution_are_alike(ctx: moderngl.Context) -> None:
    """Smooth light whose radii cross the split: what is spread at less resolution is no other light."""
    y, x = np.mgrid[0:80, 0:120].astype(np.float32)
    light = np.repeat((1.2 + np.sin(0.2 * x) * np.cos(0.15 * y))[..., None], 4, axis=2).astype(np.float32)
    radii = (2 + 12 * x / 120).astype(np.float32)
    shape = make_blur_shape(IrisShape(), behind=True)
    whole = blurred(ctx, light, radii, shape, 14)
    split = blurred(ctx, light, radii, shape, 14, split_px=8.0)
    inner = (slice(16, -16), slice(16, -16))
    assert np.abs(split - whole)[inner].max() < 0.08 * whole[inner].max()
    assert split.sum() == pytest.approx(whole.sum(), rel=5e-3)


@pytest.mark.parametrize("size", [(64, 36), (960, 540), (3840, 2160)])
@pytest.mark.parametrize("most", [3, 24, 81])
def test_memory_has_a_bound(size: tuple[int, int], most: int) -> None:
    for two_sided in (False, True):
        ring = Ring.for_picture(size, most, two_sided=two_sided)
        least = 16 + 2 * 16 * -(-most // 16)
        assert ring.ahead >= most
        assert ring.slices == (most + 1) * (2 if two_sided else 1)
        fitting = BAND_BYTES // (size[0] * ring.slices * CONTRIBUTION_BYTES)
        assert ring.rows == least if fitting < least else least <= ring.rows <= fitting
        assert ring.rows < size[1] + 2 * most + 48


@pytest.mark.parametrize("width", [64, 960, 1920, 3840, 7680])
def test_memory_is_as_much_as_the_manual_says(width: int) -> None:
    for two_sided, column_bytes in ((False, 33.3e3), (True, 66.6e3)):
        ring = Ring.for_picture((width, width * 9 // 16), int(SPLIT_PX) + 1, two_sided=two_sided)
        assert ring.rows * width * ring.slices * CONTRIBUTION_BYTES <= max(67.2e6, column_bytes * width)


def test_rows_that_are_held_in_turn_are_distinguished(ctx: moderngl.Context, monkeypatch: pytest.MonkeyPatch) -> None:
    random = np.random.default_rng(8)
    light = random.random((150, 40, 4)).astype(np.float32)
    radii = (5 * random.random((150, 40))).astype(np.float32)
    shape = make_blur_shape(IRISES["five, turned"], behind=True)
    whole = blurred(ctx, light, radii, shape, 5)
    monkeypatch.setattr("render.postblur.flag.BAND_BYTES", 0)
    assert Ring.for_picture((40, 150), 6, two_sided=True).new == 16
    np.testing.assert_array_equal(blurred(ctx, light, radii, shape, 5), whole)


def test_flag_is_sharp_in_focus_and_blurs_as_much_as_the_lens(renderer: FrameRenderer, tmp_path: Path) -> None:
    stage = write_posts_shot(tmp_path / "room.usda")
    card = add_card(stage, "/card", size=(0.7, 0.8), depth=3.0, colour=(1, 1, 0.2))
    key_move(card.AddTranslateOp(), Gf.Vec3d(0.4, 0, 0), Gf.Vec3d(0.4, 0, 0))
    stage.Save()
    shot = Shot.open(tmp_path / "room.usda")
    settings = FrameSettings(240, 135, shading="unlit", rays=128, supersample=2)
    lens, flag, sharp = (
        make_picture(renderer, shot, "/cam", 1.0, replace(settings, engine=engine), Grade()).frame.color
        for engine in ("lens", "flag", "pinhole")
    )
    assert psnr_db(lens, flag) > 30
    assert psnr_db(lens, flag) > psnr_db(lens, sharp) + 6
    middle = (slice(60, 75), slice(145, 155))  # of the card, in focus
    np.testing.assert_allclose(flag[middle], sharp[middle], atol=2e-3)


@pytest.mark.parametrize("made", [spheres_over_checkerboard, posts_before_wall])
def test_generated_scenes_look_alike(renderer: FrameRenderer, made: Callable[[], tuple[Scene, Camera]]) -> None:
    scene, camera = made()
    settings = FrameSettings(200, 150, shading="unlit", rays=64, supersample=3)  # without a sharp layer
    lens, flag, sharp = (
        renderer.render(scene, camera, replace(settings, engine=engine)).color for engine in ("lens", "flag", "pinhole")
    )
    assert psnr_db(lens, flag) > psnr_db(lens, sharp) + 3


@pytest.mark.parametrize("depth", [1.5, 30.0])
def test_an_odd_iris_stands_as_the_lens_has_it(renderer: FrameRenderer, tmp_path: Path, depth: float) -> None:
    """Three blades before the focus stand upside down to those behind it: a small light draws the iris either way."""
    stage = write_posts_shot(tmp_path / "iris.usda")
    stage.RemovePrim("/wall")
    stage.RemovePrim("/posts")
    add_card(stage, "/light", size=(0.02 * depth, 0.02 * depth), depth=depth, colour=(1, 1, 1))
    stage.Save()
    shot = Shot.open(tmp_path / "iris.usda")
    camera = replace(shot.camera_at("/cam", 1.0, 200, 112), iris=IrisShape(blades=3, rotation_rad=0.3), f_stop=0.15)
    settings = FrameSettings(200, 112, shading="unlit", rays=256, supersample=2, tiled=False)
    lens, flag = (
        renderer.render(shot.scene_at(1.0), camera, replace(settings, engine=engine)).color[..., 0]
        for engine in ("lens", "flag")
    )
    drawn = np.corrcoef(lens.ravel(), flag.ravel())[0, 1]
    upside_down = np.corrcoef(lens.ravel(), flag[::-1, ::-1].ravel())[0, 1]
    assert drawn > 0.98
    assert drawn > upside_down + 0.05


def before_wall(card_m: float, wall_m: float, wall_shade: float) -> tuple[Scene, Camera]:
    """The edge of a dark card in the middle of the picture, before a wall, 4 m in focus, at f/0.35."""
    batches = []
    for prim, (depth, right, shade) in enumerate(((card_m, -depth_span(card_m), 0.05), (wall_m, 0.0, wall_shade))):
        half = depth_span(depth)
        glow = Material(base_color=(shade, shade, shade), roughness=1.0)
        centre = (right, 0.0, -depth)
        batches.append(Batch(rectangle(centre, (half, 0, 0), (0, half, 0), prim), glow, np.eye(4)[None]))
    dome = Dome((0, 0, 0), np.eye(4), visible=False)
    camera = Camera(
        np.eye(4),
        focal_length_mm=35,
        horizontal_aperture_mm=24,
        vertical_aperture_mm=18,
        f_stop=0.35,
        focus_distance_m=4.0,
        near_m=0.1,
        path="/camera",
    )
    return Scene(tuple(batches), (), dome, ("/card", "/wall")), camera


def depth_span(depth_m: float) -> float:
    """Half of a square that fills the picture from there, and more."""
    return 0.6 * depth_m


def profile(renderer: FrameRenderer, scene: Scene, camera: Camera, engine: str) -> FloatArray:
    """Brightness along the middle row."""
    settings = FrameSettings(320, 240, shading="unlit", rays=256, supersample=2, engine=engine)
    return renderer.render(scene, camera, settings).color[100:140, :, 0].mean(axis=0)


def test_near_over_near_has_a_soft_edge_and_no_dark_seam(renderer: FrameRenderer) -> None:
    scene, camera = before_wall(1.2, 2.2, 0.8)  # circles of 13 and 4.5 px, both before the focus
    lens, flag = (profile(renderer, scene, camera, engine) for engine in ("lens", "flag"))
    assert np.abs(flag - lens).max() < 0.08
    assert flag.min() > 0.045  # nothing is darker than the card
    assert np.all(np.diff(flag[120:200]) > -0.02)


def test_a_bright_wall_does_not_leak_over_little_blurred_objects(renderer: FrameRenderer) -> None:
    scene, camera = before_wall(4.6, 30.0, 0.8)  # circles of 0.8 and 5.3 px, both behind the focus
    lens, flag = (profile(renderer, scene, camera, engine) for engine in ("lens", "flag"))
    edge = 160
    assert lens[edge - 3] < 0.06
    np.testing.assert_allclose(flag[: edge - 2], lens[: edge - 2], atol=0.01)
    np.testing.assert_allclose(flag[edge + 8 :], lens[edge + 8 :], atol=0.01)
