"""Gaussian splats as a view sees them, against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import sph_harm_y

from render.layers.splats import colours_towards, nearest_splat_w, project_splats
from render.model.arrays import DoubleArray
from render.model.splats import MOST_OPACITY, SplatBatch, SplatCloud
from render.optics.view import PinholeView
from tests.render.kits.splats import CAMERA, SIZE, plain_cloud

VIEW = PinholeView.from_camera(CAMERA, *SIZE)


def batch(cloud: SplatCloud, pose: DoubleArray | None = None) -> SplatBatch:
    return SplatBatch(cloud, (np.eye(4) if pose is None else pose)[None])


def covariance(record: np.ndarray) -> DoubleArray:
    """Covariance of a projected splat, square pixels."""
    factor = np.array([[record[4], 0], [record[5], record[6]]], np.float64)
    return factor @ factor.T


def test_a_splat_is_projected_by_the_derivative_at_its_centre() -> None:
    """The covariance of points around it, projected one by one, is that of its ellipse."""
    random = np.random.default_rng(3)
    axes = random.normal(size=(3, 3)) * 1e-3
    centre = np.array([0.3, -0.2, -2.5])
    cloud = SplatCloud(
        centre[None].astype(np.float32),
        axes[None].astype(np.float32),
        np.array([0.5], np.float32),
        np.zeros((1, 1, 3), np.float32),
    )
    points = centre + random.normal(size=(200_000, 3)) @ axes.T
    pixels, _ = VIEW.project(points)
    (record,) = project_splats([batch(cloud)], VIEW, 0.0).records
    np.testing.assert_allclose(record[:2], pixels.mean(axis=0), atol=2e-3)
    assert record[2] == pytest.approx(1 / 2.5)
    np.testing.assert_allclose(covariance(record), np.cov(pixels.T), rtol=0.02, atol=2e-6)


def test_a_low_pass_filter_widens_each_splat() -> None:
    cloud = plain_cloud([[0, 0, -2]], [[0.02, 0.01, 0.5]], [[1, 1, 1]], [0.5])
    (record,) = project_splats([batch(cloud)], VIEW, 0.3).records
    wide, high = (VIEW.fx * size / 2.0 for size in (0.02, 0.01))
    np.testing.assert_allclose(covariance(record), np.diag([wide**2 + 0.3, high**2 + 0.3]), rtol=1e-5, atol=1e-6)


def test_views_through_the_pupil_shear_splats() -> None:
    """A view through another point of the pupil sees what a view from there sees, moved to keep the focus in place."""
    from render.optics.thin_lens import focal_surface

    cloud = plain_cloud([[0.1, 0.2, -3.0]], [[0.02, 0.01, 0.05]], [[1, 1, 1]], [0.5])
    sheared = VIEW.through(0.05, -0.03, focal_surface(CAMERA).plane)
    (record,) = project_splats([batch(cloud)], sheared, 0.0).records
    pixels, _ = sheared.project(np.array([[0.1, 0.2, -3.0]]))
    np.testing.assert_allclose(record[:2], pixels[0], rtol=1e-6)
    moved = np.eye(4)
    moved[:2, 3] = -0.05, 0.03
    (beside,) = project_splats([batch(cloud, moved)], VIEW, 0.0).records
    np.testing.assert_allclose(covariance(record), covariance(beside), rtol=1e-5)


def test_splats_are_sorted_far_to_near_and_clipped() -> None:
    depths = [3.0, 0.05, 1.0, 9.0, 2.0, -1.0]
    cloud = plain_cloud(
        [[0, 0, -z] for z in depths], [[0.01] * 3] * 6, [[1, 1, 1]] * 6, [0.5, 0.5, 0.5, 0.5, 0.001, 0.5]
    )
    view = replace(VIEW, far_m=5.0)
    found = project_splats([batch(cloud)], view, 0.3)
    np.testing.assert_allclose(found.w, [1 / 3, 1.0])
    assert nearest_splat_w([batch(cloud)], view) == pytest.approx(1.0)


def test_opacity_is_limited_as_in_the_reference_rasteriser() -> None:
    cloud = plain_cloud([[0, 0, -2]], [[0.02] * 3], [[1, 1, 1]], [1.0])
    (record,) = project_splats([batch(cloud)], VIEW, 0.3).records
    assert record[3] == pytest.approx(MOST_OPACITY)
    assert record[7] == pytest.approx(np.sqrt(2 * np.log(255 * MOST_OPACITY)))


def real_harmonic(degree: int, order: int, towards: DoubleArray) -> DoubleArray:
    """Real spherical harmonic, with the sign of Condon and Shortley, of directions ``(n, 3)``."""
    theta, phi = np.arccos(towards[:, 2]), np.arctan2(towards[:, 1], towards[:, 0])
    value = sph_harm_y(degree, abs(order), theta, phi)
    if order == 0:
        return np.asarray(value.real)
    return np.asarray(np.sqrt(2) * (value.imag if order < 0 else value.real))


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_colours_are_real_spherical_harmonics(degree: int) -> None:
    """Each coefficient by itself gives its harmonic at the direction from the eye to the splat."""
    random = np.random.default_rng(degree)
    towards = random.normal(size=(50, 3))
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    eye = np.array([0.5, 1.0, -2.0])
    for order in range(-degree, degree + 1):
        place = degree * degree + degree + order
        harmonics = np.zeros((50, (degree + 1) ** 2, 3), np.float32)
        harmonics[:, place] = 0.2
        positions = (eye + 3 * towards).astype(np.float32)
        cloud = SplatCloud(positions, np.zeros((50, 3, 3), np.float32), np.ones(50, np.float32), harmonics, False)
        found = colours_towards(cloud, np.arange(50), eye)[:, 0] - 0.5
        np.testing.assert_allclose(found, 0.2 * real_harmonic(degree, order, towards), atol=2e-6)


def test_encoded_colours_are_made_linear() -> None:
    cloud = plain_cloud(
        [[0, 0, -2]] * 3, [[0.02] * 3] * 3, [[0.02] * 3, [0.5] * 3, [-1.0] * 3], [0.5] * 3, is_encoded=True
    )
    found = colours_towards(cloud, np.arange(3), np.zeros(3))
    np.testing.assert_allclose(found[:, 0], [0.02 / 12.92, ((0.5 + 0.055) / 1.055) ** 2.4, 0.0], rtol=1e-5)


def test_a_turned_cloud_turns_its_harmonics() -> None:
    """Directions count in the cloud's own space."""
    harmonics = np.zeros((1, 4, 3), np.float32)
    harmonics[0, 3] = 0.4  # towards -x
    cloud = SplatCloud(
        np.zeros((1, 3), np.float32), np.eye(3, dtype=np.float32)[None] / 50, np.ones(1, np.float32), harmonics, False
    )
    turn = np.array(
        [[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, -2], [0, 0, 0, 1]], np.float64
    )  # x of the cloud is -z of the world
    (record,) = project_splats([batch(cloud, turn)], VIEW, 0.3).records
    assert record[8] == pytest.approx(0.5 - 0.4886025119 * 0.4 * 1.0)
