"""The lens engine's tables of the library's lenses of glass: finite, and lit over the gate."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.optics.prescription.mounting import mount_lens
from render.optics.view import PinholeView
from render.shot.lens.lens_alone import library_lens_alone
from render.trace.bundles import BundleMaker
from render.trace.lens_table import LIGHT, PolynomialTable
from render.trace.rays import make_ray_pattern
from usd_schemas import library_lenses

pytestmark = pytest.mark.gl

GATES_MM = {"petzval_50": (10.26, 7.49), "speed_panchro_50": (24.89, 18.66), "angenieux_50": (24.89, 18.66)}
"""Gates of motion pictures, for lenses that cover no more; full frame for the others."""
LIT_MM = {"fisheye_10": 13.0, "canon_fisheye_15": 18.5}
"""Heights on the film up to which fisheyes are lit: an image circle of 28 mm, and the 77° that one picture can show."""
NAMES = [
    lens.name
    for lens in library_lenses()
    if lens.lens.model == "prescription" and not any(lens.lens.prescription.radius_across)
]


@pytest.fixture(scope="module")
def maker() -> Iterator[BundleMaker]:
    with GraphicsContext() as graphics:
        yield BundleMaker(graphics.ctx, ProgramCache(graphics.ctx))


@pytest.mark.parametrize("name", NAMES)
def test_a_lens_of_the_library_lights_its_gate(name: str, maker: BundleMaker) -> None:
    alone = library_lens_alone(name).camera
    width, height = GATES_MM.get(name, (36.0, 24.0))
    camera = replace(
        alone,
        horizontal_aperture_mm=width,
        vertical_aperture_mm=height,
        focus_distance_m=max(3.0, alone.focal_length_mm / 20),
        near_m=0.1,
    )
    view = PinholeView.from_camera(camera, 32, 18)
    table = maker.make_bundle(camera, view, make_ray_pattern(4, camera.iris)).table
    assert isinstance(table, PolynomialTable)
    assert np.isfinite(table.rows).all()
    light = table.rows[1, :, LIGHT].astype(np.float64)
    lens = mount_lens(camera)
    slopes = np.linspace(0, table.last_slope, len(light))
    farthest_mm = LIT_MM.get(name, math.hypot(width, height) / 2)
    within = slopes < farthest_mm / lens.image_scale_mm
    assert light[0] == pytest.approx(1, abs=1e-3)
    assert light[within].min() > 0.04
