"""Errors of a lens put on a finished picture: closed forms, the shaders against numpy, and both against the rays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer
from render.gl.cancellation import Cancelled
from render.lab.reference.aberrate import aberrate
from render.lab.reference.metrics import psnr_db
from render.model.arrays import FloatArray
from render.model.data_sheet import DataSheet
from render.model.lens import AberrationScales
from render.model.moment import Moment
from render.model.scene import Dome, Scene
from render.optics.photometry.illuminance import light_over_picture
from render.optics.view import PinholeView
from render.pictures.image_space import ImageSpace, renders_in_image_space
from render.postblur.aberrate_passes import aberrate_on_device
from render.postblur.picture_errors import SIGMAS, PictureErrors, make_picture_errors
from tests.render.kits.lens_pictures import SHEET_SETTINGS, SOFT_SHEET, glowing_point, sheet_camera, spot_size

PX_MM = 0.1


def view_of(width: int, height: int) -> PinholeView:
    """0.1 mm a pixel, behind 50 mm."""
    gate = {"horizontal_aperture_mm": width * PX_MM, "vertical_aperture_mm": height * PX_MM}
    return PinholeView.from_camera(sheet_camera(DataSheet((0.0,)), **gate), width, height)


def errors_of(sheet: DataSheet, view: PinholeView, **kinds: object) -> PictureErrors:
    last = float(np.hypot(view.width, view.height)) * PX_MM / 2 / 50
    return make_picture_errors(sheet, AberrationScales(), focal_length_mm=50, f_stop=2.8, last_slope=last, **kinds)  # type: ignore[arg-type]


def point_at(view: PinholeView, x: int, y: int) -> FloatArray:
    picture = np.zeros((view.height, view.width, 4), np.float32)
    picture[y, x] = 100.0
    return picture


@pytest.mark.parametrize(("along_px", "across_px"), [(0.4, 0.2), (1.5, 3.0), (6.0, 1.0)])
def test_a_point_is_blurred_as_wide_as_the_sheet_says(along_px: float, across_px: float) -> None:
    view = view_of(641, 41)
    sheet = DataSheet(
        (0.0, 20.0), sagittal_blur_mm=(across_px * PX_MM,) * 2, tangential_blur_mm=(along_px * PX_MM,) * 2, f_stop=2.8
    )
    blurred = aberrate(point_at(view, 570, 20), view, errors_of(sheet, view))
    x, y, along, across = spot_size(blurred)
    np.testing.assert_allclose([along, across], [along_px, across_px], rtol=0.025)
    np.testing.assert_allclose([x, y], [570.5, 20.5], atol=0.15)
    assert blurred[..., 1].sum() == pytest.approx(100, rel=0.01)
    np.testing.assert_array_equal(blurred[..., 1], blurred[..., 3])  # coverage goes with green


def test_aslant_the_blur_is_as_wide() -> None:
    view = view_of(141, 141)
    sheet = DataSheet((0.0, 20.0), tangential_blur_mm=(0.4, 0.4), f_stop=2.8)
    light = aberrate(point_at(view, 105, 92), view, errors_of(sheet, view))[..., 1].astype(np.float64)
    y, x = np.mgrid[:141, :141] - np.array([92, 105])[:, None, None]
    outward = np.array([35, 22]) / np.hypot(35, 22)
    along, across = x * outward[0] + y * outward[1], y * outward[0] - x * outward[1]
    assert np.sqrt((along**2 * light).sum() / light.sum()) == pytest.approx(4, rel=0.03)
    assert np.sqrt((across**2 * light).sum() / light.sum()) < 0.5  # between two texels it is joined linearly


def test_distortion_lateral_colour_and_light_are_the_sheets() -> None:
    view = view_of(241, 41)
    sheet = DataSheet((0.0, 6.0, 20.0), (0.0, -0.05, -0.05), (1.0, 0.7, 0.7), lateral_color_mm=(0.0, 0.3, 0.3))
    ideal_px = 80 / 0.95  # what shall be seen 80 px off the axis
    ramp = np.zeros((41, 241, 4), np.float32)
    ramp[...] = (np.arange(241) - 120 - ideal_px)[None, :, None]
    seen = aberrate(ramp, view, errors_of(sheet, view))[20, 120 + 80] / 0.7
    assert seen[1] == pytest.approx((562.5 - 510) / 175 * 3 / 0.95, abs=0.02)  # green lies in a little
    assert seen[2] - seen[0] == pytest.approx(3 / 0.95, abs=0.02)  # red lies 3 px farther out than blue
    white = aberrate(np.ones((41, 241, 4), np.float32), view, errors_of(sheet, view))
    np.testing.assert_allclose(white[20, 190:, :3], 0.7, atol=1e-5)
    np.testing.assert_allclose(white[20, 120], 1.0, atol=1e-4)


def test_comas_flare_points_outward() -> None:
    view = view_of(561, 41)
    sheet = DataSheet((0.0, 6.0, 20.0), coma_mm=(0.0, 1.2, 1.2), f_stop=2.8)
    x, y, along, across = spot_size(aberrate(point_at(view, 545, 20), view, errors_of(sheet, view)))
    assert (x - 545.5, y - 20.5) == (pytest.approx(4, abs=0.15), pytest.approx(0, abs=0.05))
    assert (along, across) == (pytest.approx(4 * np.sqrt(1 / 2), rel=0.05), pytest.approx(4 * np.sqrt(1 / 6), rel=0.08))
    left = spot_size(aberrate(point_at(view, 15, 20), view, errors_of(sheet, view)))
    assert left[0] == pytest.approx(561 - x, abs=0.01)


@pytest.mark.parametrize("squeeze", [1.0, 2.0])
def test_the_shaders_do_what_numpy_does(renderer: FrameRenderer, squeeze: float) -> None:
    view = view_of(90, 70)
    picture = np.random.default_rng(4).uniform(0, 4, (70, 90, 4)).astype(np.float32)
    errors = errors_of(replace(SOFT_SHEET, heights_mm=(0.0, 2.0, 4.0, 6.0)), view, squeeze=squeeze)
    ours = aberrate_on_device(renderer.graphics.ctx, picture, view, errors)
    np.testing.assert_allclose(ours, aberrate(picture, view, errors), atol=2e-4)
    sharp = errors_of(DataSheet((0.0,)), view)
    np.testing.assert_allclose(aberrate_on_device(renderer.graphics.ctx, picture, view, sharp), picture, atol=2e-5)


def test_a_large_blur_can_be_cancelled(renderer: FrameRenderer) -> None:
    view = view_of(90, 70)
    picture = np.random.default_rng(4).uniform(0, 4, (70, 90, 4)).astype(np.float32)
    errors = errors_of(SOFT_SHEET, view)
    polls = 0

    def is_stale() -> bool:
        nonlocal polls
        polls += 1
        return polls == 10

    cancellation = renderer.graphics.cancellation
    with pytest.raises(Cancelled), cancellation.cancel_when(is_stale):
        aberrate_on_device(renderer.graphics.ctx, picture, view, errors, cancellation)
    assert polls == 10
    with cancellation.cancel_when(lambda: False):
        pieces = aberrate_on_device(renderer.graphics.ctx, picture, view, errors, cancellation)
    np.testing.assert_array_equal(pieces, aberrate_on_device(renderer.graphics.ctx, picture, view, errors))


@pytest.mark.parametrize("squeeze", [1.0, 0.5])
def test_a_blur_reaches_at_most_over_the_picture(renderer: FrameRenderer, squeeze: float) -> None:
    """Also by a sheet that asks for ten thousand pixels."""
    view = view_of(40, 30)
    sheet = DataSheet((0.0, 20.0), sagittal_blur_mm=(1e3,) * 2, tangential_blur_mm=(1e3,) * 2, f_stop=2.8)
    errors = errors_of(sheet, view, squeeze=squeeze)
    widest = np.hypot(errors.even, np.maximum(errors.along, errors.across)).max()
    assert SIGMAS * widest * max(view.fx / squeeze, view.fy) <= 1.001 * np.hypot(view.width, view.height)
    assert errors.margin(view) <= (view.width, view.height)
    picture = np.random.default_rng(4).uniform(0, 4, (30, 40, 4)).astype(np.float32)
    ours = aberrate_on_device(renderer.graphics.ctx, picture, view, errors)
    np.testing.assert_allclose(ours, aberrate(picture, view, errors), atol=2e-4)
    assert ours.std() < 0.2 * picture.std()


def test_a_flat_chart_looks_as_through_the_rays(renderer: FrameRenderer) -> None:
    """In the plane of focus both forms of a data sheet say the same: where light is, how wide, and how much of it."""
    camera = sheet_camera(SOFT_SHEET)
    for slope in (0.0, 0.27):
        scene = glowing_point(slope, 0.3 * slope, 4, 0.016)
        rays = renderer.render(scene, camera, replace(SHEET_SETTINGS, rays=128)).color
        space = ImageSpace.for_camera(camera, replace(SHEET_SETTINGS, engine="pinhole", rays=16))
        wide = renderer.render(scene, space.widen_camera(camera), space.settings)
        picture = space.apply(renderer, wide).color
        assert picture.shape == rays.shape
        for channel in range(3):
            np.testing.assert_allclose(spot_size(picture, channel)[:2], spot_size(rays, channel)[:2], atol=0.25)
            np.testing.assert_allclose(spot_size(picture, channel)[2:], spot_size(rays, channel)[2:], rtol=0.08)
            assert picture[..., channel].sum() == pytest.approx(rays[..., channel].sum(), rel=0.08)


def test_nothing_is_missing_at_the_edge_of_a_bent_picture(renderer: FrameRenderer) -> None:
    """The surround that barrel distortion draws into the frame is rendered, and measured AOVs keep their size."""
    camera, scene = sheet_camera(SOFT_SHEET), glowing_point(0.0, 0.0, 4, 3.0)  # a chart that fills more than the frame
    settings = replace(
        SHEET_SETTINGS, engine="pinhole", rays=4, width=96, height=72, aovs=("color", "depth", "prim_id")
    )
    space = ImageSpace.for_camera(camera, settings)
    frame = space.apply(renderer, renderer.render(scene, space.widen_camera(camera), space.settings))
    assert frame.color.shape == (72, 96, 4)
    assert {name: aov.shape for name, aov in frame.aovs.items()} == {"depth": (72, 96), "prim_id": (72, 96)}
    np.testing.assert_allclose(frame.color[..., 3], 1.0, atol=1e-4)
    np.testing.assert_allclose(frame.aovs["depth"], 4.0, rtol=1e-3)
    light = frame.color[..., 1] / 3000
    assert light[36, 48] == pytest.approx(1, rel=0.01)
    assert light[0, 0] == pytest.approx(0.4, abs=0.02)


def test_other_lenses_and_engines_are_left_as_they_are(renderer: FrameRenderer) -> None:
    camera, settings = sheet_camera(SOFT_SHEET), replace(SHEET_SETTINGS, width=64, height=48, rays=4)
    assert not renders_in_image_space(camera, settings)
    assert renders_in_image_space(camera, replace(settings, engine="pinhole"))
    assert not renders_in_image_space(replace(camera, f_stop=0.0), replace(settings, engine="pinhole"))
    space = ImageSpace.for_camera(camera, settings)
    assert (space.settings, space.widen_camera(camera)) == (settings, camera)
    frame = renderer.render(glowing_point(0, 0, 4), camera, settings)
    assert space.apply(renderer, frame) is frame


def test_both_forms_of_a_shot_look_alike(renderer: FrameRenderer) -> None:
    """Not alike out of focus, where the picture has no depth to blur by: so all of it is in focus."""
    checks = glowing_point(0, 0, 4, 0.3)
    camera = sheet_camera(replace(SOFT_SHEET, tangential_blur_mm=(0.15, 0.15, 0.15, 0.15), coma_mm=()))
    settings = replace(SHEET_SETTINGS, width=160, height=120, rays=128)
    rays = renderer.render(checks, camera, settings).color / 3000
    space = ImageSpace.for_camera(camera, replace(settings, engine="pinhole", rays=16))
    picture = space.apply(renderer, renderer.render(checks, space.widen_camera(camera), space.settings)).color / 3000
    assert psnr_db(picture, rays) > 34


@pytest.mark.parametrize("shape", [(1, 1, 1), (48, 1, 1), (1, 64, 1)])
def test_a_travelling_shutter_is_open_around_the_frame_as_at_its_edge(shape: tuple[int, int, int]) -> None:
    camera, settings = sheet_camera(SOFT_SHEET), replace(SHEET_SETTINGS, width=64, height=48, engine="pinhole")
    share = np.linspace(0, 1, shape[0] * shape[1], dtype=np.float32).reshape(shape)
    space = ImageSpace.for_camera(camera, settings)
    nothing = Scene((), (), Dome((0, 0, 0), np.eye(4)), ())
    wide = space.widen_moment(Moment(nothing, camera, share))
    (across, up), told = space.margin, np.asarray(wide.share)
    assert told.shape == (shape[0] + 2 * up * (shape[0] > 1), shape[1] + 2 * across * (shape[1] > 1), 1)
    assert (told.min(), told.max()) == (share.min(), share.max())
    assert wide.camera.horizontal_aperture_mm == pytest.approx(32 * (64 + 2 * across) / 64)


def test_light_that_the_tables_take_is_not_taken_again() -> None:
    camera = sheet_camera(SOFT_SHEET)
    camera = replace(camera, lens=replace(camera.lens, natural_vignetting=True))
    assert light_over_picture(camera, 64, 48, is_pinhole=True) is None
    bare = replace(camera, lens=replace(camera.lens, data_sheet=DataSheet((0.0,))))
    assert light_over_picture(bare, 64, 48, is_pinhole=True) is not None
    assert light_over_picture(replace(camera, f_stop=0.0), 64, 48, is_pinhole=True) is not None
