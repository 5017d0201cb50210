"""The linear post-filter: tables that lose no light, and sums that are those of a pixel by pixel spreading."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import moderngl
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.frame import FrameRenderer, FrameSettings
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache
from render.lab.reference.metrics import psnr_db
from render.lab.reference.scenes import posts_before_wall, spheres_over_checkerboard
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.model.lens import IrisShape
from render.model.scene import Scene
from render.optics.iris import transmission
from render.postblur import spread_tables
from render.postblur.focus_split import FocusSplit
from render.postblur.linear import (
    CUTOFF_PX,
    CUTOFF_SHARE,
    DOUBLE_BITS,
    NO_CUTOFF,
    FieldSpreader,
    LinearBlur,
    LinearField,
)
from render.postblur.spread_tables import (
    MAX_RADIUS_PX,
    WEIGHT_BITS,
    Gaussian,
    IrisImage,
    Spread,
    SpreadTables,
    make_table,
    step_of,
    step_radius,
)
from tests.render.kits.blur_fields import as_array, as_field

SPREADS: dict[str, Spread] = {
    "gaussian": Gaussian(),
    "round": IrisImage(IrisShape()),
    "five, turned": IrisImage(IrisShape(blades=5, rotation_rad=0.4)),
    "squeezed": IrisImage(IrisShape(blades=6), is_behind=False, squeeze=2.0),
    "widened": IrisImage(IrisShape(blades=6), squeeze=0.5),
}


@pytest.fixture
def ctx(renderer: FrameRenderer) -> moderngl.Context:
    return renderer.graphics.ctx


def spread_by(
    ctx: moderngl.Context, light: FloatArray, radii: FloatArray, spread: Spread, cutoff_px: float = NO_CUTOFF
) -> FloatArray:
    """Sums of weighted light and of weights, ``(h, w, 4)``."""
    field = as_field(ctx, light, radii)
    linear = LinearField(FieldSpreader(ctx, ProgramCache(ctx), cutoff_px=cutoff_px))
    sums = as_array(linear.spread(field, 1.0, spread, float(np.abs(radii).max())))
    for made in (linear, field.light, field.radii):
        made.release()
    return sums


def shed(light: FloatArray, radii: FloatArray, spread: Spread, cutoff_px: float) -> DoubleArray:
    """The same, point by point."""
    height, width = radii.shape
    steps = np.array([[step_of(abs(radius)) for radius in row] for row in radii])
    rounded = np.sign(radii) * np.array([[step_radius(step) for step in row] for row in steps])
    total = np.zeros((height, width, 4))
    for y, x in np.argwhere((light != 0).any(axis=-1)):
        half = int(np.ceil(spread.wide * abs(rounded[y, x]) + 0.5))
        table = make_table(spread, abs(rounded[y, x]), half)
        top, left = max(y - half, 0), max(x - half, 0)
        seen = rounded[top : y + half + 1, left : x + half + 1]
        rows, columns = seen.shape
        here = table[top - y + half :, left - x + half :][:rows, :columns] * (
            rounded[y, x] >= CUTOFF_SHARE * np.minimum(seen, 0) - cutoff_px
        )
        total[top : y + half + 1, left : x + half + 1] += here[..., None] * light[y, x]
    return total


@given(step=st.integers(0, 80), name=st.sampled_from(sorted(SPREADS)))
def test_a_table_is_whole_and_as_wide_as_its_circle(step: int, name: str) -> None:
    radius = step_radius(step)
    half = int(np.ceil(SPREADS[name].wide * radius + 0.5))
    table = make_table(SPREADS[name], radius, half)
    assert table.sum() == 1
    assert (table * 2**WEIGHT_BITS == np.round(table * 2**WEIGHT_BITS)).all()
    assert (table >= 0).all()
    offsets = np.arange(-half, half + 1.0)
    assert np.hypot(offsets[:, None], offsets)[table > 0].max() <= SPREADS[name].wide * radius + 1
    if radius > 4:
        middle = [(table.sum(axis=axis) * offsets).sum() for axis in (0, 1)]
        assert np.hypot(*middle) < 0.1 * radius


@pytest.mark.parametrize("most_px", [5.0, 1e9])
def test_no_table_cuts_a_widened_circle_off(ctx: moderngl.Context, most_px: float) -> None:
    """A squeeze below 1 widens circles; the widest table stays as large as without it."""
    spread = IrisImage(IrisShape(), squeeze=0.25)
    tables = SpreadTables(ctx, spread, most_px)
    widest = step_radius(tables.count - 1)
    assert 4 * widest == pytest.approx(min(4 * most_px, MAX_RADIUS_PX), abs=2)
    assert 4 * widest <= tables.half - 1 <= MAX_RADIUS_PX + 4
    assert -0.5 <= tables.beyond_px <= 1
    tables.release()


@pytest.mark.parametrize("spread", [*SPREADS.values(), IrisImage(IrisShape(radial_weights=(0,) * 60 + (1,)))])
def test_a_double_holds_all_that_a_pixel_may_get(ctx: moderngl.Context, spread: Spread) -> None:
    """Where each pixel around it has the radius by which it adds the most."""
    side = 2 * int(MAX_RADIUS_PX + 4) + 1
    most = np.zeros((side, side))
    for radius in np.unique(
        [step_radius(step_of(radius)) for radius in np.arange(0.5, MAX_RADIUS_PX / spread.wide, 0.5)]
    ):
        table = spread.weights(float(radius), side // 2)
        most = np.maximum(most, table / table.sum())
    spreader = FieldSpreader(ctx, ProgramCache(ctx))
    spreader.update_tables(spread, 1.0)
    assert 2.0 ** (spreader.light_bits + WEIGHT_BITS) * (most.sum() + 1) < 2.0**DOUBLE_BITS
    assert spreader.light_bits >= 25
    spreader.release()


def test_the_iris_is_drawn_for_new_tables_only(ctx: moderngl.Context, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = []

    def counted(iris: IrisShape) -> DoubleArray:
        drawn.append(iris)
        return transmission(iris)

    monkeypatch.setattr(spread_tables, "transmission", counted)
    linear = LinearBlur(ctx, ProgramCache(ctx))
    with Resources() as scope:
        near, far = (scope.keep(ctx.texture((8, 8), 4, bytes(16 * 64), dtype="f4")) for _ in range(2))
        radii = scope.keep(ctx.texture((8, 8), 2, bytes(8 * 64), dtype="f4"))
        for _ in range(3):
            linear.blur(FocusSplit(near, far, radii, 3.0, IrisShape(blades=5)), scope)
    linear.release()
    assert len(drawn) == 2, "one for each field"


def test_an_even_disc_is_the_circle_of_confusion() -> None:
    table = make_table(IrisImage(IrisShape()), 20.0, 21)
    y, x = np.mgrid[-21:22, -21:22]
    inside = np.hypot(x, y) < 19
    np.testing.assert_allclose(table[inside], 1 / (np.pi * 400), rtol=0.02)
    assert table[np.hypot(x, y) > 21].max() == 0


def test_steps_of_the_radius_are_half_a_pixel_and_then_a_sixty_fourth() -> None:
    radii = [step_radius(step) for step in range(140)]
    assert radii[:4] == [0, 0.5, 1, 1.5]
    assert [step_of(radius) for radius in radii if radius < MAX_RADIUS_PX] == [
        step for step, radius in enumerate(radii) if radius < MAX_RADIUS_PX
    ]
    assert radii[139] / radii[138] == pytest.approx(1 + 1 / 64, rel=1e-2)
    assert step_of(1e9) == step_of(MAX_RADIUS_PX)


@pytest.mark.parametrize("cutoff_px", [NO_CUTOFF, CUTOFF_PX])
@pytest.mark.parametrize("name", SPREADS)
def test_pixels_shed_what_points_do(ctx: moderngl.Context, name: str, cutoff_px: float) -> None:
    random = np.random.default_rng(7)
    light = random.random((37, 45, 4)).astype(np.float32)
    light[random.random((37, 45)) < 0.2] = 0
    radii = (14.6 * random.random((37, 45)) - 7.3).astype(np.float32)
    seen = spread_by(ctx, light, radii, SPREADS[name], cutoff_px)
    np.testing.assert_allclose(seen, shed(light, radii, SPREADS[name], cutoff_px), rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("scale", [1e-5, 1.0, 3e6])
def test_light_of_any_scale_keeps_its_energy(ctx: moderngl.Context, scale: float) -> None:
    light = np.zeros((70, 70, 4), np.float32)
    light[30:40, 30:40] = [scale, 1e-3 * scale, 0, 1]
    light[35, 35, 0] = np.nan
    seen = spread_by(ctx, light, np.full((70, 70), -11.3, np.float32), Gaussian())
    np.testing.assert_allclose(seen.sum(axis=(0, 1)), [99 * scale, 0.1 * scale, 0, 100], rtol=1e-5)


def test_what_is_sharp_and_near_gets_nothing_of_a_blur_behind_it(ctx: moderngl.Context) -> None:
    """A dark sharp post before a bright wall: with the cutoff it stays dark, and the wall beside it even."""
    light = np.ones((40, 60, 4), np.float32)
    radii = np.full((40, 60), -9.0, np.float32)
    light[:, 25:35, :3], radii[:, 25:35] = 0, 0
    kept, leaks = (spread_by(ctx, light, radii, Gaussian(), cutoff) for cutoff in (CUTOFF_PX, NO_CUTOFF))
    picture = kept[..., 0] / kept[..., 3]
    assert picture[:, 25:35].max() == 0
    np.testing.assert_allclose(picture[:, [24, 35, 10, 50]], 1, atol=1e-6)
    assert (leaks[..., 0] / leaks[..., 3])[20, 30] > 0.1


@pytest.mark.parametrize("made", [spheres_over_checkerboard, posts_before_wall])
def test_generated_scenes_look_as_by_the_lens(
    renderer: FrameRenderer, made: Callable[[], tuple[Scene, Camera]]
) -> None:
    scene, camera = made()
    settings = FrameSettings(200, 150, shading="unlit", rays=64, supersample=3)  # without a sharp layer
    lens, linear, sharp = (
        renderer.render(scene, camera, replace(settings, engine=engine)).color
        for engine in ("lens", "linear", "pinhole")
    )
    assert psnr_db(lens, linear) > psnr_db(lens, sharp) + 3
