"""Importance ordering: all changes make the linear method's picture to the bit, and some of them are the most important."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np
import pytest

from render.errors import SettingsError
from render.frame import FrameRenderer, FrameSettings
from render.gl.cancellation import CancellationPoint, Cancelled
from render.gl.shaders import ProgramCache
from render.lab.reference.scenes import posts_before_wall
from render.model.arrays import FloatArray
from render.postblur.importance_field import NEVER_CANCELLED, UNLIMITED, ImportanceField, UpdateLimit
from render.postblur.importance_order import Importance
from render.postblur.linear import CUTOFF_PX, NO_CUTOFF, FieldSpreader, LinearField
from render.postblur.spread_tables import Gaussian
from tests.render.kits.blur_fields import as_array, as_field

HEIGHT, WIDTH = 51, 45


class Stand:
    """A picture that changes, spread both ways."""

    def __init__(self, ctx: moderngl.Context, cutoff_px: float = CUTOFF_PX, **importance: float | bool) -> None:
        programs = ProgramCache(ctx)
        self.ctx, self.random = ctx, np.random.default_rng(5)
        self.light = self.random.random((HEIGHT, WIDTH, 4)).astype(np.float32)
        self.radii = self._radii((HEIGHT, WIDTH))
        self.linear = LinearField(FieldSpreader(ctx, programs, cutoff_px=cutoff_px))
        self.ordered = ImportanceField(
            ctx,
            programs,
            FieldSpreader(ctx, programs, cutoff_px=cutoff_px),
            Importance(**importance),  # type: ignore[arg-type]
        )

    def _radii(self, shape: tuple[int, ...]) -> FloatArray:
        return (13 * self.random.random(shape) - 6.5).astype(np.float32)

    def change(self, count: int) -> None:
        """Change the light or the radius of some pixels, or both."""
        y, x = self.random.integers(0, HEIGHT, count), self.random.integers(0, WIDTH, count)
        thirds = count // 3
        self.light[y[thirds:], x[thirds:]] = self.random.random((count - thirds, 4))
        self.light[y[:9], x[:9]] = 0
        self.radii[y[: 2 * thirds], x[: 2 * thirds]] = self._radii((2 * thirds,))

    def taken(self, limit: UpdateLimit = UNLIMITED, cancellation: CancellationPoint = NEVER_CANCELLED) -> FloatArray:
        field = as_field(self.ctx, self.light, self.radii)
        try:
            return as_array(self.ordered.update(field, 1.0, Gaussian(), 6.5, limit, cancellation))
        finally:
            field.light.release()
            field.radii.release()

    def wanted(self) -> FloatArray:
        field = as_field(self.ctx, self.light, self.radii)
        sums = as_array(self.linear.spread(field, 1.0, Gaussian(), 6.5))
        field.light.release()
        field.radii.release()
        return sums


@pytest.fixture
def ctx(renderer: FrameRenderer) -> moderngl.Context:
    return renderer.graphics.ctx


@pytest.mark.parametrize("cutoff_px", [NO_CUTOFF, CUTOFF_PX])
def test_all_changes_make_the_linear_picture_to_the_bit(ctx: moderngl.Context, cutoff_px: float) -> None:
    """Also what a cut off one before has left waiting, and whatever has moved over what stood still."""
    stand = Stand(ctx, cutoff_px)
    stand.taken()
    for count in (3, 200, 900, 40, 4000):
        stand.change(count)
        part = stand.taken(UpdateLimit(share=0.4))
        assert count < 30 or not np.array_equal(part, stand.wanted())
        stand.change(count // 2)
        assert np.array_equal(stand.taken(), stand.wanted())
    assert stand.ordered.stats.changed > 0


def test_hundreds_of_updates_do_not_drift(ctx: moderngl.Context) -> None:
    stand = Stand(ctx)
    for number in range(300):
        stand.change(60)
        stand.light[number % HEIGHT, number % WIDTH, :3] = 4096.0 if number % 2 else 1e-4
        stand.taken(UpdateLimit(share=0.9))
    assert not stand.ordered.stats.from_scratch
    assert np.array_equal(stand.taken(), stand.wanted())


def test_what_has_not_changed_is_not_spread(ctx: moderngl.Context) -> None:
    stand = Stand(ctx)
    first = stand.taken()
    assert (stand.ordered.stats.from_scratch, stand.ordered.stats.spread) == (True, HEIGHT * WIDTH)
    assert np.array_equal(stand.taken(), first)
    assert stand.ordered.stats.changed == 0
    steps = np.abs(stand.radii) * 2
    stand.radii *= np.where(np.abs(steps - np.round(steps)) < 0.4, 1 + 1e-3, 1).astype(np.float32)  # below a step
    stand.taken()
    assert stand.ordered.stats.changed == 0


def test_the_most_important_is_first(ctx: moderngl.Context) -> None:
    """A large change of light, a small one and one of radius between: a third and two thirds of them."""
    stand = Stand(ctx, NO_CUTOFF)
    stand.light[:], stand.radii[:] = 0.5, -2.0
    before = stand.taken()
    places = {"large": (8, 8), "radius": (25, 30), "small": (42, 12)}
    stand.light[places["large"]], stand.light[places["small"]] = 3.0, 0.5001
    stand.radii[places["radius"]] = -4.0
    made = [stand.taken(UpdateLimit(share=share)) for share in (0.3, 0.5, 1.0)]
    seen = [[bool((sums != before)[place].any()) for place in places.values()] for sums in made]
    assert seen == [[True, False, False], [True, True, False], [True, True, True]]


def test_weights_choose_what_is_important(ctx: moderngl.Context) -> None:
    for coc_weight, rgb_weight, expected in ((1.0, 0.0, (25, 30)), (0.0, 1.0, (8, 8))):
        stand = Stand(ctx, NO_CUTOFF, coc_weight=coc_weight, rgb_weight=rgb_weight)
        stand.light[:], stand.radii[:] = 0.5, -2.0
        before = stand.taken()
        stand.light[8, 8], stand.radii[25, 30] = 1.0, -4.0
        changed = (stand.taken(UpdateLimit(share=0.5)) != before).any(axis=-1)
        assert changed[expected]
        assert changed.sum() < 120


def test_a_perceptual_distance_sees_the_dark(ctx: moderngl.Context) -> None:
    """From 0.01 to 0.03 is more to the eye than from 0.9 to 0.95, which is more light."""
    firsts = []
    for is_perceptual in (False, True):
        stand = Stand(ctx, NO_CUTOFF, is_perceptual=is_perceptual)
        stand.light[:], stand.radii[:] = 0.01, -1.0
        stand.light[30:] = 0.9
        before = stand.taken()
        stand.light[10, 10, :3], stand.light[40, 10, :3] = 0.03, 0.95
        changed = (stand.taken(UpdateLimit(share=0.5)) != before).any(axis=-1)
        firsts.append("dark" if changed[10, 10] else "bright")
        assert changed[10, 10] != changed[40, 10]
    assert firsts == ["bright", "dark"]


def test_what_waits_grows_until_it_is_made(ctx: moderngl.Context) -> None:
    """A small change is starved by large ones of every frame, for as many frames as octaves lie between them."""
    stand = Stand(ctx, NO_CUTOFF)
    stand.light[:], stand.radii[:] = 0.5, -2.0
    stand.taken()
    stand.light[40, 40, 0] = 0.501
    waited = 0
    for number in range(20):
        stand.light[5:10, 5:15, :3] = number % 2
        sums = stand.taken(UpdateLimit(share=0.97))  # all but one
        if sums[40, 40, 0] != 0.5:
            break
        waited += 1
    assert 3 < waited < 14


def test_time_is_kept_to_in_pieces(ctx: moderngl.Context) -> None:
    stand = Stand(ctx)
    stand.taken()
    stand.change(3000)
    before = stand.wanted()
    stand.ordered._piece.units = 16
    stand.taken(UpdateLimit(budget_ms=0.0))
    assert 0 < stand.ordered.stats.spread < stand.ordered.stats.changed
    stand.taken(UpdateLimit(budget_ms=1e6))
    assert stand.ordered.stats.spread == stand.ordered.stats.changed
    assert np.array_equal(stand.taken(), before)


def test_stale_work_is_left_between_pieces_and_goes_on_from_there(ctx: moderngl.Context) -> None:
    stand = Stand(ctx)
    cancellation = CancellationPoint(ctx.finish)
    beats = iter([False, True])
    stand.ordered._spreader._piece.units = 1  # rows of tiles
    with pytest.raises(Cancelled), cancellation.cancel_when(lambda: next(beats)):
        stand.taken(cancellation=cancellation)
    assert np.array_equal(stand.taken(), stand.wanted())
    stand.change(600)
    stand.ordered._piece.units = 16
    with pytest.raises(Cancelled), cancellation.cancel_when(lambda: True):
        stand.taken(cancellation=cancellation)
    assert np.array_equal(stand.taken(), stand.wanted())


@pytest.mark.parametrize("bad", [{"share": 0.0}, {"share": 1.1}, {"share": float("nan")}, {"budget_ms": -1.0}])
def test_an_extent_out_of_range_is_reported(bad: dict[str, float]) -> None:
    with pytest.raises(SettingsError, match=f"{next(iter(bad))}|share"):
        UpdateLimit(**bad)


def test_a_weight_below_zero_is_reported() -> None:
    with pytest.raises(SettingsError, match="rgb_weight must be 0 or more, got -1"):
        Importance(rgb_weight=-1)


def test_frames_of_a_renderer_are_those_of_the_linear_engine(renderer: FrameRenderer) -> None:
    """A camera that pulls its focus, and then another size."""
    scene, camera = posts_before_wall()
    settings = FrameSettings(160, 90, shading="unlit", engine="importance", supersample=1)
    for distance, size in ((1.0, (160, 90)), (1.02, (160, 90)), (1.3, (160, 90)), (1.3, (96, 64))):
        pulled = replace(camera, focus_distance_m=camera.focus_distance_m * distance)
        asked = replace(settings, width=size[0], height=size[1])
        made = renderer.render(scene, pulled, asked).color
        done = renderer.engine(asked)._blur.stats  # type: ignore[attr-defined]
        wanted = renderer.render(scene, pulled, replace(asked, engine="linear")).color
        np.testing.assert_allclose(made, wanted, rtol=1e-5, atol=1e-6)
        assert (distance == 1.02) == (not any(field.from_scratch for field in done))
