"""Grain: as much as is stated, where the film is, new in each frame, and the same for whoever asks."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import fftconvolve
from scipy.stats import kstest

from render.film.grain import APERTURE_UM, add_grain, grain_field
from render.film.noise import normal_noise
from render.film.process import apply_grain, densities, develop_on_film
from render.film.settings import film_settings
from render.film.stock import MIDDLE_GREY, camera_stock
from render.model.arrays import FloatArray
from usd_schemas import FilmData, Grain

PIXEL_UM = 6.0


def through_the_aperture(field: FloatArray, pixel_um: float = PIXEL_UM) -> float:
    """Standard deviation of a field's mean over a round hole of 48 µm, as a microdensitometer has it."""
    half = int(np.ceil(APERTURE_UM / pixel_um / 2)) + 1
    fine = (np.arange((2 * half + 1) * 16) + 0.5) / 16 - half - 0.5
    inside = np.hypot(fine[:, None], fine) <= APERTURE_UM / pixel_um / 2
    hole = inside.reshape(2 * half + 1, 16, 2 * half + 1, 16).mean((1, 3))
    return float(fftconvolve(field, hole / hole.sum(), mode="valid").std())


@pytest.mark.parametrize("size_um", [0.0, 6.0, 15.0])
@pytest.mark.parametrize("pixel_um", [3.0, 6.0, 10.0])
def test_the_field_scatters_by_1_through_the_aperture(size_um: float, pixel_um: float) -> None:
    field = grain_field((500, 600, 1), (pixel_um, pixel_um), size_um, frame=1, seed=2)[..., 0]
    assert abs(field.mean()) < 0.05 * field.std()
    assert through_the_aperture(field, pixel_um) == pytest.approx(1, rel=0.08)


@pytest.mark.parametrize("name", ["double_x_5222", "tri_x_400", "velvia_50", "kodachrome_64", "vision3_500t_5219"])
def test_a_stock_has_its_granularity_at_density_1(name: str) -> None:
    stock = camera_stock(name)
    stated = {"double_x_5222": 14, "tri_x_400": 17, "velvia_50": 9, "kodachrome_64": 10}.get(name)
    shot = film_settings(FilmData(grain=Grain(amount=1, size_um=6.0)), name=name)
    flat = np.array([base + 1.0 for base in stock.base], np.float32)
    grainy = apply_grain(np.broadcast_to(flat, (480, 480, len(flat))), shot, frame=7, gate_mm=(2.88, 2.88))
    for record, (base, table) in enumerate(zip(stock.base, stock.granularity, strict=True)):
        wanted = stated / 1000 if stated else float(np.interp(base + 1.0, *np.array(table).T))
        assert through_the_aperture(grainy[..., record]) == pytest.approx(wanted, rel=0.1)


def test_grain_follows_density_and_its_amount() -> None:
    granularity = camera_stock("velvia_50").granularity
    field = np.ones((1, 3, 3), np.float32)
    density = np.broadcast_to(np.array([0.2, 1.2, 3.2], np.float32)[None, :, None], (1, 3, 3))
    once = add_grain(density, granularity, field, 1.0) - density
    assert (np.diff(once[0, :, 0]) > 0).all()
    assert add_grain(density, granularity, field, 2.0) - density == pytest.approx(2 * once, rel=1e-4)


def test_a_small_format_enlarged_shows_more_grain_than_a_large_one() -> None:
    film = film_settings(FilmData(grain=Grain(amount=1)), name="double_x_5222")
    flat = np.full((200, 300, 3), MIDDLE_GREY, np.float32)
    seen = [develop_on_film(flat, film, frame=1, gate_mm=gate).std() for gate in ((10.3, 6.9), (24.9, 16.6), (36, 24))]
    assert seen[0] > 2.2 * seen[1] > 2.2 * 1.35 * seen[2]


def test_grain_is_the_same_for_the_same_frame_and_new_in_each_frame() -> None:
    film = film_settings(FilmData(grain=Grain(amount=1)), name="5219")
    flat = np.full((64, 64, 3), MIDDLE_GREY, np.float32)

    def taken(frame: int, seed: int) -> FloatArray:
        return develop_on_film(flat, film, frame=frame, gate_mm=(1.0, 1.0), seed=seed)

    assert (taken(1, 0) == taken(1, 0)).all()
    for other in (taken(2, 0), taken(1, 1), taken(-1, 0)):
        assert abs(np.corrcoef(taken(1, 0).ravel(), other.ravel())[0, 1]) < 0.05
    records = grain_field((64, 64, 3), (15, 15), 6, frame=1, seed=0).reshape(-1, 3)
    assert np.abs(np.corrcoef(records.T) - np.eye(3)).max() < 0.06


@pytest.mark.parametrize("size_um", [0.0, 30.0])
def test_tiles_of_grain_fit_together(size_um: float) -> None:
    whole = grain_field((90, 70, 3), (8, 9), size_um, frame=5, seed=3)
    tile = grain_field((40, 25, 3), (8, 9), size_um, frame=5, seed=3, first_row=33, first_column=21)
    assert (tile == whole[33:73, 21:46]).all()


def test_noise_belongs_to_its_place() -> None:
    noise = normal_noise(range(-3, 100), range(-7, 393), 3, frame=1, seed=-5)
    assert (noise[50:60, 20:30] == normal_noise(range(47, 57), range(13, 23), 3, frame=1, seed=-5)).all()


def test_noise_is_normal_and_white() -> None:
    noise = normal_noise(range(512), range(512), 4, frame=3, seed=8)
    assert kstest(noise[..., 0].ravel(), "norm").pvalue > 1e-3
    assert kstest(noise[..., 3].ravel(), "norm").pvalue > 1e-3
    power = np.abs(np.fft.fft2(noise[..., 1])) ** 2 / 512**2
    assert kstest(power[1:256].ravel(), "expon").pvalue > 1e-3, "no frequency is stronger than another"
    others = (noise[:-1] * noise[1:], noise[:, :-1] * noise[:, 1:], noise[..., :3] * noise[..., 1:])
    later = noise * normal_noise(range(512), range(512), 4, frame=4, seed=8)
    for product in (*others, later, noise * normal_noise(range(512), range(512), 4, frame=3, seed=9)):
        assert abs(product.mean()) < 4.5 / np.sqrt(product.size)


def test_grain_of_the_negative_is_printed_with_the_prints_contrast() -> None:
    film = film_settings(FilmData(grain=Grain(amount=1)), name="tri_x_400")
    flat = np.full((200, 200, 3), MIDDLE_GREY, np.float32)
    print_density = -np.log10(develop_on_film(flat, film, frame=1, gate_mm=(1.2, 1.2)))[..., 0]
    assert film.stock is not None
    assert film.print_stock is not None
    [printed] = film.print_stock.curves
    lights = film.print_stock.middle_log_exposure[0]
    gamma = float(printed.density(lights + 0.05) - printed.density(lights - 0.05)) / 0.1
    density = float(densities(flat[:1, :1], film)[0, 0, 0])
    negative = float(np.interp(density, *np.array(film.stock.granularity[0]).T))
    assert through_the_aperture(print_density) == pytest.approx(gamma * negative, rel=0.15)
