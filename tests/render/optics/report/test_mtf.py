"""Modulation transfer, colour errors and focus scale against closed forms and first-order optics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import j1

from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.lens import Lens
from render.optics.prescription.mounting import breathing_ratio, distance_from_film_m, mount_lens
from render.optics.prescription.paraxial import first_order
from render.optics.prescription.tracing import TracedRays
from render.optics.report import lens_report
from render.optics.report.colour import measure_colour
from render.optics.report.film_cone import FilmCone
from render.optics.report.film_rays import SqueezedRays
from render.optics.report.focus_scale import THROW_DEG, focus_scale
from render.optics.report.glass_rays import GlassRays
from render.optics.report.lens_report import film_rays
from render.optics.report.mtf import FREQUENCIES, LIGHT, measure_mtf, perfect_transfer
from render.optics.report.wavefront import Wavefront, fit_wavefront
from render.shot.lens.lens_alone import lens_alone
from tests.render.kits.lenses import DOUBLE_GAUSS, PLANAR, TELEPHOTO, KnownLens

SINE = 0.1
"""Numerical aperture of the round pupil: f/5."""
SIDE = 96
NM = 550.0
NO_RAYS = TracedRays(np.zeros((0, 0, 3)), np.zeros((0, 3)), np.zeros(0, np.int64), np.zeros(0, np.uint8))


def known(lens: KnownLens) -> Camera:
    return Camera(
        np.eye(4),
        focal_length_mm=lens.focal_length_mm,
        f_stop=lens.f_stop,
        lens=Lens("prescription", prescription=lens.prescription),
        horizontal_aperture_mm=36.0,
        vertical_aperture_mm=24.0,
    )


def thin() -> Camera:
    return replace(known(DOUBLE_GAUSS), lens=Lens(), focal_length_mm=50.0, f_stop=2.0)


def round_wavefront(path_mm: DoubleArray | float) -> Wavefront:
    """A round pupil with a path error, given over `disc`."""
    radius = np.hypot(*disc().T)
    cover = np.clip(0.5 + (1 - radius) * SIDE / 2 / 1.05, 0, 1)
    cone = FilmCone(SINE * disc(), (2 * 1.05 * SINE / SIDE) ** 2, SIDE, cover, NO_RAYS)
    found = fit_wavefront(cone, np.broadcast_to(path_mm, radius.shape).astype(float), NM)
    assert found is not None
    return found


def disc() -> DoubleArray:
    """Points of a grid around the unit disc."""
    line = ((np.arange(SIDE) + 0.5) / SIDE * 2 - 1) * 1.05
    return np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("frequency", [10.0, 40.0, 150.0, 300.0])
def test_a_perfect_wavefront_has_the_perfect_lens_s_transfer(axis: int, frequency: float) -> None:
    found = round_wavefront(0.0).diffraction(np.zeros(1), frequency, axis)[0]
    assert abs(found) == pytest.approx(perfect_transfer(frequency, NM, 1 / (2 * SINE)), abs=3e-3)


def test_the_perfect_transfer_ends_at_its_cutoff() -> None:
    assert perfect_transfer(0.0, NM, 4.0) == pytest.approx(1.0)
    assert perfect_transfer(1 / (NM * 1e-6 * 4.0), NM, 4.0) == pytest.approx(0.0, abs=1e-9)
    assert perfect_transfer(0.5 / (NM * 1e-6 * 4.0), NM, 4.0) == pytest.approx(
        0.391, abs=1e-3
    )  # Goodman 2005, figure 6.3


@pytest.mark.parametrize("shift_mm", [0.05, -0.2, 0.4])
def test_the_rays_of_a_defocused_circle_have_two_j1_over_x(shift_mm: float) -> None:
    """The disc's radius is z·tan u; it is evenly lit but for the fourth order of u."""
    wave = round_wavefront(0.0)
    for frequency in FREQUENCIES:
        x = 2 * np.pi * frequency * shift_mm * SINE / np.sqrt(1 - SINE**2 / 2)
        found = wave.geometric(np.array([shift_mm]), frequency, 1)[0]
        assert found.real == pytest.approx(2 * j1(x) / x, abs=6e-3)


def strehl(wave: Wavefront) -> float:
    """Peak of a point's image over that without errors: ``|⟨exp(ikW)⟩|²`` (Born & Wolf 1999, section 9.1.3)."""
    path = wave._path(*wave._lines(np.zeros(2)))
    phase = np.exp(2j * np.pi / (wave.wavelength_nm * 1e-6) * path)
    return float(abs((wave.cover * phase).sum() / wave.cover.sum()) ** 2)


@pytest.mark.parametrize("waves", [0.1, 0.25, 0.5])
def test_defocus_has_its_known_strehl_ratio(waves: float) -> None:
    """``W = A·ρ²`` leaves ``(sin x / x)²`` of the peak, x = πA/λ (Born & Wolf, section 8.8)."""
    wave = round_wavefront(waves * NM * 1e-6 * (disc() ** 2).sum(axis=1))
    x = np.pi * waves
    assert strehl(wave) == pytest.approx((np.sin(x) / x) ** 2, abs=3e-3)


def test_balanced_spherical_aberration_has_its_known_strehl_ratio() -> None:
    """A wave of Zernike's Z₄⁰, ``√5·(6ρ⁴ − 6ρ² + 1)`` times its deviation: about ``exp(−(2πσ)²)`` (Mahajan 1983)."""
    squared = (disc() ** 2).sum(axis=1)
    wave = round_wavefront(0.05 * NM * 1e-6 * np.sqrt(5) * (6 * squared**2 - 6 * squared + 1))
    assert strehl(wave) == pytest.approx(np.exp(-((2 * np.pi * 0.05) ** 2)), abs=3e-3)


@pytest.mark.parametrize("lens", [DOUBLE_GAUSS, TELEPHOTO], ids=["double gauss", "telephoto"])
def test_through_focus_is_what_a_moved_film_sees(lens: KnownLens) -> None:
    camera = known(lens)
    mounted = mount_lens(camera)
    here, moved = GlassRays(mounted, 0.0), GlassRays(replace(mounted, film_mm=mounted.film_mm + 0.06), 0.0)
    wave, other = here.wavefront(0.0, 550.0), moved.wavefront(0.0, 550.0)
    assert wave is not None
    assert other is not None
    for method in ("diffraction", "geometric"):
        shifted = getattr(wave, method)(np.array([0.0, 0.06]), 20.0, 1)
        assert abs(shifted[1]) == pytest.approx(abs(getattr(other, method)(np.zeros(1), 20.0, 1)[0]), abs=5e-3)
        assert abs(shifted[0] - shifted[1]) > 0.02


def test_the_wavefront_s_rays_are_those_of_the_spots() -> None:
    """The transfer by slopes of optical paths, and by exact rays that are aimed from the scene through the stop."""
    rays = film_rays(replace(known(PLANAR), f_stop=4.0))
    through = measure_mtf(rays, 21.6, 4.0)
    aimed = measure_mtf(SqueezedRays(rays, 1.0), 21.6, 4.0)
    np.testing.assert_allclose(through.field_geometric, aimed.field_geometric, atol=0.02)
    assert through.is_exact
    assert not aimed.is_exact


def test_a_stopped_down_lens_is_limited_by_diffraction() -> None:
    found = measure_mtf(film_rays(replace(known(DOUBLE_GAUSS), f_stop=16.0)), 21.6, 16.0)
    perfect = [sum(w * perfect_transfer(f, nm, 16.0) for nm, w in LIGHT) for f in FREQUENCIES]
    np.testing.assert_allclose(found.field[:, 0, 0], perfect, atol=0.01)
    assert found.field_geometric[2, 0, 0] > found.field[2, 0, 0] + 0.1


def test_a_thin_lens_is_perfect_and_dark_places_have_no_transfer() -> None:
    found = measure_mtf(film_rays(thin()), 21.6, 2.0)
    np.testing.assert_allclose(found.field_geometric, 1.0)
    assert sum(weight for _, weight in LIGHT) == pytest.approx(1.0)
    far = measure_mtf(film_rays(known(DOUBLE_GAUSS)), 80.0, 2.0)
    assert np.isnan(far.field[:, :, -1]).all()


def test_axial_colour_of_the_innermost_rays_is_the_paraxial_one() -> None:
    camera = lens_alone("planar_50").set_to(None, None, (36.0, 24.0))
    colour, glass = measure_colour(film_rays(camera), 21.6), mount_lens(camera).prescription
    paraxial = [first_order(glass, nm).back_focal_mm for nm in (650.0, 475.0)]
    assert colour.longitudinal_mm[0, 0] - colour.longitudinal_mm[2, 0] == pytest.approx(
        paraxial[0] - paraxial[1], rel=0.02
    )
    np.testing.assert_allclose(colour.lateral_um[1], 0.0)
    assert np.abs(colour.lateral_um[0]).max() > 0.5


def test_marks_of_the_focus_ring_follow_newton_s_equation() -> None:
    """The whole lens moves: x·x′ = f², with x from its front focus; angles are in proportion."""
    camera = replace(known(DOUBLE_GAUSS), lens=replace(known(DOUBLE_GAUSS).lens, close_focus_m=0.6), f_stop=11.0)
    marks = focus_scale(camera)
    assert {mark.unit for mark in marks} == {"m", "ft"}
    assert marks[0].label == "∞"
    assert marks[0].travel_mm == 0
    assert marks[0].breathing == pytest.approx(0.0, abs=1e-12)
    nearest = [mark for mark in marks if mark.unit == "m"][-1]
    assert nearest.label == "0.6"
    assert nearest.turn_deg == pytest.approx(THROW_DEG)
    first = first_order(mount_lens(replace(camera, focus_distance_m=float("inf"))).prescription)
    for mark in marks[1:]:
        if np.isfinite(mark.distance_m):
            whole = first.length_mm + first.back_focal_mm  # from the front vertex to the film at infinity
            x_mm = 1000 * mark.distance_m - whole - mark.travel_mm - (first.focal_length_mm - first.front_principal_mm)
            assert mark.travel_mm == pytest.approx(first.focal_length_mm**2 / x_mm, rel=0.01)
    two_m = next(mark for mark in marks if mark.distance_m == 2.0)
    feet = next(mark for mark in marks if mark.unit == "ft" and mark.label == "6")
    assert feet.distance_m == pytest.approx(1.8288)
    focused = replace(camera, focus_distance_m=2.0)
    off_m = distance_from_film_m(focused) - 2.0
    near = breathing_ratio(replace(camera, focus_distance_m=2.0 - off_m)) - 1
    assert two_m.breathing == pytest.approx(near, rel=0.05)


def test_a_lens_without_surfaces_has_no_ring() -> None:
    assert lens_report(thin()).focus_marks == ()
