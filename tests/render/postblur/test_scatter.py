"""Scatter: a point's picture is the iris as the lens draws it, no light is lost, and none leaks onto what is sharper."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np
import pytest

from render.frame import FrameRenderer
from render.gl.cancellation import CancellationPoint, Cancelled
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache
from render.lab.reference.metrics import psnr_db
from render.model.arrays import DoubleArray, FloatArray
from render.model.lens import AberrationScales, IrisShape, SeidelErrors
from render.optics.iris import transmission
from render.postblur import scatter_splats, spot_cache
from render.postblur.focus_split import FocusSplit
from render.postblur.scatter import ScatterBlur
from render.postblur.scatter_axis import make_axis_spot
from render.postblur.scatter_spot import SQUARE_SIDES, STEPS, Spot, SpotTables, make_camera_spot, make_spot_tables
from render.trace.axis_rays import LensErrors
from render.trace.seidel_table import make_seidel_table

IRISES = {
    "round": IrisShape(),
    "three blades": IrisShape(blades=3, rotation_rad=0.3),
    "ring": IrisShape(radial_weights=(0.1, 0.2, 1.0)),
    "mask": IrisShape(mask=np.tri(16)),
}
FAINT = 1e-4
"""Alpha of near light: too little to hide anything, so that pictures are sums."""


@pytest.fixture
def blur(renderer: FrameRenderer) -> ScatterBlur:
    ctx = renderer.graphics.ctx
    return ScatterBlur(ctx, ProgramCache(ctx))


def picture(
    blur: ScatterBlur,
    radii: FloatArray,
    *,
    near: FloatArray | float = 0.0,
    far: FloatArray | float = 0.0,
    cover: FloatArray | float = 1.0,
    iris: IrisShape = IRISES["round"],
    errors: LensErrors | None = None,
    squeeze: float = 1.0,
) -> FloatArray:
    """``(h, w)`` of grey fields, near and far with the same radii ``(h, w)``; the near one covers as much as is said."""
    height, width = radii.shape
    ctx = blur._ctx
    with Resources() as scope:

        def texture(*channels: FloatArray | float) -> moderngl.Texture:
            values = np.stack([np.broadcast_to(channel, radii.shape) for channel in channels], axis=-1)
            return scope.keep(ctx.texture((width, height), len(channels), values.astype("f4").tobytes(), dtype="f4"))

        before = texture(near, near, near, np.where(np.broadcast_to(near, radii.shape) > 0, cover, 0.0))
        behind = texture(far, far, far, 1.0)
        split = FocusSplit(before, behind, texture(radii, radii), float(radii.max()), iris, squeeze, errors)
        made = blur.blur(split, scope)
        return np.frombuffer(made.read(), np.float32).reshape(height, width, 4)[..., 0].copy()


def point(size: int = 121, light: float = 1.0) -> FloatArray:
    made = np.zeros((size, size), np.float32)
    made[size // 2, size // 2] = light
    return made


def radius_of(light: FloatArray) -> float:
    """Return the radius of an even disc with the same spread."""
    middle = len(light) // 2
    y, x = np.mgrid[: len(light), : len(light)] - middle
    return float(np.sqrt(2 * ((x**2 + y**2) * light).sum() / light.sum()))


def soft_lens(edge_px: float) -> LensErrors:
    """Spherical aberration by which rays through the edge of the pupil land that far out, of what is in focus."""
    focal_px, pupil_m = 1000.0, 0.01
    scale = {"focal_length_mm": 50.0, "pupil_radius_m": pupil_m, "last_slope": 0.4, "wavelengths_nm": (510.0,)}
    unit = make_seidel_table(SeidelErrors(w040=1.0), AberrationScales(), **scale)
    slope = (
        -float(
            make_camera_spot(IRISES["round"], 1.0, make_axis_spot(LensErrors(unit, pupil_m, 1e9))).error_px[:, 0].max()
        )
        / 1e9
    )
    table = make_seidel_table(SeidelErrors(w040=-edge_px / focal_px / slope), AberrationScales(), **scale)
    return LensErrors(table, pupil_m, focal_px)


def test_tables_keep_all_the_light() -> None:
    for iris in (IRISES["three blades"], IRISES["ring"]):
        tables = make_spot_tables(make_camera_spot(iris, 1.0, make_axis_spot(soft_lens(4.0))), 12, behind=False)
        np.testing.assert_allclose(tables.weights.sum(axis=(1, 2), dtype=np.float64), 1.0, atol=1e-6)
        assert len(tables.weights) == len(SQUARE_SIDES) * tables.steps


def test_nothing_is_lost(blur: ScatterBlur) -> None:
    """Points of all sizes, alone and in squares, at the whole and at less resolution."""
    random = np.random.default_rng(3)
    light, radii = np.zeros((2, 640, 640), np.float32)
    inner = slice(200, -200)
    light[inner, inner] = random.random((240, 240)) * (random.random((240, 240)) < 0.5)
    light[260:330, 260:330] = 0.7  # drawn in squares
    radii[inner, inner] = 70 * random.random((240, 240)) ** 3
    radii[260:330, 260:330] = np.linspace(1, 60, 70)
    for errors in (None, soft_lens(3.0)):
        seen = picture(blur, radii, near=light, cover=FAINT, errors=errors)
        assert seen.sum(dtype=np.float64) == pytest.approx(light.sum(dtype=np.float64), rel=1e-3)


@pytest.mark.parametrize("squeeze", [1.0, 2.0])
@pytest.mark.parametrize("iris", IRISES)
def test_a_points_picture_is_the_iris(blur: ScatterBlur, iris: str, squeeze: float) -> None:
    """Upright behind the focus, upside down before it, a squeeze narrower."""
    wanted = transmission(IRISES[iris], 40)
    wanted = wanted.reshape(40, round(40 / squeeze), -1).mean(axis=2)
    shape = np.zeros((121, 121))
    left = 60 - wanted.shape[1] // 2
    shape[40:80, left : left + wanted.shape[1]] = wanted
    shape = (shape + np.roll(shape, 1, axis=(0)) + np.roll(shape, 1, axis=1) + np.roll(shape, (1, 1), axis=(0, 1))) / 4
    radii = np.full((121, 121), 20, np.float32)
    behind = picture(blur, radii, far=point(), iris=IRISES[iris], squeeze=squeeze)
    before = picture(blur, radii, near=point(), cover=FAINT, iris=IRISES[iris], squeeze=squeeze)
    assert np.corrcoef(behind.ravel(), shape.ravel())[0, 1] > 0.985
    np.testing.assert_allclose(before, behind[::-1, ::-1], atol=0.03 * behind.max())


@pytest.mark.parametrize("radius", [0.3, 1.0, 2.6, 7.0, 19.0, 31.0, 57.0])
def test_a_disc_is_as_wide_as_its_circle_of_confusion(blur: ScatterBlur, radius: float) -> None:
    seen = picture(blur, np.full((161, 161), radius, np.float32), near=point(161), cover=FAINT)
    assert seen.sum() == pytest.approx(1, rel=1e-3)
    wanted = np.hypot(radius, np.sqrt(1 / 3)) if radius > 0.5 else 0.0  # pixels are no points
    assert radius_of(seen) == pytest.approx(wanted, abs=max(0.12, 0.03 * radius))


@pytest.mark.parametrize("edge_px", [-6.0, 6.0])
@pytest.mark.parametrize("behind", [True, False])
def test_spherical_aberration_moves_light_as_its_rays_do(edge_px: float, behind: bool) -> None:
    """Within the ring where rays of a zone land is what passes inside the zone: ``t = c·ρ + e·ρ³`` holds ρ² of the light."""
    coc = 20.0 if behind else -20.0
    tables = make_spot_tables(
        make_camera_spot(IRISES["round"], 1.0, make_axis_spot(soft_lens(edge_px))), 20, behind=behind
    )
    light = tables.weights[20 * STEPS]
    off = np.hypot(*np.mgrid[-tables.middle : tables.middle + 1, -tables.middle : tables.middle + 1])
    for zone in (0.4, 0.6, 0.8):
        lands = abs(coc * zone + edge_px * zone**3)
        assert light[off <= lands].sum() == pytest.approx(zone**2, abs=0.02)
    rim, core = light[(off > 11) & (off < 13)].mean(), light[off < 5].mean()
    assert (rim > core) == (coc * edge_px < 0)


def test_a_soft_lens_spreads_what_is_in_focus_too(blur: ScatterBlur) -> None:
    errors = soft_lens(8.0)
    seen = picture(blur, np.zeros((121, 121), np.float32), far=point(), errors=errors)
    assert seen.sum() == pytest.approx(1, rel=1e-3)
    assert radius_of(seen) == pytest.approx(8 * np.sqrt(2 / 8) * np.sqrt(2), rel=0.05)  # e²·∫ρ⁶·2ρdρ, as a disc
    sharp = picture(blur, np.zeros((121, 121), np.float32), far=point(), errors=soft_lens(0.1))
    np.testing.assert_array_equal(sharp, point())


def test_a_lens_of_enormous_errors_is_drawn_coarsely(blur: ScatterBlur) -> None:
    seen = picture(blur, np.full((801, 801), 9, np.float32), near=point(801), cover=FAINT, errors=soft_lens(150.0))
    assert seen.sum() == pytest.approx(1, rel=1e-3)
    assert radius_of(seen) == pytest.approx(150 / np.sqrt(2), rel=0.1)


def test_squares_drawn_as_one_shed_what_their_pixels_do(blur: ScatterBlur, monkeypatch: pytest.MonkeyPatch) -> None:
    y, x = np.mgrid[0:150, 0:200].astype(np.float32)
    light = (1.2 + np.sin(0.05 * x) * np.cos(0.04 * y)).astype(np.float32)
    light[40:80:7, 30:170:9] = 30.0
    radii = (1 + 29 * x / 200).astype(np.float32)
    together = picture(blur, radii, far=light)
    monkeypatch.setattr(scatter_splats, "SHIFT", -1.0)
    assert psnr_db(together / 4, picture(blur, radii, far=light) / 4) > 45


def test_what_is_sharp_or_less_blurred_stays_clean(blur: ScatterBlur) -> None:
    """Dark on the left, a bright and far more blurred thing behind it on the right."""
    bright = np.zeros((90, 160), np.float32)
    bright[:, 80:] = 50.0
    for left in (0.0, 1.5, 4.0):
        radii = np.where(bright > 0, 20.0, left).astype(np.float32)
        seen = picture(blur, radii, far=bright)
        kept = int(np.ceil(left)) + 2
        assert seen[20:70, 24 : 80 - kept].max() < 1e-4
        np.testing.assert_allclose(seen[20:70, 80 + kept : 136], 50, rtol=1e-4)


def test_a_near_thing_has_soft_edges_over_a_sharp_background(blur: ScatterBlur) -> None:
    near, radius = np.zeros((80, 160), np.float32), 12.0
    near[:, 80:] = 1.0
    far = np.where(np.arange(160) % 4 < 2, 0.25, 0.0)[None, :].astype(np.float32)
    radii = np.full((80, 160), radius, np.float32)
    over_black = picture(blur, radii, near=near)[40]
    off = np.clip((np.arange(160) - 79.5) / radius, -1, 1)
    covered = 0.5 + (off * np.sqrt(1 - off**2) + np.arcsin(off)) / np.pi  # of a disc, beyond a chord
    inside = covered < 0.8  # from where on it falls short of nothing
    np.testing.assert_allclose(over_black[16:144][inside[16:144]], covered[16:144][inside[16:144]], atol=0.02)
    np.testing.assert_allclose(over_black[16:144], covered[16:144], atol=0.1)
    sharp = _with_far(blur, near, far, radius)[40, 20:60]
    np.testing.assert_array_equal(sharp, far[0, 20:60])


def _with_far(blur: ScatterBlur, near: FloatArray, far: FloatArray, radius: float) -> FloatArray:
    """Over what is in focus."""
    ctx, (height, width) = blur._ctx, near.shape
    with Resources() as scope:

        def texture(values: DoubleArray) -> moderngl.Texture:
            channels = values.shape[-1]
            return scope.keep(ctx.texture((width, height), channels, values.astype("f4").tobytes(), dtype="f4"))

        before = texture(np.repeat(near[..., None], 4, axis=-1))
        grey = np.broadcast_to(far, near.shape)
        behind = texture(np.stack([grey, grey, grey, np.ones_like(near)], axis=-1))
        radii = texture(np.broadcast_to([radius, 0.0], (height, width, 2)))
        made = blur.blur(FocusSplit(before, behind, radii, radius, IrisShape()), scope)
        return np.frombuffer(made.read(), np.float32).reshape(height, width, 4)[..., 0].copy()


def test_a_near_surface_through_all_sizes_has_no_seams(blur: ScatterBlur) -> None:
    """White, over black: a gap would be dark, and a double covering is none."""
    x = np.mgrid[0:120, 0:900][1]
    radii = (0.2 + 60 * x / 900).astype(np.float32)
    seen = picture(blur, radii, near=np.ones(radii.shape, np.float32))
    np.testing.assert_allclose(seen[60, 10:830], 1.0, atol=0.01)


def test_a_far_surface_through_all_sizes_is_blurred(blur: ScatterBlur) -> None:
    """Fine stripes become grey; a pixel that no spot reached would keep its own light."""
    x = np.mgrid[0:120, 0:900][1]
    radii = (0.2 + 60 * x / 900).astype(np.float32)
    seen = picture(blur, radii, far=(2.0 * (x % 2)).astype(np.float32))
    np.testing.assert_allclose(seen[40:80, 80:], 1.0, atol=0.02)


def test_the_same_picture_each_time(blur: ScatterBlur) -> None:
    random = np.random.default_rng(8)
    light, radii = random.random((2, 100, 130)).astype(np.float32)
    first = picture(blur, 30 * radii, far=light)
    np.testing.assert_array_equal(picture(blur, 30 * radii, far=light), first)


def test_a_cancelled_blur_stops(renderer: FrameRenderer) -> None:
    ctx = renderer.graphics.ctx
    cancellation = CancellationPoint(ctx.finish)
    blur = ScatterBlur(ctx, ProgramCache(ctx), cancellation)
    radii = np.full((200, 200), 9, np.float32)
    light = np.random.default_rng(1).random((200, 200)).astype(np.float32)
    whole = picture(blur, radii, far=light)
    with cancellation.cancel_when(lambda: True), pytest.raises(Cancelled):
        picture(blur, radii, far=light)
    with cancellation.cancel_when(lambda: False):
        np.testing.assert_array_equal(picture(blur, radii, far=light), whole)


def test_how_much_is_drawn_at_once_is_learnt_from_picture_to_picture(renderer: FrameRenderer) -> None:
    """Not too much at first, and more and more where that takes next to no time."""
    beats: list[int] = []

    class Quick(CancellationPoint):
        is_cancellable = True

        def poll(self) -> float:
            beats[-1] += 1
            return 0.1

    ctx = renderer.graphics.ctx
    blur = ScatterBlur(ctx, ProgramCache(ctx), Quick(ctx.finish))
    light = np.random.default_rng(1).random((100, 100)).astype(np.float32)
    for _ in range(3):
        beats.append(0)
        picture(blur, np.full((100, 100), 20, np.float32), far=light)
    assert beats[0] > 3
    assert beats[2] < beats[1] < beats[0], beats


def test_a_picture_finds_all_its_tables_again(blur: ScatterBlur, monkeypatch: pytest.MonkeyPatch) -> None:
    """However many targets it has."""
    made = []

    def counted(*arguments: Any, **named: Any) -> SpotTables:
        made.append(arguments)
        return make_spot_tables(*arguments, **named)

    monkeypatch.setattr(spot_cache, "make_spot_tables", counted)
    errors = soft_lens(3.0)
    for _ in range(2):
        picture(blur, np.full((40, 40), 500, np.float32), far=point(40), errors=errors)
        assert len(made) == 12, "of six targets, for both fields"


def test_memory_is_given_back(blur: ScatterBlur) -> None:
    picture(blur, np.full((20, 20), 3, np.float32), far=point(20))
    kept = [tables for kept in blur._spots._kept.values() for tables in kept.tables.values()]
    assert kept
    blur.release()
    assert all(isinstance(tables.weights.mglo, moderngl.InvalidObject) for tables in kept)
    assert all(isinstance(tables.reach.mglo, moderngl.InvalidObject) for tables in kept)
    picture(blur, np.full((20, 20), 3, np.float32), far=point(20))


def test_a_spot_without_errors_is_a_point_in_focus() -> None:
    spot = make_camera_spot(IRISES["round"], 1.0)
    assert isinstance(spot, Spot)
    assert not spot.has_errors
    np.testing.assert_allclose(spot.moments, (1, 0, 0), atol=1e-3)


@pytest.mark.parametrize("shape", [(1, 1), (3, 7), (41, 17)])
def test_small_pictures_and_enormous_radii(blur: ScatterBlur, shape: tuple[int, int]) -> None:
    """All of the picture's light is mixed evenly."""
    far = np.random.default_rng(5).random(shape).astype(np.float32)
    np.testing.assert_array_equal(picture(blur, np.zeros(shape, np.float32), far=far), far)
    some = picture(blur, np.full(shape, 4, np.float32), far=far)
    assert some.std() <= 0.5 * far.std()
    np.testing.assert_allclose(picture(blur, np.full(shape, 900, np.float32), far=far), far.mean(), rtol=1e-4)
    awful = picture(blur, np.full(shape, 4, np.float32), far=far, errors=soft_lens(1e5))
    np.testing.assert_allclose(awful, far.mean(), rtol=1e-2)
