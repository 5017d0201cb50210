"""Gaussian splats in the engines that blur one picture, against the lens engine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db
from render.lab.reference.scenes import rectangle
from render.model.scene import Batch, Material
from render.optics.view import PinholeView
from tests.render.kits.splats import CAMERA, SIZE, captured_set, plain_cloud, scene_of

pytestmark = pytest.mark.gl

SETTINGS = FrameSettings(*SIZE, rays=32, shading="unlit")
OPEN = replace(CAMERA, focal_length_mm=35, f_stop=0.1, focus_distance_m=2.5)
ENGINES = ("flag", "scatter", "gather", "linear", "importance")


def wall(depth_m: float) -> Batch:
    """A wall across the left half of the view."""
    quad = rectangle((-5.0, 0, -depth_m), (5.0, 0, 0), (0, 5.0, 0))
    return Batch(quad, Material(base_color=(0.5,) * 3), np.eye(4)[None])


@pytest.mark.parametrize("engine", ENGINES)
def test_splats_are_blurred_as_by_the_lens(renderer: FrameRenderer, engine: str) -> None:
    """A captured set around a wall, in front of the focus and behind it."""
    scene = scene_of(captured_set(3_000), batches=(wall(3.0),))
    reference = renderer.render(scene, OPEN, SETTINGS).color[..., :3]
    picture = renderer.render(scene, OPEN, replace(SETTINGS, engine=engine)).color[..., :3]
    sharp = renderer.render(scene, OPEN, replace(SETTINGS, engine="pinhole")).color[..., :3]
    assert psnr_db(picture, reference) > 31
    assert psnr_db(sharp, reference) < 26


@pytest.mark.parametrize("depth_m", [1.2, 6.0])
def test_a_splat_out_of_focus_keeps_most_of_its_light(renderer: FrameRenderer, depth_m: float) -> None:
    cloud = plain_cloud([[0, 0, -depth_m]], [[0.01 * depth_m] * 3], [[1, 0.5, 0.25]], [0.9])
    sharp, blurred = (
        renderer.render(scene_of(cloud), camera, replace(SETTINGS, engine="flag")).color[..., :3]
        for camera in (replace(OPEN, f_stop=0.0), OPEN)
    )
    np.testing.assert_allclose(blurred.sum(axis=(0, 1)), sharp.sum(axis=(0, 1)), rtol=0.2)
    assert blurred.max() < 0.5 * sharp.max()


def test_opaque_surfaces_hide_what_is_behind(renderer: FrameRenderer) -> None:
    cloud = plain_cloud([[0, 0, -2.6], [0, 0, -2.4]], [[6, 6, 0.01]] * 2, [[2.0, 0, 0], [0, 0, 2.0]], [0.5, 0.25])
    picture = renderer.render(scene_of(cloud, batches=(wall(2.5),)), OPEN, replace(SETTINGS, engine="flag")).color
    y, x = SIZE[1] // 2, SIZE[0] // 2
    np.testing.assert_allclose(picture[y, x - 12, :3], [0.375, 0.375, 0.875], atol=0.01)
    np.testing.assert_allclose(picture[y, x + 12, :3], [0.75, 0.0, 0.5], atol=0.01)


def test_blurred_previews_show_splats(renderer: FrameRenderer) -> None:
    scene = scene_of(captured_set(2_000), batches=(wall(3.0),))
    picture = renderer.render(scene, OPEN, replace(SETTINGS, engine="flag")).color[..., :3]
    previewer, peeler = renderer.device.previewer, renderer.device.peeler
    view = PinholeView.from_camera(OPEN, *SIZE)
    with renderer.on_device():
        peeled, view = previewer.peel(peeler, OPEN, view, unlit=True, sketch="never")
        preview = previewer.blur(peeler, peeled, OPEN, view)[..., :3]
    assert psnr_db(preview, picture) > 33
