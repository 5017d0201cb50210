"""Film that the device develops is the film that the processor develops for files, and leaves nothing behind."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import moderngl
import numpy as np
import pytest

from render.errors import GraphicsError, SettingsError
from render.film import FilmSettings, Grade, develop_on_film, film_settings
from render.film.develop import expose
from render.film.gpu.developer import Exposure, FilmPass
from render.film.settings import GrainSettings, HalationSettings
from render.film.stock import print_stock
from render.film.targets import small_scene
from render.frame import FrameRenderer
from render.gl.compat import GL
from render.gl.context import GraphicsContext
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.lens import Lens
from render.pictures.live_finisher import LiveFinisher
from render.shot.film.finish import Finish
from usd_schemas import CharacteristicCurve, FilmData, Grain, Sensor, film_names, library_film

pytestmark = pytest.mark.gl

CAMERA_STOCKS = [name for name in film_names() if library_film(name).kind == "camera"]
HEIGHT = 90
SUPER_16 = (12.52, 7.41)
TINY = (1.6, 0.9)
"""A gate on which grain is larger than a pixel."""
HALATION = HalationSettings(0.08, 0.15)


@pytest.fixture
def film_pass(renderer: FrameRenderer) -> Iterator[FilmPass]:
    made = FilmPass(renderer.graphics.ctx)
    yield made
    made.release()


def on_the_device(film_pass: FilmPass, light: FloatArray, film: FilmSettings, exposure: Exposure) -> FloatArray:
    ctx, (height, width, channels) = moderngl.get_context(), light.shape
    source = ctx.texture((width, height), channels, np.ascontiguousarray(light).tobytes(), dtype="f4")
    target = ctx.texture((width, height), 4, dtype="f4")
    film_pass.run(source, target, film, exposure)
    developed = np.frombuffer(target.read(), np.float32).reshape(height, width, 4)
    source.release()
    target.release()
    return developed[..., :3]


def on_the_processor(light: FloatArray, film: FilmSettings, exposure: Exposure) -> FloatArray:
    exposed = expose(light[..., :3], exposure.scale)
    return develop_on_film(exposed, film, frame=exposure.frame, gate_mm=exposure.gate_mm, seed=exposure.seed)


def assert_alike(film_pass: FilmPass, light: FloatArray, film: FilmSettings, exposure: Exposure) -> None:
    """Less than a tenth of one of 255 levels of a display whose gamma is 2.4, where that is steep."""
    ours, wanted = on_the_device(film_pass, light, film, exposure), on_the_processor(light, film, exposure)
    assert np.isfinite(ours).all()
    shown, meant = (np.clip(picture, 0, 1) ** (1 / 2.4) for picture in (ours, wanted))
    assert np.abs(shown - meant).max() < 0.1 / 255
    np.testing.assert_allclose(ours, wanted, rtol=2e-3, atol=1e-4)


@pytest.mark.parametrize("gate_mm", [SUPER_16, TINY], ids=["super 16", "tiny"])
@pytest.mark.parametrize("name", CAMERA_STOCKS)
def test_every_stock_is_developed_alike(film_pass: FilmPass, name: str, gate_mm: tuple[float, float]) -> None:
    film = film_settings(FilmData(push=0.5, white_balance_k=4800, tint=5), name=name)
    amount = 1.0 if film.stock is not None and film.stock.granularity else 0.0
    film = replace(film, grain=GrainSettings(amount, seed=3), halation=HALATION)

    assert_alike(film_pass, small_scene(HEIGHT), film, Exposure(1.3, frame=7, gate_mm=gate_mm, seed=2**40))


def test_a_slide_is_not_printed_whatever_print_there_is(film_pass: FilmPass) -> None:
    film = replace(film_settings(FilmData(), name="velvia_50"), print_stock=print_stock("vision_2383"))

    assert_alike(film_pass, small_scene(HEIGHT), film, Exposure(1.0, frame=1, gate_mm=SUPER_16))


@pytest.mark.parametrize("radius_mm", [0.0, 0.01, 0.4, 5.0])
def test_halation_of_any_size_is_spread_alike(film_pass: FilmPass, radius_mm: float) -> None:
    film = replace(film_settings(FilmData(), name="5219"), halation=HalationSettings(0.3, radius_mm, (1.0, 0.5, 0.0)))

    assert_alike(film_pass, small_scene(60)[:, :71], film, Exposure(1.0, frame=1, gate_mm=(14.2, 12.0)))


def test_a_lamp_has_its_ring_on_the_device_too(film_pass: FilmPass) -> None:
    light = np.full((41, 61, 3), 0.001, np.float32)
    light[20, 30] = 200
    film = replace(film_settings(FilmData(), name="velvia_50"), halation=HalationSettings(0.2, 0.8, (1.0, 0.0, 0.0)))
    exposure = Exposure(1.0, frame=1, gate_mm=(6.1, 4.1))

    assert_alike(film_pass, light, film, exposure)
    shown = on_the_device(film_pass, light, film, exposure)
    assert shown[20, 40, 0] > 10 * shown[20, 40, 1], "the red layer lies deepest"
    assert shown[20, 40, 0] > 3 * shown[20, 33, 0], "it is a ring"


@pytest.mark.parametrize("size_um", [2.0, 20.0, 60.0])
@pytest.mark.parametrize("gate_mm", [(0.64, 0.9), (16.0, 9.0)])
def test_grain_of_any_size_is_the_same_grain(film_pass: FilmPass, size_um: float, gate_mm: tuple[float, float]) -> None:
    film = replace(film_settings(FilmData(), name="tri_x_400"), grain=GrainSettings(1.5, size_um, seed=-4))
    light = np.full((64, 96, 3), 0.18, np.float32)

    assert_alike(film_pass, light, film, Exposure(1.0, frame=-12, gate_mm=gate_mm))
    assert on_the_device(film_pass, light, film, Exposure(1.0, frame=-12, gate_mm=gate_mm)).std() > 1e-3


def test_drawn_curves_and_sensors_and_no_film_are_alike(film_pass: FilmPass) -> None:
    drawn = CharacteristicCurve("parametric", gamma=(0.5, 0.6, 0.7))
    granular = Grain(1.0, (4, 5, 9))
    sensor = Sensor(full_well_e=900, read_noise_e=12, clip_stops=3, sensitivity=(0.5, 1, 0.7))
    said = [
        FilmData("negative", curve=drawn, grain=granular),
        FilmData("monochrome", curve=drawn, grain=granular, push=-1),
        FilmData("digital", sensor=sensor, white_balance_k=3200),
        FilmData("digital", sensor=replace(sensor, clip_stops=0.0), resolution=(4000, 3000)),
        FilmData("none", white_balance_k=7500, tint=-10),
    ]
    for data in said:
        assert_alike(film_pass, small_scene(HEIGHT), film_settings(data), Exposure(0.7, frame=3, gate_mm=SUPER_16))


def test_broken_light_does_not_break_the_picture(film_pass: FilmPass) -> None:
    light = np.array([[[np.nan] * 4, [np.inf] * 4, [-np.inf, 0.5, np.nan, 1], [1e30, -3, 0, 0]]], np.float32)
    film = replace(film_settings(FilmData(), name="5219"), halation=HALATION)

    assert_alike(film_pass, light, replace(film, halation=HalationSettings()), Exposure(2.0, 1, SUPER_16))
    assert np.isfinite(on_the_device(film_pass, light, film, Exposure(2.0, 1, SUPER_16))).all()


def test_an_impossible_exposure_is_refused() -> None:
    with pytest.raises(SettingsError, match="exposure scale must be a finite number from 0 up"):
        Exposure(float("nan"), 1, SUPER_16)
    with pytest.raises(SettingsError, match="a film gate needs a width and a height above 0 mm, got 0 x 9"):
        Exposure(1.0, 1, (0.0, 9.0))


def camera(squeeze: float = 1.0) -> Camera:
    return Camera(
        np.eye(4), focal_length_mm=50, horizontal_aperture_mm=24.9, vertical_aperture_mm=14,
        exposure_scale=1.2, lens=Lens(squeeze=squeeze),
    )  # fmt: skip


def finishes() -> list[Finish]:
    print_film = replace(film_settings(FilmData(grain=Grain(1.0)), name="5219"), halation=HALATION)
    digital = film_settings(FilmData("digital", sensor=Sensor(clip_stops=4, read_noise_e=5)))
    p3 = Grade(display="Display P3 - Display")
    return [Finish(Grade()), Finish(p3, print_film), Finish(Grade(), digital), Finish(p3)]


@pytest.mark.parametrize("finish", finishes(), ids=["graded", "printed", "digital", "display"])
@pytest.mark.parametrize("squeeze", [1.0, 2.0])
def test_a_live_picture_is_the_files_picture(renderer: FrameRenderer, finish: Finish, squeeze: float) -> None:
    light = np.concatenate([small_scene(HEIGHT), np.ones((HEIGHT, 160, 1), np.float32)], axis=2)
    finisher = LiveFinisher(renderer)

    live = finisher.finish(finish, light, camera(squeeze), time=12.75, seed=4)
    finisher.release()

    assert live.dtype == np.float32
    assert np.abs(live - finish.apply(light, camera(squeeze), time=12.75, seed=4)).max() < 0.6 / 255


@pytest.fixture
def own_context() -> Iterator[GraphicsContext]:
    """A context in which nothing lives yet."""
    with GraphicsContext() as graphics:
        yield graphics


class Device:
    """As much of a renderer as finishing needs."""

    def __init__(self, graphics: GraphicsContext) -> None:
        self.graphics = graphics


def living() -> dict[str, list[int]]:
    """Names of all textures and buffers of the current context."""
    return {kind: [i for i in range(1, 300) if getattr(GL, f"glIs{kind}")(i)] for kind in ("Texture", "Buffer")}


def test_many_pictures_take_no_more_of_the_device_than_one(own_context: GraphicsContext) -> None:
    before = living()
    finisher = LiveFinisher(Device(own_context))  # type: ignore[arg-type]
    counts = []
    for turn in range(4):
        for height in (30, 45):
            for finish in finishes():
                finisher.finish(finish, small_scene(height), camera(), time=turn, seed=turn)
        counts.append({kind: len(names) for kind, names in living().items()})

    assert counts[1:] == counts[:1] * 3
    finisher.release()
    assert living() == before


def test_a_context_that_was_made_anew_is_finished_on_anew(own_context: GraphicsContext) -> None:
    device = Device(own_context)
    finisher = LiveFinisher(device)  # type: ignore[arg-type]
    light, [graded, *_] = small_scene(30), finishes()
    first = finisher.finish(graded, light, camera(), time=1, seed=0)
    with GraphicsContext() as device.graphics:
        again = finisher.finish(graded, light, camera(), time=1, seed=0)
        finisher.release()

    np.testing.assert_array_equal(first, again)


class SmallDevice:
    """A context whose shaders read few bytes."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self.info = ctx.info | {"GL_MAX_SHADER_STORAGE_BLOCK_SIZE": 4096}

    def __getattr__(self, name: str) -> Any:
        return getattr(self._ctx, name)


def test_a_picture_too_large_for_the_gpu_is_finished_on_the_cpu(
    own_context: GraphicsContext,
) -> None:
    device = Device(own_context)
    device.graphics.ctx = SmallDevice(own_context.ctx)  # type: ignore[assignment]
    light, [_, printed, *_] = small_scene(30), finishes()

    live = LiveFinisher(device).finish(printed, light, camera(), time=3, seed=0)  # type: ignore[arg-type]

    np.testing.assert_array_equal(live, printed.apply(light, camera(), time=3, seed=0))


class FillingDevice:
    """A context that makes some textures and buffers, and then no more."""

    def __init__(self, ctx: moderngl.Context, left: int) -> None:
        self._ctx, self.left = ctx, left

    def __getattr__(self, name: str) -> Any:
        made = getattr(self._ctx, name)
        if name not in ("texture", "texture3d", "buffer"):
            return made

        def counted(*arguments: Any, **named: Any) -> Any:
            if not self.left:
                raise moderngl.Error("the device is full")
            self.left -= 1
            return made(*arguments, **named)

        return counted


def test_a_picture_that_fails_half_way_leaves_nothing_on_the_device(own_context: GraphicsContext) -> None:
    light, [_, printed, *_] = small_scene(30), finishes()
    device, ctx = Device(own_context), own_context.ctx
    finisher = LiveFinisher(device)  # type: ignore[arg-type]
    device.graphics.ctx = filling = FillingDevice(ctx, 60)  # type: ignore[assignment]
    finisher.finish(printed, light, camera(), time=1, seed=0)
    finisher.release()
    needed, before = 60 - filling.left, living()
    for left in range(needed):
        device.graphics.ctx = FillingDevice(ctx, left)  # type: ignore[assignment]
        with pytest.raises(GraphicsError, match="the device is full"):
            finisher.finish(printed, light, camera(), time=1, seed=0)
        assert living() == before
    own_context.ctx = ctx

    assert needed > 5


def test_light_of_a_strange_shape_is_refused(renderer: FrameRenderer) -> None:
    with pytest.raises(SettingsError, match=r"radiance must be \(height, width, 3\)"):
        LiveFinisher(renderer).finish(Finish(Grade()), np.zeros((4, 4), np.float32), camera(), time=1, seed=0)
