"""F-numbers against a ray trace written here: the plane formulas of refraction at spheres, in float64."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from render.model.lens import Glass, Prescription, Surface
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.f_numbers import f_number, iris_radius_mm, paraxial_f_number, widest_f_number
from render.optics.prescription.focusing import focus_lens
from render.optics.prescription.paraxial import first_order, stop_index
from tests.render.kits.lenses import DISTAGON, DOUBLE_GAUSS, FISHEYE, PLANAR, SIX_LENSES, TELEPHOTO, WIDE, KnownLens

NAMES = [lens.prescription.name for lens in SIX_LENSES]
SPHERICAL = (DOUBLE_GAUSS, WIDE, FISHEYE, TELEPHOTO, PLANAR)


def trace_by_hand(
    lens: Prescription, y: float, slope: float = 0.0, *, last: int | None = None
) -> tuple[list[float], float]:
    """Heights of a ray of the meridional plane at surfaces up to ``last``, and the angle at which it leaves; a sphere each.

    The ray enters at height ``y`` in the plane of the front vertex. Indices are those of the d line.
    """
    heights, angle, z, n = [], math.atan(slope), 0.0, 1.0
    for surface in lens.surfaces[: None if last is None else last + 1]:
        c = 1 / surface.radius_mm if surface.radius_mm else 0.0
        sine, cosine = math.sin(angle), math.cos(angle)
        # the way along the ray from (z, y) to the sphere through the origin: c·t²/2 − b·t + a = 0
        a, b = c * (y * y + z * z) / 2 - z, cosine - c * (y * sine + z * cosine)
        t = 2 * a / (b + math.sqrt(b * b - 2 * a * c))
        y, z = y + t * sine, z + t * cosine
        normal = math.asin(-c * y)
        angle = normal + math.asin(n / surface.glass.index * math.sin(angle - normal))
        n = surface.glass.index
        heights.append(y)
        z -= surface.thickness_mm
    return heights, angle


def widest_by_hand(lens: Prescription, stop_radius_mm: float) -> float:
    """F-number of the widest parallel ray that every rim lets through, with the stop closed to a radius."""
    stop, low, high = stop_index(lens), 0.0, lens.surfaces[0].semi_diameter_mm
    rims = [s.semi_diameter_mm for s in lens.surfaces]
    rims[stop] = min(rims[stop], stop_radius_mm)
    for _ in range(50):
        middle = (low + high) / 2
        try:
            passes = bool((np.abs(trace_by_hand(lens, middle)[0]) <= rims).all())
        except ValueError:  # it misses a sphere, or is totally reflected
            passes = False
        low, high = (middle, high) if passes else (low, middle)
    return first_order(lens).focal_length_mm / (2 * low)


def changed(lens: Prescription, index: int, semi_diameter_mm: float, f_stop: float = 0.0) -> Prescription:
    surfaces = list(lens.surfaces)
    surfaces[index] = replace(surfaces[index], semi_diameter_mm=semi_diameter_mm)
    return replace(lens, surfaces=tuple(surfaces), f_stop=f_stop)


@pytest.mark.parametrize("lens", SPHERICAL, ids=lambda lens: lens.prescription.name)
def test_the_f_number_wide_open_is_that_of_the_real_beam(lens: KnownLens) -> None:
    whole = complete_prescription(lens.prescription)
    assert whole.f_stop == pytest.approx(widest_by_hand(whole, math.inf), rel=1e-6)
    assert whole.f_stop == pytest.approx(lens.f_stop, rel=0.01)  # as its maker says


@pytest.mark.parametrize("lens", SPHERICAL, ids=lambda lens: lens.prescription.name)
@pytest.mark.parametrize("stops", [0.1, 1, 4])
def test_an_f_number_that_is_set_is_that_of_the_real_beam(lens: KnownLens, stops: float) -> None:
    whole = complete_prescription(lens.prescription)
    f_stop = lens.f_stop * 2 ** (stops / 2)
    for distance_m in (math.inf, 3.0):  # the f-number is that of the lens at infinity
        focused = focus_lens(whole, distance_m, f_stop)
        assert focused.f_stop == f_stop
        assert widest_by_hand(whole, focused.stop_radius_mm) == pytest.approx(f_stop, rel=1e-3)


@pytest.mark.parametrize("lens", SIX_LENSES, ids=NAMES)
@pytest.mark.parametrize("f_stop", [2.8, 5.6, 16.0])
def test_the_iris_is_as_wide_as_the_marginal_ray_is_high(lens: KnownLens, f_stop: float) -> None:
    stop = stop_index(lens.prescription)
    heights, _ = trace_by_hand(
        lens.prescription, first_order(lens.prescription).focal_length_mm / (2 * f_stop), last=stop
    )
    assert iris_radius_mm(lens.prescription, f_stop) == pytest.approx(abs(heights[stop]), rel=1e-9)
    assert f_number(lens.prescription, abs(heights[stop]), clip=False) == pytest.approx(f_stop, rel=1e-6)


def test_asked_for_f2_the_paraxial_number_is_another() -> None:
    focused = focus_lens(complete_prescription(DISTAGON.prescription), math.inf, 2.0)
    assert focused.f_stop == 2.0
    assert 2 * focused.entrance_pupil_radius_mm == pytest.approx(focused.first.focal_length_mm / 2, rel=1e-6)
    assert focused.paraxial_f_stop < 0.98 * focused.f_stop
    assert focused.paraxial_f_stop == paraxial_f_number(DISTAGON.prescription, focused.stop_radius_mm)


@pytest.mark.parametrize("lens", SPHERICAL, ids=lambda lens: lens.prescription.name)
def test_the_working_f_number_is_that_of_the_cone_on_the_film(lens: KnownLens) -> None:
    focused = focus_lens(complete_prescription(lens.prescription), math.inf, 2 * lens.f_stop)
    _, angle = trace_by_hand(focused.prescription, focused.first.focal_length_mm / (4 * lens.f_stop))
    assert focused.working_f_stop == pytest.approx(1 / (2 * abs(math.sin(angle))), rel=1e-6)


def test_nearer_the_working_f_number_grows_by_the_bellows_factor() -> None:
    lens = complete_prescription(PLANAR.prescription)
    far, near = (focus_lens(lens, distance_m, 8.0) for distance_m in (math.inf, 0.3))
    magnification = near.image_scale_mm / 300
    factor = 1 + magnification / near.pupil_magnification
    assert near.working_f_stop == pytest.approx(far.working_f_stop * factor, rel=0.01)
    object_mm = near.entrance_pupil_mm - 300
    slope = near.entrance_pupil_radius_mm / 300
    _, angle = trace_by_hand(near.prescription, slope * (near.vertices_mm[0] - object_mm), slope)
    assert near.working_f_stop == pytest.approx(1 / (2 * abs(math.sin(angle))), rel=1e-6)


def test_a_rim_that_cuts_the_beam_is_its_f_number() -> None:
    lens = complete_prescription(changed(DOUBLE_GAUSS.prescription, 8, 5.0))
    assert lens.f_stop > 1.5 * DOUBLE_GAUSS.f_stop
    assert lens.f_stop == pytest.approx(widest_by_hand(lens, math.inf), rel=1e-6)
    assert focus_lens(lens, math.inf, 2.0).f_stop == lens.f_stop
    assert focus_lens(lens, math.inf, 8.0).f_stop == 8.0


def test_a_stated_f_number_that_the_beam_has_needs_no_note() -> None:
    stated = complete_prescription(replace(DISTAGON.prescription, f_stop=1.4))
    assert stated.f_stop == pytest.approx(1.4, rel=1e-3)
    stop = stated.surfaces[stop_index(stated)].semi_diameter_mm
    assert paraxial_f_number(stated, stop) < 1.32  # by which it would be called wrong
    assert not any("f/1.3" in note or "said" in note for note in stated.notes)


def test_a_stop_too_narrow_for_what_is_stated_says_both_numbers() -> None:
    stop = stop_index(PLANAR.prescription)
    lens = complete_prescription(changed(PLANAR.prescription, stop, 10.0, f_stop=1.4))
    assert lens.surfaces[stop].semi_diameter_mm == 10.0
    [note] = [note for note in lens.notes if "said to be" in note]
    paraxial = paraxial_f_number(lens, 10.0)
    assert f"f/1.4, but its stop and rims let f/{lens.f_stop:.3g} through (f/{paraxial:.3g} by" in note
    assert complete_prescription(lens) == lens


def test_a_stop_too_wide_for_what_is_stated_does_not_open_so_far() -> None:
    stop = stop_index(PLANAR.prescription)
    lens = complete_prescription(
        changed(PLANAR.prescription, stop, PLANAR.prescription.surfaces[stop].semi_diameter_mm, 2.0)
    )
    assert lens.f_stop == 2.0
    assert widest_by_hand(lens, math.inf) == pytest.approx(2.0, rel=1e-6)
    assert any("opens to f/2 as is stated; its clear diameter would let f/1.4 through" in note for note in lens.notes)
    assert complete_prescription(lens) == lens


def test_a_thin_lens_behind_its_stop_has_one_f_number() -> None:
    weak = Prescription(
        (
            Surface(0.0, 0.0, semi_diameter_mm=5.0, is_stop=True),
            Surface(1e4, 1.0, Glass(1.5), 20.0),
            Surface(0.0, 0.0, semi_diameter_mm=20.0),
        )
    )
    lens = complete_prescription(weak)
    assert widest_f_number(lens) == pytest.approx(paraxial_f_number(lens, 5.0), rel=1e-6)
    assert focus_lens(lens, math.inf, lens.f_stop).working_f_stop == pytest.approx(lens.f_stop, rel=1e-6)
