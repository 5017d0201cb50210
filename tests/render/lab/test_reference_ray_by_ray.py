"""The ray-by-ray pictures: against the accumulation buffer, and what must be true of what rays see."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db
from render.lab.reference.ray_by_ray import ray_by_ray_picture
from render.lab.reference.scenes import posts_before_wall, rectangle, spheres_over_checkerboard
from render.lab.reference.triangles import TriangleTracer
from render.lab.reference.unlit import UnlitScene, from_packets, in_packets, looked_up
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.scene import Batch, Dome, Image, Material, Scene, TextureLookup, Wrap

HERE = np.eye(4)[None]
RED, WHITE = (0.9, 0.1, 0.2), (1.0, 1.0, 1.0)


def seen(scene: Scene, *slopes: tuple[float, float], offset: tuple[float, float] = (0.0, 0.0)) -> DoubleArray:
    """``(n, 4)`` what single rays see from the origin, looking along -Z."""
    there = UnlitScene(scene, np.eye(4), near_m=0.1, far_m=np.inf)
    return there.radiance(np.tile(offset, (len(slopes), 1, 1)), np.array(slopes)[:, None, :])[:, 0]


def board(depth_m: float, half_m: float = 1.0, **material: object) -> Batch:
    """A square on the view axis that faces the camera."""
    return Batch(rectangle((0, 0, -depth_m), (half_m, 0, 0), (0, half_m, 0)), Material(**material), HERE)


def rolled(angle_rad: float) -> DoubleArray:
    """World from a camera at the origin that is turned about its axis."""
    cosine, sine = np.cos(angle_rad), np.sin(angle_rad)
    pose = np.eye(4)
    pose[:2, :2] = [[cosine, -sine], [sine, cosine]]
    return pose


@pytest.mark.parametrize(
    ("make", "size", "rays", "bound_db"),
    [(posts_before_wall, (160, 120), 24, 50), (spheres_over_checkerboard, (80, 60), 6, 48)],
)
def test_a_thin_lens_sees_what_the_accumulation_buffer_does(
    renderer: FrameRenderer, make: Callable[[], tuple[Scene, Camera]], size: tuple[int, int], rays: int, bound_db: float
) -> None:
    """The same samples, the same triangles, no layers on either side: only the device's rounding at edges is left.

    The camera is rolled, so that no edge of the scene lies along a row of samples."""
    scene, camera = make()
    camera = replace(camera, world_from_camera=rolled(0.3))
    settings = FrameSettings(*size, engine="accumulation", rays=rays, tiled=False, shading="unlit")
    accumulated = renderer.render(scene, camera, settings).color
    traced = ray_by_ray_picture(scene, camera, width=size[0], height=size[1], rays=rays)
    assert psnr_db(traced, accumulated) >= bound_db
    np.testing.assert_allclose(traced.mean((0, 1)), accumulated.mean((0, 1)), rtol=1e-3)


def test_the_nearest_triangle_is_found() -> None:
    """Against every triangle tried in turn (Möller & Trumbore 1997), some of them behind the camera or through its plane."""
    rng = np.random.default_rng(3)
    corners = rng.uniform(-2, 2, (400, 1, 3)) + np.array([0, 0, -1.5]) + rng.normal(0, 0.3, (400, 3, 3))
    two_sided = rng.uniform(size=400) < 0.5
    offsets, slopes = rng.uniform(-0.05, 0.05, (2, 6, 64, 2)) * [[[[1.0]]], [[[20.0]]]]
    hits = TriangleTracer(corners, two_sided, near_m=0.2, far_m=3.0).nearest(offsets, slopes)
    expected = np.zeros((6, 64))
    first, along, across = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    for place in np.ndindex(6, 64):
        heading = np.array([*slopes[place], -1.0])
        away = np.array([*offsets[place], 0.0]) - first
        p, q = np.cross(heading, across), np.cross(away, along)
        facing = (along * p).sum(1)
        u, v, depth = (away * p).sum(1) / facing, (q @ heading) / facing, (across * q).sum(1) / facing
        met = (u >= 0) & (v >= 0) & (u + v <= 1) & (depth >= 0.2) & (depth <= 3) & ((facing > 0) | two_sided)
        expected[place] = 1 / depth[met].min() if met.any() else 0.0
    np.testing.assert_allclose(hits.w, expected, rtol=1e-9)
    assert 0.2 < (expected > 0).mean() < 0.98


def test_a_hits_barycentric_coordinates_are_its_place() -> None:
    corners = np.array([[[0.0, 0, -2], [1, 0, -2], [0, 1, -4]]])
    slopes = np.array([[[0.1, 0.05], [0.2, 0.1], [0.05, 0.2]]])
    hits = TriangleTracer(corners, np.array([True]), near_m=0.1, far_m=np.inf).nearest(np.zeros_like(slopes), slopes)
    a, b, c = corners[0]
    for u, v, w, slope in zip(hits.u[0], hits.v[0], hits.w[0], slopes[0], strict=True):
        np.testing.assert_allclose(a + u * (b - a) + v * (c - a), np.array([*slope, -1]) / w, atol=1e-12)


def test_a_ray_through_the_edge_of_the_pupil_moves_with_depth() -> None:
    """A ray that starts 0.3 m to the right and goes left by 0.1 per metre meets the axis at 3 m."""
    posts = Scene((board(3, 0.05, base_color=RED), board(4, 0.05, base_color=WHITE)))
    np.testing.assert_allclose(seen(posts, (-0.1, 0.0), offset=(0.3, 0.0))[0], [*RED, 1])
    np.testing.assert_allclose(seen(posts, (-0.075, 0.0), offset=(0.3, 0.0))[0], [*WHITE, 1])


def test_backs_are_seen_only_of_surfaces_with_two_sides() -> None:
    away = board(2, base_color=RED)
    turned = np.diag([-1.0, 1, -1, 1])[None]
    turned[0, 2, 3] = -4
    assert seen(Scene((replace(away, poses=turned),)), (0.1, 0.1))[0, 3] == 0
    assert seen(Scene((replace(away, poses=turned, double_sided=True),)), (0.1, 0.1))[0, 3] == 1
    mirrored = np.diag([-1.0, 1, 1, 1])[None]  # turns the winding around, not the side that is outside
    assert seen(Scene((replace(away, poses=mirrored),)), (0.1, 0.1))[0, 3] == 1


def test_partly_transparent_surfaces_are_seen_in_order() -> None:
    panes = (
        board(3, base_color=WHITE),
        board(1, base_color=RED, opacity=0.25),
        board(2, base_color=WHITE, opacity=0.0),
    )
    dome = Dome((0.5, 0.6, 0.7), np.eye(4))
    through, beside = seen(Scene(panes, dome=dome), (0.0, 0.0), (0.9, 0.0))
    np.testing.assert_allclose(through, [*(0.25 * np.array(RED) + 0.75), 1])
    np.testing.assert_allclose(beside, [*(0.25 * np.array(RED) + 0.75 * np.array([0.5, 0.6, 0.7])), 0.25])
    hole = board(1, base_color=RED, opacity=0.25, opacity_threshold=0.5)
    np.testing.assert_allclose(seen(Scene((hole,), dome=dome), (0.0, 0.0))[0], [0.5, 0.6, 0.7, 0])


def test_a_dome_that_is_not_visible_is_dark() -> None:
    assert seen(Scene(dome=Dome((1, 1, 1), np.eye(4), visible=False)), (0.2, 0.1)).max() == 0


def test_a_domes_image_stands_where_the_scene_says() -> None:
    """Row 0 looks up; -Z is at the left and right edge, +X a quarter of the width to the left of the centre."""
    pixels = np.zeros((4, 8, 4), np.float16)
    pixels[1:3, [0, 7], 0] = 1  # around -Z
    pixels[0, :, 1] = 1  # up
    pixels[1:3, 1:3, 2] = 1  # around +X
    scene = Scene(dome=Dome((1, 1, 1), np.eye(4), Image(pixels)))
    ahead, up, right = seen(scene, (0.0, 0.0), (0.0, 50.0), (50.0, 0.0))
    assert ahead.argmax() == 0
    assert up.argmax() == 1
    assert right.argmax() == 2


@pytest.mark.parametrize(("wrap", "outside"), [("repeat", 3.0), ("clamp", 1.0), ("mirror", 1.0), ("black", 0.0)])
def test_textures_wrap(wrap: Wrap, outside: float) -> None:
    """A texel's value at its centre, the mean half way to the next, and beyond the edge what the wrap says."""
    pixels = np.array([[1, 2, 3]], np.float16)[..., None].repeat(4, -1)
    lookup = TextureLookup(Image(pixels), wrap_s=wrap, wrap_t=wrap)
    values = looked_up(lookup, np.array([[1 / 6, 0.5], [2 / 6, 0.5], [-1 / 6, 0.5]]))[:, 0]
    np.testing.assert_allclose(values, [1, 1.5, outside], atol=1e-6)


def test_texture_and_display_colour_make_the_base_colour() -> None:
    """A 2x2 image upright on a board whose display colour halves red: rows go down, texture coordinates up."""
    pixels = np.zeros((2, 2, 4), np.float16)
    pixels[0, 0], pixels[1, 1] = [1, 0, 0, 1], [0, 1, 0, 1]
    material = Material(uses_display_color=True, lookups={"base_color": TextureLookup(Image(pixels))})
    geometry = rectangle((0, 0, -2), (1, 0, 0), (0, 1, 0))
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
    tinted = replace(geometry, uvs=corners, colors=np.tile(np.array([0.5, 1, 1, 1], np.float32), (4, 1)))
    upper_left, lower_right = seen(Scene((Batch(tinted, material, HERE),)), (-0.25, 0.25), (0.25, -0.25))
    np.testing.assert_allclose(upper_left, [0.5, 0, 0, 1], atol=1e-6)
    np.testing.assert_allclose(lower_right, [0, 1, 0, 1], atol=1e-6)


def test_packets_come_apart_as_they_were_put_together() -> None:
    image = np.random.default_rng(4).normal(size=(13, 21, 3))
    assert np.array_equal(from_packets(in_packets(image), 13, 21), image)


def test_a_picture_of_nothing_is_black() -> None:
    camera = Camera(np.eye(4), f_stop=2.8)
    assert ray_by_ray_picture(Scene(), camera, width=9, height=7, rays=3).max() == 0


def test_the_blur_of_an_edge_is_the_circle_of_confusion() -> None:
    """A white board behind the focus fades over f_px·R·|w − w_f| to both sides of its edge; in focus it is sharp."""
    camera = Camera(np.eye(4), 50, 36, 27, f_stop=1.4, focus_distance_m=1.0)
    f_px, pupil_m = 50 / 36 * 200, 0.05 / 2.8
    for depth in (1.0, 4.0):
        scene = Scene((board(depth, 0.15 * depth, base_color=WHITE),))
        row = ray_by_ray_picture(scene, camera, width=200, height=3, rays=128)[1, :100, 0]
        soft = np.flatnonzero((row > 0.003) & (row < 0.997))
        assert np.ptp(soft) + 1 == pytest.approx(2 * f_px * pupil_m * abs(1 / depth - 1) + 1, abs=1.5)
        assert np.interp(0.5, row, np.arange(100) + 0.5) == pytest.approx(100 - 0.15 * f_px, abs=0.3)
