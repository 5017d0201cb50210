"""Lens reports against closed forms, theory and the published numbers of six lenses."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from render.model.camera import Camera
from render.model.lens import Glass, IrisShape, Lens, Prescription, SeidelErrors, Surface
from render.optics.distortion import chief_rays
from render.optics.glass import D_LINE_NM
from render.optics.prescription.focusing import focus_lens
from render.optics.prescription.mounting import distance_from_film_m, mount_lens, nearer_than_marked
from render.optics.prescription.principal_rays import principal_rays
from render.optics.report import LensReport, data_sheet, lens_report
from render.optics.report.aiming import Targets, aim, trace_aimed
from render.optics.report.field import spots
from render.optics.report.lens_report import film_rays, lens_bokeh
from render.optics.report.section import lens_section
from tests.render.kits.lenses import DOUBLE_GAUSS, FISHEYE, PLANAR, SIX_LENSES, TELEPHOTO, KnownLens

SINGLET = Prescription(
    (
        Surface(50.2792, 8, Glass(1.5168, 64.17), 8.9286, is_stop=True),
        Surface(-50.2792, 0, semi_diameter_mm=30),
    ),
    name="singlet",
)


def camera_with(lens: Lens, focal_length_mm: float, f_stop: float, **changes: object) -> Camera:
    camera = Camera(
        np.eye(4),
        focal_length_mm=focal_length_mm,
        f_stop=f_stop,
        lens=lens,
        horizontal_aperture_mm=36.0,
        vertical_aperture_mm=24.0,
    )
    return replace(camera, **changes)  # type: ignore[arg-type]


def known(lens: KnownLens) -> Camera:
    return camera_with(Lens("prescription", prescription=lens.prescription), lens.focal_length_mm, lens.f_stop)


def thin(**changes: object) -> Camera:
    return camera_with(Lens(), 50.0, 2.0, **changes)


@pytest.fixture(scope="module")
def planar() -> LensReport:
    return lens_report(known(PLANAR))


@pytest.mark.parametrize("lens", SIX_LENSES, ids=lambda lens: lens.prescription.name)
def test_numbers_of_the_six_lenses_are_those_that_are_known(lens: KnownLens) -> None:
    report = lens_report(known(lens))
    assert report.barrel is not None
    assert report.focused is not None
    assert report.focused.first.focal_length_mm == pytest.approx(lens.focal_length_mm, rel=1e-3)
    assert report.barrel.back_focus == pytest.approx(lens.back_focal_mm, rel=1e-3)
    assert report.wide_open == pytest.approx(lens.f_stop, rel=0.01)
    assert report.barrel.entrance_pupil_diameter * report.f_stop == pytest.approx(lens.focal_length_mm, rel=1e-3)
    light = report.curves.illumination
    assert light[0] == pytest.approx(1)
    assert (np.diff(light) < 3e-3).all()
    bends_outward = lens is TELEPHOTO
    lit = np.isfinite(report.curves.distortion)
    middle = report.curves.distortion[lit][len(report.curves.distortion[lit]) // 2]
    assert middle > 0 if bends_outward else middle < 0
    assert 0 < report.nearest_m < 4 * lens.focal_length_mm / 1000


def test_the_t_stop_counts_what_is_stated_or_else_the_coatings() -> None:
    surfaces = tuple(replace(s, coating_nm=540.0 if s.glass.index == 1 else 0.0) for s in SINGLET.surfaces)
    coated = replace(SINGLET, surfaces=surfaces)
    lens = Lens("spherical", prescription=coated)
    by_coatings, bare, stated = (
        lens_report(camera_with(each, 50.0, 4.0))
        for each in (lens, replace(lens, prescription=SINGLET), replace(lens, transmittance=0.81))
    )
    fresnel = ((1.5168 - 1) / (1.5168 + 1)) ** 2  # of the bare front; the rear's layer takes away most of it
    assert 1 - 2 * fresnel < by_coatings.transmittance < 1 - fresnel
    assert by_coatings.t_stop == pytest.approx(by_coatings.f_stop / math.sqrt(by_coatings.transmittance))
    assert (bare.transmittance, bare.t_stop) == (1, bare.f_stop)  # it says nothing of its coatings
    assert stated.t_stop == pytest.approx(4 / 0.9)


def test_light_ends_where_the_image_circle_does() -> None:
    report = lens_report(known(FISHEYE))
    assert 24 < report.image_circle_mm < 2 * report.corner_mm
    dark = 2 * report.curves.heights_mm > report.image_circle_mm + 0.5
    assert (report.curves.illumination[dark] == 0).all()
    assert np.isnan(report.curves.distortion[dark]).all()
    assert math.isnan(report.spots[-1].rms_um)
    assert report.bokeh is not None
    assert report.bokeh.places[-1].share == 0
    assert 140 < report.field_of_view_deg[2] < 180  # across the image circle, and not where no light is


def test_a_parabola_images_its_axis_to_a_point_and_a_sphere_does_not() -> None:
    """The rear surface of a plano-hyperbolic lens with K = −n² has no spherical aberration for parallel light (Descartes)."""
    index = 1.5
    for conic, least, most in ((-(index**2), 0.0, 1e-3), (0.0, 50.0, 1e4)):
        glass = Prescription(
            (
                Surface(0, 10, Glass(index), 14, is_stop=True),
                Surface(-25, 0, semi_diameter_mm=16, conic=conic),
            ),
            name="Descartes",
        )
        camera = camera_with(Lens("prescription", prescription=glass), 50.0, 2.0)
        [axis] = spots(film_rays(camera), np.array([0.0]), IrisShape())
        assert least <= axis.rms_um < most


def test_a_thin_lens_has_no_errors_and_round_bokeh_of_the_coc() -> None:
    report = lens_report(thin(focus_distance_m=2.0))
    assert max(spot.rms_um for spot in report.spots) < 1e-9
    assert np.abs(report.curves.distortion).max() < 1e-12
    assert (report.curves.illumination == 1).all()
    assert report.curves.cos4[-1] == pytest.approx(math.cos(math.atan(report.corner_mm / 50)) ** 4)
    assert report.barrel is None
    sheet = report.bokeh
    assert sheet is not None
    assert sheet.disc_mm == pytest.approx(50 / 2 * 50 / 2000)  # f²/(N·d), DESIGN section 2
    disc = sheet.places[0].light[..., 1]
    area_mm2 = (disc > 0.5).sum() * (sheet.places[0].width_mm / len(disc)) ** 2
    assert area_mm2 == pytest.approx(np.pi / 4 * sheet.disc_mm**2, rel=0.02)
    assert disc[disc > 0.5].mean() == pytest.approx(1, abs=0.02)
    for place in sheet.places:
        assert place.share == pytest.approx(1)


def test_squeeze_and_blades_show_in_the_bokeh() -> None:
    squeezed = lens_bokeh(camera_with(Lens(squeeze=2.0), 50.0, 2.0))
    assert squeezed is not None
    lit = squeezed.places[0].light[..., 1] > 0.3
    assert lit.any(axis=1).sum() / lit.any(axis=0).sum() == pytest.approx(2, rel=0.05)
    bladed = lens_bokeh(thin(iris=IrisShape(blades=3)))
    assert bladed is not None
    rows = (bladed.places[0].light[..., 1] > 0.5).sum(axis=1)
    lit_rows = np.flatnonzero(rows)
    quarters = np.array_split(rows[lit_rows[0] : lit_rows[-1]], 3)
    assert max(np.abs(np.diff([part.sum() for part in quarters]))) > 100  # no circle: not alike up and down


@pytest.mark.parametrize("w311", [400.0, -150.0])
def test_squeeze_narrows_the_distortion_from_side_to_side(w311: float) -> None:
    """The renderer's chief rays are the independent account."""
    errors = SeidelErrors(w311=w311, reference_f_stop=1.4, reference_height_mm=15.0)
    reports = [lens_report(camera_with(Lens("seidel", seidel=errors, squeeze=s), 50.0, 2.0)) for s in (1.0, 2.0)]
    for report in reports:
        camera = report.camera
        right, up = camera.horizontal_aperture_mm / 100, camera.vertical_aperture_mm / 100
        chief = chief_rays(camera)
        assert chief is not None
        slopes = chief.undistort_slopes(np.array([[right, 0.0], [0.0, up], [right, up]]))
        expected = 2 * np.degrees(np.arctan(np.linalg.norm(slopes, axis=-1)))
        assert report.field_of_view_deg == pytest.approx(expected, rel=1e-4)
        corner = np.array([right, up])
        ideal_over_seen = corner / chief.undistort_slopes(corner)
        distortion = [report.curves.distortion_across[-1], report.curves.distortion[-1]]
        assert distortion == pytest.approx(ideal_over_seen - 1, rel=1e-3)
    spherical, anamorphic = reports
    assert anamorphic.field_of_view_deg[0] != pytest.approx(spherical.field_of_view_deg[0], rel=1e-3)
    assert anamorphic.field_of_view_deg[1] == pytest.approx(spherical.field_of_view_deg[1])
    told = dict(row for group in data_sheet(anamorphic) for row in group)["distortion"]
    assert "% up" in told
    assert "% across, in the corner" in told
    assert any("18 mm wide on the film" in note for note in anamorphic.notes)


def test_rims_make_a_cats_eye_that_is_narrow_along_the_radius() -> None:
    sheet = lens_bokeh(known(DOUBLE_GAUSS))
    assert sheet is not None
    centre, mid, _, corner, opposite = sheet.places
    assert mid.place == (0.5, 0.0)
    assert corner.share < mid.share < centre.share == 1
    lit = mid.light[..., 1] > 0.3
    assert lit.any(axis=1).sum() > 1.25 * lit.any(axis=0).sum()
    np.testing.assert_allclose(corner.light, opposite.light[::-1, ::-1], atol=0.3)
    np.testing.assert_allclose(corner.light.mean(), opposite.light.mean(), rtol=1e-3)


def test_near_the_axis_the_foci_part_as_the_seidel_sums_say() -> None:
    """Stopped down, sagittal and tangential focus are 2·W220 and 2·(W220 + W222) away, by 8·N²·λ/2 for each wave of defocus."""
    lens = replace(known(DOUBLE_GAUSS), f_stop=16.0, horizontal_aperture_mm=3.6, vertical_aperture_mm=2.4)
    report = lens_report(lens)
    waves, curves = report.third_order, report.curves
    assert waves is not None
    per_wave = -8 * report.f_stop**2 * D_LINE_NM * 1e-6
    sagittal, tangential = (values[-1] - values[0] for values in (curves.sagittal_mm, curves.tangential_mm))
    assert sagittal == pytest.approx(per_wave * waves.w220, rel=0.03)
    assert tangential == pytest.approx(per_wave * (waves.w220 + waves.w222), rel=0.06)


def test_seidel_errors_of_a_thin_lens_give_its_foci_and_distortion() -> None:
    errors = SeidelErrors(w222=-3, w220=5, w311=20, reference_f_stop=2.0, reference_height_mm=20.0)
    report = lens_report(camera_with(Lens("seidel", seidel=errors), 50.0, 2.0))
    eta2 = (report.corner_mm / 20) ** 2
    per_wave = -8 * 4 * D_LINE_NM * 1e-6
    assert report.curves.sagittal_mm[-1] - report.curves.sagittal_mm[0] == pytest.approx(per_wave * 5 * eta2, rel=1e-6)
    assert report.curves.tangential_mm[-1] - report.curves.tangential_mm[0] == pytest.approx(
        per_wave * 2 * eta2, rel=1e-6
    )
    assert report.curves.distortion[-1] < 0  # positive W311 is barrel-shaped


def test_illumination_is_the_projected_solid_angle_of_what_is_open() -> None:
    """A stop before a weak lens that rims do not clip: cos⁴ of the angle, but for the lens's own distortion."""
    glass = Prescription(
        (
            Surface(0, 0.01, semi_diameter_mm=0.5, is_stop=True),
            Surface(200, 10, Glass(1.5), 40),
            Surface(-200, 0, semi_diameter_mm=40),
        ),
        name="weak",
    )
    report = lens_report(camera_with(Lens("prescription", prescription=glass), 200.0, 200.0))
    stretch = np.gradient(report.curves.heights_mm * (1 + 0 * report.curves.distortion), report.curves.heights_mm)
    np.testing.assert_allclose(report.curves.illumination * stretch, report.curves.cos4, rtol=3e-3)
    np.testing.assert_allclose(report.curves.geometric, report.curves.illumination, rtol=1e-12)


@pytest.mark.parametrize("lens", [DOUBLE_GAUSS, FISHEYE], ids=["double gauss", "fisheye"])
def test_aimed_rays_meet_their_stop_point_even_far_off_the_axis(lens: KnownLens) -> None:
    glass = mount_lens(known(lens))
    chief = principal_rays(glass)
    height = 0.8 * min(chief.last_height_mm, lens.field_mm)
    slope, crossing = chief.at(np.array([height]), 0.0)
    stop = glass.stop_radius_mm * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    count = len(stop)
    targets = Targets(
        np.tile([0.0, float(slope[0])], (count, 1)), 0.0, stop, np.tile([0.0, float(crossing[0])], (count, 1)),
        D_LINE_NM,
    )  # fmt: skip
    rays = aim(glass, targets)
    assert rays.solved.all()
    traced = trace_aimed(glass, rays, targets.wavelength_nm, clip=False)
    np.testing.assert_allclose(traced.points_mm[glass.stop, :, :2], stop, atol=1e-6 * glass.stop_radius_mm)
    assert -traced.at(glass.film_mm)[0, 1] == pytest.approx(height, abs=2e-3)


def test_a_refracting_surface_may_be_the_stop() -> None:
    chief = chief_rays(camera_with(Lens("spherical", prescription=SINGLET), 50.0, 2.8))
    assert chief is not None
    near = (chief.ideal > 0) & (chief.ideal < 0.2)
    np.testing.assert_allclose(chief.seen[near] / chief.ideal[near], 1, atol=0.01)


def test_close_focus_is_what_focusing_reaches(planar: LensReport) -> None:
    assert planar.focused is not None
    nearest = planar.nearest_m
    focus_lens(planar.focused.prescription, 1.01 * nearest, 16.0, by="paraxial")
    with pytest.raises(Exception, match="cannot focus"):
        focus_lens(planar.focused.prescription, 0.99 * nearest, 16.0, by="paraxial")


@pytest.mark.parametrize(
    "lens",
    [
        Lens("prescription", prescription=PLANAR.prescription, close_focus_m=0.45),
        Lens(close_focus_m=0.45),
    ],
    ids=["glass", "thin"],
)
def test_close_focus_is_measured_from_the_film_and_reported(lens: Lens) -> None:
    at_mark = camera_with(lens, 50.0, 1.4, focus_distance_m=0.45)
    before_film = distance_from_film_m(at_mark)
    assert 0.45 + 0.05 < before_film < 0.45 + 0.11  # the image distance, more or less the way between the pupils
    assert not nearer_than_marked(at_mark)
    nearer = replace(at_mark, focus_distance_m=0.45 - 1.3 * (before_film - 0.45))
    assert nearer_than_marked(nearer)
    assert any("nearer than the 0.45 m that are marked on it" in note for note in lens_report(nearer).notes)
    assert not any("marked" in note for note in lens_report(at_mark).notes)


def test_a_pinhole_has_no_bokeh_and_no_disc_of_diffraction() -> None:
    report = lens_report(camera_with(Lens("pinhole"), 35.0, 0.0))
    assert report.bokeh is None
    assert report.airy_um == 0
    assert "no glass" in report.notes[0]


def test_the_section_shows_elements_stop_film_and_vignetted_rays() -> None:
    camera = known(PLANAR)
    section = lens_section(camera)
    assert len(section.glasses) == 7
    assert section.stop_mm[1] == pytest.approx(24.292 / 2, rel=1e-3)
    axial, _, corner = section.beams
    assert axial.angle_deg == 0
    whole = [ray for ray in axial.rays if not ray.blocked]
    assert len(whole) >= 7
    assert all(ray.points_mm[-1, 0] == section.film_mm[0] for ray in whole)
    assert np.abs([ray.points_mm[-1, 1] for ray in whole]).max() < 0.1
    blocked = [ray for ray in corner.rays if ray.blocked]
    assert blocked
    assert all(ray.points_mm[-1, 0] < section.film_mm[0] for ray in blocked)
    reached = [ray.points_mm[-1, 1] for ray in corner.rays if not ray.blocked]
    np.testing.assert_allclose(reached, -corner.height_mm, atol=0.5)


def test_an_ideal_lens_has_a_section_without_glass() -> None:
    section = lens_section(thin())
    assert section.glasses == ()
    for beam in section.beams:
        assert {round(float(ray.points_mm[-1, 1]), 9) for ray in beam.rays} == {round(-beam.height_mm, 9)}
