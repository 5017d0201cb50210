"""Rendered pictures through glass against dense exact rays: the light of a white field, and cat's eyes, within 2 %."""

from __future__ import annotations

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.optics.prescription.mounting import mount_lens
from render.optics.spectrum import THREE_LINES
from render.optics.view import PinholeView
from tests.render.kits.exact_rays import exact_light, grid, trace
from tests.render.kits.lens_pictures import WHITE, camera_of, glowing_point, spot_size
from tests.render.kits.lenses import DISTAGON, DOUBLE_GAUSS, PLANAR, KnownLens

LENSES = pytest.mark.parametrize("known", [DOUBLE_GAUSS, PLANAR, DISTAGON], ids=lambda known: known.prescription.name)
FIELD, EYE = FrameSettings(96, 72, rays=256), FrameSettings(400, 300, rays=484)
HALF = 5e-4  # side of a light, over twice its distance
GREEN_NM = THREE_LINES.wavelengths_nm[1]


@pytest.mark.gl
@LENSES
def test_a_white_field_darkens_as_exact_rays_say(renderer: FrameRenderer, known: KnownLens) -> None:
    """Along the diagonal, over the light of the axis."""
    camera = camera_of(known)
    picture = renderer.render(WHITE, camera, FIELD).color[..., 1]
    lens, view = mount_lens(camera), PinholeView.from_camera(camera, FIELD.width, FIELD.height)
    axis = exact_light(lens, 0.0)
    for share in (0.3, 0.55, 0.8, 0.97):
        column, row = (int(view.cx + share * FIELD.width / 2), int(view.cy - share * FIELD.height / 2))
        slope = np.hypot((column + 0.5 - view.cx) / view.fx, (row + 0.5 - view.cy) / view.fy)
        assert picture[row, column] == pytest.approx(exact_light(lens, slope * lens.image_scale_mm) / axis, rel=0.02)


@pytest.mark.gl
@pytest.mark.parametrize("place", [(0.0, 0.0), (0.6, 0.0), (0.7, 0.7)], ids=["middle", "right", "corner"])
@LENSES
def test_cat_s_eyes_have_the_place_and_shape_of_exact_rays(
    renderer: FrameRenderer, known: KnownLens, place: tuple[float, float]
) -> None:
    """Centre, both widths and area of the patch of a light before the focus, whose place is in halves of the gate."""
    camera = camera_of(known)
    slope = np.array(place) * [16.0, 12.0] / known.focal_length_mm
    picture = renderer.render(
        glowing_point(slope[0], slope[1], near_m(known), half_m=HALF * near_m(known)), camera, EYE
    ).color
    exact, area_px = exact_patch(camera, slope, near_m(known))
    side_px = 2 * HALF * camera.focal_length_mm / camera.horizontal_aperture_mm * EYE.width
    wide = np.sqrt(exact.var(axis=0) + (1 + side_px**2) / 12)  # of a square light, in square pixels
    x, y, across, down = spot_size(picture)
    width = float(np.hypot(across, down))
    assert (x, y) == pytest.approx(tuple(exact.mean(axis=0)), abs=0.02 * width + 0.1)
    assert (across, down) == pytest.approx(tuple(wide), rel=0.02)
    assert across * down == pytest.approx(wide.prod(), rel=0.02)
    light = picture[..., 1].astype(np.float64)
    assert lit_area(light) == pytest.approx(area_px, rel=0.03)  # a tenth of a pixel at the patch's edge


def near_m(known: KnownLens) -> float:
    """Distance of the light from the entrance pupil that makes a patch of about 30 pixels; the lens is focused at 4 m."""
    return 0.4 if known is DISTAGON else 1.0


def exact_patch(camera: Camera, slope: DoubleArray, near_m: float) -> tuple[DoubleArray, float]:
    """Where exact rays of a point light land, in pixels, and the area that they cover."""
    lens, view = mount_lens(camera), PinholeView.from_camera(camera, EYE.width, EYE.height)
    away = 1000 * near_m
    light = np.array([*(slope * away), lens.entrance_pupil_mm - away])
    reach = 1.5 * lens.prescription.surfaces[0].semi_diameter_mm
    box = np.array([[-reach, -reach], [reach, reach]])
    for _ in range(2):  # the second time only around what passes
        points, step = grid(box)
        aims = np.column_stack([points, np.full(len(points), lens.vertices_mm[0])])
        traced = trace(lens, np.tile(light, (len(points), 1)), aims - light, "film", GREEN_NM)
        passing = points[traced.passes]
        box = np.array([passing.min(axis=0) - 2 * step, passing.max(axis=0) + 2 * step])
    seen = -traced.at(lens.film_mm)[traced.passes] / lens.image_scale_mm
    at = np.column_stack([view.cx + view.fx * seen[:, 0], view.cy - view.fy * seen[:, 1]])
    count, _, _ = np.histogram2d(
        at[:, 1], at[:, 0], bins=(EYE.height, EYE.width), range=((0, EYE.height), (0, EYE.width))
    )
    return at, lit_area(count)


def lit_area(light: DoubleArray) -> float:
    """Number of pixels that a patch covers, those at its edge by their share of the usual light within."""
    usual = np.median(light[light > 0.25 * np.percentile(light[light > 0], 80)])
    return float(np.clip(light / usual, 0, 1).sum())
