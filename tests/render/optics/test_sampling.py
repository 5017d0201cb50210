"""Lens samples fill the iris evenly, stay inside it, and are the same every time."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import SettingsError
from render.model.lens import IrisShape
from render.optics.iris import fill_iris, transmission
from render.optics.sampling import lens_samples, pattern_mask, ray_range, sample_points, square_to_disc
from render.optics.sobol import owen_sobol

# squared radii by turns: many turns, since sixteen blades leave each bin of an angle few of them
GRID = np.stack(np.meshgrid(*[(np.arange(n) + 0.5) / n for n in (99, 3001)], indexing="ij"), -1).reshape(-1, 2)


def rim(angle: np.ndarray, iris: IrisShape) -> np.ndarray:
    half = np.pi / iris.blades
    within = np.mod(angle - iris.rotation_rad, 2 * half) - half
    return iris.roundness + (1 - iris.roundness) * np.cos(half) / np.cos(within)


def test_a_round_iris_is_filled_evenly() -> None:
    points = fill_iris(GRID, IrisShape())
    radius = np.hypot(*points.T)
    assert radius.max() <= 1
    assert np.mean(radius**2) == pytest.approx(0.5, abs=1e-3)  # uniform disc: <r²> = 1/2
    assert np.mean(radius < 0.5) == pytest.approx(0.25, abs=5e-3)
    np.testing.assert_allclose(points.mean(0), 0, atol=1e-3)


@given(st.integers(3, 16), st.floats(0, 1), st.floats(-3, 3))
def test_a_bladed_iris_is_filled_to_its_rim_and_evenly(blades: int, roundness: float, rotation: float) -> None:
    iris = IrisShape(blades, roundness, rotation)
    points = fill_iris(GRID, iris)
    radius, angle = np.hypot(*points.T), np.arctan2(points[:, 1], points[:, 0])
    share = radius / rim(angle, iris)
    assert share.max() <= 1 + 1e-6
    assert share.max() > 0.99
    assert np.mean(share**2) == pytest.approx(0.5, abs=2e-3)
    # density along the rim: a uniform polygon has in each direction an area in proportion to rim²
    sector = np.mod(angle - rotation, 2 * np.pi / blades)
    counts, edges = np.histogram(sector, bins=8, range=(0, 2 * np.pi / blades))
    fine = np.linspace(0, 2 * np.pi / blades, 4001)
    weight = np.histogram(fine, bins=edges, weights=rim(fine + rotation, iris) ** 2)[0]
    np.testing.assert_allclose(counts / counts.sum(), weight / weight.sum(), rtol=0.06)


def test_a_mask_is_filled_as_densely_as_it_passes_light() -> None:
    mask = np.zeros((64, 64))
    mask[:32, 40:] = 1.0  # upper right
    mask[32:, 40:] = 0.5  # lower right
    points = fill_iris(GRID, IrisShape(mask=mask))
    assert (points[:, 0] >= 2 * 40 / 64 - 1 - 1e-9).all()
    assert np.hypot(*points.T).max() <= 1.01  # pixels that the rim crosses are filled whole
    assert np.mean(points[:, 1] > 0) == pytest.approx(2 / 3, abs=0.01)


def test_radial_weights_move_light_to_the_rim_or_from_it() -> None:
    ring = np.hypot(*fill_iris(GRID, IrisShape(radial_weights=(0.0, 0.0, 1.0))).T)
    soft = np.hypot(*fill_iris(GRID, IrisShape(radial_weights=(1.0, 0.0))).T)
    assert ring.min() >= 0.5 - 1e-6
    assert np.mean(soft) == pytest.approx(0.5, abs=5e-3)  # density (1 - r)·r: mean radius 1/2
    image = transmission(IrisShape(radial_weights=(1.0, 0.0)), 64)
    assert image.sum() / 64**2 == pytest.approx(np.pi / 3 / 4, rel=0.01)  # volume of a cone over the square's area


def test_the_irises_image_has_its_area() -> None:
    blades = 6
    area = transmission(IrisShape(blades, rotation_rad=0.3), 128).mean() * 4
    assert area == pytest.approx(blades / 2 * np.sin(2 * np.pi / blades), rel=2e-3)


@pytest.mark.parametrize("iris", [IrisShape(mask=np.zeros((8, 8))), IrisShape(radial_weights=(0.0, 0.0))])
def test_an_iris_that_lets_nothing_through_is_refused(iris: IrisShape) -> None:
    with pytest.raises(SettingsError, match=r"mask|weights"):
        lens_samples(4, iris)


@pytest.mark.parametrize("side", [2, 4, 8])
def test_pixels_of_a_square_have_successive_patterns(side: int) -> None:
    mask = pattern_mask()
    squares = mask.reshape(64 // side, side, 64 // side, side).swapaxes(1, 2).reshape(-1, side * side)
    ordered = np.sort(squares, axis=1)
    assert (ordered[:, 0] % side**2 == 0).all()
    assert (np.diff(ordered, axis=1) == 1).all()
    assert len({row.tobytes() for row in squares}) > 3  # in random order, so that no regular grain is seen


@pytest.mark.parametrize("seed", [0, 7])
def test_points_are_stratified_in_all_pairs_of_dimensions(seed: int) -> None:
    """Each cell has its share of 256 points that are aligned in the sequence."""
    points = owen_sobol(512, seed)[256:]
    for dimension in range(4):
        assert (np.bincount((points[:, dimension] * 256).astype(int), minlength=256) == 1).all()
    for columns, rows in ((256, 1), (64, 4), (16, 16), (4, 64)):
        cells = (points[:, 0] * columns).astype(int) * rows + (points[:, 1] * rows).astype(int)
        assert (np.bincount(cells, minlength=256) == 1).all()
    for one in range(4):
        for other in range(one):
            cells = (points[:, one] * 8).astype(int) * 8 + (points[:, other] * 8).astype(int)
            assert (np.bincount(cells, minlength=64) == 4).all()


def test_four_neighbours_have_less_error_together_than_alone() -> None:
    """The points of a square of 2x2 pixels are one run: their mean error is that of four times the points, not of chance."""
    points = sample_points(64, 0, 64)
    x = np.sqrt(points[..., 0]) * np.cos(2 * np.pi * points[..., 1]) + 0.3 * points[..., 2]
    edges = np.linspace(-0.5, 0.8, 40)
    truth = np.mean(x.ravel()[:, None] < edges, axis=0)
    alone = np.mean(x[..., None] < edges, axis=1) - truth
    together = alone.reshape(16, 4, -1).mean(axis=1)
    assert np.sqrt(np.mean(together**2)) < 0.4 * np.sqrt(np.mean(alone**2))  # chance: 0.5


def test_the_map_to_the_disc_keeps_area_and_neighbours() -> None:
    square = np.stack(np.meshgrid(*[(np.arange(200) + 0.5) / 200] * 2, indexing="ij"), -1)
    disc = fill_iris(square_to_disc(square), IrisShape())
    across, down = np.diff(disc, axis=0)[:, :-1], np.diff(disc, axis=1)[:-1]
    area = np.abs(across[..., 0] * down[..., 1] - across[..., 1] * down[..., 0]) * 200**2
    assert np.mean(np.abs(area / np.pi - 1) < 0.05) > 0.98  # all but the seams along the diagonals
    assert np.median(area) == pytest.approx(np.pi, rel=1e-3)
    assert max(np.hypot(*np.moveaxis(step, -1, 0)).max() for step in (across, down)) < 2.5 / 200 * np.pi / 2


@pytest.mark.parametrize(("rays", "parts"), [(100, 16), (64, 16), (128, 2), (50, 7)])
def test_parts_of_a_pattern_are_spread_as_evenly_as_a_pattern(rays: int, parts: int) -> None:
    points = lens_samples(rays, IrisShape()).pupil
    runs = [ray_range(rays, index, parts) for index in range(parts)]
    assert [i for run in runs for i in range(rays)[run]] == list(range(rays))
    error = np.mean([np.mean(points[:, run].mean(axis=1) ** 2) for run in runs])
    assert error < 0.5 * 0.25 * parts / rays  # 0.25: variance of x over the disc; half of what random points have


def test_the_pattern_integrates_a_smooth_pupil_better_than_random() -> None:
    points = lens_samples(256, IrisShape(), tiled=False).pupil[0]
    error = abs(np.mean(np.cos(2 * points[:, 0]) * np.exp(points[:, 1])) - _disc_mean())
    assert error < 0.25 * 0.66 / np.sqrt(256)  # 0.66: the integrand's standard deviation, so random points err by 0.041


def _disc_mean() -> float:
    points = fill_iris(GRID, IrisShape())
    return float(np.mean(np.cos(2 * points[:, 0]) * np.exp(points[:, 1])))


@given(st.integers(1, 4096), st.integers(0, 2**31 - 1))
def test_the_same_seed_gives_the_same_pattern(rays: int, seed: int) -> None:
    a, b = (lens_samples(rays, IrisShape(6), seed=seed, tiled=False) for _ in range(2))
    assert np.array_equal(a.pupil, b.pupil)
    assert np.array_equal(a.pixel, b.pixel)
    assert np.abs(a.pixel).max() <= 0.5


def test_tiles_differ_and_seeds_differ() -> None:
    tiled = lens_samples(16, IrisShape()).pupil
    assert len({row.tobytes() for row in tiled}) == 64
    assert not np.array_equal(tiled, lens_samples(16, IrisShape(), seed=1).pupil)


def test_one_ray_passes_the_centre() -> None:
    samples = lens_samples(1, IrisShape(5))
    assert not samples.pupil.any()
    assert not samples.pixel.any()


@pytest.mark.parametrize("rays", [0, -3, 4097])
def test_an_absurd_number_of_rays_is_refused(rays: int) -> None:
    with pytest.raises(SettingsError, match="rays must be from 1 to 4096"):
        lens_samples(rays, IrisShape())


@pytest.mark.parametrize("iris", [{"blades": 2}, {"blades": -1}, {"blades": 6, "roundness": 1.5}])
def test_an_impossible_iris_is_refused(iris: dict[str, float]) -> None:
    with pytest.raises(SettingsError, match=r"blades|roundness"):
        IrisShape(**iris)  # type: ignore[arg-type]
