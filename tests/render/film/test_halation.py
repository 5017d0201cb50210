"""Halation: a ring of the light that was there, no more and no less."""

from __future__ import annotations

import numpy as np
import pytest

from render.errors import SettingsError
from render.film.halation import add_halation, halation_kernel

RED = (1.0, 0.3, 0.1)


@pytest.mark.parametrize("where", [(50, 60), (0, 0), (3, 118), (99, 60)])
def test_no_light_is_made_or_lost(where: tuple[int, int]) -> None:
    light = np.full((100, 120, 3), 0.18, np.float32)
    light[where] = 1000.0
    glowing = add_halation(light, 0.2, 0.3, RED, (0.05, 0.05))
    assert glowing.sum((0, 1), dtype=np.float64) == pytest.approx(light.sum((0, 1), dtype=np.float64), rel=1e-5)
    assert glowing[where] == pytest.approx(1000 * (1 - 0.2 * np.array(RED)), rel=0.02)


def test_an_even_picture_stays_even() -> None:
    light = np.full((31, 47, 3), 0.7, np.float32)
    assert add_halation(light, 0.5, 0.4, RED, (0.1, 0.08)) == pytest.approx(light, rel=1e-5)


def test_light_comes_back_as_a_ring_of_the_given_radius() -> None:
    light = np.zeros((201, 201, 3), np.float32)
    light[100, 100] = 1.0
    glowing = add_halation(light, 0.1, 1.0, (1, 1, 1), (0.05, 0.05))[100, 100:, 1]
    assert 20 <= int(np.argmax(glowing[1:])) + 1 <= 21  # 20 pixels to the millimetre
    assert glowing[10] < 0.15 * glowing[21]
    assert glowing[21] > glowing[30] > glowing[60] > 0
    # (1 + tan² θ)⁻², and tan θ grows with the distance: at the ring it is the critical angle's, 1/√(n² − 1)
    tan2 = 1 / (1.48**2 - 1)
    wanted = ((1 + tan2 * (21 / 20) ** 2) / (1 + tan2 * (42 / 20) ** 2)) ** 2
    assert glowing[42] / glowing[21] == pytest.approx(wanted, rel=0.01)


def test_a_ring_is_round_on_the_film_though_pixels_are_not_square() -> None:
    kernel = halation_kernel(20.0, 10.0)
    rows, columns = (n // 2 for n in kernel.shape)
    assert np.argmax(kernel[rows, columns + 1 :]) in (19, 20)
    assert np.argmax(kernel[rows + 1 :, columns]) in (9, 10)
    assert kernel.sum() == pytest.approx(1)
    assert kernel == pytest.approx(kernel[::-1, ::-1])


def test_halation_within_a_pixel_changes_little_and_radius_0_nothing() -> None:
    light = np.random.default_rng(3).random((20, 20, 3), np.float32)
    assert add_halation(light, 0.1, 0.001, RED, (1.0, 1.0)) == pytest.approx(light, abs=0.02)
    assert add_halation(light, 0.1, 0.0, RED, (1.0, 1.0)) is light
    assert add_halation(light, 0.0, 0.1, RED, (1.0, 1.0)) is light


def test_a_ring_larger_than_the_picture_is_drawn_too() -> None:
    light = np.random.default_rng(3).random((12, 9, 3), np.float32)
    glowing = add_halation(light, 0.3, 2.0, (1, 1, 1), (0.1, 0.1))
    assert glowing.sum() == pytest.approx(light.sum(), rel=1e-4)


@pytest.mark.parametrize(
    ("amount", "radius", "color"),
    [(1.5, 0.1, RED), (-0.1, 0.1, RED), (0.5, -1.0, RED), (0.5, 1e4, RED), (0.6, 0.1, (2.0, 0, 0))],
)
def test_more_light_than_there_is_cannot_come_back(
    amount: float, radius: float, color: tuple[float, float, float]
) -> None:
    with pytest.raises(SettingsError, match="halation needs a radius from 0 to 5 mm and throws back from 0 to 1"):
        add_halation(np.zeros((4, 4, 3), np.float32), amount, radius, color, (0.1, 0.1))
