"""An iris measured from a photograph of its bokeh is the iris that drew it."""

from __future__ import annotations

import numpy as np
import pytest

from render.errors import InputError
from render.model.arrays import DoubleArray
from render.model.lens import IrisShape
from render.optics.iris import transmission
from render.optics.measured.bokeh_photo import SIDE, STEPS, measure_iris

CENTRE, RADIUS = (141.5, 98.5), 60.0


def photograph(iris: IrisShape, noise: float = 0.0) -> DoubleArray:
    """A picture of 300 x 200 pixels with a disc that the iris draws, on a ground of 0.02."""
    stamp = transmission(iris, side=int(2 * RADIUS))
    picture = np.full((200, 300), 0.02)
    top, left = round(CENTRE[1] + 0.5 - RADIUS), round(CENTRE[0] + 0.5 - RADIUS)
    picture[top : top + len(stamp), left : left + len(stamp)] += 0.6 * stamp
    return picture + noise * np.random.default_rng(5).standard_normal(picture.shape)


@pytest.mark.parametrize("noise", [0.0, 0.02])
@pytest.mark.parametrize("weights", [(1.0,), (1.0, 1.0, 0.8, 0.6), (0.55, 0.6, 0.8, 1.0)])
def test_centre_and_weights_of_a_round_iris_are_found(weights: tuple[float, ...], noise: float) -> None:
    found = measure_iris(photograph(IrisShape(radial_weights=weights), noise), "photo")
    assert found.centre_px == pytest.approx(CENTRE, abs=1)
    assert found.radius_px == pytest.approx(RADIUS, abs=2)
    inner = np.linspace(0, 1, STEPS)[1:-2]
    expected = np.interp(inner, np.linspace(0, 1, len(weights)), weights) / max(weights)
    assert np.array(found.weights)[1:-2] == pytest.approx(expected, abs=0.05)
    assert max(found.weights) == 1


def test_the_blades_are_in_the_mask_and_not_in_the_weights() -> None:
    blades = IrisShape(blades=5, roundness=0.0, rotation_rad=0.3)
    found = measure_iris(photograph(blades), "photo")
    drawn = transmission(blades, side=SIDE) > 0.5
    assert ((found.mask > 0.5) == drawn).mean() > 0.97
    assert np.array(found.weights)[:12] == pytest.approx(1, abs=0.06)


def test_mask_and_weights_together_are_the_photograph() -> None:
    iris = IrisShape(blades=6, roundness=0.2, radial_weights=(0.6, 0.8, 1.0))
    found = measure_iris(photograph(iris), "photo")
    again = transmission(IrisShape(mask=found.mask, radial_weights=found.weights), side=128)
    drawn = transmission(iris, side=128)
    assert np.abs(again / again.max() - drawn / drawn.max()).mean() < 0.04


@pytest.mark.parametrize(
    ("picture", "words"),
    [
        (np.zeros((200, 300)), "no bright disc"),
        (np.ones((200, 300)), "no bright disc"),
        (np.full((200, 300), np.nan), "no numbers"),
        (np.ones((4, 4)), "too small"),
        (photograph(IrisShape())[:, 120:], "cut off"),
        (photograph(IrisShape())[::12, ::12], "too small|pixels wide"),
        (-photograph(IrisShape()), "no bright disc"),
    ],
)
def test_what_is_no_bokeh_is_one_error(picture: DoubleArray, words: str) -> None:
    with pytest.raises(InputError, match=words):
        measure_iris(picture, "photo")


def test_an_overexposed_disc_is_noted() -> None:
    clipped = np.minimum(photograph(IrisShape(radial_weights=(0.6, 1.0))), 0.3)
    assert "overexposed" in measure_iris(clipped, "photo").notes[0]
