"""Samples of deep pictures: composited front to back, they give the flat picture."""

from __future__ import annotations

import numpy as np

from render.model.arrays import FloatArray
from render.model.deep import DeepSamples, layer_samples
from render.model.mattes import MatteSum


def flatten(deep: DeepSamples, count: int) -> FloatArray:
    """``(count, 4)`` pixels, each sample over the next."""
    flat = np.zeros((count, 4))
    for pixel, light in zip(deep.pixels.tolist(), deep.light.astype(np.float64), strict=True):
        flat[pixel] += (1 - flat[pixel, 3]) * light
    return flat


def test_samples_over_each_other_add_up_to_the_flat_picture() -> None:
    """Surfaces side by side in their pixels, in any order, before a background that shows between them."""
    rng = np.random.default_rng(4)
    pixels = rng.integers(0, 12, 60)
    coverage = rng.uniform(0.01, 0.1, 60)
    light, w = rng.uniform(0, 3, (60, 3)) * coverage[:, None], rng.uniform(0.1, 2, 60)
    color = rng.uniform(0.05, 0.1, (3, 4, 4))
    color[..., 3] = 0
    for i, pixel in enumerate(pixels):
        color.reshape(-1, 4)[pixel] += [*light[i], coverage[i]]
    deep = layer_samples(pixels, np.column_stack([coverage, light, w * coverage]), color.astype(np.float32))

    np.testing.assert_allclose(flatten(deep, 12), color.reshape(-1, 4), rtol=1e-6, atol=1e-7)
    assert (np.diff(deep.pixels) >= 0).all()
    for pixel in range(12):
        own = deep.pixels == pixel
        assert (np.diff(deep.depths_m[own]) >= 0).all()
        np.testing.assert_allclose(sorted(deep.depths_m[own][:-1]), sorted(1 / w[pixels == pixel]), rtol=1e-6)
        assert deep.depths_m[own][-1] == np.inf
        assert deep.light[own][-1, 3] == 0


def test_a_pixel_without_a_background_has_no_sample_of_it() -> None:
    """A whole pixel, one that is half covered before black, and one where nothing is."""
    values = np.array([[0.25, 1, 0, 0, 0.5], [0.75, 0, 1, 0, 0.75], [0.5, 0, 0, 1, 0.125]])
    color = np.array([[[1, 1, 0, 1], [0, 0, 1, 0.5], [0, 0, 0, 0]]], np.float32)
    deep = layer_samples(np.array([0, 0, 1]), values, color)

    np.testing.assert_array_equal(deep.pixels, [0, 0, 1])
    np.testing.assert_allclose(deep.depths_m, [0.5, 1, 4])
    np.testing.assert_allclose(deep.light, [[1, 0, 0, 0.25], [0, 4 / 3, 0, 1], [0, 0, 1, 0.5]], rtol=1e-6)


def test_gain_dims_light_and_leaves_alpha() -> None:
    color = np.array([[[2, 2, 2, 1], [3, 3, 3, 0]]], np.float32)
    deep = layer_samples(np.array([0]), np.array([[1.0, 2, 2, 2, 1]]), color)
    gain = np.array([[[0.5, 0.25, 1, 9], [0.1, 0.1, 0.1, 9]]], np.float32)
    np.testing.assert_allclose(deep.dim(gain).light, [[1, 0.5, 2, 1], [0.3, 0.3, 0.3, 0]], rtol=1e-6)


def test_moments_are_weighed_in_light_and_depth_too() -> None:
    """The same surface at 1 m for a quarter of the exposure, at 2 m for the rest."""
    total = MatteSum(1, 1, is_deep=True)
    for share, depth_m, light in ((0.25, 1.0, 8.0), (0.75, 2.0, 4.0)):
        values = np.array([1.0, light, 0, 0, 1 / depth_m], np.float32).reshape(1, 1, 1, 5)
        total.put((0, 0, 1, 1), np.array([[[7]]], np.uint32), values)
        total.end_moment(share)
    deep = total.layer(np.array([[[5, 0, 0, 1]]], np.float32))
    np.testing.assert_allclose(deep.light, [[5, 0, 0, 1]])
    np.testing.assert_allclose(deep.depths_m, [1 / (0.25 * 1 + 0.75 * 0.5)])


def test_depths_far_away_keep_their_precision() -> None:
    """Two surfaces a millimetre apart at 100 km, by inverse depths that count from a base, as of an orthographic camera."""
    total, base_m = MatteSum(1, 1, is_deep=True), 1e5
    depths_m = np.array([base_m - 0.002, base_m - 0.001])
    off = 1 / depths_m - 1 / base_m
    values = np.array([[0.5, 1, 0, 0, 0.5 * off[0]], [0.5, 0, 1, 0, 0.5 * off[1]]], np.float32).reshape(2, 1, 1, 5)
    total.put((0, 0, 1, 1), np.array([[[7]], [[8]]], np.uint32), values, 1 / base_m)
    total.end_moment(1.0)
    np.testing.assert_allclose(total.layer(np.ones((1, 1, 4), np.float32)).depths_m, depths_m, atol=1e-5, rtol=0)
