"""A lens whose image circle is smaller than the film: up to its edge it sees further out, and the layers show all of it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.lens import Lens
from render.optics.view import PinholeView
from render.trace.bundles import BundleMaker
from render.trace.layer_view import bound_rays
from render.trace.lens_table import LIGHT, SLOPE_T, WEIGHT, PolynomialTable
from render.trace.picture_focus import picture_focus
from render.trace.rays import RayBundle, make_ray_pattern
from tests.render.kits.lenses import FISHEYE

pytestmark = pytest.mark.gl

CAMERA = Camera(  # its image circle is 28 mm across, the film 36 mm wide
    np.eye(4),
    focal_length_mm=10.0,
    f_stop=4.0,
    focus_distance_m=3.0,
    near_m=0.1,
    lens=Lens("prescription", prescription=FISHEYE.prescription),
)
VIEW = PinholeView.from_camera(CAMERA, 320, 180)


@pytest.fixture(scope="module")
def bundle() -> Iterator[RayBundle]:
    graphics = GraphicsContext()
    graphics.make_current()
    yield BundleMaker(graphics.ctx, ProgramCache(graphics.ctx)).make_bundle(
        CAMERA, VIEW, make_ray_pattern(4, CAMERA.iris)
    )
    graphics.close()


def seen_slopes(table: PolynomialTable) -> tuple[DoubleArray, DoubleArray]:
    """Return the middle ray's slope in object space ``(heights,)`` and the mean light, at the middle wavelength."""
    rows = table.rows[1].astype(np.float64)
    return np.linspace(0, table.last_slope, len(rows)) + rows[:, SLOPE_T], rows[:, LIGHT]


def test_film_farther_from_the_middle_sees_farther_off_the_axis(bundle: RayBundle) -> None:
    """Also in the dark beyond the image circle, toward which pictures blend at its edge."""
    assert isinstance(bundle.table, PolynomialTable)
    seen, light = seen_slopes(bundle.table)
    assert np.diff(seen).min() > 0
    dark = int(np.argmin(light > 0))
    assert 0 < dark < len(light) - 1
    assert np.abs(light[dark:]).max() == 0
    assert np.abs(bundle.table.rows[:, dark:, WEIGHT : WEIGHT + 4]).max() == 0


def test_the_layers_show_all_that_the_lens_sees(bundle: RayBundle) -> None:
    assert isinstance(bundle.table, PolynomialTable)
    seen, light = seen_slopes(bundle.table)
    farthest = seen[light > 0].max()
    assert farthest > 3  # 72 degrees
    extent = bound_rays(VIEW, bundle, picture_focus(CAMERA, VIEW), nearest_w=1.0)
    assert extent.right >= farthest
    assert extent.left <= -farthest
    upper = CAMERA.vertical_aperture_mm / 2 / CAMERA.focal_length_mm  # the circle is cut above and below
    heights = np.linspace(0, bundle.table.last_slope, len(seen))
    assert -extent.top == pytest.approx(extent.bottom)
    assert extent.bottom >= np.interp(upper, heights, seen)
