"""Scattered pictures beside the lens tracer's: the same spots, and the same errors of the lens over the picture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.gl.shaders import ProgramCache
from render.lab.reference.metrics import psnr_db
from render.lab.reference.scenes import posts_before_wall, spheres_over_checkerboard
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.data_sheet import DataSheet
from render.model.lens import IrisShape, Lens, SeidelErrors
from render.model.scene import Scene
from render.optics.thin_lens import pupil_radius_m
from render.optics.view import PinholeView
from render.pictures.image_space import ImageSpace
from render.postblur import spot_cache
from render.postblur.scatter_axis import ROUNDED_PUPIL, ROUNDED_PX, ExactSpot, SymmetricSpot, make_axis_spot
from render.trace.axis_rays import LensErrors
from render.trace.bundles import BundleMaker
from render.trace.rays import make_ray_pattern
from tests.render.kits.lens_pictures import (
    SHEET_SETTINGS,
    SOFT_SHEET,
    WHITE,
    camera_of,
    glowing_point,
    sheet_camera,
    spot_size,
)
from tests.render.kits.lenses import DOUBLE_GAUSS, PLANAR, TELEPHOTO

SMALL = FrameSettings(160, 120, rays=512, supersample=2, tiled=False, connections=False)


def both(renderer: FrameRenderer, camera: Camera, depth_m: float) -> tuple[FloatArray, FloatArray]:
    """``(h, w, 1)`` a small light on the axis, by rays and scattered."""
    scene = glowing_point(0, 0, depth_m, 0.006 * depth_m)
    rays, scattered = (
        renderer.render(scene, camera, replace(SMALL, engine=engine)).color[..., 1:2] for engine in ("lens", "scatter")
    )
    return rays, scattered


def assert_alike(rays: FloatArray, scattered: FloatArray, correlation: float = 0.995) -> None:
    assert np.corrcoef(rays.ravel(), scattered.ravel())[0, 1] > correlation
    np.testing.assert_allclose(spot_size(scattered, 0), spot_size(rays, 0), rtol=0.03)
    assert scattered.sum() == pytest.approx(rays.sum(), rel=0.04)


@pytest.mark.parametrize("depth_m", [1.6, 3.4, 30.0])
@pytest.mark.parametrize("w040", [40.0, -40.0])
def test_spherical_aberration_is_the_ray_tables(renderer: FrameRenderer, depth_m: float, w040: float) -> None:
    """Before the focus, about in it and behind: soft where the rays are soft, a bright rim where they have one."""
    lens = Lens("seidel", seidel=SeidelErrors(w040=w040, reference_f_stop=1.0))
    camera = Camera(np.eye(4), 50.0, 16.0, 12.0, f_stop=1.0, focus_distance_m=3.0, near_m=0.1, lens=lens)
    assert_alike(*both(renderer, camera, depth_m))


@pytest.mark.parametrize("depth_m", [1.6, 30.0])
@pytest.mark.parametrize("known", [DOUBLE_GAUSS, PLANAR, TELEPHOTO], ids=lambda known: known.prescription.name)
def test_glass_draws_its_own_spots(renderer: FrameRenderer, known: object, depth_m: float) -> None:
    assert_alike(*both(renderer, replace(camera_of(known), focus_distance_m=3.0), depth_m))  # type: ignore[arg-type]


@pytest.mark.parametrize("depth_m", [1.6, 30.0])
@pytest.mark.parametrize(
    "iris",
    [IrisShape(blades=3, rotation_rad=0.2), IrisShape(mask=np.tri(8)), IrisShape(radial_weights=(0.1, 0.1, 1.0))],
    ids=["blades", "mask", "ring"],
)
def test_an_iris_stands_as_the_lens_has_it(renderer: FrameRenderer, iris: IrisShape, depth_m: float) -> None:
    camera = Camera(np.eye(4), 50.0, 16.0, 12.0, f_stop=0.2, focus_distance_m=3.0, near_m=0.1, iris=iris)
    rays, scattered = both(renderer, camera, depth_m)
    assert_alike(rays, scattered, 0.98)
    if not iris.radial_weights:
        assert np.corrcoef(rays.ravel(), scattered[::-1, ::-1].ravel())[0, 1] < 0.93


def through_the_sheet(
    renderer: FrameRenderer, scene: Scene, sheet: DataSheet, **changes: int
) -> tuple[FloatArray, FloatArray]:
    """A scene through a lens by its data sheet: by rays, and scattered and then bent, blurred and darkened."""
    camera, settings = sheet_camera(sheet), replace(SHEET_SETTINGS, **({"rays": 64} | changes))
    space = ImageSpace.for_camera(camera, replace(settings, engine="scatter"))
    assert space.errors is not None
    wide = renderer.render(scene, space.widen_camera(camera), space.settings)
    return renderer.render(scene, camera, settings).color, space.apply(renderer, wide).color


ONE_BY_ONE = {
    "distortion": DataSheet(SOFT_SHEET.heights_mm, distortion=SOFT_SHEET.distortion),
    "vignetting": DataSheet(SOFT_SHEET.heights_mm, light=SOFT_SHEET.light),
    "astigmatism": DataSheet(
        SOFT_SHEET.heights_mm,
        sagittal_blur_mm=(0.02, 0.1, 0.15, 0.2),
        tangential_blur_mm=(0.02, 0.2, 0.3, 0.4),
        f_stop=2.8,
    ),
    "spherical": DataSheet((0.0, 20.0), (), (), (0.2, 0.2), (0.2, 0.2), (0.8, 0.8), f_stop=2.8),
    "all": SOFT_SHEET,
}


@pytest.mark.parametrize("kind", ONE_BY_ONE)
def test_each_error_of_a_data_sheet_is_drawn(renderer: FrameRenderer, kind: str) -> None:
    """In the plane of focus, where both forms of a sheet say the same."""
    for slope in (0.0, 0.27) if kind == "all" else (0.27,):
        rays, scattered = through_the_sheet(renderer, glowing_point(slope, 0.3 * slope, 4, 0.016), ONE_BY_ONE[kind])
        for channel in range(3):
            np.testing.assert_allclose(spot_size(scattered, channel)[:2], spot_size(rays, channel)[:2], atol=0.25)
            np.testing.assert_allclose(spot_size(scattered, channel)[2:], spot_size(rays, channel)[2:], rtol=0.08)
            assert scattered[..., channel].sum() == pytest.approx(rays[..., channel].sum(), rel=0.08)


def test_a_white_field_is_as_dark_in_the_corners_as_the_sheet_says(renderer: FrameRenderer) -> None:
    rays, scattered = through_the_sheet(renderer, WHITE, ONE_BY_ONE["vignetting"], width=80, height=60)
    np.testing.assert_allclose(scattered[30, 40, :3], 1.0, atol=1e-3)
    np.testing.assert_allclose(scattered[..., 1], rays[..., 1], atol=0.02)


def test_out_of_focus_a_sheets_spherical_aberration_is_in_the_spot(renderer: FrameRenderer) -> None:
    """It is no blur laid over all: a rim stays bright, as by the rays."""
    scene = glowing_point(0, 0, 12.0, 0.05)
    rays, scattered = through_the_sheet(renderer, scene, ONE_BY_ONE["spherical"], width=160, height=120, rays=256)
    assert np.corrcoef(rays[..., 1].ravel(), scattered[..., 1].ravel())[0, 1] > 0.99


@pytest.mark.parametrize("made", [spheres_over_checkerboard, posts_before_wall])
def test_generated_scenes_look_alike(renderer: FrameRenderer, made: Callable[[], tuple[Scene, Camera]]) -> None:
    scene, camera = made()
    camera = replace(camera, f_stop=camera.f_stop / 4)
    settings = FrameSettings(200, 150, shading="unlit", rays=128)
    lens, scattered, sharp = (
        renderer.render(scene, camera, replace(settings, engine=engine)).color
        for engine in ("lens", "scatter", "pinhole")
    )
    assert psnr_db(lens, scattered) > 32
    assert psnr_db(lens, scattered) > psnr_db(lens, sharp) + 6


class Made:
    """Count of the things that the store makes."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
        self.count = 0
        plain = getattr(spot_cache, name)

        def counted(*arguments: object, **named: object) -> object:
            self.count += 1
            return plain(*arguments, **named)

        monkeypatch.setattr(spot_cache, name, counted)


SEIDEL = Lens("seidel", seidel=SeidelErrors(w040=40.0, reference_f_stop=1.0))


@pytest.mark.parametrize(("glass", "most"), [(False, 1), (True, 3)])
def test_a_pull_of_the_focus_keeps_its_spots(
    renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch, glass: bool, most: int
) -> None:
    """A sheet of errors says nothing of the distance; glass changes a little with it."""
    scene, _ = posts_before_wall()
    camera = camera_of(PLANAR) if glass else Camera(np.eye(4), 50.0, 16.0, 12.0, f_stop=1.0, near_m=0.1, lens=SEIDEL)
    settings = FrameSettings(240, 180, shading="unlit", engine="scatter", layers=2, supersample=1)
    spots, tables = Made(monkeypatch, "make_camera_spot"), Made(monkeypatch, "make_spot_tables")
    for distance_m in np.geomspace(2.0, 5.0, 6):
        renderer.render(scene, replace(camera, focus_distance_m=float(distance_m)), settings)
    assert 0 < spots.count <= most
    assert tables.count <= 8 * most


@pytest.mark.parametrize("known", [DOUBLE_GAUSS, PLANAR, TELEPHOTO], ids=lambda known: known.prescription.name)
def test_rounding_moves_rays_by_no_more_than_it_says(renderer: FrameRenderer, known: object) -> None:
    camera = replace(camera_of(known), focus_distance_m=3.3)  # type: ignore[arg-type]
    focal_px = 960 * camera.focal_length_mm / 36
    view = PinholeView(960, 540, focal_px, focal_px, 480, 270, 0.1, 1000, np.eye(4))
    ctx = renderer.graphics.ctx
    table = BundleMaker(ctx, ProgramCache(ctx)).make_bundle(camera, view, make_ray_pattern(1, IrisShape()), 1).table
    assert table is not None
    errors = LensErrors(table, pupil_radius_m(camera), focal_px)
    rounded, exact = make_axis_spot(errors), ExactSpot(errors)
    assert isinstance(rounded, SymmetricSpot)
    stops = np.stack(np.meshgrid(*[np.linspace(-1, 1, 41)] * 2), axis=-1).reshape(-1, 2)
    stops = stops[np.hypot(*stops.T) < 0.98 * min(rounded.opened) / 256]
    for one, other, most in zip(rounded.rays(stops), exact.rays(stops), (ROUNDED_PUPIL, ROUNDED_PX), strict=True):
        assert np.hypot(*(one - other).T).max() < most
