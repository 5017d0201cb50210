"""Blurs over the outline of the iris: they draw its image and neither lose nor add light."""

from __future__ import annotations

import moderngl
import numpy as np
import pytest

from render.frame import FrameRenderer
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache
from render.model.arrays import FloatArray
from render.model.lens import IrisShape
from render.postblur.blur_shape import BlurShape, make_blur_shape
from render.postblur.flag import Flag
from render.postblur.gather import Gather
from render.postblur.point_spread import ALL_RADII
from render.postblur.spread_tables import IrisImage
from tests.render.kits.blur_fields import as_array, as_field

IRISES = {
    "round": IrisShape(),
    "three blades": IrisShape(blades=3),
    "three, turned": IrisShape(blades=3, rotation_rad=0.5),
    "four, upright": IrisShape(blades=4, rotation_rad=np.pi / 4),
    "five, turned": IrisShape(blades=5, rotation_rad=0.4),
    "seven blades": IrisShape(blades=7),
    "nine, rounded": IrisShape(blades=9, roundness=0.5, rotation_rad=0.1),
}


@pytest.fixture
def ctx(renderer: FrameRenderer) -> moderngl.Context:
    return renderer.graphics.ctx


def blurred(
    ctx: moderngl.Context, by: type[Flag] | type[Gather], light: FloatArray, radii: FloatArray, shape: BlurShape
) -> FloatArray:
    """``(h, w, 4)``, of light ``(h, w, 4)`` with radii ``(h, w)``."""
    with Resources() as scope:
        field = as_field(ctx, light, radii)
        scope.keep(field.light)
        scope.keep(field.radii)
        target = scope.keep(ctx.texture(field.light.size, 4, dtype="f4"))
        by(ctx, ProgramCache(ctx)).blur(field, shape, float(radii.max()), target, ALL_RADII)
        return as_array(target)


def point(side: int) -> FloatArray:
    light = np.zeros((side, side, 4), np.float32)
    light[side // 2, side // 2] = 1
    return light


@pytest.mark.parametrize("by", [Flag, Gather])
@pytest.mark.parametrize("iris", IRISES)
def test_points_of_all_small_radii_keep_their_light(
    ctx: moderngl.Context, iris: str, by: type[Flag] | type[Gather]
) -> None:
    """Each point in a cell of its own; radii lie as densely as columns enter the shape."""
    cell, count = 11, 18
    light, radii = np.zeros((cell * count, cell * count, 4), np.float32), np.zeros(2 * (cell * count,), np.float32)
    light[cell // 2 :: cell, cell // 2 :: cell] = 1
    radii[cell // 2 :: cell, cell // 2 :: cell] = np.linspace(0.25, 4.0, count * count).reshape(count, count)
    for behind in (True, False):
        seen = blurred(ctx, by, light, radii, make_blur_shape(IRISES[iris], behind=behind))
        kept = seen[..., 0].astype(np.float64).reshape(count, cell, count, cell).sum(axis=(1, 3))
        np.testing.assert_allclose(kept, 1, atol=1e-5)


@pytest.mark.parametrize("by", [Flag, Gather])
@pytest.mark.parametrize("radius", [1.02, 1.103, 2.01])
def test_an_opaque_surface_stays_opaque(ctx: moderngl.Context, radius: float, by: type[Flag] | type[Gather]) -> None:
    light, radii = np.ones((24, 24, 4), np.float32), np.full((24, 24), radius, np.float32)
    for iris in ("round", "seven blades"):
        seen = blurred(ctx, by, light, radii, make_blur_shape(IRISES[iris], behind=False))
        np.testing.assert_allclose(seen[4:-4, 4:-4], 1, atol=1e-5)


@pytest.mark.parametrize("iris", ["round", "four, upright", "five, turned"])
def test_a_wide_point_keeps_its_light(ctx: moderngl.Context, iris: str) -> None:
    """The area of a shape of more columns than its outline has is an integral."""
    seen = blurred(
        ctx, Flag, point(321), np.full((321, 321), 150.3, np.float32), make_blur_shape(IRISES[iris], behind=True)
    )
    assert seen[..., 0].sum(dtype=np.float64) == pytest.approx(1, rel=3e-4)


@pytest.mark.parametrize("by", [Flag, Gather])
@pytest.mark.parametrize("squeeze", [1.0, 0.5, 2.0])
@pytest.mark.parametrize("iris", IRISES)
def test_a_point_draws_the_image_of_the_iris(
    ctx: moderngl.Context, iris: str, squeeze: float, by: type[Flag] | type[Gather]
) -> None:
    """Also where a column of the iris lies wholly above or below the middle."""
    radius, half = 16.3, 35
    for behind in (True, False):
        shape = make_blur_shape(IRISES[iris], behind=behind, squeeze=squeeze)
        seen = blurred(ctx, by, point(2 * half + 1), np.full(2 * (2 * half + 1,), radius, np.float32), shape)[..., 0]
        wanted = IrisImage(IRISES[iris], is_behind=behind, squeeze=squeeze).weights(radius, half)
        wanted = wanted / wanted.sum()
        assert np.abs(seen - wanted).sum() < 0.1 * max(1.0, squeeze)  # a column is drawn whole or not at all
