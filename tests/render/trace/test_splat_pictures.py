"""Pictures of Gaussian splats: profiles, order, surfaces among them, and lenses, against closed forms and the accumulation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.engines import Engine, register, unregister
from render.errors import SettingsError
from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db
from render.lab.reference.scenes import rectangle
from render.model.arrays import FloatArray
from render.model.moment import Moment, ShutterScenes
from render.model.scene import Batch, Material, Scene
from render.optics.view import PinholeView
from render.trace.rays import make_ray_pattern
from render.trace.tiling.plan import LayerBudget
from tests.render.kits.lens_pictures import camera_of
from tests.render.kits.lenses import PLANAR
from tests.render.kits.splats import CAMERA, SIZE, captured_set, plain_cloud, scene_of

pytestmark = pytest.mark.gl

SHARP = FrameSettings(*SIZE, engine="pinhole", rays=16, shading="unlit")
VIEW = PinholeView.from_camera(CAMERA, *SIZE)


def wall(depth_m: float, radiance: float, opacity: float = 1.0) -> Batch:
    """A wall across the left half of the view."""
    quad = rectangle((-5.0, 0, -depth_m), (5.0, 0, 0), (0, 5.0, 0))
    return Batch(quad, Material(base_color=(radiance,) * 3, opacity=opacity), np.eye(4)[None])


def beside(picture: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Colours a little left and right of the middle."""
    x, y = SIZE[0] // 2, SIZE[1] // 2
    return picture[y, x - 4], picture[y, x + 4]


@pytest.mark.parametrize("engine", ["pinhole", "accumulation"])
def test_a_splat_has_the_profile_of_its_gaussian(renderer: FrameRenderer, engine: str) -> None:
    cloud = plain_cloud([[0.05, 0.03, -2]], [[0.06, 0.03, 0.01]], [[0.8, 0.4, 0.2]], [0.7])
    picture = renderer.render(scene_of(cloud), CAMERA, replace(SHARP, engine=engine, rays=64)).color
    (centre,), _ = VIEW.project(np.array([[0.05, 0.03, -2.0]]))
    y, x = np.mgrid[: SIZE[1], : SIZE[0]] + 0.5
    own_x, own_y = ((VIEW.fx * size / 2) ** 2 + 0.3 for size in (0.06, 0.03))
    spread_x, spread_y = own_x + 1 / 12, own_y + 1 / 12  # the mean over a pixel
    peak = 0.7 * np.sqrt(own_x * own_y / (spread_x * spread_y))
    expected = peak * np.exp(-((x - centre[0]) ** 2) / (2 * spread_x) - (y - centre[1]) ** 2 / (2 * spread_y))
    np.testing.assert_allclose(picture[..., 3], expected, atol=0.012)
    np.testing.assert_allclose(picture[..., :3], picture[..., 3:] * [0.8, 0.4, 0.2], atol=2e-3)


@pytest.mark.parametrize("engine", ["pinhole", "accumulation"])
def test_near_splats_are_composited_over_far_ones(renderer: FrameRenderer, engine: str) -> None:
    """Whatever their order in the list."""
    red, green = [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]
    for depths, colours in (((2.0, 3.0), (red, green)), ((3.0, 2.0), (green, red))):
        cloud = plain_cloud([[0, 0, -z] for z in depths], [[5, 5, 0.01]] * 2, colours, [0.5, 0.5])
        picture = renderer.render(scene_of(cloud), CAMERA, replace(SHARP, engine=engine)).color
        np.testing.assert_allclose(picture[SIZE[1] // 2, SIZE[0] // 2], [1.0, 0.5, 0.0, 0.75], atol=4e-3)


@pytest.mark.parametrize("engine", ["pinhole", "accumulation", "lens"])
def test_opaque_surfaces_hide_the_splats_behind(renderer: FrameRenderer, engine: str) -> None:
    cloud = plain_cloud([[0, 0, -2.1], [0, 0, -1.9]], [[3, 3, 0.01]] * 2, [[2.0, 0, 0], [0, 0, 2.0]], [0.5, 0.25])
    settings = replace(SHARP, engine=engine)
    left, right = beside(renderer.render(scene_of(cloud, batches=(wall(2.0, 0.5),)), CAMERA, settings).color)
    np.testing.assert_allclose(left, [0.375, 0.375, 0.875, 1.0], atol=5e-3)
    np.testing.assert_allclose(right, [0.75, 0.0, 0.5, 0.625], atol=5e-3)


@pytest.mark.parametrize("engine", ["pinhole", "accumulation"])
def test_splats_are_seen_through_panes_and_before_them(renderer: FrameRenderer, engine: str) -> None:
    cloud = plain_cloud([[0, 0, -4.0], [0, 0, -1.5]], [[5, 5, 0.01]] * 2, [[2.0, 0, 0], [0, 0, 2.0]], [0.5, 0.5])
    scene = scene_of(cloud, batches=(wall(2.0, 1.0, opacity=0.5), wall(6.0, 1.0)))
    left, right = beside(renderer.render(scene, CAMERA, replace(SHARP, engine=engine)).color)
    np.testing.assert_allclose(left, [0.25 + 0.25 + 0.125, 0.25 + 0.125, 1.0 + 0.25 + 0.125, 1.0], atol=5e-3)
    np.testing.assert_allclose(right, [0.5, 0.0, 1.0, 0.75], atol=5e-3)


def test_instances_stand_at_their_poses(renderer: FrameRenderer) -> None:
    cloud = plain_cloud([[0, 0, 0]], [[0.05] * 3], [[1, 1, 1]], [0.9])
    poses = [np.eye(4), np.eye(4)]
    for pose, x in zip(poses, (-0.3, 0.4), strict=True):
        pose[:3, 3] = x, 0, -2
    alpha = renderer.render(scene_of(cloud, *poses), CAMERA, SHARP).color[SIZE[1] // 2, :, 3]
    peaks = [i for i in range(1, SIZE[0] - 1) if alpha[i] > 0.5 and alpha[i] >= max(alpha[i - 1], alpha[i + 1])]
    expected = [VIEW.cx + VIEW.fx * x / 2 - 0.5 for x in (-0.3, 0.4)]
    assert min(abs(p - expected[0]) for p in peaks) <= 1
    assert min(abs(p - expected[1]) for p in peaks) <= 1


def test_a_captured_set_through_a_lens_is_that_of_the_reference(renderer: FrameRenderer) -> None:
    """200,000 splats, near ones out of focus and far ones in it, by the same points of the pupil."""
    scene = scene_of(captured_set(200_000))
    camera = replace(CAMERA, focal_length_mm=35, f_stop=0.2, focus_distance_m=5.0)
    settings = FrameSettings(*SIZE, rays=6, tiled=False, supersample=2)
    reference = renderer.render(scene, camera, replace(settings, engine="accumulation")).color
    assert psnr_db(renderer.render(scene, camera, settings).color, reference) >= 42
    assert psnr_db(renderer.render(scene, replace(camera, f_stop=0.0), settings).color, reference) < 36


@pytest.mark.parametrize("focus_m", [1.7, 9.0])
def test_other_focus_distances_are_as_good(renderer: FrameRenderer, focus_m: float) -> None:
    scene = scene_of(captured_set(10_000))
    camera = replace(CAMERA, focal_length_mm=35, f_stop=0.15, focus_distance_m=focus_m)
    settings = FrameSettings(*SIZE, rays=16, tiled=False, supersample=2)
    reference = renderer.render(scene, camera, replace(settings, engine="accumulation")).color
    assert psnr_db(renderer.render(scene, camera, settings).color, reference) >= 40


def test_glass_blurs_splats_that_are_out_of_focus(renderer: FrameRenderer) -> None:
    """The same light over a larger circle."""
    camera = replace(camera_of(PLANAR), focus_distance_m=4.0, horizontal_aperture_mm=8.0, vertical_aperture_mm=16 / 3)
    peaks, sums = [], []
    for depth_m in (4.0, 1.5):
        cloud = plain_cloud([[0, 0, -depth_m]], [[0.0005 * depth_m] * 3], [[1, 1, 1]], [0.9])
        alpha = renderer.render(scene_of(cloud), camera, replace(SHARP, engine="lens", rays=64)).color[..., 3]
        peaks.append(alpha.max())
        sums.append(alpha.sum())
    assert peaks[0] > 6 * peaks[1]
    assert sums[1] == pytest.approx(sums[0], rel=0.1)


def test_tiles_do_not_change_the_pixels(renderer: FrameRenderer) -> None:
    scene = scene_of(captured_set(2_000), batches=(wall(2.5, 0.5),))
    camera = replace(CAMERA, f_stop=1.4)
    settings = FrameSettings(*SIZE, rays=16, shading="unlit")
    whole = renderer.render(scene, camera, settings).color
    tracer, budget = renderer.device.tracer, renderer.device.tracer.budget
    tracer.budget = LayerBudget(1 << 20)
    try:
        tiled = renderer.render(scene, camera, settings).color
    finally:
        tracer.budget = budget
    np.testing.assert_allclose(tiled, whole, atol=2e-3)


def test_swept_pictures_show_splats(renderer: FrameRenderer) -> None:
    scene = scene_of(captured_set(2_000), batches=(wall(2.5, 0.5),))
    settings = FrameSettings(*SIZE, rays=16, shading="unlit", motion=2, motion_by="velocities")
    moments = [Moment(scene, CAMERA, 0.5)] * 2
    swept = renderer.render_swept(ShutterScenes(scene, scene, scene), CAMERA, moments, settings).color
    still = renderer.render(scene, CAMERA, replace(settings, motion=1, supersample=2)).color
    assert psnr_db(swept, still) > 40


def test_previews_show_splats(renderer: FrameRenderer) -> None:
    scene, camera = scene_of(captured_set(2_000), batches=(wall(2.5, 0.5),)), replace(CAMERA, f_stop=1.4)
    settings = FrameSettings(*SIZE, rays=16, shading="unlit")
    picture = renderer.render(scene, camera, settings).color
    previewer, peeler = renderer.device.previewer, renderer.device.peeler
    with renderer.on_device():
        peeled, view = previewer.peel(peeler, camera, VIEW, unlit=True, sketch="never")
        preview = previewer.trace(peeler, peeled, camera, view, make_ray_pattern(16, camera.iris), 1)
    assert psnr_db(preview, picture) > 30


def test_a_click_gives_the_depth_where_splats_hide_half(renderer: FrameRenderer) -> None:
    depths, opacities = [1.5, 2.0, 3.0], [0.3, 0.4, 0.9]  # 0.7, 0.42 and 0.04 let through
    cloud = plain_cloud([[0, 0, -z] for z in depths], [[1, 1, 0.01]] * 3, [[1, 1, 1]] * 3, opacities)
    middle = SIZE[0] / 2, SIZE[1] / 2
    picked = renderer.pick(scene_of(cloud), CAMERA, *SIZE, *middle)
    assert picked is not None
    assert picked.depth_m == pytest.approx(2.0)
    np.testing.assert_allclose(picked.position_m, [0, 0, -2], atol=1e-6)
    left = middle[0] - 4, middle[1]
    for behind_m, expected in ((1.7, 1.7), (2.5, 2.0)):
        found = renderer.pick(scene_of(cloud, batches=(wall(behind_m, 0.5),)), CAMERA, *SIZE, *left)
        assert found is not None
        assert found.depth_m == pytest.approx(expected, rel=1e-3)
    thin = scene_of(plain_cloud([[0, 0, -2]], [[1, 1, 0.01]], [[1, 1, 1]], [0.4]))
    assert renderer.pick(thin, CAMERA, *SIZE, *middle) is None


def test_engines_that_cannot_show_splats_say_so(renderer: FrameRenderer) -> None:
    scene = scene_of(captured_set(10))

    class Bare(Engine):
        name, summary = "bare", "shows surfaces alone"

    register(Bare)
    try:
        with pytest.raises(SettingsError, match="shows no Gaussian splats"):
            renderer.render(scene, CAMERA, replace(SHARP, engine="bare"))
    finally:
        unregister(Bare)
    with pytest.raises(SettingsError, match="deep picture"):
        renderer.render(scene, CAMERA, replace(SHARP, engine="lens", deep=True))


def test_a_view_without_splats_draws_none(renderer: FrameRenderer) -> None:
    behind = scene_of(plain_cloud([[0, 0, 5.0]], [[0.1] * 3], [[1, 1, 1]], [0.9]))
    for engine in ("lens", "accumulation"):
        assert not renderer.render(behind, CAMERA, replace(SHARP, engine=engine)).color.any()
    assert not renderer.render(Scene((), (), behind.dome), CAMERA, SHARP).color.any()
