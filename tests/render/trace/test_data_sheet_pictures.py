"""Pictures through lenses by data sheet: light lands in them as the tables say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db
from render.lab.reference.scenes import spheres_over_checkerboard
from render.model.data_sheet import DataSheet
from render.model.lens import IrisShape, Lens
from render.optics.data_sheet import at_heights, open_pupil, sheet_errors
from render.optics.view import PinholeView
from render.trace.rays import make_ray_pattern
from tests.render.kits.lens_pictures import SHEET_SETTINGS, SOFT_SHEET, WHITE, glowing_point, sheet_camera, spot_size

PX_MM = 0.1


@pytest.mark.parametrize("height_mm", [0.0, 8.0, 13.0])
def test_a_point_lands_where_and_as_wide_as_the_sheet_says(renderer: FrameRenderer, height_mm: float) -> None:
    heights, half_m = np.array([height_mm]), 0.016
    errors = sheet_errors(SOFT_SHEET, heights, focal_length_mm=50, f_stop=2.8)
    scene = glowing_point(float(errors.seen[0]), 0, 4, half_m)
    picture = renderer.render(scene, sheet_camera(SOFT_SHEET), SHEET_SETTINGS).color
    found = [spot_size(picture, channel) for channel in range(3)]
    square = half_m / 4 * 50 / np.sqrt(3)
    wanted = np.hypot(errors.spread_mm(510.0)[0], square)
    got = np.array(found[1][2:]) * PX_MM
    np.testing.assert_allclose(got, wanted, rtol=0.04)  # tables change over the width of a spot
    red, blue = ((found[channel][0] - found[1][0]) * PX_MM for channel in (0, 2))
    lateral = at_heights(SOFT_SHEET, "lateral_color_mm", heights)[0]
    assert red - blue == pytest.approx(lateral, rel=0.06, abs=0.002)
    flare = at_heights(SOFT_SHEET, "coma_mm", heights)[0] / 3  # its centre of light, where the iris is not clipped much
    middle = (found[1][0] - 160) * PX_MM - (510 - 562.5) / 175 * lateral
    assert middle == pytest.approx(height_mm + flare, abs=0.02 if height_mm < 10 else 0.05)


def test_a_white_field_has_the_sheets_light(renderer: FrameRenderer) -> None:
    picture = renderer.render(WHITE, sheet_camera(SOFT_SHEET), replace(SHEET_SETTINGS, rays=64, adaptive=False)).color
    y, x = np.mgrid[:240, :320] + 0.5
    wanted = at_heights(SOFT_SHEET, "light", np.hypot(x - 160, y - 120).ravel() * PX_MM).reshape(240, 320)
    np.testing.assert_allclose(picture[..., 1], wanted, atol=0.006)
    assert np.ptp(picture[..., :3], axis=-1).max() < 0.002


def test_adaptive_rays_lose_no_light_towards_the_corners(renderer: FrameRenderer) -> None:
    """Passes of few rays, all of which the lens may block, count as much as others."""
    picture = renderer.render(WHITE, sheet_camera(SOFT_SHEET), replace(SHEET_SETTINGS, rays=64)).color
    exact = renderer.render(WHITE, sheet_camera(SOFT_SHEET), replace(SHEET_SETTINGS, rays=64, adaptive=False)).color
    np.testing.assert_allclose(picture[..., 1], exact[..., 1], atol=0.006)


def test_cats_eyes_stand_in_the_corner_and_open_with_the_iris_closed(renderer: FrameRenderer) -> None:
    """Out of focus, a point is as wide across the radius and narrower along it."""
    sheet = DataSheet((0.0, 8.0, 20.0), light=(1.0, 0.9, 0.3), f_stop=2.8)
    scene, shapes = glowing_point(0.26, 0, 20, 0.03), []
    for f_stop in (2.8, 8.0):
        camera = sheet_camera(sheet, f_stop=f_stop, focus_distance_m=0.5)
        _, _, along, across = spot_size(renderer.render(scene, camera, replace(SHEET_SETTINGS, rays=512)).color)
        shapes.append(along / across)
    rim = sheet_errors(sheet, np.array([13.0]), focal_length_mm=50, f_stop=2.8).rim_offset
    points, weights = open_pupil(1.0, rim, 1.0)
    along, across = np.sqrt((weights[0, :, None] * points[0] ** 2).sum(axis=0))
    assert shapes[0] == pytest.approx(along / across, rel=0.03)
    assert along / across < 0.9
    assert shapes[1] == pytest.approx(1, abs=0.03)


@pytest.mark.parametrize("iris", [IrisShape(), IrisShape(blades=6)])
def test_both_ways_to_bound_a_footprint_give_the_same_picture(renderer: FrameRenderer, iris: IrisShape) -> None:
    scene, camera = spheres_over_checkerboard()
    camera = replace(sheet_camera(SOFT_SHEET), world_from_camera=camera.world_from_camera, near_m=camera.near_m)
    camera = replace(camera, focus_distance_m=3.0)
    view = PinholeView.from_camera(camera, 160, 120)
    renderer.render(scene, camera, FrameSettings(160, 120, rays=1))  # loads the scene
    pictures = [
        renderer.device.tracer.picture(
            renderer.device.peeler,
            camera,
            view,
            make_ray_pattern(32, iris),
            layers=4,
            supersample=2,
            bound_by_rays=by_rays,
        ).color
        for by_rays in (False, True)
    ]
    assert psnr_db(*pictures) > 50


def test_a_sheet_without_tables_is_the_thin_lens(renderer: FrameRenderer) -> None:
    scene, camera = spheres_over_checkerboard()
    camera = replace(camera, f_stop=2.0)
    thin = renderer.render(scene, camera, FrameSettings(160, 120, rays=64)).color
    empty = replace(camera, lens=Lens("dataSheet", data_sheet=DataSheet((0.0,))))
    assert psnr_db(renderer.render(scene, empty, FrameSettings(160, 120, rays=64)).color, thin) > 38
