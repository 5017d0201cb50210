"""Clearances over the pupil: traced where the edge of what is open runs, and as if all had been."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.trace.open_pupil import clearances

_LINE = np.linspace(-1, 1, 41)
_SQUARE = np.stack(np.meshgrid(_LINE, _LINE[20:], indexing="ij"), axis=-1)
_ON_DISC = np.hypot(*np.moveaxis(_SQUARE, -1, 0)) <= 1 + 1e-9


def _circle(centre: float, radius: float) -> DoubleArray:
    return np.asarray(np.hypot(_SQUARE[..., 0] - centre, _SQUARE[..., 1]) / radius - 1)


@pytest.mark.parametrize(
    "whole",
    [
        _circle(0.0, 1.1),
        np.maximum(_circle(0.7, 1.0), _circle(-0.6, 1.2)),  # cat's eye
        _circle(0.95, 0.2),
        np.where(_SQUARE[..., 0] > 0.31, np.nan, _circle(0.0, 0.62)),  # rays that are lost
        np.full(_ON_DISC.shape, np.nan),
    ],
    ids=["open", "cat's eye", "last light", "lost", "dark"],
)
def test_the_open_pupil_is_found_from_part_of_its_rays(whole: DoubleArray) -> None:
    asked = 0

    def trace(heights: NDArray[np.int64], points: NDArray[np.int64]) -> DoubleArray:
        nonlocal asked
        asked += len(heights)
        return np.asarray(np.where(heights == 0, whole.ravel()[points], -0.5))

    found, other = clearances(trace, 2, _ON_DISC)
    is_open = whole <= 0
    np.testing.assert_array_equal((found <= 0)[_ON_DISC], is_open[_ON_DISC])
    np.testing.assert_array_equal(other[_ON_DISC] <= 0, True)
    for axis in (0, 1):  # where the kind changes between neighbours, both are exact
        a, b = (slice(None, -1), slice(1, None)) if axis == 0 else ((slice(None), slice(None, -1)), np.s_[:, 1:])
        edge = (is_open[a] != is_open[b]) & _ON_DISC[a] & _ON_DISC[b]
        for part in (a, b):
            np.testing.assert_array_equal(found[part][edge], whole[part][edge])
    assert asked < 0.6 * 2 * _ON_DISC.sum()
