"""FLIP agrees with the authors' program, and has the properties that their paper asks for."""

from __future__ import annotations

import numpy as np
import pytest

from render.lab.reference.flip import flip, flip_map
from render.model.arrays import FloatArray


def picture() -> FloatArray:
    """A gradient in red and green and a chequered pattern in blue, ``(48, 64, 3)``."""
    y, x = np.mgrid[:48, :64]
    return np.stack([x / 64, y / 48, (x // 8 + y // 8) % 2], axis=-1).astype(np.float32) * 0.8


def changed() -> FloatArray:
    """The picture with a darker part, a white dot and a yellow line."""
    other = picture()
    other[10:30, 20:40] *= 0.7
    other[40, 50] = 1.0
    other[5, :, :2] = 0.9
    return other


def test_values_are_those_of_the_authors_program() -> None:
    """Values of flip-evaluator 1.7 for the same linear pictures, LDR, default distance."""
    errors = flip_map(changed(), picture())
    assert errors.mean() == pytest.approx(0.151494, abs=2e-5)
    places = {(5, 10): 0.83181, (20, 30): 0.39742, (40, 50): 0.14974, (41, 52): 0.03761, (24, 12): 0.00247}
    for place, error in places.items():
        assert errors[place] == pytest.approx(error, abs=2e-5)


def test_it_is_symmetric_bounded_and_0_for_equal_pictures() -> None:
    assert flip(picture(), picture()) == 0
    assert flip(changed(), picture()) == pytest.approx(flip(picture(), changed()))
    black, white = np.zeros((16, 16, 3), np.float32), np.ones((16, 16, 3), np.float32)
    assert 0.9 < flip(black, white) <= 1


def test_a_pattern_too_fine_to_be_seen_is_less_of_an_error_from_afar() -> None:
    noise = np.random.default_rng(1).uniform(-0.1, 0.1, (48, 64, 1)).astype(np.float32)
    near, far = (flip(picture() + noise, picture(), ppd) for ppd in (30.0, 120.0))
    assert far < 0.7 * near
