"""Diffractive surfaces, by closed forms of the thin lens and of gratings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.errors import InputError
from render.model.arrays import DoubleArray
from render.model.lens import Glass, Prescription, Surface
from render.optics.prescription.completion import complete_prescription, scale_prescription
from render.optics.prescription.diffraction import diffract, phase_at, phase_slopes
from render.optics.prescription.paraxial import first_order, focal_points, paraxial_system
from render.optics.prescription.surface_shape import slopes_at
from render.optics.prescription.tracing import Fate, trace_backward, trace_forward
from render.optics.prescription.validation import check_prescription
from tests.render.kits.phases import ideal_phase

DESIGN_NM = 550.0
FOCAL_MM = 80.0


PLATE = Prescription(
    (Surface(0.0, FOCAL_MM, semi_diameter_mm=10.0, is_stop=True, phase=ideal_phase(FOCAL_MM)),), f_stop=4
)


def parallel(points: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    starts = np.concatenate([points, np.full((len(points), 1), -5.0)], axis=1)
    return starts, np.tile([0.0, 0.0, 1.0], (len(points), 1))


def ring(radius: float, count: int = 12) -> DoubleArray:
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


@pytest.mark.parametrize("wavelength_nm", [450.0, 550.0, 650.0])
def test_the_focal_length_is_as_one_over_the_wavelength(wavelength_nm: float) -> None:
    wanted = FOCAL_MM * DESIGN_NM / wavelength_nm
    assert focal_points(paraxial_system(PLATE, wavelength_nm))[0] == pytest.approx(wanted, rel=1e-12)
    near = trace_forward(PLATE, *parallel(ring(0.01)), wavelength_nm)
    np.testing.assert_allclose(near.at(wanted), 0.0, atol=1e-9)


def test_light_of_the_design_wavelength_meets_in_a_point() -> None:
    points = np.concatenate([ring(radius) for radius in (2.0, 6.0, 9.9)])
    np.testing.assert_allclose(trace_forward(PLATE, *parallel(points), DESIGN_NM).at(FOCAL_MM), 0.0, atol=1e-9)


def test_each_zone_is_a_grating() -> None:
    """sin θ' = sin θ + λ·(dφ/dr)/2π at a plane in air."""
    lens = Prescription((Surface(0.0, 10.0, phase=(30.0, -0.2)),))
    heights = np.linspace(-6, 6, 13)
    starts, headings = parallel(np.stack([np.zeros(13), heights], axis=1))
    sine = 0.2
    headings = headings * 0 + [0.0, sine, np.sqrt(1 - sine**2)]
    starts[:, 1] -= 5.0 * headings[:, 1] / headings[:, 2]
    rays = trace_forward(lens, starts, headings, 600.0)
    rays_sines = sine + 600e-6 / (2 * np.pi) * (60.0 * heights - 0.8 * heights**3)
    np.testing.assert_allclose(rays.directions[:, 1], rays_sines, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(rays.directions, axis=1), 1.0, atol=1e-14)


CURVED = Surface(40.0, 6.0, Glass(1.5), 12.0, conic=-0.5, aspheric=(1e-6,), phase=(-25.0, 0.03))


def test_on_glass_the_tangential_momentum_grows_by_the_phase() -> None:
    rng = np.random.default_rng(4)
    starts = np.concatenate([rng.uniform(-8, 8, (50, 2)), np.full((50, 1), -5.0)], axis=1)
    headings = np.concatenate([rng.uniform(-0.2, 0.2, (50, 2)), np.ones((50, 1))], axis=1)
    headings /= np.linalg.norm(headings, axis=1)[:, None]
    rays = trace_forward(Prescription((CURVED,)), starts, headings, 500.0)
    points, step = rays.points_mm[0], 1e-5
    normals = np.concatenate([-slopes_at(CURVED, points[:, :2]), np.ones((50, 1))], axis=1)
    added = 500e-6 / (2 * np.pi) * np.pad(phase_slopes(CURVED, points[:, :2]), [(0, 0), (0, 1)])
    np.testing.assert_allclose(
        np.cross(normals, 1.5 * rays.directions), np.cross(normals, headings + added), atol=1e-12
    )
    by_steps = [
        (phase_at(CURVED, points[:, :2] + step * way) - phase_at(CURVED, points[:, :2])) / step for way in np.eye(2)
    ]
    np.testing.assert_allclose(phase_slopes(CURVED, points[:, :2]), np.stack(by_steps, axis=1), atol=1e-2)


def test_without_phase_it_is_refraction() -> None:
    points = np.column_stack([ring(5.0), np.zeros(12)])
    headings = np.tile([0.1, -0.05, np.sqrt(1 - 0.0125)], (12, 1))
    plain = replace(CURVED, phase=())
    lens = trace_forward(Prescription((plain,)), points - 9 * headings, headings)
    met, _ = diffract(plain, lens.points_mm[0], headings, 1 / 1.5, 1e-4)
    np.testing.assert_allclose(met, lens.directions, atol=1e-14)


def test_a_ray_goes_back_as_it_came() -> None:
    lens = Prescription((CURVED, Surface(-70.0, 0.0, semi_diameter_mm=12.0, phase=(4.0,))))
    starts, headings = parallel(ring(6.0) + np.array([0.5, 0.0]))
    there = trace_forward(lens, starts, headings, 620.0)
    back = trace_backward(lens, there.points_mm[-1] + there.directions, -there.directions, 620.0)
    np.testing.assert_allclose(back.directions, -headings, atol=1e-12)


def test_an_order_that_does_not_exist_is_reflected() -> None:
    lens = Prescription((Surface(0.0, 5.0, phase=(2000.0,)),))
    rays = trace_forward(lens, *parallel(np.array([[0.0, 1.0], [0.0, 3.0]])))
    assert rays.fates.tolist() == [Fate.PASSES, Fate.REFLECTED]


def test_a_hybrid_is_an_achromat() -> None:
    """A diffractive surface has the Abbe number λ_d/(λ_F − λ_C) = −3.45: power of it and of the glass in that ratio."""
    glass, number = Glass(1.5168, 64.17), 587.5618 / (486.1327 - 656.2725)
    power = 0.01
    by_glass = power * 64.17 / (64.17 - number)
    phase = (-(power - by_glass) * np.pi / 587.5618e-6,)
    lens = Prescription((Surface(0.5168 / by_glass, 0.0, glass, is_stop=True), Surface(0.0, 0.0, phase=phase)))
    plain = replace(lens, surfaces=(replace(lens.surfaces[0], radius_mm=51.68), Surface(0.0, 0.0)))
    focal, without = (
        [first_order(each, line).focal_length_mm for line in (486.1327, 587.5618, 656.2725)] for each in (lens, plain)
    )
    assert focal[1] == pytest.approx(100.0, rel=1e-9)
    assert abs(focal[2] - focal[0]) < 0.02 * abs(without[2] - without[0])


def test_diffraction_leaves_the_image_flat() -> None:
    assert first_order(PLATE).petzval_sum == 0


def test_a_scaled_lens_bends_as_much() -> None:
    large = scale_prescription(PLATE, 2.5)
    assert first_order(large, DESIGN_NM).focal_length_mm == pytest.approx(2.5 * FOCAL_MM)
    np.testing.assert_allclose(
        trace_forward(large, *parallel(ring(20.0)), DESIGN_NM).at(2.5 * FOCAL_MM), 0.0, atol=1e-8
    )


def test_a_plate_alone_is_a_lens() -> None:
    whole = complete_prescription(PLATE)
    assert whole.surfaces[0].thickness_mm == pytest.approx(FOCAL_MM, rel=0.1)


@pytest.mark.parametrize(
    ("phase", "message"),
    [
        ((float("nan"),), r"phase coefficient of r\^2 must be a finite number"),
        ((1.0, 1e9), r"phase coefficient of r\^4 must be at most 100000"),
        ((1.0,) * 11, "at most 10 phase coefficients, got 11"),
    ],
)
def test_impossible_phases_are_refused(phase: tuple[float, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        check_prescription(replace(PLATE, surfaces=(replace(PLATE.surfaces[0], phase=phase),)))
