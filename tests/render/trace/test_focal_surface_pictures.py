"""The focal surface in pictures: what the device makes of it, tilted planes and surfaces that no lens has."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.focus.surface import focused_at
from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db, ssim
from render.lab.reference.ray_by_ray import ray_by_ray_picture
from render.lab.reference.scenes import posts_before_wall, spheres_over_checkerboard
from render.model.focal_surface import Controls, FocalPlane, FocalSurface, HalfLens
from render.optics.view import PinholeView
from render.trace.focal_map import FocalMaps
from render.trace.picture_focus import picture_focus

SCENE, CAMERA = spheres_over_checkerboard()
RANDOM = np.random.default_rng(4)
POINTS = Controls(
    RANDOM.uniform(-0.3, 0.3, (12, 2)),
    np.stack([RANDOM.uniform(0.05, 0.6, 12), RANDOM.uniform(-1, 1, 12)], axis=1),
    RANDOM.uniform(0, 2, 12),
    np.where(RANDOM.random(12) < 0.5, 0.0, 0.25),
    3.0,
)
BENDS = Controls(np.array([[0.0, 0.0], [0.3, 0.2]]), np.array([[0.0], [0.08]]), np.ones(2), np.zeros(2), 2.0)
HALVES = (HalfLens((0.6, 0.8), 0.1, 0.05, 0.5), HalfLens((-1.0, 0.0), 0.2, 0.0, 0.2))


@pytest.mark.parametrize(
    "surface",
    [
        FocalSurface(FocalPlane(0.3, 0.1, -0.4), POINTS, 0.7),
        FocalSurface(FocalPlane(0.3), halves=HALVES),
        FocalSurface(FocalPlane(0.3, 0.2, 0.1), POINTS, 1.0, HALVES, BENDS),
    ],
    ids=["points", "halves", "all"],
)
def test_the_device_evaluates_the_same_surface(renderer: FrameRenderer, surface: FocalSurface) -> None:
    camera = replace(CAMERA, focal_surface=surface)
    view = PinholeView.from_camera(camera, 320, 240)
    renderer.graphics.make_current()
    maps = FocalMaps(renderer.graphics.ctx, renderer.device.tracer._tracer._programs)
    made = np.frombuffer(maps.draw(picture_focus(camera, view)).read(), np.float32).reshape(240, 320, 2)
    maps.release()
    x, y = np.meshgrid(np.arange(320) + 0.5, np.arange(240) + 0.5)
    w, pupil = focused_at(surface, np.stack([(x - view.cx) / view.fx, (view.cy - y) / view.fy], axis=-1))
    np.testing.assert_allclose(made[..., 0], w, rtol=2e-4, atol=2e-5)
    np.testing.assert_allclose(made[..., 1], pupil, rtol=5e-4)


def test_a_tilted_plane_against_the_accumulation_buffer(renderer: FrameRenderer) -> None:
    """The same shear that keeps an upright plane in place keeps a tilted one (Haeberli & Akeley 1990)."""
    w0 = 1 / CAMERA.focus_distance_m
    tilted = replace(CAMERA, focal_surface=FocalSurface(FocalPlane(w0, 0.2 * w0, -1.5 * w0)))
    settings = FrameSettings(640, 480, rays=48, tiled=False)
    traced = renderer.render(SCENE, tilted, settings).color
    reference = renderer.render(SCENE, tilted, replace(settings, engine="accumulation")).color
    assert psnr_db(traced, reference) >= 40
    assert ssim(traced, reference) >= 0.99
    upright = renderer.render(SCENE, CAMERA, settings).color
    assert psnr_db(upright, reference) < psnr_db(traced, reference) - 6  # and it is not the picture of an upright plane


def test_a_surface_that_is_no_plane_against_every_ray_on_its_own(renderer: FrameRenderer) -> None:
    scene, camera = posts_before_wall()
    nearest, far = 1 / 3.0, 1 / 12.0
    points = Controls(
        np.array([[-0.2, 0.0], [0.2, 0.05], [0.0, -0.1]]),
        np.array([[nearest, 0.0], [far, 0.7], [0.5 * (nearest + far), -0.4]]),
        np.ones(3),
        np.zeros(3),
        2.5,
    )
    camera = replace(camera, focal_surface=FocalSurface(FocalPlane(1 / 5.0), points))
    slow = ray_by_ray_picture(scene, camera, width=160, height=120, rays=64)
    settings = FrameSettings(160, 120, rays=64, layers=8, supersample=4, shading="unlit", tiled=False)
    assert psnr_db(renderer.render(scene, camera, settings).color, slow) >= 40


def test_what_is_measured_is_the_surface_that_is_traced(renderer: FrameRenderer) -> None:
    surface = FocalSurface(FocalPlane(0.3, 0.0, -0.3), POINTS, 0.5)
    camera = replace(CAMERA, focal_surface=surface)
    settings = FrameSettings(80, 60, rays=4, aovs=("color", "depth", "coc", "defocus", "focus_depth"))
    aovs = renderer.render(SCENE, camera, settings).aovs
    view = PinholeView.from_camera(camera, 80, 60)
    x, y = np.meshgrid(np.arange(80) + 0.5, np.arange(60) + 0.5)
    w_f, pupil = focused_at(surface, np.stack([(x - view.cx) / view.fx, (view.cy - y) / view.fy], axis=-1))
    np.testing.assert_allclose(aovs["focus_depth"], 1 / w_f, rtol=1e-5)
    there = np.isfinite(aovs["depth"])
    defocus = 1 / aovs["depth"][there].astype(np.float64) - w_f[there]
    np.testing.assert_allclose(aovs["defocus"][there], defocus, atol=1e-5)
    radius_m = camera.focal_length_mm / (2000 * camera.f_stop)
    np.testing.assert_allclose(aovs["coc"][there], -view.fx * radius_m * pupil[there] * defocus, atol=2e-3)


def test_the_accumulation_buffer_shows_planes_alone(renderer: FrameRenderer) -> None:
    camera = replace(CAMERA, focal_surface=FocalSurface(FocalPlane(0.3), POINTS))
    with pytest.raises(Exception, match="a plane of focus alone"):
        renderer.render(SCENE, camera, FrameSettings(16, 12, rays=4, engine="accumulation"))
