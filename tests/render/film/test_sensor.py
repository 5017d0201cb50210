"""Digital sensors: linear up to the clip, with the noise that electrons have."""

from __future__ import annotations

import math

import numpy as np
import pytest

from render.errors import SettingsError
from render.film.process import develop_on_film
from render.film.sensor import SensorSettings, expose_sensor
from render.film.settings import FilmSettings, film_settings
from usd_schemas import FilmData
from usd_schemas import Sensor as SensorData

SIZE = (200, 300, 3)


def seen(level: float, sensor: SensorSettings, frame: int = 1) -> np.ndarray:
    return expose_sensor(np.full(SIZE, level, np.float32), sensor, frame=frame, seed=0)


@pytest.mark.parametrize("level", [0.02, 0.18, 0.9, 5.0])
def test_it_is_linear_and_its_noise_is_the_root_of_the_electrons(level: float) -> None:
    sensor = SensorSettings(full_well_e=20000, read_noise_e=6)
    picture = seen(level, sensor)
    electrons = 20000 * level
    assert picture.mean() == pytest.approx(level, rel=0.002)
    assert picture.std() == pytest.approx(math.sqrt(electrons + 36) / 20000, rel=0.02)


def test_it_clips_so_many_stops_above_middle_grey_at_each_speed() -> None:
    for iso in (100, 800):
        sensor = SensorSettings(clip_stops=3, iso=iso, full_well_e=1e6)
        assert sensor.clip == pytest.approx(1.44)
        assert seen(1.3, sensor).mean() == pytest.approx(1.3, rel=0.01)
        assert seen(40.0, sensor).max() == pytest.approx(1.44)
    assert seen(40.0, SensorSettings()).mean() == pytest.approx(40, rel=0.01)


def test_each_doubling_of_the_speed_halves_the_electrons() -> None:
    base = SensorSettings(full_well_e=20000, base_iso=800, iso=800)
    fast = SensorSettings(full_well_e=20000, base_iso=800, iso=3200)
    assert seen(0.18, fast).std() == pytest.approx(2 * seen(0.18, base).std(), rel=0.02)
    assert seen(0.18, fast).mean() == pytest.approx(0.18, rel=0.002)


def test_a_weak_channel_is_noisier_and_as_bright() -> None:
    picture = seen(0.18, SensorSettings(sensitivity=(0.25, 1.0, 0.5)))
    assert picture.mean((0, 1)) == pytest.approx([0.18] * 3, rel=0.002)
    red, green, blue = picture.std((0, 1))
    assert (red / green, blue / green) == pytest.approx((2, math.sqrt(2)), rel=0.03)


def test_a_pixel_averages_the_photosites_that_it_covers() -> None:
    fine = SensorSettings(photosites=(1200, 800))  # 16 to a pixel
    assert seen(0.18, fine).std() == pytest.approx(seen(0.18, SensorSettings()).std() / 4, rel=0.03)


def test_noise_is_of_the_frame() -> None:
    sensor = SensorSettings()
    assert (seen(0.18, sensor, 4) == seen(0.18, sensor, 4)).all()
    assert abs(np.corrcoef(seen(0.18, sensor, 4).ravel(), seen(0.18, sensor, 5).ravel())[0, 1]) < 0.02


def test_the_shot_s_sensor_is_developed_with_its_speed_and_balance() -> None:
    data = FilmData(
        process="digital",
        speed=800,
        white_balance_k=3200,
        resolution=(600, 400),
        sensor=SensorData(read_noise_e=3, clip_stops=5),
    )
    film = film_settings(data, iso=1600)
    assert film.sensor == SensorSettings(40000, 3, 5, (1, 1, 1), 800, 1600, (600, 400))
    assert film_settings(data).sensor.iso == 800
    light = np.full(SIZE, 0.18, np.float32)
    plain, balanced = (
        develop_on_film(light, made, frame=1, gate_mm=(36, 24))
        for made in (FilmSettings("digital", sensor=film.sensor), film)
    )
    assert plain.mean((0, 1)) == pytest.approx([0.18] * 3, rel=0.01)
    red, _, blue = balanced.mean((0, 1))
    assert red < 0.15 < 0.4 < blue  # white light under tungsten's balance
    noise = balanced.std((0, 1)) / balanced.mean((0, 1))
    assert np.ptp(noise) < 0.04 * noise.mean()  # the electrons are as many in each channel: they are only turned up


@pytest.mark.parametrize(
    "said",
    [
        {"full_well_e": 0.0},
        {"iso": -1.0},
        {"iso": 1e300},
        {"read_noise_e": -1.0},
        {"sensitivity": (1, 0, 1)},
        {"clip_stops": -2.0},
        {"clip_stops": 5000.0},
    ],
)
def test_an_impossible_sensor_is_refused(said: dict[str, float]) -> None:
    with pytest.raises(SettingsError, match="a sensor needs"):
        SensorSettings(**said)  # type: ignore[arg-type]
