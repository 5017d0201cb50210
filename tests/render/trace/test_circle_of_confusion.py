"""The thin lens against closed forms: a point light's blur has the radius that geometry gives it.

For a uniform disc of radius c the mean squared distance from its centre is c²/2, so c is measured from the picture's second
moment, less what the light's own size and the pixel's box add. The bound is 1 % or half a pixel, whichever is larger.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import point_light
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.lens import IrisShape
from render.optics.thin_lens import coc_radius_px

WIDTH_PX = 160
RADII_PX = (4.0, 10.0, 20.0, 40.0, 60.0)
"""Each case gets the film gate on which its blur has one of these radii, so that small and large blurs are measured alike."""

# focal length mm, f-number, focus m, depth m: ten in front of the plane of focus and ten behind it
CASES = [
    (24, 1.4, 2.0, 1.0),
    (24, 1.4, 1.0, 6.0),
    (28, 2.0, 4.0, 0.6),
    (28, 1.2, 0.7, 30.0),
    (35, 1.4, 3.0, 1.2),
    (35, 1.4, 1.5, 8.0),
    (35, 2.8, 2.0, 0.7),
    (40, 2.0, 0.9, 100.0),
    (50, 1.2, 4.0, 2.0),
    (50, 1.4, 2.0, 12.0),
    (50, 2.0, 3.0, 1.2),
    (50, 4.0, 0.8, 50.0),
    (65, 1.8, 5.0, 2.5),
    (65, 2.0, 2.5, 20.0),
    (75, 1.5, 8.0, 4.0),
    (75, 2.8, 2.0, 9.0),
    (100, 2.0, 10.0, 4.0),
    (100, 2.8, 3.0, 40.0),
    (135, 2.0, 20.0, 8.0),
    (135, 4.0, 4.0, 200.0),
]


def test_the_cases_stand_on_both_sides_of_the_focus() -> None:
    assert len(CASES) == 20
    assert sum(depth < focus for _, _, focus, depth in CASES) == 10


def measured_radius_px(picture: FloatArray, source_half_px: float) -> float:
    luminance = picture[..., 1].astype(np.float64)
    y, x = (np.indices(luminance.shape) + 0.5 - np.array(luminance.shape)[:, None, None] / 2).astype(np.float64)
    moment = float((luminance * (x * x + y * y)).sum() / luminance.sum())
    return float(np.sqrt(2 * max(moment - 2 * source_half_px**2 / 3 - 1 / 6, 0.0)))


def closed_form_radius_mm(focal_mm: float, f_number: float, focus_m: float, depth_m: float) -> float:
    """Potmesil & Chakravarty 1981, eq. 8, with the image scaled to the field of view that ``focalLength`` asks for."""
    f, d, x = focal_mm / 1000, focus_m, depth_m
    image_distance = f * d / (d - f)
    diameter_m = f / f_number * image_distance * abs(1 / d - 1 / x)
    return diameter_m / 2 * f / image_distance * 1000


@pytest.mark.parametrize("number", range(len(CASES)), ids=lambda i: "f{}_N{}_focus{}_at{}".format(*CASES[i]))
def test_the_blur_of_a_point_light(renderer: FrameRenderer, number: int) -> None:
    focal_mm, f_number, focus_m, depth_m = CASES[number]
    expected = RADII_PX[number % len(RADII_PX)]
    gate_mm = closed_form_radius_mm(*CASES[number]) * WIDTH_PX / expected
    camera = Camera(
        np.eye(4),
        focal_length_mm=focal_mm,
        horizontal_aperture_mm=gate_mm,
        vertical_aperture_mm=gate_mm,
        f_stop=f_number,
        focus_distance_m=focus_m,
        near_m=0.05,
    )
    half_px = 1.5
    f_px = focal_mm / gate_mm * WIDTH_PX
    scene = point_light(depth_m, half_px * depth_m / f_px)
    frame = renderer.render(scene, camera, FrameSettings(WIDTH_PX, WIDTH_PX, rays=512))
    assert measured_radius_px(frame.color, half_px) == pytest.approx(expected, rel=0.01, abs=0.5)
    shared = coc_radius_px(f_px, focal_mm / f_number / 2000, 1 / depth_m, 1 / focus_m)
    assert abs(shared) == pytest.approx(expected)
    assert np.sign(shared) == np.sign(depth_m - focus_m)


def test_the_light_of_a_blurred_point_is_all_there(renderer: FrameRenderer) -> None:
    """Blur moves light about and loses none: 0.5 % is what the sampling of a three-pixel light leaves."""
    camera = Camera(np.eye(4), 50, 36, 36, f_stop=1.4, focus_distance_m=2.0, near_m=0.05)
    scene = point_light(8.0, 0.036)
    settings = FrameSettings(WIDTH_PX, WIDTH_PX, rays=512)
    sharp = renderer.render(scene, camera, replace(settings, engine="pinhole")).color[..., :3].sum()
    blurred = renderer.render(scene, camera, settings).color[..., :3].sum()
    assert blurred == pytest.approx(sharp, rel=5e-3)


def test_the_blur_has_the_shape_of_the_iris(renderer: FrameRenderer) -> None:
    """A five-bladed iris makes a pentagon: its area is 5/2·sin(72°) of the circle's r², against π."""
    camera = Camera(np.eye(4), 50, 36, 36, f_stop=1.4, focus_distance_m=2.0, near_m=0.05)
    scene = point_light(12.0, 0.05)
    settings = FrameSettings(240, 240, rays=1024)
    area = [
        float((picture.color[..., 3] > 0.5 * picture.color[..., 3].max()).sum())
        for picture in (renderer.render(scene, replace(camera, iris=IrisShape(blades)), settings) for blades in (0, 5))
    ]
    assert area[1] / area[0] == pytest.approx(2.5 * np.sin(np.radians(72)) / np.pi, rel=0.04)
