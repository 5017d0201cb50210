"""Reflectance of lens surfaces, against textbook numbers."""

from __future__ import annotations

import numpy as np
import pytest

from render.optics.flare.coating import MGF2_INDEX, reflectance


def test_a_bare_surface_reflects_as_fresnel_says_at_normal_incidence() -> None:
    assert reflectance(1.0, 1.5, 1.0, 550.0) == pytest.approx(0.04)
    assert reflectance(1.5, 1.0, 1.0, 550.0) == pytest.approx(0.04)
    assert reflectance(1.5, 1.5, 0.3, 550.0) == pytest.approx(0.0)


def test_at_brewsters_angle_only_one_polarisation_is_reflected() -> None:
    n = 1.5
    # there the reflected and the refracted ray are at right angles, and r_s = cos(2·angle)
    angle = np.arctan(n)
    assert reflectance(1.0, n, np.cos(angle), 550.0) == pytest.approx(np.cos(2 * angle) ** 2 / 2)


def test_beyond_the_critical_angle_everything_is_reflected() -> None:
    critical = np.arcsin(1 / 1.5)
    steep = np.cos([critical + 0.01, 1.5])
    assert reflectance(1.5, 1.0, steep, 550.0) == pytest.approx(1.0)
    assert reflectance(1.5, 1.0, steep, 550.0, 550.0) == pytest.approx(1.0)
    assert reflectance(1.0, 1.5, np.zeros(1), 550.0) == pytest.approx(1.0)


def test_a_quarter_wave_layer_reflects_its_closed_form() -> None:
    n = 1.7
    expected = ((n - MGF2_INDEX**2) / (n + MGF2_INDEX**2)) ** 2
    assert reflectance(1.0, n, 1.0, 520.0, 520.0) == pytest.approx(expected)
    assert reflectance(n, 1.0, 1.0, 520.0, 520.0) == pytest.approx(expected)
    # glass whose index is the square of the layer's is made dark altogether
    assert reflectance(1.0, MGF2_INDEX**2, 1.0, 520.0, 520.0) == pytest.approx(0.0, abs=1e-12)


def test_a_layer_half_a_wave_thick_is_not_there() -> None:
    assert reflectance(1.0, 1.7, 1.0, 260.0, 520.0) == pytest.approx(reflectance(1.0, 1.7, 1.0, 260.0))


def test_a_coating_for_green_leaves_the_ends_of_the_spectrum_brighter() -> None:
    wavelengths_nm = np.array([430.0, 540.0, 680.0])
    blue, green, red = reflectance(1.0, 1.7, 1.0, wavelengths_nm, 540.0)
    assert green < red < blue < reflectance(1.0, 1.7, 1.0, 540.0)
