"""Stars of irises, held against the closed forms of diffraction."""

from __future__ import annotations

import numpy as np
import pytest

from render.model.arrays import DoubleArray
from render.model.lens import IrisShape
from render.optics.flare.diffraction import VISIBLE, Star, star
from render.optics.iris import transmission
from render.optics.spectrum import Spectrum

GREEN = Spectrum((550.0,), np.ones((1, 3)))


def point(side: int = 256, value: float = 1.0) -> np.ndarray:
    picture = np.zeros((side, side, 3), np.float32)
    picture[side // 2, side // 2] = value
    return picture


def of_green(iris: IrisShape, lambda_over_d_px: float, side: int = 256, **more: float) -> Star:
    per_nm = lambda_over_d_px / 550.0
    return star(iris, (per_nm, per_nm), side, side, light=GREEN, **more)


def along(picture: np.ndarray, angle_rad: float, radii: DoubleArray) -> DoubleArray:
    """The green channel along a direction from the middle, counter-clockwise from the right."""
    middle = picture.shape[0] // 2
    x, y = middle + radii * np.cos(angle_rad), middle - radii * np.sin(angle_rad)
    return np.asarray(picture[np.round(y).astype(int), np.round(x).astype(int), 1], np.float64)


def test_a_round_iris_draws_airys_disc() -> None:
    # Airy: 4·(J1(x)/x)², whose first zeros are at 1.22 and 2.23 λ/D, and whose first ring peaks at 1.64 λ/D with 1.75 %
    spread = of_green(IrisShape(), 16.0).spread(point())
    radii = np.arange(1.0, 50.0)
    profile = along(spread, 0.0, radii) / spread.max()
    first = radii[8:26][profile[8:26].argmin()]
    second = radii[28:42][profile[28:42].argmin()]
    assert first == pytest.approx(1.22 * 16, abs=1)
    assert second == pytest.approx(2.233 * 16, abs=1)
    assert profile[int(1.635 * 16) - 1] == pytest.approx(0.0175, rel=0.05)


def test_a_round_irises_light_within_a_radius_is_airys() -> None:
    # Rayleigh: 83.8 % within the first dark ring
    spread = of_green(IrisShape(), 16.0, 512).spread(point(512))
    y, x = np.mgrid[:512, :512] - 256
    assert spread[np.hypot(x, y) < 1.22 * 16, 1].sum() == pytest.approx(0.838, abs=0.01)


@pytest.mark.parametrize(("blades", "spikes"), [(3, 6), (5, 10), (6, 6), (7, 14), (8, 8)])
def test_odd_blades_draw_twice_as_many_spikes_and_even_ones_as_many(blades: int, spikes: int) -> None:
    spread = star(IrisShape(blades=blades, rotation_rad=0.1), (0.005, 0.005), 257, 257).spread(point(257))[..., 1]
    y, x = np.mgrid[:257, :257] - 128
    radius = np.hypot(x, y)
    ring = (radius > 40) & (radius < 120)
    bins = (np.arctan2(-y, x)[ring] / (2 * np.pi) * 180).astype(int) % 180
    profile = np.bincount(bins, spread[ring] * radius[ring] ** 2, 180) / np.bincount(bins, minlength=180)
    around = [profile.take(range(i - 5, i + 6), mode="wrap").max() for i in range(180)]
    peaks = np.flatnonzero((profile == around) & (profile > 0.3 * profile.max())).tolist()
    assert len(peaks) == spikes
    assert np.diff([*peaks, peaks[0] + 180]) == pytest.approx(180 / spikes, abs=2)


def test_spikes_stand_across_the_blades() -> None:
    # a square on its corner: edges at 45 degrees, spikes across them; turned by an eighth they lie level
    def strongest(rotation_rad: float) -> float:
        spread = star(IrisShape(blades=4, rotation_rad=rotation_rad), (0.002, 0.002), 129, 129).spread(point(129))
        turns = np.linspace(0, np.pi / 2, 91)
        return float(turns[np.argmax([along(spread, turn, np.arange(20.0, 60.0)).mean() for turn in turns])])

    assert strongest(0.0) == pytest.approx(np.pi / 4, abs=0.03)
    assert strongest(0.2) == pytest.approx(np.pi / 4 + 0.2, abs=0.03)


@pytest.mark.parametrize(
    "iris", [IrisShape(), IrisShape(blades=7, roundness=0.3), IrisShape(radial_weights=(1.0, 0.2))], ids=str
)
def test_light_is_kept_and_an_even_picture_stays_even(iris: IrisShape) -> None:
    made = star(iris, (0.003, 0.003), 160, 90)
    rng = np.random.default_rng(3)
    picture = (rng.random((90, 160, 3)) ** 20 * 1000).astype(np.float32)
    spread = made.spread(picture)
    assert spread.min() >= 0
    assert spread.sum(axis=(0, 1), dtype=np.float64) == pytest.approx(
        picture.sum(axis=(0, 1), dtype=np.float64), rel=0.01
    )
    even = made.spread(np.full((90, 160, 3), 0.18, np.float32))
    assert even.min() == pytest.approx(0.18, rel=1e-5)
    assert even.max() == pytest.approx(0.18, rel=1e-5)


def test_a_star_is_the_squared_fourier_transform_of_its_iris() -> None:
    iris = IrisShape(blades=5, rotation_rad=0.4)
    side, cells = 512, 64  # λ/D is side/cells pixels of the transform
    opening = np.zeros((side, side))
    opening[:cells, :cells] = transmission(iris, cells)
    expected = np.fft.fftshift(np.abs(np.fft.fft2(opening)) ** 2)
    made = of_green(iris, side / cells, side).spread(point(side))[..., 1]
    middle = slice(side // 2 - 40, side // 2 + 41)
    expected /= expected.sum()
    # The picture's pixels gather light that the transform has at their middles: alike where it changes slowly.
    difference = np.abs(made[middle, middle] - expected[middle, middle])
    assert difference.max() < 0.03 * expected.max()
    assert (
        np.corrcoef(np.log(made[middle, middle] + 1e-7).ravel(), np.log(expected[middle, middle] + 1e-7).ravel())[0, 1]
        > 0.98
    )


def test_an_iris_by_its_image_has_the_star_of_its_outline() -> None:
    blades = IrisShape(blades=6)
    by_image = of_green(IrisShape(mask=transmission(blades, 512)), 8.0).spread(point())
    by_outline = of_green(blades, 8.0).spread(point())
    assert np.abs(by_image - by_outline).max() < 0.01 * by_outline.max()


def test_diffraction_grows_with_the_f_number_and_the_wavelength() -> None:
    # far out the light falls with the square of the distance along a spike: twice λ/D has twice the light there
    near, far = of_green(IrisShape(blades=4), 0.05), of_green(IrisShape(blades=4), 0.1)
    radii = np.arange(30.0, 80.0)
    spike = [along(s.spread(point()), np.pi / 4, radii).sum() for s in (near, far)]
    assert spike[1] / spike[0] == pytest.approx(2.0, rel=0.05)
    red, _, blue = (
        star(IrisShape(blades=4), (1e-3, 1e-3), 256, 256, light=VISIBLE)
        .spread(point())[100:110, 100:110]
        .sum(axis=(0, 1))
    )
    assert red > blue


def test_strength_multiplies_what_lands_far_from_its_source() -> None:
    radii = np.arange(30.0, 80.0)
    iris = IrisShape(blades=4)
    spike = [along(of_green(iris, 0.05, strength=s).spread(point()), np.pi / 4, radii).sum() for s in (1.0, 3.0)]
    assert spike[1] / spike[0] == pytest.approx(3.0, rel=0.05)
    none, half, whole, twice = (of_green(iris, 2.0, strength=s).spread(point())[..., 1] for s in (0, 0.5, 1, 2))
    np.testing.assert_allclose(none, point()[..., 1], atol=1e-6)
    core = np.s_[125:132, 125:132]
    np.testing.assert_allclose(half[core], (whole + none)[core] / 2, rtol=0.02)
    around = whole[core] < whole.max()
    np.testing.assert_allclose(twice[core][around], whole[core][around], rtol=0.01)  # it is no blur
    assert twice.sum() == pytest.approx(whole.sum(), rel=0.01)


def test_a_squeezed_pupil_spreads_wider_across() -> None:
    spread = star(IrisShape(), (0.02, 0.01), 256, 256).spread(point())
    assert along(spread, 0.0, np.arange(9.0, 12.0)).sum() > 3 * along(spread, np.pi / 2, np.arange(9.0, 12.0)).sum()
