"""Exact ray tracing against what geometry knows without tracing, and what becomes of rays that do not get through."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.model.arrays import DoubleArray
from render.model.lens import AIR, Glass, Prescription, Surface
from render.optics.glass import refractive_index
from render.optics.prescription.paraxial import first_order, paraxial_ray, paraxial_system
from render.optics.prescription.surface_shape import intersect, sag_mm
from render.optics.prescription.tracing import PASSES, Fate, TracedRays, trace_backward, trace_forward
from tests.render.kits.glasses import glass
from tests.render.kits.lenses import DISTAGON, DOUBLE_GAUSS, SIX_LENSES

INDEX = 1.5
SF10 = glass("SF10")
ALL_LENSES = st.sampled_from([lens.prescription for lens in SIX_LENSES])


def lens_of(*surfaces: Surface) -> Prescription:
    return Prescription(surfaces, name="Test lens")


def rays(
    heights: DoubleArray | list[float] | float, slopes: DoubleArray | list[float] | float, z_mm: float = 0.0
) -> tuple[DoubleArray, ...]:
    """Rays in the y-z plane."""
    y, u = np.broadcast_arrays(np.atleast_1d(heights).astype(float), np.atleast_1d(slopes).astype(float))
    directions = np.stack([0 * u, u, 1 + 0 * u], axis=1)
    return np.stack([0 * y, y, 0 * y + z_mm], axis=1), directions / np.linalg.norm(directions, axis=1)[:, None]


def axis_crossings(traced: TracedRays) -> DoubleArray:
    last, heading = traced.points_mm[-1], traced.directions
    return last[:, 2] - last[:, 1] * heading[:, 2] / heading[:, 1]


@pytest.mark.parametrize("radius", [20.0, -20.0])
def test_one_spherical_surface_bends_parallel_light_by_trigonometry(radius: float) -> None:
    heights = np.array([0.5, 3.0, 7.0, 12.0])
    traced = trace_forward(lens_of(Surface(radius, 0.0, Glass(INDEX))), *rays(heights, 0.0))
    incidence = np.arcsin(heights / radius)
    refracted = np.arcsin(heights / radius / INDEX)
    # the law of sines in the triangle of surface point, centre of curvature and axis crossing
    expected = radius + radius * np.sin(refracted) / np.sin(incidence - refracted)
    assert axis_crossings(traced) == pytest.approx(expected, rel=1e-12)


def test_a_sphere_images_its_aplanatic_point_without_error() -> None:
    # From within glass: what lies R/n from the centre is imaged, by all rays, to R·n from it (Welford 1986, ch. 8).
    radius = -10.0
    prescription = lens_of(Surface(0.0, 1.0, Glass(INDEX)), Surface(radius, 0.0))
    vertex = 1.0
    traced = trace_forward(
        prescription,
        *rays(0.0, np.linspace(0.1, 1.0, 10), vertex + radius - radius / -INDEX),
        clip=False,
        between=(1, 2),
    )
    assert axis_crossings(traced) == pytest.approx(np.full(10, vertex + radius + radius * INDEX), rel=1e-12)


def test_an_ellipsoid_focuses_parallel_light_in_glass_to_a_point() -> None:
    surface = Surface(20.0, 0.0, Glass(INDEX), conic=-1 / INDEX**2)
    traced = trace_forward(lens_of(surface), *rays(np.linspace(0.5, 14, 20), 0.0))
    assert axis_crossings(traced) == pytest.approx(np.full(20, 20 * INDEX / (INDEX - 1)), rel=1e-12)


def test_a_hyperboloid_focuses_parallel_light_from_glass_to_a_point() -> None:
    surfaces = (Surface(0.0, 10.0, Glass(INDEX)), Surface(-20.0, 0.0, conic=-(INDEX**2)))
    traced = trace_forward(lens_of(*surfaces), *rays(np.linspace(0.5, 14, 20), 0.0))
    assert axis_crossings(traced) == pytest.approx(np.full(20, 10 + 20 / (INDEX - 1)), rel=1e-12)


def test_a_plane_parallel_plate_shifts_a_ray_and_does_not_turn_it() -> None:
    slope, thickness = 0.7, 8.0
    traced = trace_forward(lens_of(Surface(0.0, thickness, Glass(INDEX)), Surface(0.0, 0.0)), *rays(0.0, slope))
    inside = np.tan(np.arcsin(np.sin(np.arctan(slope)) / INDEX))
    assert traced.points_mm[-1, 0, 1] == pytest.approx(thickness * inside)
    assert traced.directions[0, 1] / traced.directions[0, 2] == pytest.approx(slope)


def test_an_asphere_that_spells_out_a_sphere_is_one() -> None:
    # the sphere's sag less the parabola's: the terms c³/8, c⁵/16, 5c⁷/128, 7c⁹/256, 21c¹¹/1024 of r⁴ … r¹²
    c = 1 / 30
    terms = (c**3 / 8, c**5 / 16, 5 * c**7 / 128, 7 * c**9 / 256, 21 * c**11 / 1024)
    sphere, spelt = Surface(30.0, 0.0, Glass(INDEX)), Surface(30.0, 0.0, Glass(INDEX), conic=-1.0, aspheric=terms)
    sent = rays(np.linspace(-6, 6, 13), 0.3)
    one, other = (trace_forward(lens_of(surface), *sent) for surface in (sphere, spelt))
    assert other.points_mm == pytest.approx(one.points_mm, abs=1e-7)
    assert other.directions == pytest.approx(one.directions, abs=1e-7)


@given(
    conic=st.floats(-3, 1),
    curvature=st.floats(-0.05, 0.05),
    fourth=st.floats(-2e-5, 2e-5),
    sixth=st.floats(-1e-7, 1e-7),
    height=st.floats(-9, 9),
    slope=st.floats(-0.8, 0.8),
    backward=st.booleans(),
)
def test_rays_meet_an_asphere_on_its_surface(
    conic: float, curvature: float, fourth: float, sixth: float, height: float, slope: float, backward: bool
) -> None:
    radius = 1 / curvature if abs(curvature) > 1e-6 else 0.0
    surface = Surface(radius, 0.0, semi_diameter_mm=12.0, conic=conic, aspheric=(fourth, sixth))
    points, directions = rays([height], [slope])
    met, hit = intersect(surface, points, -directions if backward else directions)
    along = (met[0] - points[0]) @ directions[0]
    assert met[0] == pytest.approx(points[0] + along * directions[0], abs=1e-9)
    if hit[0]:
        assert met[0, 2] == pytest.approx(float(sag_mm(surface, met[0, 1] ** 2)), abs=1e-9)
    else:
        assert np.hypot(met[0, 0], met[0, 1]) > 12


@given(lens=ALL_LENSES, x=st.floats(-5, 5), y=st.floats(-5, 5), u=st.floats(-0.15, 0.15), v=st.floats(-0.15, 0.15))
def test_a_ray_traced_forward_and_back_returns(lens: Prescription, x: float, y: float, u: float, v: float) -> None:
    points, directions = np.array([[x, y, -5.0]]), np.array([[u, v, 1.0]]) / np.sqrt(1 + u * u + v * v)
    there = trace_forward(lens, points, directions, clip=False)
    if not there.passes[0]:
        return
    back = trace_backward(lens, there.points_mm[-1] + 3 * there.directions, -there.directions, clip=False)
    assert back.passes[0]
    assert back.directions == pytest.approx(-directions, abs=1e-10)
    assert back.at(-5.0)[0] == pytest.approx(points[0, :2], abs=1e-8)
    assert back.points_mm[::-1] == pytest.approx(there.points_mm, abs=1e-8)


@given(
    lens=ALL_LENSES, turn=st.floats(0, 2 * np.pi), y=st.floats(-6, 6), u=st.floats(-0.2, 0.2), v=st.floats(-0.2, 0.2)
)
def test_turning_a_ray_about_the_axis_turns_its_image(
    lens: Prescription, turn: float, y: float, u: float, v: float
) -> None:
    turned = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    points, directions = np.array([[1.0, y, -5.0]]), np.array([[u, v, 1.0]]) / np.sqrt(1 + u * u + v * v)
    one = trace_forward(lens, points, directions, clip=False)
    other = trace_forward(lens, points @ turned.T, directions @ turned.T, clip=False)
    assert other.directions == pytest.approx(one.directions @ turned.T, abs=1e-9, nan_ok=True)
    assert other.stopped_by.tolist() == one.stopped_by.tolist()


@given(lens=ALL_LENSES, height=st.floats(-1, 1), slope=st.floats(-0.1, 0.1))
def test_rays_close_to_the_axis_are_paraxial_ones(lens: Prescription, height: float, slope: float) -> None:
    small = 1e-4
    traced = trace_forward(lens, *rays([small * height], [small * slope], -1.0), clip=False)
    near = paraxial_ray(paraxial_system(lens), -1.0, small * height, small * slope)
    assert traced.points_mm[:, 0, 1] == pytest.approx(near.heights_mm, abs=1e-10)
    assert traced.directions[0, 1] / traced.directions[0, 2] == pytest.approx(near.slopes[-1], abs=1e-10)


@given(lens=ALL_LENSES, y=st.floats(-4, 4), u=st.floats(-0.1, 0.1))
def test_a_lens_neither_gathers_nor_scatters_etendue(lens: Prescription, y: float, u: float) -> None:
    # (y, n·sin) at entry to (y, n·sin) at exit is a canonical map in the plane: its determinant is 1 (Liouville).
    step = 1e-4
    sines = np.array([u, u + step, u - step, u, u])
    points = np.stack([np.zeros(5), [y, y, y, y + step, y - step], np.full(5, -1.0)], axis=1)
    directions = np.stack([np.zeros(5), sines, np.sqrt(1 - sines**2)], axis=1)
    traced = trace_forward(lens, points, directions)
    if not traced.passes.all():
        return
    out = np.stack([traced.at(100.0)[:, 1], traced.directions[:, 1]])
    by_sine, by_height = (out[:, 1] - out[:, 2]) / (2 * step), (out[:, 3] - out[:, 4]) / (2 * step)
    assert by_height[0] * by_sine[1] - by_sine[0] * by_height[1] == pytest.approx(1, abs=2e-4)


def test_the_reversed_lens_has_the_same_focal_length() -> None:
    lens = DISTAGON.prescription
    back_to_front = [
        replace(
            surface,
            radius_mm=-surface.radius_mm,
            aspheric=tuple(-term for term in surface.aspheric),
            glass=lens.surfaces[i - 1].glass if i else AIR,
            thickness_mm=lens.surfaces[i - 1].thickness_mm if i else 0.0,
        )
        for i, surface in reversed(list(enumerate(lens.surfaces)))
    ]
    one, other = first_order(lens), first_order(replace(lens, surfaces=tuple(back_to_front)))
    assert other.focal_length_mm == pytest.approx(one.focal_length_mm)
    assert other.back_focal_mm == pytest.approx(-one.front_focal_mm)
    assert other.exit_pupil_mm == pytest.approx(one.length_mm - one.entrance_pupil_mm)
    assert other.petzval_sum == pytest.approx(one.petzval_sum)


def test_each_ray_can_have_its_own_wavelength() -> None:
    lens = lens_of(Surface(30.0, 5.0, SF10), Surface(-30.0, 0.0))
    lines = np.array([475.0, 510.0, 650.0])
    together = trace_forward(lens, *rays([6.0] * 3, [0.1] * 3), lines)
    for i, line in enumerate(lines):
        alone = trace_forward(lens, *rays([6.0], [0.1]), float(line))
        assert together.directions[i] == pytest.approx(alone.directions[0], abs=1e-14)


def test_rims_block_and_name_their_surface() -> None:
    lens = DOUBLE_GAUSS.prescription
    front, closed = (
        trace_forward(lens, *rays([12.7], [0.0])),
        trace_forward(lens, *rays([5.0], [0.0]), stop_radius_mm=2.0),
    )
    assert (front.stopped_by[0], front.fates[0]) == (0, Fate.BLOCKED)
    assert (closed.stopped_by[0], closed.fates[0]) == (5, Fate.BLOCKED)
    assert np.isnan(closed.directions).all()
    assert np.isfinite(closed.points_mm[:6]).all()
    assert np.isnan(closed.points_mm[6:]).all()


def test_an_iris_wider_than_the_stop_opens_it_no_further() -> None:
    traced = trace_forward(DOUBLE_GAUSS.prescription, *rays([12.4], [0.0]), stop_radius_mm=100.0, between=(5, 11))
    assert traced.stopped_by[0] == 5


def test_rays_that_miss_and_rays_totally_reflected_are_distinguished() -> None:
    ball = lens_of(Surface(10.0, 20.0, Glass(INDEX)), Surface(-10.0, 0.0))
    missing = trace_forward(ball, *rays([10.5], [0.0]))
    assert (missing.stopped_by[0], missing.fates[0]) == (0, Fate.MISSES)
    plate = lens_of(Surface(0.0, 1.0, Glass(INDEX)), Surface(-5.0, 0.0))
    critical = 5 / INDEX
    traced = trace_forward(plate, *rays([critical - 1e-3, critical + 1e-3], 0.0))
    assert traced.stopped_by.tolist() == [PASSES, 1]
    assert traced.fates.tolist() == [Fate.PASSES, Fate.REFLECTED]


def test_a_ray_beside_a_mounted_surface_is_blocked_by_the_mount() -> None:
    ball = lens_of(Surface(10.0, 20.0, Glass(INDEX), 9.0), Surface(-10.0, 0.0, semi_diameter_mm=9.0))
    beside = trace_forward(ball, *rays([10.5], [0.0]))
    assert (beside.stopped_by[0], beside.fates[0]) == (0, Fate.BLOCKED)


def test_dispersion_bends_blue_more() -> None:
    prism_like = lens_of(Surface(0.0, 1.0, SF10), Surface(-30.0, 0.0))
    slopes = trace_forward(prism_like, *rays([5.0, 5.0], 0.0), np.array([475.0, 650.0])).directions[:, 1]
    assert abs(slopes[0]) > abs(slopes[1])
    assert refractive_index(SF10, 475.0) > refractive_index(SF10, 650.0)
