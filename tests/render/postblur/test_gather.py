"""The naive gather sheds what a point by point blur does, and is what FLAG comes to in far less time."""

from __future__ import annotations

import moderngl
import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.gl.cancellation import CancellationPoint, Cancelled
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache
from render.lab.reference.scenes import posts_before_wall, spheres_over_checkerboard
from render.model.arrays import FloatArray
from render.model.lens import IrisShape
from render.postblur.blur_shape import make_blur_shape
from render.postblur.flag import Flag
from render.postblur.gather import Gather
from render.postblur.point_spread import ALL_RADII, Field, RadiusWindow
from tests.render.kits.blur_fields import IRISES, blur_by_point


@pytest.fixture
def ctx(renderer: FrameRenderer) -> moderngl.Context:
    return renderer.graphics.ctx


class Stand:
    """A field on the device, blurred by one engine or another."""

    def __init__(self, ctx: moderngl.Context, scope: Resources, light: FloatArray, radii: FloatArray) -> None:
        height, width = radii.shape
        both = np.stack([0 * radii, radii], axis=-1).astype("f4")
        self.field = Field(
            scope.keep(ctx.texture((width, height), 4, light.tobytes(), dtype="f4")),
            scope.keep(ctx.texture((width, height), 2, both.tobytes(), dtype="f4")),
            1,
        )
        self.most_px = float(radii.max())
        self._target = scope.keep(ctx.texture((width, height), 4, dtype="f4"))

    def blurred(self, by: Flag | Gather, iris: IrisShape, window: RadiusWindow = ALL_RADII) -> FloatArray:
        by.blur(self.field, make_blur_shape(iris, behind=True), self.most_px, self._target, window)
        width, height = self._target.size
        return np.frombuffer(self._target.read(), np.float32).reshape(height, width, 4).copy()


def random_field(size: tuple[int, int], most_px: float) -> tuple[FloatArray, FloatArray]:
    random = np.random.default_rng(11)
    light = random.random((*size, 4)).astype(np.float32)
    light[random.random(size) < 0.2] = 0
    return light, (most_px * random.random(size)).astype(np.float32)


@pytest.mark.parametrize("iris", IRISES)
def test_each_pixel_finds_what_points_shed_on_it(ctx: moderngl.Context, iris: str) -> None:
    light, radii = random_field((17, 23), 6.4)
    shape = make_blur_shape(IRISES[iris], behind=True)
    with Resources() as scope:
        seen = Stand(ctx, scope, light, radii).blurred(Gather(ctx, ProgramCache(ctx)), IRISES[iris])
    np.testing.assert_allclose(seen, blur_by_point(light, radii, shape), atol=5e-5)


@pytest.mark.parametrize("window", [ALL_RADII, RadiusWindow(rise=(2.0, 3.5)), RadiusWindow(fall=(1.0, 4.0))])
def test_flag_comes_to_the_same(ctx: moderngl.Context, window: RadiusWindow) -> None:
    light, radii = random_field((60, 90), 17.0)
    programs = ProgramCache(ctx)
    with Resources() as scope:
        stand = Stand(ctx, scope, light, radii)
        gather = stand.blurred(Gather(ctx, programs), IRISES["five, turned"], window)
        flag = stand.blurred(Flag(ctx, programs), IRISES["five, turned"], window)
    assert gather.max() > 0.1
    np.testing.assert_allclose(flag, gather, atol=2e-5)


def test_windows_that_share_the_light_share_all_of_it(ctx: moderngl.Context) -> None:
    light, radii = random_field((30, 40), 8.0)
    gather = Gather(ctx, ProgramCache(ctx))
    with Resources() as scope:
        stand = Stand(ctx, scope, light, radii)
        parts = [
            stand.blurred(gather, IrisShape(), window)
            for window in (RadiusWindow(rise=(3, 5)), RadiusWindow(fall=(3, 5)))
        ]
        np.testing.assert_allclose(parts[0] + parts[1], stand.blurred(gather, IrisShape()), atol=2e-5)


def test_the_memory_of_a_blur_does_not_grow_with_its_radius(ctx: moderngl.Context) -> None:
    """All pixels get the same small share of a point's light."""
    light, radii = np.zeros((20, 24, 4), np.float32), np.full((20, 24), 20_000, np.float32)
    light[7, 9] = 1
    with Resources() as scope:
        seen = Stand(ctx, scope, light, radii).blurred(Gather(ctx, ProgramCache(ctx)), IrisShape())
    np.testing.assert_allclose(seen, 1 / (np.pi * 20_000**2), rtol=1e-3)


@pytest.mark.parametrize("made", [spheres_over_checkerboard, posts_before_wall])
def test_the_engine_draws_what_flag_does(renderer: FrameRenderer, made: object) -> None:
    scene, camera = made()  # type: ignore[operator]
    settings = FrameSettings(160, 120, shading="unlit", supersample=1)
    gather, flag = (
        renderer.render(scene, camera, FrameSettings(**{**vars(settings), "engine": engine})).color
        for engine in ("gather", "flag")
    )
    np.testing.assert_allclose(flag, gather, atol=2e-4 * float(gather.max()))


def test_work_that_is_watched_is_done_in_pieces_however_wide_the_blur(
    ctx: moderngl.Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To the same picture, and each piece looks at no more pixels than it should."""
    monkeypatch.setattr("render.postblur.gather.FIRST_DISPATCH_SAMPLES", 1 << 17)
    light, radii = random_field((60, 300), 15.0)
    cancellation = CancellationPoint(ctx.finish)
    beats = []

    def is_stale() -> bool:
        beats.append(1)
        return False

    gather = Gather(ctx, ProgramCache(ctx), cancellation)
    monkeypatch.setattr(gather._piece, "learn", lambda units, took_ms: None)
    with Resources() as scope:
        stand = Stand(ctx, scope, light, radii)
        whole = stand.blurred(gather, IrisShape())
        with cancellation.cancel_when(is_stale):
            pieces = stand.blurred(gather, IrisShape())
    np.testing.assert_array_equal(pieces, whole)
    assert len(beats) > 60 * 300 * 31**2 / (1 << 17)


@pytest.mark.parametrize("engine", [Gather, Flag])
def test_it_can_be_called_off(ctx: moderngl.Context, engine: type[Gather] | type[Flag]) -> None:
    light, radii = random_field((200, 100), 9.0)
    cancellation = CancellationPoint(ctx.finish)
    beats = []

    def is_stale() -> bool:
        beats.append(1)
        return len(beats) > 2

    with Resources() as scope:
        stand = Stand(ctx, scope, light, radii)
        with pytest.raises(Cancelled), cancellation.cancel_when(is_stale):
            stand.blurred(engine(ctx, ProgramCache(ctx), cancellation), IrisShape())
    assert len(beats) == 3
